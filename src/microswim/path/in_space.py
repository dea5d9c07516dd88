"""A path in a field that depends on place: the field pulls as well as turns.

Force ``J' m`` and torque ``m x B`` at the body's centre, integrated by an adaptive Runge-Kutta
method of order 8 (SciPy's DOP853) in position, quaternion and phase.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait.gait import Gait
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.swimmer.magnetism.applied_field import AppliedField

TOLERANCE = 1e-9


def follow(
    gait: Gait,
    t: Array,
    rate: Callable[[float], float],
    moment: Array,
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
    moment, field
        Magnetic moment, body frame, and the field.
    load
        Further force, torque and flow at a time, lab frame.
    max_step
        Longest step.

    Raises
    ------
    MicroswimError
        If the path cannot be followed, as next to the source of the field.
    """
    from scipy.integrate import solve_ivp  # nobody waits for it without such a field

    def change(time: float, y: Array) -> Array:
        place, q, phase = y[:3], y[3:7] / np.linalg.norm(y[3:7]), y[7]
        Q = rotation_matrix(q)
        force, torque, flow = load(time)
        pull = field.gradient(time, place).T @ (Q @ moment)
        wrench = np.concatenate([Q.T @ (force + pull), Q.T @ torque])
        wrench[3:] += np.cross(moment, Q.T @ field.at(time, place))
        turning = rate(time)
        V = np.real(gait.velocity(phase, turning, wrench))
        spin = multiply(q, np.concatenate([[0.0], V[3:]])) / 2.0
        return np.concatenate([Q @ V[:3] + flow, spin, [turning]])

    x0, q0, phase0 = start
    y0 = np.concatenate([x0, q0, [float(phase0)]])
    scale = np.concatenate([np.full(3, length_of(gait)), np.ones(5)])
    found = solve_ivp(
        change, (t[0], t[-1]), y0, "DOP853", t, rtol=TOLERANCE, atol=TOLERANCE * scale,
        max_step=max_step,
    )  # fmt: skip
    if not found.success or not np.isfinite(found.y).all():
        raise MicroswimError(
            "the path cannot be followed to its end: it leads to the source of the field, or the "
            "field changes too fast"
        )
    q = found.y[3:7].T
    return found.y[:3].T, q / np.linalg.norm(q, axis=1, keepdims=True), found.y[7]


def length_of(gait: Gait) -> float:
    """Return a length of the swimmer, from its resistances to turning and to moving."""
    R = np.real(gait.resistance(0.0))
    return float(np.sqrt(np.trace(R[3:, 3:]) / np.trace(R[:3, :3])))
