"""Tails whose motors give a torque: each turns as fast as it can, and their phases drift or lock.

Each tail has its own phase ``phi_i``, whose rate, and the swimmer's velocity, `motors` say at the
phases of all; pose, phases and the work of the motors are followed in time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.gait.units import unit
from microswim.numerics.array import Array, sealed
from microswim.path.motors import Motors, motors_of, one_for_each
from microswim.path.on_hooks import OnHooks
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

#: Of the phases and the pose, relative and absolute (rad, body lengths).
TOLERANCE = 1e-8
#: Evaluations of a path, after which it is given up: some minutes.
MOST = 2_000_000


@checks.given(
    swimmer=checks.swimmer,
    times=checks.series,
    model=checks.one_of("rft", "bem"),
    level=checks.one_of("coarse", "standard", "fine"),
    tolerance=checks.above_zero("number"),
    workers=checks.at_least(0),
    progress=checks.function,
)
def own_motors(
    swimmer: Swimmer,
    times: Any,
    *,
    torque: Any = None,
    no_load: Any = None,
    knee: Any = None,
    phase: Any = None,
    axes: Any = None,
    model: Literal["rft", "bem"] = "rft",
    level: Literal["coarse", "standard", "fine"] = "standard",
    tolerance: float = TOLERANCE,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Follow a swimmer whose motors give a torque each; their phases drift, or lock.

    Parameters
    ----------
    swimmer
        With one tail or several; their frequencies do not matter.
    times
        Increasing, (m,).
    torque
        Of the motors, one number or n; it turns a tail the way a positive frequency does. By
        default what the swimmer's own `Motor` says.
    no_load
        Rate of the motors without load (rad per time), one number or n: their torque falls in a
        straight line from `torque` at rest to none there. None: the torque is constant.
    knee
        Rate (rad per time), one number or n, up to which the torque does not fall.
    phase
        Of the tails at the start (rad), n; by default ``tail.phase`` of each.
    axes
        Of tails on a `Hook` at the start, (n, 3) in the body; by default as they are at rest.
    model
        ``"rft"``: resistive force theory, where tails feel one another through the body's motion
        alone; ``"bem"``: boundary elements, where they feel one another's flow, solved at some
        phases of all tails that are kept in the user's cache.
    level
        Of the boundary elements.
    tolerance
        Error of a time step, in radians and lengths of the body.
    workers, progress
        Of the boundary elements: processes (default: one a core); called with (solves done, solves
        foreseen).

    Returns
    -------
    Dataset
        Over ``time``: ``phase`` and ``rate`` (time, tail), ``torque`` (time, tail), ``position``,
        ``quaternion``, ``velocity`` (body frame), ``motor_work`` of all motors since the start;
        with a `Hook` ``tail_axis`` (time, tail, sqr), ``hook_bend`` (time, tail) and
        ``hook_energy``; by ``"bem"`` as attributes ``velocity_error`` (6,) and ``rate_error``
        (tail), shares of
        speed, rate of turning and rates.

    Raises
    ------
    SpecError
        If an argument has the wrong shape or is out of range.
    MicroswimError
        If so many turns do not end, or tails touch at some phases (``"bem"``).

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix")
    >>> found = ms.own_motors(robot, np.linspace(0.0, 2.0, 5), torque=120.0)
    >>> bool(abs(found.rate[-1, 0] - 2 * np.pi) < 1.0)
    True
    """
    t = np.atleast_1d(np.asarray(times, dtype=float))
    if t.ndim != 1 or t.size < 2 or not np.isfinite(t).all() or (np.diff(t) <= 0).any():
        raise SpecError("times", times, "two or more, finite and increasing")
    how = {"level": level, "workers": workers, "progress": progress} if model == "bem" else {}
    motors = motors_of(swimmer, torque, no_load, knee, model=model, **how)
    count = len(swimmer.tail.each)
    ahead = [float(tail.ahead) for tail in swimmer.tail.each]
    start = one_for_each("phase", ahead if phase is None else phase, count, "n phases (rad)")
    length = float(np.real(swimmer.body_length))
    first = at_origin(start, _axes(motors, axes))
    y = followed(motors, t, first, length, float(tolerance))
    return told(swimmer, motors, t, y)


def _axes(motors: Motors | OnHooks, given: Any) -> Array:
    """Return unit axes of the tails at the start; those at rest where none are given."""
    if given is None:
        return motors.axes
    if not len(motors.axes):
        raise SpecError("axes", given, "left out without a hook", "tails stand as they are")
    axes = np.asarray(given, float)
    size = np.linalg.norm(axes, axis=-1) if axes.shape == motors.axes.shape else np.zeros(1)
    if not (np.isfinite(axes).all() and (size > 0.0).all()):
        raise SpecError("axes", given, "a direction [s, q, r] for each tail")
    return axes / size[:, None]


def at_origin(phases: Array, axes: Array) -> Array:
    """Return the state at the start: phases (n,), place, quaternion, no work yet, axes; (k,)."""
    return np.concatenate([phases, np.zeros(3), [1.0, 0.0, 0.0, 0.0, 0.0], axes.ravel()])


