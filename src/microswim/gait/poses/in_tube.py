"""A swimmer in an endless round tube, compiled: R and F_p by interpolation.

Body of revolution and rigid tail are one rigid thing but for a turn about s, so that what it feels
depends on where the tube's axis lies in the frame that turns with the tail: on the line's direction
t, either sense of it, and on b, the vector from the line to the body's centre. In that frame

    R = S exp(L) S' + R_t,   F_p = S (f_0 + f) + F_t,   S S' = R and f_0 = S^-1 F_p in free fluid,

R_t and F_t what a tail that all but touches the tube has from it (`tail_near_tube`), so that R is
symmetric positive definite for any symmetric L. L (21 numbers) and f (6) are smooth functions of

    z = (b, t t', q_b, q_t, <q>, <q s>, <q n>)

with q = log(g/(g + size)) of the gap g: of body and tail where they are nearest, and averaged over
the tail, which feels how much of it is near, where along it and on which side (n points from the
wall to the axis); of a body with edges averaged over these as well. Which turn of the tail is
nearest jumps from pose to pose, the means do not.
None knows the sense of t. L and f are interpolated between scattered poses by their covariances,
Matern 5/2 of the distance in z: one for L, and one for f, each with lengths of its own. Towards
contact the eigenvalue of L across the wall goes like -log g and all else like a power of log g
less; below the smallest gap solved R goes on as lubrication has it (`lubricated`). Velocities would
not do in place of f: where the tail touches, they turn from what drags it to what the contact
leaves, within a gap or two.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.poses.beside_wall import LEAST, LENGTH, SIZE, TAIL_RADIUS
from microswim.gait.poses.tube_contact import of_line
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.matern import matern
from microswim.numerics.solve6 import solve

#: Features of a pose; those first that say where it is.
FEATURES, WHERE = 18, 10
#: Where `PoseTable.root` has the share of `tail_near_tube` that is told apart.
SHARED = 7, 1
#: Points of a circle of a body with edges.
AROUND = 64


@compiled(fastmath=FAST, error_model="numpy")
def features(
    line: Any, of_body: Any, of_tail: Any, parts: Any, numbers: Any, radius: Any, z: Any
) -> None:
    """Write z (18,) of a line and the gaps of body and tail; one below the least counts as it."""
    per = 1.0 / numbers[LENGTH]
    t0, t1, t2 = line[0], line[1], line[2]
    z[0], z[1], z[2] = line[3] * per, line[4] * per, line[5] * per
    z[3], z[4], z[5], z[6] = t0 * t1, t0 * t2, t1 * t1 - t2 * t2, t1 * t2
    z[7] = t0 * t0
    z[8], z[9] = _of_gap(of_body, numbers), _of_gap(of_tail, numbers)
    body, tail = parts
    _along(line, tail, numbers, radius, z)
    for k in range(14, FEATURES):
        z[k] = 0.0
    if body.shape[0] > 0 and body.shape[1] == 3:
        _around(line, body, numbers, radius, z)


@compiled(fastmath=FAST, error_model="numpy")
def _along(line: Any, tail: Any, numbers: Any, radius: Any, z: Any) -> None:
    """Write the means over the tail to z[10:14]."""
    for k in range(10, 14):
        z[k] = 0.0
    n = tail.shape[0]
    if n == 0:
        return
    middle, share = 0.5 * (tail[0, 0] + tail[n - 1, 0]), 1.0 / n
    for i in range(n):
        y0, y1, y2 = line[3] + tail[i, 0], line[4] + tail[i, 1], line[5] + tail[i, 2]
        along = y0 * line[0] + y1 * line[1] + y2 * line[2]
        y0, y1, y2 = y0 - along * line[0], y1 - along * line[1], y2 - along * line[2]
        far = np.sqrt(y0 * y0 + y1 * y1 + y2 * y2)
        q = share * _of_gap(radius - far - numbers[TAIL_RADIUS], numbers)
        z[10] += q
        z[11] += q * (tail[i, 0] - middle) / numbers[LENGTH]
        z[12] -= q * y1 / radius
        z[13] -= q * y2 / radius


@compiled(fastmath=FAST, error_model="numpy")
def _around(line: Any, rings: Any, numbers: Any, radius: Any, z: Any) -> None:
    """Add the means over the circles of a body with edges to z[14:18]."""
    share = 1.0 / (AROUND * rings.shape[0])
    for m in range(rings.shape[0]):
        for k in range(AROUND):
            angle = 2.0 * np.pi * k / AROUND
            y0 = line[3] + rings[m, 0]
            y1 = line[4] + rings[m, 1] * np.cos(angle)
            y2 = line[5] + rings[m, 1] * np.sin(angle)
            along = y0 * line[0] + y1 * line[1] + y2 * line[2]
            y0, y1, y2 = y0 - along * line[0], y1 - along * line[1], y2 - along * line[2]
            far = np.sqrt(y0 * y0 + y1 * y1 + y2 * y2)
            q = share * _of_gap(radius - far - rings[m, 2], numbers)
            z[14] += q
            z[15] += q * rings[m, 0] / numbers[LENGTH]
            z[16] -= q * y1 / radius
            z[17] -= q * y2 / radius


@compiled(error_model="numpy")
def _of_gap(gap: Any, numbers: Any) -> Any:
    near = max(gap, numbers[LEAST])
    return 0.0 if near == np.inf else np.log(near / (near + numbers[SIZE]))


@compiled(fastmath=FAST, error_model="numpy")
def between(known: Any, weights: Any, z: Any, values: Any, near: Any) -> None:
    """Write what is interpolated at z.

    ``values = mean + sum_i k(z, z_i) alpha_i``: `known` (1 + features, n) holds the lengths of the
    kernel (first `features` of row 0) and the poses in these lengths; `weights` (m, 1 + n) the mean
    and alpha of each target.
    """
    n = known.shape[1]
    near[:n] = 0.0
    for f in range(known.shape[0] - 1):
        at = z[f] * known[0, f]
        for i in range(n):
            d = at - known[1 + f, i]
            near[i] += d * d
    for i in range(n):
        near[i] = matern(near[i])
    for j in range(weights.shape[0]):
        total = 0.0
        for i in range(n):
            total += near[i] * weights[j, 1 + i]
        values[j] = weights[j, 0] + total


@compiled()
def both(known: Any, weights: Any, z: Any, values: Any, near: Any) -> None:
    """Write L (21 numbers), and f and the motor's power (7), each by its own lengths."""
    between(known[0], weights[:21], z, values[:21], near)
    between(known[1], weights[21:], z, values[21:], near)


