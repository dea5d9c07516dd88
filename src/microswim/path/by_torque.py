"""The path of a swimmer whose motors give a torque: every tail at a phase of its own."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.path import keeping, outcome
from microswim.path.motors import Motors, motors_of
from microswim.path.on_hooks import OnHooks, smallest_turns
from microswim.path.own_motors import at_origin, followed, told
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.parts import with_part
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

LOOSE = 30.0  #: times the tolerance: a second march, for the error of the first
CHUNKS = 48  #: in which a path grows and is kept
MOST_TURNS = 20_000  #: of the fastest motor: some minutes
_AROUND = ("wall", "channel", "magnet", "field", "gravity", "flow", "noise")


def check_alone(swimmer: Swimmer, model: str, pushed: Any, **others: Any) -> None:
    """Refuse what does not act on a path by the torque of motors, `others` by their names.

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
    for name, value in others.items():
        if value is not None:
            raise SpecError(name, value, "left out with [motor]", "its steps are adaptive")
    if model not in ("auto", "rft", "bem"):
        raise SpecError("model", model, "auto, rft or bem with [motor]", "or leave out [motor]")


def fastest(swimmer: Swimmer, motors: Motors | OnHooks) -> float:
    """Return the period of the fastest motor at the start."""
    phases = np.array([float(t.ahead) for t in swimmer.tail.each])
    rate = motors.moving(phases, motors.axes)[1]
    return float(2.0 * np.pi / np.abs(rate).max())


