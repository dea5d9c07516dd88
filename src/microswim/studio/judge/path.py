"""Where a swimmer goes: its path under all that its spec says, beside its wall or in its tube.

It comes in the axes that the body has at the start, as the scene has them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from microswim import checks
from microswim.calibration.poses.around import around
from microswim.calibration.poses.scattered import Scatter
from microswim.calibration.poses.solved import SolvedPoses
from microswim.calibration.poses.wall import Grid
from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.numerics.plain import plain
from microswim.path.following import path as followed
from microswim.path.remembering import remembers
from microswim.studio.answers import surrogate
from microswim.studio.spec_tables import swimmer_of
from microswim.swimmer.magnetism.applied_field import RotatingField
from microswim.swimmer.swimmer import Swimmer

Progress = Callable[[int, int], None]
USUAL, MOST_TURNS = 300, 20_000  #: turns of the motor
A_TURN, MOST_PLACES = 8, 3000
#: How many poses are solved: some, for a first look, or as many as `microswim path` takes.
SOME: dict[str, dict[str, Any]] = {
    "wall": {"grid": Grid(gaps=6, tilts=4, phases=5, left_out=8)},
    "channel": {"scatter": Scatter(poses=160, left_out=8)},
}
TOLD = ("outcome", "circle_radius", "circle_sense", "gap_mean", "position_error", "boundary")


def path(question: dict[str, Any], progress: Progress) -> dict[str, Any]:
    """Return the places of a swimmer in time, where it ends up, and how well its poses are known.

    Beside a wall and in a tube poses are solved first, and kept: ``"poses"`` says how many.

    Raises
    ------
    SpecError, MicroswimError
        If the path cannot be followed.
    """
    swimmer = swimmer_of(question["tables"])
    turns = turns_of(question, USUAL, MOST_TURNS)
    options: dict[str, Any] = {}
    if swimmer.wall is not None or swimmer.channel is not None:
        options["poses"] = around(swimmer, progress=progress, **many_of(question, swimmer))
    elif not remembers(swimmer):
        options["gait"] = surrogate(swimmer)
    samples = max(round(min(A_TURN * turns, MOST_PLACES)), 1) + 1
    found = followed(swimmer, turns * period(swimmer), samples=samples, **options)
    x, q, phase = (found[name].values for name in ("position", "quaternion", "phase"))
    told = {name: found.attrs.get(name) for name in TOLD}
    return {
        "time": rounded(found.time.values),
        "swimmers": [rows_of(*seen_from_start(x, q), phase)],
        "numbers": plain({**told, "speed": speed(x, found.time.values), "turns": turns}),
        "expected_error": _errors(options.get("poses")),
    }


def _errors(poses: SolvedPoses | None) -> dict[str, float]:
    """Of each velocity, where poses were solved."""
    told = {} if poses is None else poses.expected_error
    return {name: float(told[name]) for name in DEGREES_OF_FREEDOM if name in told}


def many_of(question: dict[str, Any], swimmer: Swimmer) -> dict[str, Any]:
    """Return which poses are solved: nothing for all, as `around` takes it.

    Raises
    ------
    SpecError
        If it is no such word.
    """
    word = question.get("poses", "some")
    checks.choice("poses", word, ("some", "all"))
    boundary = "wall" if swimmer.wall is not None else "channel"
    return SOME[boundary] if word == "some" else {}


def turns_of(question: dict[str, Any], usual: float, most: float) -> float:
    """Return how many turns of the motor, or of the field, a path is asked for.

    Raises
    ------
    SpecError
        If it is no such number.
    """
    turns = question.get("turns", usual)
    if not isinstance(turns, (int, float)) or not 1 <= turns <= most:
        raise SpecError("turns", turns, f"a number from 1 to {most}")
    return float(turns)


def period(swimmer: Swimmer) -> float:
    """Return the time of a turn of the motor, or of the field where there is no motor.

    Raises
    ------
    SpecError
        If nothing turns.
    """
    frequency = 0.0 if swimmer.tail.is_absent else abs(float(swimmer.tail.frequency))
    if not frequency and isinstance(swimmer.field, RotatingField):
        frequency = abs(float(swimmer.field.frequency))
    if not frequency:
        raise SpecError(
            "path: nothing turns that would say for how long; give the tail or the field a "
            "frequency, or take microswim path with --time"
        )
    return 1.0 / frequency


def speed(x: np.ndarray, t: np.ndarray) -> float:
    """Return the length of a path of about `A_TURN` places a turn over its time, wobble apart."""
    chords = np.diff(x[::A_TURN], axis=0)
    last = (len(x) - 1) // A_TURN * A_TURN
    return float(np.linalg.norm(chords, axis=1).sum() / (t[last] - t[0])) if last else 0.0


def seen_from_start(x: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and quaternions wxyz in the axes of the first pose, from its place."""
    back = Rotation.from_quat(q[0], scalar_first=True).inv()
    turned = back * Rotation.from_quat(q, scalar_first=True)
    return back.apply(x - x[0]), turned.as_quat(scalar_first=True)


def rows_of(x: np.ndarray, q: np.ndarray, phase: np.ndarray) -> dict[str, list[float]]:
    """Return positions (3 n), quaternions (4 n) and phases (n,) for the page."""
    return {"x": rounded(x), "q": rounded(q), "phase": rounded(phase)}


def rounded(values: np.ndarray) -> list[float]:
    """Return numbers of seven digits: a tenth of them is felt by an eye."""
    return [float(f"{v:.7g}") for v in values.ravel()]
