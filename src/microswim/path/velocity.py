"""Velocity of a swimmer at a pose under all its loads, compiled.

    R V + F_p rate = W + S e + C c         V relative to the flow u(x), body frame
    x' = Q V + u(x)     w = Omega + Q' curl u / 2

W: force and torque, weight in its two middles, torque of the field, contact with a boundary;
S e: strain of the flow, C c: its curvature (`microswim.path.strain`). R, F_p: at this pose
(`microswim.gait.poses.table`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from microswim.gait.poses.lubricated import kept_off, kept_off_wall
from microswim.gait.poses.table import TUBE, WALL, carry, resist
from microswim.gait.poses.table import WORK as POSE_WORK
from microswim.gait.stepping import row
from microswim.numerics.compiling.compiled import compiled
from microswim.numerics.solve6 import solve
from microswim.path.contact import add_contact, cross_to

STILL, LINEAR, CURVED = 0, 1, 2  #: flows: none that bends or turns, one gradient, Poiseuille's


class Loads(NamedTuple):
    """Everything that acts on a swimmer, as plain arrays; vectors in the lab frame unless said.

    Parameters
    ----------
    rate
        Phase rate of the motor.
    free
        Degrees of freedom that are free (6,).
    force, torque
        Constant, weight included (3,).
    gravity
        Acceleration (3,), times the series `arm` a torque.
    arm
        Series (1 + 2 H, 3) of ``sum (rho_i - rho_f) V_i r_i`` about the body's centre, body frame.
    magnetic
        Moment m_0, then C row by row of ``m = m_0 + C B``, body frame (12,).
    field
        Rows of ``B = B_0 + B_1 cos(w t) + B_2 sin(w t)`` (3, 3).
    field_rate
        w (rad per time).
    flow, gradient
        Velocity at the lab's origin (3,) and its gradient (3, 3).
    tube
        Poiseuille's flow: axis (3,), a point of it (3,), speed on it, 1/a^2.
    bends
        `STILL`, `LINEAR` or `CURVED`.
    strain, curved
        Series of S (1 + 2 H, 36) and of C (1 + 2 H, 108).
    activity
        Series of the motor's power per squared rate with the body held.
    contact
        As `contact.repulsion` has it.
    """

    rate: float
    free: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    gravity: np.ndarray
    arm: np.ndarray
    magnetic: np.ndarray
    field: np.ndarray
    field_rate: float
    flow: np.ndarray
    gradient: np.ndarray
    tube: np.ndarray
    bends: int
    strain: np.ndarray
    curved: np.ndarray
    activity: np.ndarray
    contact: np.ndarray


#: Scratch of `velocity`: R, its copy, F_p, W, touch, rotation, gradient, a row of a table.
WORK = 36 + 36 + 6 + 6 + 14 + 9 + 9 + POSE_WORK
_TABLE = 36 + 36 + 6 + 6 + 14 + 9 + 9


@compiled()
def matrix(q: Any, Q: Any) -> None:
    """Write the rotation matrix (3, 3) of a unit quaternion, body to lab."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    Q[0, 0], Q[0, 1], Q[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    Q[1, 0], Q[1, 1], Q[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    Q[2, 0], Q[2, 1], Q[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@compiled()
def into_body(Q: Any, v: Any) -> Any:
    """Return the components of a vector of the lab in the body frame."""
    return (
        Q[0, 0] * v[0] + Q[1, 0] * v[1] + Q[2, 0] * v[2],
        Q[0, 1] * v[0] + Q[1, 1] * v[1] + Q[2, 1] * v[2],
        Q[0, 2] * v[0] + Q[1, 2] * v[1] + Q[2, 2] * v[2],
    )


