"""A swimmer of any shape beside a plane wall, compiled: R and F_p by interpolation.

What it feels depends on the gap, on the wall's normal n in the body frame and on the phase: four
coordinates, where a body of revolution with a rigid tail has three (`beside_wall`). In that frame

    R = C exp(h L) C',   F_p = R (w_0 + h w),   C C' = R and w_0 = R^-1 F_p in free fluid,

C lower triangular, so that R is symmetric positive definite for any symmetric L. h, the sum of
log(g/(g + size)) of the body's gap and of its mean over the tail, is 0 far away, where nothing is
added, and grows like log(gap) towards contact. L (21 numbers), w (6) and the logarithm of the
motor's power are interpolated between scattered poses by their covariance in the features

    z = (q_b, q_t, <q>, <q s>, <q v>, n, cos(phase), sin(phase)),   q = log(g/(g + size)),

q_b and q_t where body and tail are nearest, <> the mean over the tail, v its velocity across the
wall. A swimmer that is its own mirror image, half a period on or at once, is asked on one side
(`folded`): for mirrors the signs of (U, Omega) carry over, those of C as well.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.poses.beside_wall import (
    LEAST,
    LENGTH,
    REACH,
    SIZE,
    TAIL_RADIUS,
    as_moment,
)
from microswim.gait.poses.in_tube import exponential
from microswim.gait.poses.lubricated import grown
from microswim.gait.stepping import row
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.rigid_motion import to_lab

FEATURES = 10
#: Entries of `PoseTable.numbers` after those of `beside_wall`: radius of the body's edges; whether
#: it is its own image mirrored in r, in q half a period on, turned about s half a period on; and
#: whether the tail's sections stand across s.
EDGE, MIRROR_R, MIRROR_Q, TURNED, SHEARED = 11, 12, 13, 14, 15


@compiled(error_model="numpy")
def support(body: Any, edge: Any, n0: Any, n1: Any, n2: Any) -> Any:
    """Return the point of a body that lies farthest in the direction -n.

    `body`: a meridian (m, 2) as `PoseTable` has it; half axes of an ellipsoid (1, 3); or corners
    (m, 3) of edges rounded with a radius.
    """
    if body.shape[1] == 2:
        across = np.sqrt(n1 * n1 + n2 * n2)
        where = np.arctan2(across, -n0) / np.pi * (body.shape[0] - 1)
        i = min(int(where), body.shape[0] - 2)
        part = where - i
        s = body[i, 0] + part * (body[i + 1, 0] - body[i, 0])
        rho = body[i, 1] + part * (body[i + 1, 1] - body[i, 1])
        ratio = rho / across if across > 1e-15 else 0.0
        return s, -ratio * n1, -ratio * n2
    if body.shape[0] == 1:
        a, b, c = body[0, 0], body[0, 1], body[0, 2]
        size = np.sqrt(a * a * n0 * n0 + b * b * n1 * n1 + c * c * n2 * n2)
        return -a * a * n0 / size, -b * b * n1 / size, -c * c * n2 / size
    k, lowest = 0, np.inf
    for i in range(body.shape[0]):
        y = body[i, 0] * n0 + body[i, 1] * n1 + body[i, 2] * n2
        if y < lowest:
            k, lowest = i, y
    return body[k, 0] - edge * n0, body[k, 1] - edge * n1, body[k, 2] - edge * n2


@compiled(fastmath=FAST, error_model="numpy")
def height_of(tail: Any, i: int, phase: Any, n0: Any, n1: Any, n2: Any) -> Any:
    """Return the height along n of a point of the tail, and how fast it rises with the phase."""
    y = n0 * tail[i, 0] + n1 * tail[i, 1] + n2 * tail[i, 2]
    rises, h = 0.0, 1
    c1, s1 = np.cos(phase), np.sin(phase)
    c, s = c1, s1
    for k in range(3, tail.shape[1], 6):
        a = n0 * tail[i, k] + n1 * tail[i, k + 1] + n2 * tail[i, k + 2]
        b = n0 * tail[i, k + 3] + n1 * tail[i, k + 4] + n2 * tail[i, k + 5]
        y += a * c + b * s
        rises += h * (b * c - a * s)
        h += 1
        c, s = c * c1 - s * s1, s * c1 + c * s1
    return y, rises


@compiled(fastmath=FAST, error_model="numpy")
def point_of(tail: Any, i: int, phase: Any, out: Any) -> None:
    """Write a point of the tail (3,), from the body's centre."""
    for m in range(3):
        out[m] = tail[i, m]
    h = 1
    for k in range(3, tail.shape[1], 6):
        c, s = np.cos(h * phase), np.sin(h * phase)
        for m in range(3):
            out[m] += c * tail[i, k + m] + s * tail[i, k + 3 + m]
        h += 1


