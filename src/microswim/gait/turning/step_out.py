"""Step-out and the onset of wobbling as numbers of a gait, with exact derivatives.

With ``N = M_WT [m]`` and the field's direction b seen from the body (module `steady_turning`), the
robot turns at ``w = B |N b|`` in every state of the cone ``b . S b = sin(psi) |N b|``, S the
symmetric part of N. Step-out is the largest of these: a stationary point under two constraints,

    A b = lambda grad g + nu b      A = N' N      g = (b . S b - sin(psi) |N b|)/2      |b| = 1

found by looking along the curve and refined by Newton's method, which runs in complex numbers too.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.turning.slopes import with_slopes
from microswim.gait.turning.soft_turning import SoftTurning
from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.numerics.rigid_motion import skew

SCAN = 720  #: directions of the field that are looked at
STEPS = 12


class Drive(NamedTuple):
    """What turns a robot.

    Parameters
    ----------
    moment
        Magnetic moment (3,), body frame.
    strength
        Of the rotating field.
    cone
        Its angle (rad) out of the plane.
    rate
        With which it turns (rad per time), positive.
    softness
        Moment per field (3, 3) of a soft magnet, None of a permanent one.
    """

    moment: Any
    strength: Any
    cone: Any = 0.0
    rate: Any = np.nan
    softness: Any = None


def mobility_of(gait: Gait) -> np.ndarray:
    """Return the twist by torque (6, 3) of a robot without force, its motor still at phase 0."""
    free = np.flatnonzero(gait.free)
    R = gait.resistance(0.0)
    M = np.zeros((6, 6), R.dtype)
    M[np.ix_(free, free)] = np.linalg.inv(R[np.ix_(free, free)])
    return M[:, 3:]


def steady(gait: Gait, drive: Drive) -> SteadyTurning:
    """Return all steady states, of the real parts."""
    M, m = np.real(mobility_of(gait)), np.real(drive.moment)
    if drive.softness is not None:
        return SoftTurning.of(M, np.real(drive.softness), float(np.real(drive.strength)),
                              float(np.real(drive.cone)))  # fmt: skip
    return SteadyTurning(M, m, float(np.real(drive.strength)), float(np.real(drive.cone)))


def fastest(gait: Gait, drive: Drive) -> tuple[Any, Any]:
    """Return the largest rate (rad per time) that a robot follows, and its velocity there.

    Raises
    ------
    SpecError
        If a rotation is held.
    """
    check_free(gait)
    if drive.softness is not None:
        return tuple(with_slopes(_of_a_soft_one, gait, drive)[:2])
    M, m = mobility_of(gait), np.asarray(drive.moment)
    N, lean = M[3:] @ skew(m), np.sin(drive.cone)
    b = _of_the_largest(N, lean, steady(gait, drive))
    turn = N @ b
    size = np.sqrt(turn @ turn)
    along = (M[:3] @ skew(m) @ b) @ turn / size
    return drive.strength * size, drive.strength * along


def onset(gait: Gait, drive: Drive) -> Any:
    """Return the rate (rad per time) at which wobbling begins; NaN for a field with a cone.

    Raises
    ------
    SpecError
        If a rotation is held.
    """
    check_free(gait)
    if np.real(drive.cone):
        return np.nan
    if drive.softness is not None:
        return with_slopes(_of_a_soft_one, gait, drive)[2]
    M = mobility_of(gait)
    N = M[3:] @ skew(np.asarray(drive.moment))
    S = (N + N.T) / 2.0
    values, vectors = np.linalg.eigh(np.real(S))
    b, value = vectors[:, 1].astype(N.dtype), values[1]
    for _ in range(3 if np.iscomplexobj(N) else 0):
        J = np.block([[S - value * np.eye(3), -b[:, None]], [b[None], np.zeros((1, 1))]])
        step = _solve(J, np.append(S @ b - value * b, (b @ b - 1.0) / 2.0))
        b, value = b - step[:3], value - step[3]
    turn = N @ b
    return drive.strength * np.sqrt(turn @ turn)


def _of_a_soft_one(gait: Gait, drive: Drive) -> np.ndarray:
    """Return step-out, the velocity there, and the onset of wobbling."""
    states = steady(gait, drive)
    at_most = states.at_step_out
    velocity = np.nan if at_most is None else float(at_most.velocity)
    return np.array([states.step_out, velocity, states.wobbling_onset])


def check_free(gait: Gait) -> None:
    """Refuse a gait whose rotations are held."""
    if not all(gait.free[3:]):
        raise SpecError(
            "motion.free: step-out and wobbling are those of a robot that can tilt; free its "
            'rotations, motion.free = "all"'
        )


def _of_the_largest(N: Any, lean: Any, states: SteadyTurning) -> Any:
    """Return b of the largest rate: refined from the best that was looked at, in N of size one.

    Newton's method may leap away from a flat maximum; then it starts from the end of what is held.
    """
    N = N / np.linalg.norm(np.real(N))
    start = _start(states)
    if not np.any(np.real(N @ start)):
        return np.nan * start  # no state is held
    b = _refined(N, lean, start)
    if _is_at(N, b, start):
        return b
    at_most = states.at_step_out
    if at_most is None:
        return b
    b = _refined(N, lean, at_most.field)
    return b if _is_at(N, b, at_most.field) else at_most.field


def _is_at(N: Any, b: Any, start: np.ndarray) -> bool:
    """Return whether a refined direction is a unit vector, with the rate of where it started."""
    first, last = (np.linalg.norm(np.real(N @ x)) for x in (start, b))
    one = abs(np.linalg.norm(np.real(b)) - 1.0) < 1e-9
    return bool(one and (1.0 - 1e-9) * first <= last < 1.01 * first)


def _start(states: SteadyTurning) -> np.ndarray:
    if states.cone:
        at_most = states.at_step_out
        return np.array([1.0, 0.0, 0.0]) if at_most is None else at_most.field
    b = states.curves[0](np.linspace(0.0, 2.0 * np.pi, SCAN, endpoint=False))
    N = states.mobility[3:] @ skew(states.moment)
    return b[np.argmax(np.linalg.norm(b @ N.T, axis=-1))]


def _refined(N: Any, lean: Any, b: Any) -> Any:
    """Newton's method on ``[b, lambda, nu]``, real first, then with the imaginary parts."""
    start = np.real(b)
    gradient = _conditions(np.real(N), np.real(lean), np.append(start, [0.0, 0.0]))[2]
    A = np.real(N).T @ np.real(N)
    first = np.linalg.lstsq(np.stack([gradient, start], axis=1), A @ start, rcond=None)[0]
    y = np.concatenate([start, first])
    for n, lean_n in ((np.real(N), np.real(lean)), (N, lean)):
        y = y.astype(np.result_type(y, n))
        for _ in range(STEPS):
            F, J, _ = _conditions(n, lean_n, y)
            step = _solve(J, F)
            y = y - step
            if np.abs(step[:3]).max() < 1e-15:
                break
        if not np.iscomplexobj(N) and np.ndim(lean) == 0 and not np.iscomplexobj(lean):
            break
    return y[:3]


def _conditions(N: Any, lean: Any, y: Any) -> tuple[Any, Any, Any]:
    """Return the conditions (5,), their derivatives (5, 5), and grad g."""
    b, factor, multiplier = y[:3], y[3], y[4]
    A, S, one = N.T @ N, (N + N.T) / 2.0, np.eye(3)
    size = np.sqrt(b @ A @ b)
    slope = S @ b - lean / 2.0 * (A @ b) / size
    bend = S - lean / 2.0 * (A / size - np.outer(A @ b, A @ b) / size**3)
    g = (b @ S @ b - lean * size) / 2.0
    F = np.concatenate([A @ b - factor * slope - multiplier * b, [g, (b @ b - 1.0) / 2.0]])
    J = np.zeros((5, 5), F.dtype)
    J[:3, :3] = A - factor * bend - multiplier * one
    J[:3, 3], J[:3, 4], J[3, :3], J[4, :3] = -slope, -b, slope, b
    return F, J, slope


def _solve(J: Any, F: Any) -> Any:
    return np.linalg.lstsq(J, F, rcond=1e-12)[0]
