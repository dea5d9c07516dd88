"""A path in a field that depends on place: the field pulls as well as turns.

Force ``J' m`` and torque ``m x B`` at the body's centre, ``m = m_0 + C B`` in the body frame,
integrated by an adaptive Runge-Kutta method of order 8 (SciPy's DOP853) in position, quaternion
and phase.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait.gait import Gait
from microswim.gait.stepping import length_of
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.path.velocity import WORK, Loads, velocity
from microswim.swimmer.magnetism.applied_field import AppliedField

TOLERANCE = 1e-9


def follow(
    gait: Gait,
    t: Array,
    rate: Callable[[float], float],
    magnetic: Array,
    field: AppliedField,
    load: Callable[[float], tuple[Array, Array, Array]],
    start: tuple[Array, ...],
    max_step: float,
) -> tuple[Array, Array, Array]:
    """Return positions (n, 3), quaternions (n, 4) and phases (n,) at the times.

    Parameters
    ----------
    gait, t, start
        Gait, increasing times, and position, quaternion and phase at the first.
    rate
        Phase rate of the motor at a time.
    magnetic, field
        m_0, then C row by row (12,), body frame, and the field.
    load
        Further force, torque and flow at a time, lab frame.
    max_step
        Longest step.

    Raises
    ------
    MicroswimError
        If the path cannot be followed, as next to the source of the field.
    """

    def change(time: float, y: Array) -> Array:
        place, q, phase = y[:3], y[3:7] / np.linalg.norm(y[3:7]), y[7]
        Q = rotation_matrix(q)
        force, torque, flow = load(time)
        B, J = field.at(time, place), field.gradient(time, place)
        pull, turn = magnetic_wrench(magnetic, B, J, Q)
        wrench = np.concatenate([Q.T @ (force + pull), Q.T @ torque + turn])
        turning = rate(time)
        V = np.real(gait.velocity(phase, turning, wrench))
        spin = multiply(q, np.concatenate([[0.0], V[3:]])) / 2.0
        return np.concatenate([Q @ V[:3] + flow, spin, [turning]])

    x0, q0, phase0 = start
    y0 = np.concatenate([x0, q0, [float(phase0)]])
    scale = np.concatenate([np.full(3, length_of(gait)), np.ones(5)])
    y = _integrated(change, t, y0, TOLERANCE, scale, max_step)
    q = y[:, 3:7]
    return y[:, :3], q / np.linalg.norm(q, axis=1, keepdims=True), y[:, 7]


def follow_loads(
    table: Any, loads: Loads, field: AppliedField, t: Array, start: tuple[Array, Array, float],
    control: tuple[float, float, float],
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Return positions (n, 3), quaternions (n, 4) and the two works (n, 2) at the times.

    As `microswim.path.march` does it, in a field that depends on place as well.

    Parameters
    ----------
    table, loads, field
        Gait at every pose; loads, whose magnet the field acts on.
    t, start
        Increasing times, and position, quaternion and phase at the first.
    control
        Tolerance of a step, a length, longest step.

    Raises
    ------
    MicroswimError
        If the path cannot be followed, as next to the source of the field.
    """
    out, work, kick = np.empty(8), np.empty(WORK), np.zeros(6)
    x0, q0, phase0 = start

    def change(time: float, y: Array) -> Array:
        place, q = y[:3].copy(), y[3:7] / np.linalg.norm(y[3:7])
        B, J = field.at(time, place), field.gradient(time, place)
        pull, _ = magnetic_wrench(loads.magnetic, B, J, rotation_matrix(q))
        waves = np.array([B, np.zeros(3), np.zeros(3)])
        here = loads._replace(force=loads.force + pull, field=waves)
        phase = phase0 + loads.rate * (time - t[0])
        gap = velocity.dispatcher(table, here, time, place, q, phase, kick, out, work)
        if gap <= 0.0:
            return np.full(9, np.nan)
        spin = multiply(q, np.concatenate([[0.0], out[3:6]])) / 2.0
        return np.concatenate([out[:3], spin, out[6:]])

    tolerance, length, longest = control
    power = abs(loads.rate * float(np.abs(loads.activity).sum() * loads.rate)) or 1.0
    heat = power * (t[-1] - t[0])
    scale = np.concatenate([np.full(3, length), np.ones(4), np.full(2, heat)])
    y = _integrated(change, t, np.concatenate([x0, q0, np.zeros(2)]), tolerance, scale, longest)
    q = y[:, 3:7]
    return y[:, :3], q / np.linalg.norm(q, axis=1, keepdims=True), y[:, 7:]


def magnetic_wrench(magnetic: Array, B: Array, J: Array, Q: Array) -> tuple[Array, Array]:
    """Return the force (lab frame) and the torque (body frame) of a field on a magnet.

    Parameters
    ----------
    magnetic
        m_0, then C row by row (12,), body frame.
    B, J, Q
        Field (3,) and its gradient ``dB_i/dx_j`` (3, 3) there, lab frame; rotation matrix body to
        lab (3, 3).
    """
    own = Q.T @ B
    moment = magnetic[:3] + magnetic[3:].reshape(3, 3) @ own
    return J.T @ (Q @ moment), np.cross(moment, own)


def _integrated(
    change: Callable[[float, Array], Array], t: Array, y0: Array, tolerance: float, scale: Array,
    longest: float,
) -> Array:  # fmt: skip
    """Return the states (n, k) at the times."""
    from scipy.integrate import solve_ivp  # nobody waits for it without such a field

    found = solve_ivp(
        change, (t[0], t[-1]), y0, "DOP853", t, rtol=tolerance, atol=tolerance * scale,
        max_step=longest,
    )  # fmt: skip
    if not found.success or not np.isfinite(found.y).all():
        raise MicroswimError(
            "the path cannot be followed to its end: it leads to the source of the field, or the "
            "field changes too fast"
        )
    return found.y.T
