"""One control period beside a wall or in a tube, compiled: as `motion`, R and F_p of the pose.

    R V + F_p rate = W + S e + contact        V relative to the flow

What the boundary adds is that of a path (`microswim.path.velocity`): lubrication, the short-range
repulsion of contact, Poiseuille's flow in a tube, whose velocity on the axis is `flow`. A part of a
step that would reach through the boundary, or change the gap by more than `SHARE` of it, is halved.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from microswim.control.motion import (
    FLOW_BENDS,
    body_strain,
    field_at,
    graded,
    internal_steps,
    turned,
    wrench,
)
from microswim.gait.poses.table import TUBE, near, resist
from microswim.gait.poses.table import WORK as POSE_WORK
from microswim.gait.stepping import row
from microswim.numerics.compiling.compiled import njit, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.solve6 import solve
from microswim.path.contact import add_contact
from microswim.path.velocity import add_carried, add_kept_off, matrix

SHARE = 0.5  #: of the gap by which it may change in a part of a step
DONE, INSIDE, TOO_FAR = 0, 1, 2  #: how a step ends

compiled = njit(cache=True, error_model="numpy")


class Around(NamedTuple):
    """What a boundary is to a stepper, as plain arrays.

    Parameters
    ----------
    table
        A `PoseTable`.
    free
        Degrees of freedom that are free (6,).
    strain
        Series of S (1 + 2 H, 36): wrench on the swimmer held in a strain.
    contact
        As `microswim.path.contact.repulsion` has it.
    """

    table: Any
    free: np.ndarray
    strain: np.ndarray
    contact: np.ndarray


#: Scratch: R, its copy, F_p, W, touch, rotation, gradient, a state, velocities, a row of a table.
WORK = 36 + 36 + 6 + 6 + 14 + 9 + 9 + 8 + 16 + POSE_WORK
_STATE, _OUT, _TABLE = 116, 124, 140


@compiled
def flow_at(around: Any, u: Any, x: Any, G: Any) -> Any:
    """Write the gradient of the flow at a place (3, 3); return its velocity there."""
    u0, u1, u2 = u[13], u[14], u[15]
    for i in range(3):
        for j in range(3):
            G[i, j] = u[16 + 3 * i + j]
    if around.table.kind == TUBE:  # its axis is the x axis
        per = 1.0 / around.table.boundary[6] ** 2
        u0 *= 1.0 - per * (x[1] * x[1] + x[2] * x[2])
        G[0, 1], G[0, 2] = -2.0 * per * u[13] * x[1], -2.0 * per * u[13] * x[2]
        return u0, u1, u2
    u0 += G[0, 0] * x[0] + G[0, 1] * x[1] + G[0, 2] * x[2]
    u1 += G[1, 0] * x[0] + G[1, 1] * x[1] + G[1, 2] * x[2]
    u2 += G[2, 0] * x[0] + G[2, 1] * x[1] + G[2, 2] * x[2]
    return u0, u1, u2


@compiled
def velocity(
    around: Any, magnetic: Any, x: Any, q: Any, phase: Any, u: Any, B: Any, bends: int, out: Any,
    work: Any,
) -> Any:  # fmt: skip
    """Write velocity (lab), angular velocity (body), and V relative to the flow, (12,).

    Returns the gap, not positive where the swimmer reaches into the boundary and nothing is
    written; leaves F_p in work[72:78] and the power of the motor held, or 0, in out[12].
    """
    R, A = work[:36].reshape((6, 6)), work[36:72].reshape((6, 6))
    F, W, touch = work[72:78], work[78:84], work[84:98]
    Q, G, values = work[98:107].reshape((3, 3)), work[107:116].reshape((3, 3)), work[_TABLE:]
    out[12] = resist(around.table, x, q, phase, R, F, touch, values)
    if touch[0] <= 0.0:
        return touch[0]
    matrix(q, Q)
    W[0], W[1], W[2], W[3], W[4], W[5] = wrench(magnetic, q, x, u, B, bends)
    for i in range(6):
        for j in range(6):
            A[i, j] = R[i, j]
    f0, f1, f2 = flow_at(around, u, x, G)
    add_contact(around.contact, touch, W, u[0], (f0, f1, f2), G)
    flows = bends & FLOW_BENDS or f0 != 0.0 or f1 != 0.0 or f2 != 0.0
    if around.table.kind == TUBE:
        if flows:
            add_carried(
                around.table, u[13] * around.table.boundary[3], x, q, phase, Q, (f0, f1, f2), G,
                touch, R, W, values,
            )  # fmt: skip
    elif flows:
        if bends & FLOW_BENDS:
            e = body_strain(q, u)
            row(around.strain, phase, values)
            for i in range(6):
                for k in range(6):
                    W[i] += values[6 * i + k] * e[k]
        add_kept_off(around.table, phase, Q, (f0, f1, f2), G, touch, R, W, values)
    for i in range(6):
        W[i] -= F[i] * u[0]
    solve(A, W, around.free)
    c0, c1, c2 = (G[2, 1] - G[1, 2]) / 2.0, (G[0, 2] - G[2, 0]) / 2.0, (G[1, 0] - G[0, 1]) / 2.0
    out[0] = f0 + Q[0, 0] * W[0] + Q[0, 1] * W[1] + Q[0, 2] * W[2]
    out[1] = f1 + Q[1, 0] * W[0] + Q[1, 1] * W[1] + Q[1, 2] * W[2]
    out[2] = f2 + Q[2, 0] * W[0] + Q[2, 1] * W[1] + Q[2, 2] * W[2]
    for i in range(3):
        out[3 + i] = W[3 + i] + Q[0, i] * c0 + Q[1, i] * c1 + Q[2, i] * c2
    for i in range(6):
        out[6 + i] = W[i]
    return touch[0]


@compiled
def substep(
    around: Any, magnetic: Any, y: Any, u: Any, t: Any, h: Any, bends: int, work: Any
) -> int:
    """Step at order 4, as `motion.substep`; y is overwritten if it is taken.

    Returns `DONE`, `INSIDE` where it starts in the boundary, or `TOO_FAR`. Of no length it leaves
    what `velocity` writes.
    """
    q, place, out = (y[3], y[4], y[5], y[6]), work[_STATE : _STATE + 3], work[_OUT : _OUT + 13]
    attitude = work[_STATE + 3 : _STATE + 7]
    x0, x1, x2, r0, r1, r2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # moved, turned
    v0, v1, v2, ahead, first = 0.0, 0.0, 0.0, 0.0, 0.0
    out[0], out[1], out[2] = 0.0, 0.0, 0.0
    B = field_at(u, t)
    for i in range(4):
        if i == 1 or i == 3:
            ahead = h / 2.0 if i == 1 else h
            B = field_at(u, t + ahead)
        for k in range(3):
            place[k] = y[k] + ahead * out[k]
        attitude[0], attitude[1], attitude[2], attitude[3] = turned(q, (v0, v1, v2))
        phase = y[7] + u[0] * ahead
        gap = velocity(around, magnetic, place, attitude, phase, u, B, bends, out, work)
        if gap <= 0.0:
            return INSIDE if i == 0 else TOO_FAR
        first = gap if i == 0 else first
        w0, w1, w2 = out[3], out[4], out[5]
        c0, c1, c2 = v1 * w2 - v2 * w1, v2 * w0 - v0 * w2, v0 * w1 - v1 * w0
        s0 = w0 + c0 / 2.0 + (v1 * c2 - v2 * c1) / 12.0
        s1 = w1 + c1 / 2.0 + (v2 * c0 - v0 * c2) / 12.0
        s2 = w2 + c2 / 2.0 + (v0 * c1 - v1 * c0) / 12.0
        weight = h / 6.0 if i == 0 or i == 3 else h / 3.0
        x0, x1, x2 = x0 + weight * out[0], x1 + weight * out[1], x2 + weight * out[2]
        r0, r1, r2 = r0 + weight * s0, r1 + weight * s1, r2 + weight * s2
        reach = h if i == 2 else h / 2.0
        v0, v1, v2 = reach * s0, reach * s1, reach * s2
    a, b, c, d = turned(q, (r0, r1, r2))
    unit = 1.5 - 0.5 * (a * a + b * b + c * c + d * d)
    place[0], place[1], place[2] = y[0] + x0, y[1] + x1, y[2] + x2
    attitude[0], attitude[1], attitude[2], attitude[3] = a * unit, b * unit, c * unit, d * unit
    phase = y[7] + u[0] * h
    gap = near(around.table, place, attitude, phase, work[84:98], work[_TABLE:])
    if not gap > 0.0 or abs(gap - first) > SHARE * first:
        return TOO_FAR
    for k in range(3):
        y[k] = place[k]
    for k in range(4):
        y[3 + k] = attitude[k]
    y[7] = phase
    return DONE


@compiled
def advance(
    around: Any, magnetic: Any, limits: Any, y: Any, u: Any, dt: Any, steps: int, most: int,
    work: Any,
) -> int:  # fmt: skip
    """Advance one state by dt in so many steps, 0 = as many as it takes; y is overwritten.

    Returns as `substep`, `TOO_FAR` where it would take too many parts. A time of 0 moves nothing.
    """
    n = steps if steps > 0 else internal_steps(limits, u, dt)
    whole, bends, tried, t = dt / n, graded(u), 0, 0.0
    part = whole
    for _ in range(n):
        left = whole
        while left > 0.0 or dt == 0.0:
            tried += 1
            if tried > most + n:
                return TOO_FAR
            h = part if part < 0.999999 * left else left
            how = substep(around, magnetic, y, u, t, h, bends, work)
            if how == INSIDE or dt == 0.0:
                return how
            if how == DONE:
                t += h
                left = left - h if h < left else 0.0
                part = min(2.0 * h, whole)
            else:
                part = 0.5 * h
    return DONE


@loop(error_model="numpy")
def advance_all(
    table: Any, free: Any, strain: Any, contact: Any, magnetic: Any, limits: Any, Y: Any, U: Any,
    dt: Any, steps: int, most: int, status: Any, out: Any, work: Any,
) -> None:  # fmt: skip
    """Advance all states, in blocks with one row of `work` each; `status` (n,) says how it went.

    The first four are those of `Around`, which on all cores cannot hold a table. `out` (n, 19):
    what `velocity` wrote last, and F_p.
    """
    blocks, n = work.shape[0], Y.shape[0]
    for b in prange(blocks):
        around = Around(table, free, strain, contact)
        for i in range(b * n // blocks, (b + 1) * n // blocks):
            u = U[i if U.shape[0] > 1 else 0]
            status[i] = advance(around, magnetic, limits, Y[i], u, dt, steps, most, work[b])
            for k in range(13):
                out[i, k] = work[b, _OUT + k]
            for k in range(6):
                out[i, 13 + k] = work[b, 72 + k]


def rows_of_work(blocks: int) -> np.ndarray:
    """Return scratch for so many blocks."""
    return np.empty((blocks, WORK))