@compiled(fastmath=FAST, error_model="numpy")
def _tail(
    numbers: Any, tail: Any, height: Any, phase: Any, n0: Any, n1: Any, n2: Any, out: Any
) -> Any:
    """Write gap and nearest point of the tail to out[:4]; return how fast that point rises.

    Sections across s are discs: they reach less far down than a ball does, which ends the tip.
    """
    lowest, k, last = np.inf, 0, tail.shape[0] - 1
    for i in range(last + 1):
        y, _ = height_of(tail, i, phase, n0, n1, n2)
        if y < lowest:
            lowest, k = y, i
    k = min(max(k, 1), last - 1)  # a parabola through the lowest point
    y0, v0 = height_of(tail, k - 1, phase, n0, n1, n2)
    y1, v1 = height_of(tail, k, phase, n0, n1, n2)
    y2, v2 = height_of(tail, k + 1, phase, n0, n1, n2)
    bend = y0 + y2 - 2.0 * y1
    u = 0.5 * (y0 - y2) / bend if bend > 0.0 else (1.0 if y2 < y0 else -1.0)
    u = min(max(u, -1.0), 1.0)
    w0, w1, w2 = 0.5 * u * (u - 1.0), 1.0 - u * u, 0.5 * u * (u + 1.0)
    y, rises = w0 * y0 + w1 * y1 + w2 * y2, w0 * v0 + w1 * v1 + w2 * v2
    across = max(np.sqrt(n1 * n1 + n2 * n2), 1e-15)
    d0, d1, d2 = n0, n1, n2
    if numbers[SHEARED] > 0.0:
        d0, d1, d2 = 0.0, n1 / across, n2 / across
    for c in range(4):
        out[c] = 0.0
    for m in range(3):
        share = w0 if m == 0 else (w1 if m == 1 else w2)
        point_of(tail, k - 1 + m, phase, out[4:7])
        for c in range(3):
            out[1 + c] += share * out[4 + c]
    out[1] -= numbers[TAIL_RADIUS] * d0
    out[2] -= numbers[TAIL_RADIUS] * d1
    out[3] -= numbers[TAIL_RADIUS] * d2
    out[0] = height + n0 * out[1] + n1 * out[2] + n2 * out[3]
    if numbers[SHEARED] > 0.0:
        rises = _sheared_tip(numbers, tail, height, phase, n0, n1, n2, rises, out)
    return rises


