"""One control period, compiled: a state and what is held over the period in, the next state out.

The state is ``y = [x (lab), q (wxyz, body to lab), phase]``, the inputs are the 37 numbers of
`INPUTS`, all vectors in the lab frame. With V from `response`

    x' = R_L U + u(x)          u(x) = flow + gradient x
    w  = Omega + R_L' curl(u)/2
    F  = force + J' m          B(t, x) = field + J (x - field_place), J = field_gradient
    T  = torque + m x B        field turned with the angular velocity field_rate

integrated by the Runge-Kutta-Munthe-Kaas method of order 4 of trajectory. No allocation; all
analytic, so that complex-step derivatives run through it. ``twist``, ``strain``: tables of M
and v, and of K, `response`; ``magnetic``: m_0 and C of the moment ``m = m_0 + C B``, body frame.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.stepping import LOWER as LOWER
from microswim.gait.stepping import row
from microswim.numerics.compiling.compiled import FAST, njit, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.rigid_motion import to_lab

INPUTS = {
    "motor_rate": slice(0, 1),
    "force": slice(1, 4),
    "torque": slice(4, 7),
    "field": slice(7, 10),
    "field_rate": slice(10, 13),
    "flow": slice(13, 16),
    "gradient": slice(16, 25),
    "field_gradient": slice(25, 34),
    "field_place": slice(34, 37),
}
STATE, INPUT = 8, 37
#: Where each begins; G and J: the gradients of flow and field, row by row.
MOTOR, FORCE, TORQUE, FIELD, TURNS, FLOW, G, J, PLACE = (s.start for s in INPUTS.values())
FLOW_BENDS, FIELD_BENDS = 1, 2  #: what has a gradient
#: Scratch: a row of the response and ``K e``.
WORK = 36 + 6

compiled = njit(cache=True, fastmath=FAST, error_model="numpy")


@compiled
def ratios(square: Any) -> tuple[Any, Any]:
    """Return ``sin(x)/x`` and ``(1 - cos(x))/x^2`` from x^2; below 1 rad by series, to rounding."""
    if square.real >= 1.0:
        x = np.sqrt(square)
        return np.sin(x) / x, (1.0 - np.cos(x)) / square
    a, b = 1.0 - square / 272.0, 1.0 - square / 240.0
    a, b = 1.0 - square / 210.0 * a, 1.0 - square / 182.0 * b
    a, b = 1.0 - square / 156.0 * a, 1.0 - square / 132.0 * b
    a, b = 1.0 - square / 110.0 * a, 1.0 - square / 90.0 * b
    a, b = 1.0 - square / 72.0 * a, 1.0 - square / 56.0 * b
    a, b = 1.0 - square / 42.0 * a, 1.0 - square / 30.0 * b
    a, b = 1.0 - square / 20.0 * a, 1.0 - square / 12.0 * b
    return 1.0 - square / 6.0 * a, b / 2.0


@compiled
def field_at(u: Any, t: Any) -> Any:
    """Return the field after a time t: turned about field_rate, ``B + a w x B + b w x (w x B)``."""
    b0, b1, b2 = u[FIELD], u[FIELD + 1], u[FIELD + 2]
    w0, w1, w2 = u[TURNS] * t, u[TURNS + 1] * t, u[TURNS + 2] * t
    a, b = ratios(w0 * w0 + w1 * w1 + w2 * w2)
    c0, c1, c2 = w1 * b2 - w2 * b1, w2 * b0 - w0 * b2, w0 * b1 - w1 * b0
    d0, d1, d2 = w1 * c2 - w2 * c1, w2 * c0 - w0 * c2, w0 * c1 - w1 * c0
    return b0 + a * c0 + b * d0, b1 + a * c1 + b * d1, b2 + a * c2 + b * d2


@compiled
def wrench(magnetic: Any, q: Any, x: Any, u: Any, B: Any, bends: int) -> Any:
    """Return force and torque about the body's centre, body frame: given, and of the field."""
    f0, f1, f2, B0, B1, B2 = u[FORCE], u[FORCE + 1], u[FORCE + 2], B[0], B[1], B[2]
    if bends & FIELD_BENDS:
        d0, d1, d2 = x[0] - u[PLACE], x[1] - u[PLACE + 1], x[2] - u[PLACE + 2]
        B0 = B0 + u[J] * d0 + u[J + 1] * d1 + u[J + 2] * d2
        B1 = B1 + u[J + 3] * d0 + u[J + 4] * d1 + u[J + 5] * d2
        B2 = B2 + u[J + 6] * d0 + u[J + 7] * d1 + u[J + 8] * d2
    b0, b1, b2 = to_lab(q, B0, B1, B2, -1.0)
    m0 = magnetic[0] + magnetic[3] * b0 + magnetic[4] * b1 + magnetic[5] * b2
    m1 = magnetic[1] + magnetic[6] * b0 + magnetic[7] * b1 + magnetic[8] * b2
    m2 = magnetic[2] + magnetic[9] * b0 + magnetic[10] * b1 + magnetic[11] * b2
    if bends & FIELD_BENDS:
        p0, p1, p2 = to_lab(q, m0, m1, m2, 1.0)
        f0 = f0 + u[J] * p0 + u[J + 3] * p1 + u[J + 6] * p2
        f1 = f1 + u[J + 1] * p0 + u[J + 4] * p1 + u[J + 7] * p2
        f2 = f2 + u[J + 2] * p0 + u[J + 5] * p1 + u[J + 8] * p2
    f0, f1, f2 = to_lab(q, f0, f1, f2, -1.0)
    t0, t1, t2 = to_lab(q, u[TORQUE], u[TORQUE + 1], u[TORQUE + 2], -1.0)
    return f0, f1, f2, t0 + m1 * b2 - m2 * b1, t1 + m2 * b0 - m0 * b2, t2 + m0 * b1 - m1 * b0