@compiled()
def add_loads(loads: Any, t: Any, phase: Any, Q: Any, W: Any, values: Any) -> Any:
    """Add force, torque, weight and field to W; return the motor's part against the weight."""
    for i in range(3):
        f, m = 0.0, 0.0
        for k in range(3):
            f += Q[k, i] * loads.force[k]
            m += Q[k, i] * loads.torque[k]
        W[i] += f
        W[3 + i] += m
    c, n = np.cos(loads.field_rate * t), np.sin(loads.field_rate * t)
    B, g = loads.field, loads.gravity
    b0, b1, b2 = into_body(Q, B[0] + c * B[1] + n * B[2])
    for i in range(3):
        c = 3 + 3 * i
        values[i] = loads.magnetic[i]
        values[i] += (
            loads.magnetic[c] * b0 + loads.magnetic[c + 1] * b1 + loads.magnetic[c + 2] * b2
        )
    cross_to(W, 3, values, b0, b1, b2)
    g0, g1, g2 = into_body(Q, g)
    row(loads.arm, phase, values)
    cross_to(W, 3, values, g0, g1, g2)
    lifted = 0.0  # d/dphase of arm . g
    c, n = 1.0, 0.0
    for h in range(1, loads.arm.shape[0], 2):
        c, n = np.cos((h + 1) // 2 * phase), np.sin((h + 1) // 2 * phase)
        for i in range(3):
            down = g0 if i == 0 else (g1 if i == 1 else g2)
            lifted += (h + 1) // 2 * (c * loads.arm[h + 1, i] - n * loads.arm[h, i]) * down
    return lifted


@compiled()
def add_strain(loads: Any, phase: Any, Q: Any, A: Any, W: Any, values: Any) -> None:
    """Add ``S e``; e: entries 00, 11, 22, 01, 02, 12 of ``Q' (A + A')/2 Q``."""
    row(loads.strain, phase, values)
    for n, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        e = 0.0
        for k in range(3):
            for m in range(3):
                e += Q[k, i] * (A[k, m] + A[m, k]) / 2.0 * Q[m, j]
        for r in range(6):
            W[r] += values[6 * r + n] * e


@compiled()
def add_curvature(loads: Any, phase: Any, Q: Any, W: Any, values: Any) -> None:
    """Add ``C c`` of Poiseuille's flow: ``-U/a^2 e_i (X.X - (e.X)^2)`` by its monomials X_j X_k."""
    row(loads.curved, phase, values)
    e = into_body(Q, loads.tube[:3])
    bend = -loads.tube[6] * loads.tube[7]
    for i in range(3):
        for n, (j, k) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
            c = bend * e[i] * (1.0 - e[j] * e[j]) if j == k else -2.0 * bend * e[i] * e[j] * e[k]
            for r in range(6):
                W[r] += values[18 * r + 6 * i + n] * c


@compiled()
def background(loads: Any, x: Any, A: Any) -> Any:
    """Write the flow's gradient at a place; return its velocity there."""
    u0, u1, u2 = loads.flow[0], loads.flow[1], loads.flow[2]
    for i in range(3):
        for j in range(3):
            A[i, j] = loads.gradient[i, j]
    u0 += A[0, 0] * x[0] + A[0, 1] * x[1] + A[0, 2] * x[2]
    u1 += A[1, 0] * x[0] + A[1, 1] * x[1] + A[1, 2] * x[2]
    u2 += A[2, 0] * x[0] + A[2, 1] * x[1] + A[2, 2] * x[2]
    if loads.bends == CURVED:
        tube = loads.tube
        along = 0.0
        for i in range(3):
            along += (x[i] - tube[3 + i]) * tube[i]
        square = 0.0
        for j in range(3):
            y = x[j] - tube[3 + j] - along * tube[j]
            square += y * y
            for i in range(3):
                A[i, j] -= 2.0 * tube[6] * tube[7] * tube[i] * y
        speed = tube[6] * (1.0 - square * tube[7])
        u0, u1, u2 = u0 + speed * tube[0], u1 + speed * tube[1], u2 + speed * tube[2]
    return u0, u1, u2


@compiled()
def flow_twist(Q: Any, u: Any, G: Any, U: Any) -> None:
    """Write velocity and rotation (6,) of a flow at the body's centre, body frame."""
    U[0], U[1], U[2] = into_body(Q, u)
    spin = (G[2, 1] - G[1, 2]) / 2.0, (G[0, 2] - G[2, 0]) / 2.0, (G[1, 0] - G[0, 1]) / 2.0
    U[3], U[4], U[5] = into_body(Q, spin)


@compiled()
def add_kept_off(
    table: Any, phase: Any, Q: Any, u: Any, G: Any, touch: Any, R: Any, W: Any, work: Any
) -> None:
    """Take from W what a flow would press a swimmer onto its wall with, beyond free fluid."""
    values, free = work[:27], work[27:63].reshape((6, 6))
    U, D, rest = work[63:69], work[69:75], work[75:]
    flow_twist(Q, u, G, U)
    row(table.packed, phase, values)
    m = 0
    for i in range(6):
        D[i] = 0.0
        for j in range(i + 1):
            free[i, j] = free[j, i] = values[m]
            m += 1
    kept_off_wall(table.numbers, touch, R, free, U, D, rest)
    for i in range(6):
        for j in range(6):
            W[i] += R[i, j] * D[j]


@compiled()
def add_carried(
    table: Any, speed: Any, x: Any, q: Any, phase: Any, Q: Any, u: Any, G: Any, touch: Any, R: Any,
    W: Any, work: Any,
) -> None:  # fmt: skip
    """Add R times what Poiseuille's flow gives a swimmer in its tube beyond the flow itself.

    `speed`: on the tube's axis, along its direction; u, G: the flow and its gradient at the body's
    centre.
    """
    D, U = work[-6:], work[-12:-6]
    carry(table, x, q, phase, D, work)
    flow_twist(Q, u, G, U)
    for i in range(6):
        D[i] *= speed
    kept_off(table.numbers, touch, R, U, D, work)
    for i in range(6):
        for j in range(6):
            W[i] += R[i, j] * D[j]


@compiled()
def velocity(
    table: Any, loads: Any, t: Any, x: Any, q: Any, phase: Any, kick: Any, out: Any, work: Any
) -> Any:
    """Write velocity (lab), angular velocity (body), power of motor and of dissipation, (8,).

    Returns the gap to the boundary, infinite in free fluid; where it is not positive nothing is
    written. `kick` (6,) is a further twist, body frame.
    """
    R, A = work[:36].reshape((6, 6)), work[36:72].reshape((6, 6))
    F, W, touch = work[72:78], work[78:84], work[84:98]
    Q, G, values = work[98:107].reshape((3, 3)), work[107:116].reshape((3, 3)), work[_TABLE:]
    held = resist(table, x, q, phase, R, F, touch, values)
    if touch[0] <= 0.0:
        return touch[0]
    matrix(q, Q)
    for i in range(6):
        W[i] = 0.0
        for j in range(6):
            A[i, j] = R[i, j]
    lifted = add_loads(loads, t, phase, Q, W, values)
    u0, u1, u2 = background(loads, x, G)
    add_contact(loads.contact, touch, W, loads.rate, (u0, u1, u2), G)
    if table.kind == TUBE:
        if loads.bends == CURVED:
            speed = 0.0
            for i in range(3):
                speed += loads.tube[6] * loads.tube[i] * table.boundary[3 + i]
            add_carried(table, speed, x, q, phase, Q, (u0, u1, u2), G, touch, R, W, values)
    else:
        if loads.bends != STILL:
            add_strain(loads, phase, Q, G, W, values)
        if loads.bends == CURVED:
            add_curvature(loads, phase, Q, W, values)
        flows = loads.bends != STILL or u0 != 0.0 or u1 != 0.0 or u2 != 0.0
        if table.kind == WALL and flows:
            add_kept_off(table, phase, Q, (u0, u1, u2), G, touch, R, W, values)
    for i in range(6):
        W[i] -= F[i] * loads.rate
    solve(A, W, loads.free)
    row(loads.activity, phase, values)
    values[0] = held if held > 0.0 else values[0]
    work_of_tail, spent = values[0] * loads.rate, 0.0
    for i in range(6):
        work_of_tail += F[i] * W[i]
        for j in range(6):
            spent += W[i] * R[i, j] * W[j]
    out[6] = loads.rate * (work_of_tail - lifted)
    moved = work_of_tail - values[0] * loads.rate
    out[7] = spent + loads.rate * (2.0 * moved + values[0] * loads.rate)
    for i in range(6):
        W[i] += kick[i]
    out[0] = u0 + Q[0, 0] * W[0] + Q[0, 1] * W[1] + Q[0, 2] * W[2]
    out[1] = u1 + Q[1, 0] * W[0] + Q[1, 1] * W[1] + Q[1, 2] * W[2]
    out[2] = u2 + Q[2, 0] * W[0] + Q[2, 1] * W[1] + Q[2, 2] * W[2]
    c0, c1, c2 = (G[2, 1] - G[1, 2]) / 2.0, (G[0, 2] - G[2, 0]) / 2.0, (G[1, 0] - G[0, 1]) / 2.0
    for i in range(3):
        out[3 + i] = W[3 + i] + Q[0, i] * c0 + Q[1, i] * c1 + Q[2, i] * c2
    return touch[0]