@compiled(fastmath=FAST, error_model="numpy")
def _sheared_tip(
    numbers: Any, tail: Any, height: Any, phase: Any, n0: Any, n1: Any, n2: Any, rises: Any,
    out: Any,
) -> Any:  # fmt: skip
    """Write the lowest point of the tip to out[:4] if it is nearer, and return how fast it rises.

    Its sections ``X = P(L) + r (u P'(L) + sqrt(1 - u^2) e)``, e across s, lean with the centreline:
    n . X is least, ``n . P - r sqrt((n . P')^2 + n_q^2 + n_r^2)``, where u is as -n . P' to it.
    """
    last, part = tail.shape[0] - 1, out[4:7]
    step = tail[last, 0] - tail[last - 1, 0]
    s1, s2 = 0.0, 0.0
    for m in range(3):
        share = (3.0 if m == 0 else (-4.0 if m == 1 else 1.0)) / (2.0 * step)
        point_of(tail, last - m, phase, part)
        s1 += share * part[1]
        s2 += share * part[2]
    leans = n0 + n1 * s1 + n2 * s2
    if not leans < 0.0:
        return rises
    size = np.sqrt(leans * leans + n1 * n1 + n2 * n2)
    y, falls = height_of(tail, last, phase, n0, n1, n2)
    gap = height + y - numbers[TAIL_RADIUS] * size
    if not gap < out[0]:
        return rises
    per = numbers[TAIL_RADIUS] / size
    point_of(tail, last, phase, part)
    out[0] = gap
    out[1] = part[0] - per * leans
    out[2] = part[1] - per * (leans * s1 + n1)
    out[3] = part[2] - per * (leans * s2 + n2)
    return falls


@compiled(fastmath=FAST, error_model="numpy")
def contact(
    boundary: Any, numbers: Any, body: Any, tail: Any, x: Any, q: Any, phase: Any, touch: Any,
    at: Any,
) -> None:  # fmt: skip
    """Write what `beside_wall.contact` does to touch (14,), and n, the height of the body's centre
    and the velocity across the wall of the tail's nearest point per phase rate to at (5,).
    """
    n0, n1, n2 = to_lab(q, boundary[3], boundary[4], boundary[5], -1.0)
    height = 0.0
    for i in range(3):
        height += (x[i] - boundary[i]) * boundary[3 + i]
    for i in range(14):
        touch[i] = 0.0
    touch[0] = touch[7] = np.inf
    at[0], at[1], at[2], at[3], at[4] = n0, n1, n2, height, 0.0
    if body.shape[0] > 0:
        touch[1], touch[2], touch[3] = support(body, numbers[EDGE], n0, n1, n2)
        touch[0] = height + n0 * touch[1] + n1 * touch[2] + n2 * touch[3]
    if tail.shape[0] > 0:
        at[4] = _tail(numbers, tail, height, phase, n0, n1, n2, touch[7:])
    for i in (4, 11):
        touch[i], touch[i + 1], touch[i + 2] = n0, n1, n2
    as_moment(touch[:7])
    as_moment(touch[7:])


@compiled(error_model="numpy")
def folded(numbers: Any, n: Any, phase: Any) -> Any:
    """Turn n (3,) to the side on which poses are known; return signs of q and r, and the phase."""
    of_q, of_r = 1.0, 1.0
    if numbers[TURNED] > 0.0 and n[1] < 0.0:
        n[1], n[2], of_q, of_r, phase = -n[1], -n[2], -of_q, -of_r, phase + np.pi
    if numbers[MIRROR_Q] > 0.0 and n[1] < 0.0:
        n[1], of_q, phase = -n[1], -of_q, phase + np.pi
    if numbers[MIRROR_R] > 0.0 and n[2] < 0.0:
        n[2], of_r = -n[2], -of_r
    return of_q, of_r, phase


@compiled(error_model="numpy")
def _of_gap(gap: Any, numbers: Any) -> Any:
    near = max(gap, numbers[LEAST])
    return 0.0 if near == np.inf else np.log(near / (near + numbers[SIZE]))


@compiled(fastmath=FAST, error_model="numpy")
def features(
    n: Any, height: Any, phase: Any, of_body: Any, of_tail: Any, tail: Any, numbers: Any, z: Any
) -> Any:
    """Write z (10,) of a pose on the side that is known; return h."""
    for k in range(FEATURES):
        z[k] = 0.0
    z[0], z[1] = _of_gap(of_body, numbers), _of_gap(of_tail, numbers)
    share = 1.0 / max(tail.shape[0], 1)
    for i in range(tail.shape[0]):
        y, rises = height_of(tail, i, phase, n[0], n[1], n[2])
        q = share * _of_gap(height + y - numbers[TAIL_RADIUS], numbers)
        z[2] += q
        z[3] += q * (tail[i, 0] - 0.5 * numbers[REACH]) / numbers[REACH]
        z[4] += q * rises / numbers[LENGTH]
    z[5], z[6], z[7] = n[0], n[1], n[2]
    z[8], z[9] = np.cos(phase), np.sin(phase)
    return z[0] + z[2]