@compiled
def relative_twist(
    twist: Any,
    strain: Any,
    magnetic: Any,
    q: Any,
    x: Any,
    phase: Any,
    u: Any,
    B: Any,
    bends: int,
    work: Any,
) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return the twist v relative to the flow."""
    w0, w1, w2, w3, w4, w5 = wrench(magnetic, q, x, u, B, bends)
    row(twist, phase, work)
    # lower triangle row by row, then v; written out, or memory rules the time
    M, r = work, u[MOTOR]
    V0 = M[0] * w0 + M[1] * w1 + M[3] * w2 + M[6] * w3 + M[10] * w4 + M[15] * w5 + M[21] * r
    V1 = M[1] * w0 + M[2] * w1 + M[4] * w2 + M[7] * w3 + M[11] * w4 + M[16] * w5 + M[22] * r
    V2 = M[3] * w0 + M[4] * w1 + M[5] * w2 + M[8] * w3 + M[12] * w4 + M[17] * w5 + M[23] * r
    V3 = M[6] * w0 + M[7] * w1 + M[8] * w2 + M[9] * w3 + M[13] * w4 + M[18] * w5 + M[24] * r
    V4 = M[10] * w0 + M[11] * w1 + M[12] * w2 + M[13] * w3 + M[14] * w4 + M[19] * w5 + M[25] * r
    V5 = M[15] * w0 + M[16] * w1 + M[17] * w2 + M[18] * w3 + M[19] * w4 + M[20] * w5 + M[26] * r
    if bends & FLOW_BENDS:
        d0, d1, d2, d3, d4, d5 = strained(strain, q, phase, u, work)
        V0, V1, V2, V3, V4, V5 = V0 + d0, V1 + d1, V2 + d2, V3 + d3, V4 + d4, V5 + d5
    return V0, V1, V2, V3, V4, V5


@compiled
def graded(u: Any) -> int:
    """Return what has a gradient: the flow, the field, both or none."""
    flow, field = False, False
    for k in range(9):
        flow |= u[G + k] != 0
        field |= u[J + k] != 0
    return (FLOW_BENDS if flow else 0) + (FIELD_BENDS if field else 0)


@compiled
def body_strain(q: Any, u: Any) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return entries 00, 11, 22, 01, 02, 12 of ``E = R_L' (A + A')/2 R_L``."""
    s01, s02, s12 = (
        (u[G + 1] + u[G + 3]) / 2.0,
        (u[G + 2] + u[G + 6]) / 2.0,
        (u[G + 5] + u[G + 7]) / 2.0,
    )
    a, b, c = to_lab(q, 1.0, 0.0, 0.0, 1.0)
    x, y, z = u[G] * a + s01 * b + s02 * c, s01 * a + u[G + 4] * b + s12 * c, s02 * a + s12 * b
    e00, e01, e02 = to_lab(q, x, y, z + u[G + 8] * c, -1.0)
    a, b, c = to_lab(q, 0.0, 1.0, 0.0, 1.0)
    x, y, z = u[G] * a + s01 * b + s02 * c, s01 * a + u[G + 4] * b + s12 * c, s02 * a + s12 * b
    _, e11, e12 = to_lab(q, x, y, z + u[G + 8] * c, -1.0)
    return e00, e11, u[G] + u[G + 4] + u[G + 8] - e00 - e11, e01, e02, e12


