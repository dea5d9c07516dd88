"""The path of a swimmer whose motors give a torque: every tail at a phase of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.path import outcome
from microswim.path.own_motors import followed, motors_of, own_motors
from microswim.swimmer.parts import with_part
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

LOOSE = 30.0  #: times the tolerance: a second march, for the error of the first
_AROUND = ("wall", "channel", "magnet", "field", "gravity", "flow", "noise")


def check_alone(swimmer: Swimmer, model: str, pushed: bool) -> None:
    """Refuse what does not act on a path by the torque of motors.

    Raises
    ------
    SpecError
        If there is something around, a load or noise, or another model is asked for.
    """
    mend = "leave out [motor], or this"
    for name in _AROUND:
        if getattr(swimmer, name) is not None:
            raise SpecError(
                f"{name}: motors of given torque are followed in still free fluid; {mend}"
            )
    if pushed:
        raise SpecError(f"force, torque: motors of given torque are followed without; {mend}")
    if model not in ("auto", "rft"):
        raise SpecError(
            "model", model, "auto or rft with [motor]", "tails then act through the body"
        )


def fastest(swimmer: Swimmer) -> float:
    """Return the period of the fastest motor at the start."""
    motors = motors_of(swimmer)
    rate = motors.turning(np.array([float(t.ahead) for t in swimmer.tail.each]))[1]
    return float(2.0 * np.pi / np.abs(rate).max())


def follow_motors(
    swimmer: Swimmer, times: Array, start: tuple[Array, Array], phase: float, tolerance: float
) -> Any:
    """Return the path at the times as `microswim.path` does, from a pose; ``phase`` (time, tail).

    Beside it the rate, torque and phase of each motor, and their work.
    """
    ahead = [float(tail.ahead) + phase for tail in swimmer.tail.each]
    found = own_motors(swimmer, times, phase=ahead, tolerance=tolerance)
    off = _off(swimmer, found, tolerance)
    x, q = start
    moved = found.position.values @ rotation_matrix(q).T + x
    turned = np.array([multiply(q, one) for one in found.quaternion.values])
    found = found.drop_vars("velocity").assign(
        position=(found.position.dims, moved, found.position.attrs),
        quaternion=(found.quaternion.dims, turned, found.quaternion.attrs),
    )
    return outcome.with_numbers(found, {}, _ends(swimmer, moved, found, off))


def _off(swimmer: Swimmer, found: xr.Dataset, tolerance: float) -> float:
    """Distance by which a second march with looser steps ends elsewhere."""
    phases, ends = found.phase.values[0], found.time.values[[0, -1]]
    size = float(np.real(swimmer.body_length))
    loose = followed(motors_of(swimmer), ends, phases, size, LOOSE * tolerance)
    n = len(phases)
    return float(np.linalg.norm(loose[-1, n : n + 3] - found.position.values[-1]))


def _ends(swimmer: Swimmer, x: Array, found: xr.Dataset, off: float) -> dict[str, Any]:
    radius, turn = outcome.circling(x, np.array([0.0, 0.0, 1.0]))
    span = float(found.time[-1] - found.time[0])
    length = 2.0 * float(swimmer.body.semi_axes3[0]) + float(swimmer.tail.apparent_length)
    return {
        "outcome": outcome.ended(np.full(1, np.inf), np.inf, length, 0.0, turn),
        "circle_radius": np.nan if radius is None else radius,
        "circle_sense": "" if turn is None else "counterclockwise" if turn > 0 else "clockwise",
        "gap_mean": np.nan,
        "drift": (x[-1] - x[0]) / span,
        "boundary": "none",
        "tube_radius": np.nan,
        "contact": np.nan,
        "position_error": off,
    }


def by_motor(found: xr.Dataset) -> dict[str, Any]:
    """Return turns per time on average, torque at the end, and phases against the first (rad)."""
    phase = found.phase.values
    span = float(found.time[-1] - found.time[0])
    apart = phase[-1] - phase[-1, 0]
    return {
        "motor_frequency": (phase[-1] - phase[0]) / (2.0 * np.pi * span),
        "motor_torque": found.torque.values[-1],
        "phase_difference": np.arctan2(np.sin(apart), np.cos(apart)),
    }


def at_phases(swimmer: Swimmer, phases: Any) -> Swimmer:
    """Return the swimmer whose tails are at own phases (n,) where its phase is zero."""
    from dataclasses import replace

    for n, phase in enumerate(np.atleast_1d(phases)):
        name = f"tail[{n}]" if len(swimmer.tail.each) > 1 else "tail"
        tail: Any = swimmer.tail.each[n]
        new = replace(tail, phase=float(np.mod(phase, 2.0 * np.pi)))
        swimmer = replace(swimmer, **with_part(swimmer, name, new))
    return swimmer