@compiled(error_model="numpy")
def from_free(
    packed: Any, power: Any, phase: Any, values: Any, h: Any, signs: Any, R: Any, F: Any, work: Any
) -> Any:
    """Write R = C exp(h L) C' and F_p = R (w_0 + h w), mirrored; return the motor's power.

    `values` (28,): L by rows of its lower triangle, w, log of P over that of free fluid.
    """
    L, E = work[:36].reshape((6, 6)), work[36:72].reshape((6, 6))
    C, free, V = work[72:108].reshape((6, 6)), work[108:135], work[135:141]
    room = work[141:177].reshape((6, 6))
    row(packed, phase, free)
    m = 0
    for i in range(6):
        for j in range(i + 1):
            L[i, j] = L[j, i] = h * values[m]
            total = free[m]
            for k in range(j):
                total -= C[i, k] * C[j, k]
            C[i, j] = np.sqrt(total) if i == j else total / C[j, j]
            m += 1
    for i in range(6):  # w_0 by C
        total = free[21 + i]
        for k in range(i):
            total -= C[i, k] * V[k]
        V[i] = total / C[i, i]
    for i in range(5, -1, -1):
        total = V[i]
        for k in range(i + 1, 6):
            total -= C[k, i] * V[k]
        V[i] = total / C[i, i]
    exponential(L, E, room)
    for i in range(6):
        V[i] += h * values[21 + i]
        for j in range(6):
            room[i, j] = 0.0
            for k in range(i + 1):
                room[i, j] += C[i, k] * E[k, j]
    for i in range(6):
        for j in range(i + 1):
            total = 0.0
            for k in range(j + 1):
                total += room[i, k] * C[j, k]
            R[i, j] = R[j, i] = total
    row(power, phase, free[:1])
    spent = free[0] * np.exp(h * values[27])
    for i in range(6):
        F[i] = 0.0
        for j in range(6):
            F[i] += R[i, j] * V[j]
        spent += F[i] * V[i]
    for i in range(6):
        F[i] *= signs[i]
        for j in range(6):
            R[i, j] *= signs[i] * signs[j]
    return spent


@compiled()
def signs_of(of_q: Any, of_r: Any, signs: Any) -> None:
    """Write the signs (6,) of (U, Omega) under mirrors of q and r."""
    signs[0], signs[1], signs[2] = 1.0, of_q, of_r
    signs[3], signs[4], signs[5] = of_q * of_r, of_r, of_q


@compiled(error_model="numpy")
def nearer(numbers: Any, touch: Any, rises: Any, R: Any, F: Any, work: Any) -> Any:
    """Add what grows like 1/gap below the smallest gap solved; return what is added to G."""
    return grown(numbers, touch[:7], 0.0, R, F, work) + grown(numbers, touch[7:], rises, R, F, work)


@compiled(always=True)
def of_poses(poses: Any, body: Any, tail: Any, numbers: Any, gaps: Any, Z: Any, H: Any) -> None:
    """Write gaps (n, 2), features (n, 10) and h (n,) of poses (n, 5): n, height, phase."""
    touch, at = np.zeros(14), np.zeros(5)
    wall, x, q = np.zeros(6), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
    for k in range(poses.shape[0]):
        wall[3], wall[4], wall[5] = poses[k, 0], poses[k, 1], poses[k, 2]
        for i in range(3):
            x[i] = poses[k, 3] * poses[k, i]
        contact(wall, numbers, body, tail, x, q, poses[k, 4], touch, at)
        gaps[k, 0], gaps[k, 1] = touch[0], touch[7]
        H[k] = features(poses[k, :3], poses[k, 3], poses[k, 4], touch[0], touch[7], tail, numbers,
                        Z[k])  # fmt: skip