def followed(
    motors: Motors | OnHooks, t: Array, first: Array, length: float, tolerance: float = TOLERANCE
) -> Array:
    """Return phases, place, quaternion, work and axes at the times, (m, k), from the `first` on.

    Raises
    ------
    MicroswimError
        If so many turns do not end.
    """
    from scipy.integrate import solve_ivp

    n, calls = len(motors.law.torque), 0

    def slope(_: float, y: Array) -> Array:
        nonlocal calls
        calls += 1
        if calls > MOST:
            raise MicroswimError(
                f"times: after {MOST:,} evaluations the motors have not come to the end; ask for a "
                "shorter time"
            )
        V, rate, swings = motors.moving(y[:n], _unit(y[n + 8 :]))
        w, x, y_, z = y[n + 3 : n + 7] / np.linalg.norm(y[n + 3 : n + 7])
        axis = np.array([x, y_, z])
        twice = 2.0 * np.cross(axis, V[:3])
        moved = V[:3] + w * twice + np.cross(axis, twice)
        turned = w * V[3:] + np.cross(axis, V[3:])
        half = 0.5 * np.array([-axis @ V[3:], *turned])
        return np.concatenate([rate, moved, half, [motors.given(rate) @ rate], swings.ravel()])

    turn = float(np.abs(motors.law.torque).max())
    scale = np.concatenate([np.ones(n), np.full(3, length), np.ones(4), [turn]])
    scale = np.append(scale, np.ones(len(first) - len(scale)))
    found = solve_ivp(slope, (t[0], t[-1]), first, "DOP853", t, rtol=tolerance,
                      atol=tolerance * scale)  # fmt: skip
    if not found.success:
        raise MicroswimError(f"the motors' phases were not followed: {found.message}")
    y = found.y.T.copy()
    y[:, n + 3 : n + 7] /= np.linalg.norm(y[:, n + 3 : n + 7], axis=1, keepdims=True)
    y[:, n + 8 :] = _unit(y[:, n + 8 :]).reshape(len(y), -1)
    return y


def _unit(axes: Array) -> Array:
    """Return unit axes (..., n, 3) of rows (..., 3n)."""
    each = axes.reshape(*axes.shape[:-1], -1, 3)
    return each / np.linalg.norm(each, axis=-1, keepdims=True)


def told(swimmer: Swimmer, motors: Motors | OnHooks, t: Array, y: Array) -> xr.Dataset:
    """Return what `own_motors` gives, of states at the times as of `followed`."""
    import xarray as xr

    from microswim.gait.gait import DEGREES_OF_FREEDOM

    n = len(motors.law.torque)
    axes = _unit(y[:, n + 8 :])
    V, rate, _ = map(np.array, zip(*(motors.moving(p, e) for p, e in zip(y[:, :n], axes))))
    torque = motors.given(rate)

    def said(kind: str, text: str) -> dict[str, str]:
        return {"units": unit(swimmer.units, kind), "long_name": text}

    phase = {"units": "rad", "long_name": "phase of each tail"}
    turns = said("angular rate", "rate of each motor, relative to the body")
    found = xr.Dataset(
        {
            "phase": (("time", "tail"), y[:, :n], phase),
            "rate": (("time", "tail"), rate, turns),
            "torque": (("time", "tail"), torque, said("torque", "that each motor gives")),
            "position": (("time", "axis"), y[:, n : n + 3], said("length", "body centre, lab")),
            "quaternion": (("time", "wxyz"), y[:, n + 3 : n + 7], {"units": "1"}),
            "motor_work": (("time",), y[:, n + 7], said("work", "of all motors")),
            "velocity": (("time", "dof"), V, {"long_name": "velocity, body frame"}),
        },
        coords={
            "time": ("time", t, {"units": unit(swimmer.units, "time")}),
            "tail": np.arange(n),
            "axis": list("xyz"),
            "wxyz": list("wxyz"),
            "dof": list(DEGREES_OF_FREEDOM),
        },
        attrs={"model": motors.model, "units": swimmer.units, **_errors(motors)},
    )
    if isinstance(motors, OnHooks):
        found = found.assign(_of_hooks(motors, axes, said)).assign_coords(sqr=list("sqr"))
    return sealed(found)


def _of_hooks(motors: OnHooks, axes: Array, said: Any) -> dict[str, Any]:
    """Return how tails stand on their hooks."""
    points = {"long_name": "axis of each tail, in the body"}
    bend = {"units": "rad", "long_name": "bend of each hook"}
    return {
        "tail_axis": (("time", "tail", "sqr"), axes, points),
        "hook_bend": (("time", "tail"), motors.bend(axes), bend),
        "hook_energy": (("time",), motors.stored(axes), said("work", "in all hooks")),
    }


def _errors(motors: Motors | OnHooks) -> dict[str, Any]:
    """Return the errors of a model that knows them."""
    if motors.error is None:
        return {}
    from microswim.gait.gait import DEGREES_OF_FREEDOM

    each = [motors.error[name] for name in DEGREES_OF_FREEDOM]
    return {"velocity_error": each, "rate_error": motors.error["rates"], "how": motors.error["how"]}