@compiled(error_model="numpy")
def exponential(L: Any, out: Any, work: Any) -> None:
    """Write exp(L) of a symmetric L (6, 6), lost: Taylor's series of L/2^k, squared k times."""
    size = 0.0
    for i in range(6):
        row = 0.0
        for j in range(6):
            row += abs(L[i, j])
        size = max(size, row)
    halvings = 0
    while size > 0.25 and halvings < 60:
        size *= 0.5
        halvings += 1
    small = 0.5**halvings
    for i in range(6):
        for j in range(6):
            L[i, j] *= small
            out[i, j] = 1.0 if i == j else 0.0
    for n in range(9, 0, -1):  # out = 1 + L out / n
        _product(L, out, work)
        for i in range(6):
            for j in range(6):
                out[i, j] = work[i, j] / n + (1.0 if i == j else 0.0)
    for _ in range(halvings):
        _product(out, out, work)
        for i in range(6):
            for j in range(i + 1):
                out[i, j] = out[j, i] = 0.5 * (work[i, j] + work[j, i])


@compiled(fastmath=FAST)
def _product(A: Any, B: Any, out: Any) -> None:
    for i in range(6):
        for j in range(6):
            total = 0.0
            for k in range(6):
                total += A[i, k] * B[k, j]
            out[i, j] = total


@compiled(error_model="numpy")
def from_logarithm(root: Any, values: Any, R: Any, F: Any, work: Any) -> None:
    """Write R = S exp(L) S' and F_p = S (f_0 + f), the frame of the tail.

    `root` (8, 6): S, f_0, P_0 and `SHARED`; `values` (27,): L by rows of its lower triangle, f.
    """
    L, E = work[:36].reshape((6, 6)), work[36:72].reshape((6, 6))
    room = work[72:108].reshape((6, 6))
    m = 0
    for i in range(6):
        for j in range(i + 1):
            L[i, j] = L[j, i] = values[m]
            m += 1
    exponential(L, E, room)
    _product(root, E, room)
    for i in range(6):
        for j in range(6):
            R[i, j] = 0.0
            for k in range(6):
                R[i, j] += room[i, k] * root[j, k]
    for i in range(6):
        for j in range(i):
            R[i, j] = R[j, i] = 0.5 * (R[i, j] + R[j, i])
    for i in range(6):
        F[i] = 0.0
        for j in range(6):
            F[i] += root[i, j] * (root[6, j] + values[21 + j])


@compiled()
def from_power(root: Any, values: Any, R: Any, F: Any, work: Any) -> Any:
    """Return G, the motor's power per squared rate with the body held: ``F_p . R^-1 F_p + P``.

    P > 0 is what the motor spends per squared rate where nothing holds the swimmer, `root[7, 0]`
    in free fluid; F_p of the tail's frame.
    """
    V, A = work[:6], work[6:42].reshape((6, 6))
    for i in range(6):
        V[i] = F[i]
        for j in range(6):
            A[i, j] = R[i, j]
    solve(A, V, (True, True, True, True, True, True))
    power = root[7, 0] * np.exp(values[27])
    for i in range(6):
        power += F[i] * V[i]
    return power


@compiled()
def turned(turn: Any, V: Any, at: Any) -> None:
    """Turn a vector V[at : at + 3] about s."""
    c, s = np.cos(turn), np.sin(turn)
    V[at + 1], V[at + 2] = c * V[at + 1] - s * V[at + 2], s * V[at + 1] + c * V[at + 2]


@compiled()
def out_of_the_tail(turn: Any, R: Any, F: Any, touch: Any) -> None:
    """Turn R, F_p and what touches from the tail's frame into the body's."""
    for i in range(6):
        turned(turn, R[i], 0)
        turned(turn, R[i], 3)
    for j in range(6):
        turned(turn, R[:, j], 0)
        turned(turn, R[:, j], 3)
    for i in range(6):
        for j in range(i):
            R[i, j] = R[j, i]
    for at in (0, 3):
        turned(turn, F, at)
    for at in (1, 4, 8, 11):
        turned(turn, touch, at)


@compiled(always=True)
def of_lines(
    lines: Any, body: Any, tail: Any, numbers: Any, radius: Any, gaps: Any, Z: Any
) -> None:
    """Write the gaps of body and tail (n, 2) and the features (n, 18) of lines (n, 6)."""
    touch, work = np.zeros(14), np.zeros(16)
    for n in range(lines.shape[0]):
        of_line(lines[n], body, tail, numbers, radius, touch, work)
        gaps[n, 0], gaps[n, 1] = touch[0], touch[7]
        features(lines[n], touch[0], touch[7], (body, tail), numbers, radius, Z[n])
