"""Tails whose motors give a torque: each turns as fast as it can, and their phases drift or lock.

Each tail has its own phase ``phi_i``; by resistive force theory R is the body's and the sum of the
tails', each at its own phase, and with the rates ``w_i`` of the motors

    R(phi) V + sum_i F_i(phi_i) w_i = 0             on the free axes
    F_i . V + G_i(phi_i) w_i = tau_i(w_i)

the second the torque that motor i gives: constant T, or T up to a knee K and from there in a
straight line to none at its rate without load W (`Motor`). What phases do to one another goes
through the motion of the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.gait.units import unit
from microswim.models.rft.gait import body_resistance, tail_series
from microswim.models.rft.placed import at_own_rates, moved
from microswim.numerics.array import Array, sealed
from microswim.numerics.series.fourier import evaluate
from microswim.swimmer.parts import replaced
from microswim.swimmer.physical_sense import require_drag, require_tail
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

#: Of the phases and the pose, relative and absolute (rad, body lengths).
TOLERANCE = 1e-8
#: Evaluations of a path, after which it is given up: some minutes.
MOST = 2_000_000
#: Trials of which motors turn beyond their knee.
MOST_TRIALS = 50


@dataclass(frozen=True, eq=False)
class Motors:
    """A swimmer of n tails, each with its own motor and phase.

    Parameters
    ----------
    body
        Resistance of the body (6, 6).
    tails
        Of each tail the series of ``B_t``, ``F_p`` and G in its own phase.
    free
        Which of the six motions are free, (6,).
    torque
        T of each motor, (n,).
    no_load
        Rate of each motor without load (rad per time), (n,); infinite for a constant torque.
    knee
        Rate up to which the torque does not fall, (n,); not a number where it falls from rest on.
    """

    body: Array
    tails: tuple[tuple[Array, ...], ...]
    free: NDArray[np.bool_]
    torque: Array
    no_load: Array
    knee: Array

    def given(self, rate: Array) -> Array:
        """Return the torque of each motor at its rate, (n,)."""
        level, slope = self._line
        line = level - slope * rate
        sign = np.sign(self.torque)
        return np.where(
            np.isnan(self.knee), line, sign * np.minimum(sign * self.torque, sign * line)
        )

    @property
    def _line(self) -> tuple[Array, Array]:
        """Torque at rest and slope of each line that falls to none at W; flat without W."""
        constant = np.isinf(self.no_load)
        low = np.where(np.isnan(self.knee), 0.0, self.knee)
        high = np.where(constant, 1.0, self.no_load)
        slope = np.where(constant, 0.0, self.torque / (high - np.where(constant, 0.0, low)))
        return np.where(constant, self.torque, slope * high), slope

    def at(self, phases: Array) -> tuple[Array, Array, Array]:
        """Return R (6, 6), F (6, n) and G (n,) at the phases (n,)."""
        each = [[evaluate(s, p) for s in tail] for tail, p in zip(self.tails, phases)]
        R, F, G = zip(*each)
        return self.body + np.sum(R, axis=0), np.array(F).T, np.array(G)

    def turning(self, phases: Array) -> tuple[Array, Array]:
        """Return twist V (6,) and rates (n,) at the phases (n,).

        Motors beyond their knee are those that turn faster than it: found by trying, since each
        that weakens slows them all, a few times at most.

        Raises
        ------
        MicroswimError
            If that does not end.
        """
        R, F, G = self.at(phases)
        R, F = R[np.ix_(self.free, self.free)], F[self.free]
        level, slope = self._line
        falls = np.isnan(self.knee)
        for _ in range(MOST_TRIALS):
            both: Any = np.linalg.solve(
                np.block([[R, F], [F.T, np.diag(G + np.where(falls, slope, 0.0))]]),
                np.concatenate([np.zeros(len(R)), np.where(falls, level, self.torque)]),
            )
            rate = both[len(R) :]
            beyond = np.isnan(self.knee) | (np.sign(self.torque) * (rate - self.knee) > 0.0)
            if (beyond == falls).all():
                V = np.zeros(6)
                V[self.free] = both[: len(R)]
                return V, rate
            falls = beyond
        raise MicroswimError(
            "the rates of the motors were not found at their knees; move the knees"
        )


def motors_of(
    swimmer: Swimmer, torque: Any = None, no_load: Any = None, knee: Any = None
) -> Motors:
    """Return the motors of a swimmer by resistive force theory; its own `Motor` without a torque.

    Raises
    ------
    SpecError
        If torques or rates are not one number, or one for each tail.
    """
    require_tail(swimmer, "motors of their own")
    require_drag(swimmer)
    if swimmer.tail.settles or swimmer.region is not None:
        raise SpecError(
            "tail: motors of given torque turn tails of a given shape, by the surrogate without a "
            "region calibration; leave [region] out, or take another kind of tail"
        )
    tails = at_own_rates(swimmer.tail)
    law = _laws(swimmer, len(tails), torque, no_load, knee)
    series = tuple(
        moved(tail_series(replaced(swimmer, "tail", t.own)), swimmer, t, ahead=0.0) for t in tails
    )
    free = np.array(swimmer.motion.mask)
    return Motors(body_resistance(swimmer), series, free, *law)


def _laws(
    swimmer: Swimmer, count: int, torque: Any, no_load: Any, knee: Any
) -> tuple[Array, Array, Array]:
    """T, W and K of each motor: as given, else those of the swimmer's motor."""
    if torque is None:
        if swimmer.motor is None:
            raise SpecError("torque: missing; give it, or the swimmer a motor ([motor])")
        if no_load is not None or knee is not None:
            raise SpecError("no_load, knee: those of a torque that is given; give torque too")
        return swimmer.motor.of_each(count)
    T = _one_for_each("torque", torque, count, "a torque, or one for each tail")
    W, K = np.full(count, np.inf), np.full(count, np.nan)
    allowed = "a rate other than zero (rad per time), or one for each tail"
    if no_load is not None:
        W = _one_for_each("no_load", no_load, count, allowed)
        if not (W * T > 0.0).all():
            raise SpecError("no_load", no_load, "of the sign of the torque", allowed)
    if knee is not None:
        K = _one_for_each("knee", knee, count, allowed)
        if not ((K * T > 0.0) & (np.abs(K) < np.abs(W)) & np.isfinite(W)).all():
            raise SpecError("knee", knee, "of the sign of the torque, and below no_load")
    return T, W, K