def follow_motors(
    swimmer: Swimmer,
    times_at: Callable[[float], Array],
    start: tuple[Array, Array],
    phase: float,
    *,
    tolerance: float,
    model: str = "rft",
    level: str | None = None,
    keep: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Any:
    """Return the path at times as `microswim.path` does, from a pose; ``phase`` (time, tail).

    Beside it the rate, torque and phase of each motor, and their work. `times_at` says the times at
    the period of the fastest motor; what a killed process kept in the file `keep` is gone on from.

    Raises
    ------
    SpecError
        If it would take too many turns, or `keep` holds another path.
    """
    how = {"level": level or "standard", "progress": progress} if model == "bem" else {}
    motors = motors_of(swimmer, model="bem" if model == "bem" else "rft", **how)
    period = fastest(swimmer, motors)
    times = times_at(period)
    turns = float(times[-1] - times[0]) / period
    if not turns <= MOST_TURNS:
        most = f"at most {MOST_TURNS:,} turns of the motors, here {turns:.3g}"
        raise SpecError("time", float(times[-1]), most, "ask for a shorter path")
    phases = np.array([float(tail.ahead) + phase for tail in swimmer.tail.each])
    first = at_origin(phases, motors.axes)
    y = _grown(swimmer, motors, times, first, tolerance, keep, progress)
    found = told(swimmer, motors, times, y)
    off = _off(swimmer, motors, found, tolerance)
    x, q = start
    moved = found.position.values @ rotation_matrix(q).T + x
    turned = np.array([multiply(q, one) for one in found.quaternion.values])
    found = found.drop_vars("velocity").assign(
        position=(found.position.dims, moved, found.position.attrs),
        quaternion=(found.quaternion.dims, turned, found.quaternion.attrs),
    )
    return outcome.with_numbers(found, {}, _ends(swimmer, moved, found, off))


def _grown(
    swimmer: Swimmer, motors: Motors | OnHooks, times: Array, first: Array, tolerance: float,
    keep: Path | None, progress: Callable[[int, int], None] | None,
) -> Array:  # fmt: skip
    """States at the times, chunk by chunk, each from the last state of the one before."""
    asked = (swimmer, times.tolist(), first.tolist(), tolerance, *_solved(motors))
    digest = sha256(repr(asked).encode()).hexdigest()
    cuts = np.unique(np.linspace(0, times.size - 1, CHUNKS + 1).astype(int))
    y, size = first[None], float(np.real(swimmer.body_length))
    if keep is not None and keep.exists():
        y = keeping.kept(keep, digest, ("states",))["states"]
    for i in range(int(np.searchsorted(cuts, len(y) - 1)), cuts.size - 1):
        part = times[cuts[i] : cuts[i + 1] + 1]
        y = np.concatenate([y, followed(motors, part, y[-1], size, tolerance)[1:]])
        if keep is not None:
            keeping.keep(keep, digest, states=y)
        if progress is not None:
            progress(i + 1, cuts.size - 1)
    return y


def _solved(motors: Motors | OnHooks) -> tuple[Any, ...]:
    """Return what of a model that was solved tells it from others."""
    return () if motors.error is None else (motors.model, motors.error)


def _off(swimmer: Swimmer, motors: Motors | OnHooks, found: xr.Dataset, tolerance: float) -> float:
    """Distance by which a second march with looser steps ends elsewhere."""
    phases, ends = found.phase.values[0], found.time.values[[0, -1]]
    size = float(np.real(swimmer.body_length))
    loose = followed(motors, ends, at_origin(phases, motors.axes), size, LOOSE * tolerance)
    n = len(phases)
    return float(np.linalg.norm(loose[-1, n : n + 3] - found.position.values[-1]))


def _ends(swimmer: Swimmer, x: Array, found: xr.Dataset, off: float) -> dict[str, Any]:
    radius, turn = outcome.circling(x, np.array([0.0, 0.0, 1.0]))
    span = float(found.time[-1] - found.time[0])
    length = float(nose_to_tip(swimmer))
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
    said = {
        "motor_frequency": (phase[-1] - phase[0]) / (2.0 * np.pi * span),
        "motor_torque": found.torque.values[-1],
        "phase_difference": np.arctan2(np.sin(apart), np.cos(apart)),
    }
    if "tail_axis" in found:
        axes = found.tail_axis.values[-1]
        widest = np.linalg.norm(axes[:, None] - axes, axis=-1).max()
        said |= {
            "hook_bend": found.hook_bend.values[-1],
            "largest_hook_bend": float(found.hook_bend.max()),
            "tail_axes": axes,
            "widest_angle": float(2.0 * np.arcsin(min(0.5 * widest, 1.0))),
        }
    return said


def at_phases(swimmer: Swimmer, phases: Any, axes: Any = None) -> Swimmer:
    """Return the swimmer whose tails are at own phases (n,), and axes (n, 3) if their hooks bend,
    where its phase is zero.
    """
    from dataclasses import replace

    if axes is not None:
        swimmer, phases = _bent(swimmer, np.array(phases, float), axes)
    tails: dict[str, Any] = swimmer.tail.named
    for (name, tail), phase in zip(tails.items(), np.atleast_1d(phases), strict=True):
        new = replace(tail, phase=float(np.mod(phase, 2.0 * np.pi)))
        swimmer = replace(swimmer, **with_part(swimmer, name, new))
    return swimmer


def _bent(swimmer: Swimmer, phases: Array, axes: Array) -> tuple[Swimmer, Array]:
    """Return the swimmer with its tails along axes, and the phases there.

    A tail placed along an axis is turned there from s by the shortest way, one on a hook from its
    axis at rest; what the two differ by is a turn about the axis, a phase.
    """
    from dataclasses import replace

    tails: dict[str, Any] = swimmer.tail.named
    for n, (name, tail) in enumerate(tails.items()):
        rest = tail.placement.rotation
        bent = smallest_turns(rest[None, :, 0], axes[n][None])[0] @ rest
        position = tuple(float(x) for x in tail.placement.root)
        placed = replace(tail, direction=tuple(axes[n].tolist()), position=position)
        roll = placed.placement.rotation.T @ bent
        phases[n] += float(tail.sign) * np.arctan2(roll[2, 1], roll[1, 1])
        swimmer = replace(swimmer, **with_part(swimmer, name, placed))
    return swimmer, phases
