"""Two swimmers in one fluid: each in the flow of the other, followed from where they are put."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.numerics.plain import plain
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.path.of_group import group_path
from microswim.studio.judge.path import A_TURN, rounded, rows_of, speed, turns_of
from microswim.studio.spec_tables import canonical, swimmer_of
from microswim.swimmer.group import Group
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.member import Member, direction_and_roll
from microswim.swimmer.swimmer import Swimmer

Progress = Callable[[int, int], None]
USUAL, MOST_TURNS = 20, 200  #: turns of the faster motor
ALONE = 2  #: turns that show how one swims alone: it goes along a screw
MOST = 2
PLACED = ("position", "direction", "roll", "phase")


def together(question: dict[str, Any], progress: Progress) -> dict[str, Any]:
    """Return the places of two swimmers in time, how fast each swims, and how fast alone.

    In the axes that the first has at the start, about where its body's centre is then.

    Raises
    ------
    SpecError, MicroswimError
        If they are not of one fluid, or come so near to each other that no estimate holds.
    """
    group = group_of(question)
    turns = turns_of(question, USUAL, MOST_TURNS)
    times = np.linspace(0.0, turns / _fastest(group), round(A_TURN * turns) + 1)
    try:
        found = group_path(group, times, level="coarse", progress=progress)
    except MicroswimError as error:
        raise MicroswimError(str(error).replace('take model = "bem"', "put them apart")) from None
    x, q, phase = (found[name].values for name in ("position", "quaternion", "phase"))
    n = len(group.members)
    numbers = {
        "turns": turns,
        "speeds": [speed(x[:, i], times) for i in range(n)],
        "alone": _alone(question, group, times[: ALONE * A_TURN + 1]),
        "apart": float(np.linalg.norm(x[-1, 0] - x[-1, -1])),
    }
    return {
        "time": rounded(times),
        "swimmers": [rows_of(x[:, i], q[:, i], phase[:, i]) for i in range(n)],
        "numbers": plain(numbers),
        "expected_error": {"us": float(found.expected_error.max())},
    }


def group_of(question: dict[str, Any]) -> Group:
    """Return the group that a question puts together, at the time that it says.

    A field that both stand in is that of the group.

    Raises
    ------
    SpecError
        If there are not two members, one cannot swim in company, or each has another field.
    """
    given = question.get("members")
    if not isinstance(given, list) or len(given) != MOST:
        raise SpecError("members: give two, each with tables, position, direction, roll and phase")
    swimmers = [_swimmer(n, one) for n, one in enumerate(given)]
    field = _field(swimmers)
    members = []
    for n, (one, own) in enumerate(zip(given, swimmers, strict=True)):
        try:
            members.append(Member(swimmer=replace(own, field=None), **_placed(one)))
        except SpecError as error:
            raise SpecError(f"{'AB'[n]}: {error}") from None
    time = question.get("time", 0.0)
    return Group(tuple(members), field=field, time=time)


def _swimmer(n: int, one: Any) -> Swimmer:
    if not isinstance(one, dict):
        raise SpecError(f"members[{n}]: an object with tables and position")
    try:
        return swimmer_of(one.get("tables"))
    except SpecError as error:
        raise SpecError(f"{'AB'[n]}: {error}") from None


def _placed(one: dict[str, Any]) -> dict[str, Any]:
    """Return what `Member` takes of where one is; a quaternion is direction and roll."""
    placed = {name: one[name] for name in PLACED if name in one}
    if "quaternion" in one:
        checks.numbers("quaternion", one["quaternion"], 4, "four numbers wxyz")
        turned = direction_and_roll(rotation_matrix(np.array(one["quaternion"], float)))
        placed["direction"], placed["roll"] = turned[0].tolist(), turned[1]
    return placed


def _field(swimmers: list[Swimmer]) -> AppliedField | None:
    """Return the field that those with a magnet stand in: one for both."""
    felt = [s.field for s in swimmers if s.magnet is not None]
    told = [canonical(s).get("field") for s in swimmers if s.magnet is not None]
    if any(one != told[0] for one in told):
        raise SpecError(
            "field: A and B stand in different fields, and two in one fluid feel one; make all of "
            "its numbers alike"
        )
    return felt[0] if felt else None


def _fastest(group: Group) -> float:
    """Turns per time of the faster motor, or of the field if that is faster."""
    tails = [m.swimmer.tail for m in group.members]
    rates = [0.0 if tail.is_absent else abs(float(tail.frequency)) for tail in tails]
    turning = 0.0 if group.field is None else abs(float(group.field.rate)) / (2.0 * np.pi)
    rate = max(*rates, turning)
    if not rate:
        raise SpecError(
            "together: neither has a motor that turns, nor a field that does; give a tail a "
            "frequency"
        )
    return rate


def _alone(question: dict[str, Any], group: Group, times: np.ndarray) -> list[float]:
    """How fast each swims by itself; two of a kind are asked once."""
    first, second = (one["tables"] for one in question["members"])
    alike = first == second
    found = []
    for member in group.members[: 1 if alike else MOST]:
        field = None if member.swimmer.magnet is None else group.field
        path = group_path(Group((member,), field=field), times, level="coarse")
        found.append(speed(path.position.values[:, 0], times))
    return found * MOST if alike else found