@compiled
def strained(
    strain: Any, q: Any, phase: Any, u: Any, work: Any
) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return ``K e``."""
    e0, e1, e2, e3, e4, e5 = body_strain(q, u)
    row(strain, phase, work)
    for i in range(6):
        m = 6 * i
        work[36 + i] = work[m] * e0 + work[m + 1] * e1 + work[m + 2] * e2
        work[36 + i] += work[m + 3] * e3 + work[m + 4] * e4 + work[m + 5] * e5
    return work[36], work[37], work[38], work[39], work[40], work[41]


@compiled
def turned(q: Any, v: Any) -> tuple[Any, Any, Any, Any]:
    """Return ``q exp(v/2)`` as `kinematics.turn`, in registers."""
    square = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 4.0
    ratio, versine = ratios(square)
    w = 1.0 - square * versine
    x, y, z = ratio * v[0] / 2.0, ratio * v[1] / 2.0, ratio * v[2] / 2.0
    a, b, c, d = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


@compiled
def background(q: Any, u: Any, x0: Any, x1: Any, x2: Any) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return ``gradient x`` in the lab frame and the flow's rotation in the body frame."""
    a = u[G] * x0 + u[G + 1] * x1 + u[G + 2] * x2
    b = u[G + 3] * x0 + u[G + 4] * x1 + u[G + 5] * x2
    c = u[G + 6] * x0 + u[G + 7] * x1 + u[G + 8] * x2
    w0, w1, w2 = to_lab(q, u[G + 7] - u[G + 5], u[G + 2] - u[G + 6], u[G + 3] - u[G + 1], -1.0)
    return a, b, c, w0 / 2.0, w1 / 2.0, w2 / 2.0