def _one_for_each(name: str, value: Any, count: int, allowed: str) -> Array:
    each = list(value) if np.ndim(value) == 1 else [value] * count
    checks.numbers(name, each, count, allowed)
    return np.array(each, float)


@checks.given(swimmer=checks.swimmer, times=checks.series, tolerance=checks.above_zero("number"))
def own_motors(
    swimmer: Swimmer,
    times: Any,
    *,
    torque: Any = None,
    no_load: Any = None,
    knee: Any = None,
    phase: Any = None,
    tolerance: float = TOLERANCE,
) -> xr.Dataset:
    """Follow a swimmer whose motors give a torque each; their phases drift, or lock.

    By resistive force theory, where tails feel one another through the body's motion alone.

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
    tolerance
        Error of a time step, in radians and lengths of the body.

    Returns
    -------
    Dataset
        Over ``time``: ``phase`` and ``rate`` (time, tail), ``torque`` (time, tail), ``position``,
        ``quaternion``, ``velocity`` (body frame), ``motor_work`` of all motors since the start.

    Raises
    ------
    SpecError
        If an argument has the wrong shape or is out of range.
    MicroswimError
        If so many turns do not end.

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
    motors = motors_of(swimmer, torque, no_load, knee)
    count = len(motors.tails)
    ahead = [float(tail.ahead) for tail in swimmer.tail.each]
    start = _one_for_each("phase", ahead if phase is None else phase, count, "n phases (rad)")
    length = float(np.real(swimmer.body_length))
    y = followed(motors, t, at_origin(start), length, float(tolerance))
    return told(swimmer, motors, t, y)


def at_origin(phases: Array) -> Array:
    """Return the state at the start: phases (n,), place, quaternion, no work yet; (n + 8,)."""
    return np.concatenate([phases, np.zeros(3), [1.0, 0.0, 0.0, 0.0, 0.0]])


def followed(
    motors: Motors, t: Array, first: Array, length: float, tolerance: float = TOLERANCE
) -> Array:
    """Return phases, place, quaternion and work at the times, (m, n + 8), from the `first` on.

    Raises
    ------
    MicroswimError
        If so many turns do not end.
    """
    from scipy.integrate import solve_ivp

    n, calls = len(first) - 8, 0

    def slope(_: float, y: Array) -> Array:
        nonlocal calls
        calls += 1
        if calls > MOST:
            raise MicroswimError(
                f"times: after {MOST:,} evaluations the motors have not come to the end; ask for a "
                "shorter time"
            )
        V, rate = motors.turning(y[:n])
        w, x, y_, z = y[n + 3 : n + 7] / np.linalg.norm(y[n + 3 : n + 7])
        axis = np.array([x, y_, z])
        twice = 2.0 * np.cross(axis, V[:3])
        moved = V[:3] + w * twice + np.cross(axis, twice)
        turned = w * V[3:] + np.cross(axis, V[3:])
        half = 0.5 * np.array([-axis @ V[3:], *turned])
        return np.concatenate([rate, moved, half, [motors.given(rate) @ rate]])

    turn = float(np.abs(motors.torque).max())
    scale = np.concatenate([np.ones(n), np.full(3, length), np.ones(4), [turn]])
    found = solve_ivp(slope, (t[0], t[-1]), first, "DOP853", t, rtol=tolerance,
                      atol=tolerance * scale)  # fmt: skip
    if not found.success:
        raise MicroswimError(f"the motors' phases were not followed: {found.message}")
    y = found.y.T.copy()
    y[:, n + 3 : n + 7] /= np.linalg.norm(y[:, n + 3 : n + 7], axis=1, keepdims=True)
    return y


def told(swimmer: Swimmer, motors: Motors, t: Array, y: Array) -> xr.Dataset:
    """Return what `own_motors` gives, of phases, places, quaternions and work as of `followed`."""
    import xarray as xr

    from microswim.gait.gait import DEGREES_OF_FREEDOM

    n = y.shape[1] - 8
    V, rate = map(np.array, zip(*(motors.turning(p) for p in y[:, :n])))
    torque = motors.given(rate)

    def said(kind: str, text: str) -> dict[str, str]:
        return {"units": unit(swimmer.units, kind), "long_name": text}

    phase = {"units": "rad", "long_name": "phase of each tail"}
    turns = said("angular rate", "rate of each motor, relative to the body")
    return sealed(
        xr.Dataset(
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
            attrs={"model": "rft", "units": swimmer.units},
        )
    )
