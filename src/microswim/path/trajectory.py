"""Trajectory: the pose of a swimmer in time [Tabak Eq. 16] from its gait and the loads on it.

Position and unit quaternion by a Runge-Kutta-Munthe-Kaas method of order 4: Runge-Kutta in the
rotation vector u of the step, ``u' = w + u x w / 2 + u x (u x w) / 12`` (Munthe-Kaas 1999), so the
quaternion keeps its norm. A steadily driven swimmer repeats the screw motion of one period.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.held import warn_if_held
from microswim.gait.stepping import integrate, pack
from microswim.gait.units import unit
from microswim.numerics.array import sealed
from microswim.numerics.rigid_motion import ScrewMotion, multiply, rotation_matrix
from microswim.path.in_space import follow
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.magnetism.magnet import Magnet, magnetic_of, vector_of

if TYPE_CHECKING:
    import xarray as xr

MOST_STEPS = 5e6  #: of a path; they take some seconds, and memory for the loads
LOADS = ("force", "torque", "field", "flow", "moment")


def _moment(name: str, value: Any) -> None:
    """Refuse what is neither a `Magnet` nor a load."""
    if not isinstance(value, Magnet):
        checks.load(name, value)


@checks.given(
    gait=checks.gait,
    times=checks.series,
    rate=checks.load,
    force=checks.load,
    torque=checks.load,
    moment=_moment,
    flow=checks.load,
    position=checks.series,
    quaternion=checks.series,
    max_step=checks.above_zero("time"),
)
def trajectory(
    gait: Gait,
    times: Any,
    *,
    rate: Any = None,
    force: Any = None,
    torque: Any = None,
    moment: Any = None,
    field: Any = None,
    flow: Any = None,
    position: Any = None,
    quaternion: Any = None,
    phase: float = 0.0,
    max_step: float | None = None,
) -> xr.Dataset:
    """Return the pose of a swimmer at the given times.

    A load is a vector (3,), constant in time, or a function of an array of times (n,) that
    returns (n, 3). With a constant rate and no load but a constant flow the path is built from
    the screw motion of one period, so that a thousand periods cost no more than one.

    Parameters
    ----------
    gait
        Gait of the swimmer.
    times
        Times, increasing, shape (n,); the pose given holds at the first.
    rate
        Phase rate of the motor: a number or a function of times; the gait's own by default.
        Zero for a swimmer without motor, such as a rigid magnetised helix.
    force, torque
        External force on the body's centre and torque, lab frame.
    moment, field
        Magnetic moment fixed in the body (body frame, constant) and field B in the lab frame:
        torque ``m x B``. Also a `Magnet`, which may be soft, and a `RotatingField` or another
        field of a spec; one that depends on place pulls as well.
    flow
        Uniform background velocity, lab frame.
    position, quaternion, phase
        Pose at the first time (default: origin, axes parallel to the lab's) and phase.
    max_step
        Longest time step; by default 1/64 of a motor period and 1/40 of a radian of rotation.

    Returns
    -------
    xarray.Dataset
        Over ``time``: ``position`` (time, axis) of the body's centre in the lab frame,
        ``quaternion`` (time, wxyz) body to lab, ``phase``.

    Raises
    ------
    SpecError
        If an argument has the wrong shape or is not finite, the loads turn the swimmer so fast that
        the path would never end, or the gait holds at one pose.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> gait = ms.Swimmer.preset("tabak/helix").gait()
    >>> path = ms.trajectory(gait, np.linspace(0, 10, 101))
    >>> bool(path.position[-1, 0] < 0)
    True
    """
    gait.check_path()
    t = np.atleast_1d(np.asarray(times, dtype=float))
    if t.ndim != 1 or not np.isfinite(t).all() or (np.diff(t) <= 0).any():
        raise SpecError("times", times, "finite and increasing")
    start = _start(position, quaternion, phase)
    soft = isinstance(moment, Magnet) and bool(moment.softness.any())
    if soft and not isinstance(field, AppliedField):
        raise SpecError(
            "field", field, "a field of a spec, such as ms.UniformField, with a soft magnet"
        )
    if isinstance(field, AppliedField) and (soft or not field.is_periodic):
        checks.numbers("moment", () if moment is None else vector_of(moment), 3,
                       "three numbers, or a Magnet")  # fmt: skip
        magnetic = magnetic_of(moment)
        warn_if_held(gait, magnetic)
        further = {"force": force, "torque": torque, "flow": flow}
        x, q, angle = _in_space(gait, t, rate, magnetic, field, further, start, max_step)
        return dataset(gait, t, x, q, angle)
    moment = None if moment is None else vector_of(moment)
    if isinstance(field, AppliedField):
        field = field.at
    for name, given in (("moment", moment), ("field", field)):
        if given is not None:
            checks.load(name, given)
    loads = {"force": force, "torque": torque, "field": field, "flow": flow, "moment": moment}
    if callable(moment):
        raise SpecError("moment", "a function", "a constant vector (3,) fixed in the body")
    if moment is not None and field is not None:
        warn_if_held(gait, moment)
    steady = not callable(rate) and not callable(flow) and max_step is None
    if steady and all(loads[k] is None for k in ("force", "torque", "field")):
        x, q, angle = _steady(gait if rate is None else gait.at_rate(rate), t, start)
        x = x + (t - t[0])[:, None] * _load("flow", flow, t[:1])
    else:
        x, q, angle = _driven(gait, t, gait.rate if rate is None else rate, loads, start, max_step)
    return dataset(gait, t, x, q, angle)


def _in_space(
    gait: Gait,
    t: np.ndarray,
    rate: Any,
    magnetic: np.ndarray,
    field: AppliedField,
    further: dict[str, Any],
    start: tuple[np.ndarray, ...],
    max_step: float | None,
) -> tuple[np.ndarray, ...]:
    """Poses in a field that depends on place."""
    speed = gait.rate if rate is None else rate

    def at(time: float) -> float:
        return float(_rate(speed, np.array([time]))[0])

    def load(time: float) -> Any:
        return [_load(k, v, np.array([time]))[0] for k, v in further.items()]

    fastest = max(field.rate, abs(at(t[0])))
    longest = max_step or (np.pi / 4.0 / fastest if fastest else np.inf)
    return follow(gait, t, at, magnetic, field, load, start, longest)


def _start(position: Any, quaternion: Any, phase: Any) -> tuple[np.ndarray, ...]:
    x = np.zeros(3) if position is None else np.array(position, dtype=float)
    q = np.array([1.0, 0, 0, 0]) if quaternion is None else np.array(quaternion, dtype=float)
    checks.numbers("position", x, 3, "three finite numbers")
    checks.numbers("quaternion", q, 4, "four finite numbers wxyz")
    one = phase[()] if isinstance(phase, np.ndarray) else phase  # the last of an earlier path
    checks.number("phase", one, "a finite number")
    norm = np.linalg.norm(q)
    if not 0.99 < norm < 1.01:
        raise SpecError("quaternion", quaternion, "a unit quaternion wxyz")
    return x, q / norm, np.array(phase, dtype=float)


def _load(name: str, load: Any, times: np.ndarray) -> np.ndarray:
    """Values of a load at the times, (n, 3); (1, 3) if it is constant."""
    if load is None:
        return np.zeros((1, 3))
    values = checks.reals(name, load(times) if callable(load) else load)
    shape = (times.size, 3) if callable(load) else (3,)
    if values.shape != shape or not (np.abs(values) <= checks.LARGEST).all():
        raise SpecError(name, load, "finite, a vector (3,) or a function of times (n,) to (n, 3)")
    return values.reshape(-1, 3)


def _steady(gait: Gait, t: np.ndarray, start: tuple[np.ndarray, ...]) -> tuple[np.ndarray, ...]:
    """Poses of a steadily driven swimmer by powers of its screw motion.

    After n periods and a time r < T the pose is ``g(r)`` composed with ``g(T)^n``.
    """
    x0, q0, phase0 = start
    angle = phase0 + gait.rate * (t - t[0])
    if gait.rate == 0:
        still = np.zeros((t.size, 1))
        return x0 + np.zeros(3) * still, q0 + still, angle
    cycles = np.floor((t - t[0]) / gait.period)
    rest = np.clip(t - t[0] - cycles * gait.period, 0.0, gait.period)
    unique, where = np.unique(np.concatenate([[0.0], rest, [gait.period]]), return_inverse=True)
    counts = np.ceil(np.diff(unique, prepend=0.0) / gait.period * 256).astype(np.int64)
    identity = np.array([1.0, 0, 0, 0])
    X, Q, _ = integrate(
        *(pack(gait), np.array(gait.free), np.zeros(3), identity, float(phase0)),
        *(unique, counts, np.array([float(gait.rate)]), np.zeros((1, 5, 3))),
    )
    x, q = X[where[1:-1]], Q[where[1:-1]]
    moved, turned = ScrewMotion(X[-1], Q[-1], gait.period).power(cycles)
    local = moved + np.einsum("nij,nj->ni", rotation_matrix(turned), x)
    return x0 + local @ rotation_matrix(q0).T, multiply(q0, multiply(turned, q)), angle


def _driven(
    gait: Gait,
    t: np.ndarray,
    rate: Any,
    loads: dict[str, Any],
    start: tuple[np.ndarray, ...],
    max_step: float | None,
) -> tuple[np.ndarray, ...]:
    """Poses under loads or a varying rate, step by step."""
    coarse = np.linspace(t[0], t[-1], max(257, 4 * t.size))
    sampled = {k: _load(k, v, coarse) for k, v in loads.items()}
    speeds = _rate(rate, coarse)
    h = max_step or _longest_step(gait, speeds, sampled)
    counts = _counts(t, h)
    halves = _half_steps(t, counts)
    values = {k: _load(k, v, halves) for k, v in loads.items()}
    n = max(len(v) for v in values.values())
    table = np.stack([np.broadcast_to(values[k], (n, 3)) for k in LOADS], axis=1)
    x0, q0, phase0 = start
    return integrate(
        *(pack(gait), np.array(gait.free), x0, q0, float(phase0), t, counts),
        *(_rate(rate, halves), np.ascontiguousarray(table)),
    )


def _counts(t: np.ndarray, h: float) -> np.ndarray:
    """Steps of at most h up to each time, one at least.

    Raises
    ------
    SpecError
        If they are more than would end.
    """
    steps = np.ceil(np.diff(t, prepend=t[0]) / h - 1e-9)
    if not steps.sum() <= MOST_STEPS:
        few = "loads and rate are too large for this time, or the time too long for them"
        raise SpecError(f"times: {steps.sum():.3g} steps are more than {MOST_STEPS:g}; {few}")
    counts = steps.astype(np.int64)
    counts[1:] = np.maximum(counts[1:], 1)
    return counts


def _rate(rate: Any, times: np.ndarray) -> np.ndarray:
    values = checks.reals("rate", rate(times) if callable(rate) else [rate])
    shape = (times.size,) if callable(rate) else (1,)
    if values.shape != shape or not (np.abs(values) <= checks.LARGEST).all():
        raise SpecError("rate", rate, "a finite number or a function of times (n,) to (n,)")
    return values


def _longest_step(gait: Gait, rates: np.ndarray, loads: dict[str, np.ndarray]) -> float:
    """1/64 of a motor period, 1/40 of a radian of body rotation under the largest loads."""
    top = {k: np.linalg.norm(v, axis=1).max() for k, v in loads.items()}
    fastest = np.abs(rates).max()
    phase = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    unit = np.abs(gait.at_rate(1.0).velocity(phase)[:, 3:]).sum(axis=1).max()
    f = np.flatnonzero(gait.free)
    mobility = np.zeros((6, 6))
    mobility[np.ix_(f, f)] = np.linalg.inv(gait.resistance(0.0)[np.ix_(f, f)])
    turn = fastest * unit + np.linalg.norm(mobility[3:, :3], 2) * top["force"]
    turn += np.linalg.norm(mobility[3:, 3:], 2) * (top["torque"] + top["moment"] * top["field"])
    limits = [2.0 * np.pi / 64.0 / fastest if fastest > 0 else np.inf]
    limits.append(0.025 / turn if turn > 0 else np.inf)
    shortest = min(limits)
    return shortest if np.isfinite(shortest) else 1.0


def _half_steps(t: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Times of starts, middles and ends of all steps in a row."""
    h = np.repeat(np.diff(t, prepend=t[0]) / np.maximum(counts, 1), counts)
    base = np.repeat(np.concatenate([t[:1], t[:-1]]), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    nth = np.arange(counts.sum()) - first
    starts = base + nth * h
    out = np.empty(2 * h.size + 1)
    out[0:-1:2], out[1::2], out[-1] = starts, starts + h / 2.0, t[-1]
    return out


def dataset(gait: Any, t: Any, x: Any, q: Any, angle: Any) -> xr.Dataset:
    """Return positions, quaternions and phases at the times, of one path or of several."""
    import xarray as xr

    length, time = (unit(gait.units, kind) for kind in ("length", "time"))
    many = ("path",) if np.ndim(x) == 3 else ()
    return sealed(
        xr.Dataset(
            {
                "position": (
                    (*many, "time", "axis"),
                    x,
                    {"units": length, "long_name": "body centre, lab"},
                ),
                "quaternion": (
                    (*many, "time", "wxyz"),
                    q,
                    {"units": "1", "long_name": "attitude, body to lab"},
                ),
                "phase": ("time", np.asarray(angle), {"units": "rad"}),
            },
            coords={
                "time": ("time", t, {"units": time}),
                "axis": list("xyz"),
                "wxyz": list("wxyz"),
            },
            attrs={"model": gait.model, "units": gait.units},
        )
    )