@compiled
def velocity(
    twist: Any,
    strain: Any,
    magnetic: Any,
    q: Any,
    x: Any,
    phase: Any,
    u: Any,
    B: Any,
    bends: int,
    work: Any,
) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return the velocity of the centre in the lab frame, angular velocity in the body frame."""
    V0, V1, V2, w0, w1, w2 = relative_twist(twist, strain, magnetic, q, x, phase, u, B, bends, work)
    a, b, c = to_lab(q, V0, V1, V2, 1.0)
    a, b, c = a + u[FLOW], b + u[FLOW + 1], c + u[FLOW + 2]
    if bends & FLOW_BENDS:
        d0, d1, d2, o0, o1, o2 = background(q, u, x[0], x[1], x[2])
        a, b, c, w0, w1, w2 = a + d0, b + d1, c + d2, w0 + o0, w1 + o1, w2 + o2
    return a, b, c, w0, w1, w2


@compiled
def substep(
    twist: Any, strain: Any, magnetic: Any, y: Any, u: Any, t: Any, h: Any, bends: int, work: Any
) -> None:
    """Step at order 4; `t` is the time since the inputs were set, y is overwritten."""
    q = (y[3], y[4], y[5], y[6])
    zero = 0 * (y[0] + u[MOTOR])
    x0, x1, x2, r0, r1, r2 = zero, zero, zero, zero, zero, zero  # moved, turned
    k0, k1, k2, v0, v1, v2 = zero, zero, zero, zero, zero, zero  # last velocity, rotation so far
    B = field_at(u, t)
    ahead = 0.0 * h
    for i in range(4):
        if i == 1 or i == 3:
            ahead = h / 2.0 if i == 1 else h
            B = field_at(u, t + ahead)
        x = (y[0] + ahead * k0, y[1] + ahead * k1, y[2] + ahead * k2)
        p, phase = turned(q, (v0, v1, v2)), y[7] + u[MOTOR] * ahead
        k0, k1, k2, w0, w1, w2 = velocity(twist, strain, magnetic, p, x, phase, u, B, bends, work)
        # v' = w + v x w / 2 + v x (v x w) / 12
        c0, c1, c2 = v1 * w2 - v2 * w1, v2 * w0 - v0 * w2, v0 * w1 - v1 * w0
        s0 = w0 + c0 / 2.0 + (v1 * c2 - v2 * c1) / 12.0
        s1 = w1 + c1 / 2.0 + (v2 * c0 - v0 * c2) / 12.0
        s2 = w2 + c2 / 2.0 + (v0 * c1 - v1 * c0) / 12.0
        weight = h / 6.0 if i == 0 or i == 3 else h / 3.0
        x0, x1, x2 = x0 + weight * k0, x1 + weight * k1, x2 + weight * k2
        r0, r1, r2 = r0 + weight * s0, r1 + weight * s1, r2 + weight * s2
        reach = h if i == 2 else h / 2.0
        v0, v1, v2 = reach * s0, reach * s1, reach * s2
    a, b, c, d = turned(q, (r0, r1, r2))
    # one Newton step towards norm 1 keeps rounding from adding up
    unit = 1.5 - 0.5 * (a * a + b * b + c * c + d * d)
    y[0], y[1], y[2], y[7] = y[0] + x0, y[1] + x1, y[2] + x2, y[7] + u[MOTOR] * h
    y[3], y[4], y[5], y[6] = a * unit, b * unit, c * unit, d * unit


@compiled
def size(u: Any, first: int, n: int) -> float:
    """Return the Euclidean norm of n inputs, of any size."""
    top = np.max(np.abs(u[first : first + n].real))
    return top * np.sqrt(np.sum((u[first : first + n].real / top) ** 2)) if top > 0.0 else 0.0


@compiled
def fastest(limits: Any, u: Any) -> float:
    """Return the bound of what turns fastest: tail, field and body (rad per time).

    The body's rotation is bounded by ``limits[1:] = (per motor rate, per force, per torque, size
    of m_0, of C)``, with the field as it is at ``field_place``.
    """
    B = size(u, FIELD, 3)
    moment = limits[4] + limits[5] * B
    body = limits[1] * abs(u[MOTOR].real) + limits[3] * (size(u, TORQUE, 3) + moment * B)
    body += limits[2] * (size(u, FORCE, 3) + moment * size(u, J, 9)) + size(u, G, 9)
    return max(abs(u[MOTOR].real), size(u, TURNS, 3), body)


@compiled
def fastest_of_all(limits: Any, U: Any) -> float:
    """Return the largest of `fastest`; not finite if one is not."""
    top = 0.0
    for i in range(U.shape[0]):
        one = fastest(limits, U[i])
        top = one if not one <= top else top
        if not np.isfinite(top):
            break
    return top


@compiled
def internal_steps(limits: Any, u: Any, dt: float) -> int:
    """Return steps that turn the tail, the field and the body by at most ``limits[0]`` radians
    each.
    """
    return max(1, int(np.ceil(fastest(limits, u) * abs(dt) / limits[0] - 1e-6)))


@compiled
def advance(
    twist: Any,
    strain: Any,
    magnetic: Any,
    limits: Any,
    y: Any,
    u: Any,
    dt: Any,
    steps: int,
    work: Any,
) -> None:
    """Advance one state by dt in so many steps, 0 = as many as it takes; y is overwritten."""
    n = steps if steps > 0 else internal_steps(limits, u, dt)
    h, bends = dt / n, graded(u)
    for i in range(n):
        substep(twist, strain, magnetic, y, u, i * h, h, bends, work)


@loop(fastmath=FAST, error_model="numpy")
def advance_all(
    twist: Any,
    strain: Any,
    magnetic: Any,
    limits: Any,
    Y: Any,
    U: Any,
    dt: Any,
    steps: int,
    work: Any,
) -> None:
    """Advance all states, in blocks with one row of `work` each; inputs with one row are shared."""
    blocks, n = work.shape[0], Y.shape[0]
    for b in prange(blocks):
        for i in range(b * n // blocks, (b + 1) * n // blocks):
            u = U[i if U.shape[0] > 1 else 0]
            advance(twist, strain, magnetic, limits, Y[i], u, dt, steps, work[b])
