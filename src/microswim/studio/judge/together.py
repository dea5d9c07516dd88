"""Two swimmers in one fluid: each in the flow of the other, followed from where they are put."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.numerics.plain import plain
from microswim.path.of_group import group_path
from microswim.studio.judge.path import A_TURN, rounded, rows_of, speed, turns_of
from microswim.studio.spec_tables import swimmer_of
from microswim.swimmer.group import Group
from microswim.swimmer.member import Member

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
    """Return the group that a question puts together.

    Raises
    ------
    SpecError
        If there are not two members, or one cannot swim in company.
    """
    given = question.get("members")
    if not isinstance(given, list) or len(given) != MOST:
        raise SpecError("members: give two, each with tables, position, direction, roll and phase")
    members = []
    for n, one in enumerate(given):
        if not isinstance(one, dict):
            raise SpecError(f"members[{n}]: an object with tables and position")
        placed = {name: one[name] for name in PLACED if name in one}
        try:
            members.append(Member(swimmer=swimmer_of(one.get("tables")), **placed))
        except SpecError as error:
            raise SpecError(f"{'AB'[n]}: {error}") from None
    return Group(tuple(members))


def _fastest(group: Group) -> float:
    """Turns per time of the faster motor."""
    rate = max(abs(float(m.swimmer.tail.frequency)) for m in group.members)
    if not rate:
        raise SpecError("together: neither has a motor that turns; give a tail a frequency")
    return rate


def _alone(question: dict[str, Any], group: Group, times: np.ndarray) -> list[float]:
    """How fast each swims by itself; two of a kind are asked once."""
    first, second = (one["tables"] for one in question["members"])
    alike = first == second
    found = []
    for member in group.members[: 1 if alike else MOST]:
        path = group_path(Group((member,)), times, level="coarse")
        found.append(speed(path.position.values[:, 0], times))
    return found * MOST if alike else found
