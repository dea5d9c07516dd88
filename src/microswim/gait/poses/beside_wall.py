"""A swimmer beside a plane wall, compiled: where it touches, and R and F_p by interpolation.

Body of revolution and rigid tail: what they feel depends on the gap, on the tilt between s and the
wall (sin tilt = n_s, n the wall's normal) and on the tail's phase ``psi = phase - sign azimuth(n)``
against it. With

    (F_n, T_r, F_t, F_r, T_n, T_t),  t = (s - n_s n)/cos(tilt),  r = s x n/cos(tilt),

R = M D M' (M unit lower, D diagonal) is symmetric positive definite for any M and log D. The force
across the wall stands first, so that lubrication, D_1 ~ 1/gap, is in log D_1 alone and all else
goes like log(gap). F_p = M D z, z a velocity that stays bounded. Interpolated is what the wall adds
to log D, M and z of free fluid, by splines in

    xi = log(gap / (gap + size)),

which meet both contact (linear in log gap; below the smallest gap solved as `lubricated` has it)
and free fluid (nothing at xi = 0). With them goes the logarithm of the motor's power
P = G - F_p . R^-1 F_p per squared rate. The gap has a kink where the nearest point changes from
body to tail, at ``tilt = kink(psi)``; on each side splines in

    sigma = +-log(1 + reach |tilt - kink| / g) / log(1 + reach (pi/2 -+ kink) / g),  g = gap + blur,

resolve how far body and tail then part. Of the tail it is one turn and then, suddenly, the next
that is nearest, at ``psi = switch(tilt)``, and R has a kink there too. So the phase is counted from
it,

    delta = psi - switch(tilt)  on the tail's side,   psi - switch(kink(psi))  on the body's,
    tan(turn/2) = CLOSER tan(delta/2),

and splines over one full turn, the same value at either end, need not be smooth across it. Just
before and after it two turns are about as near, and what they feel changes within a gap of that:
there the phases of evenly spaced turns lie `CLOSER` to one another.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.stepping import row
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.rigid_motion import to_lab

#: Entries of `PoseTable.numbers`.
NUMBERS = (
    "sign", "tail_radius", "size", "reach", "blur", "lowest_xi", "length", "viscosity",
    "tail_blur", "power", "least",
)  # fmt: skip
SIGN, TAIL_RADIUS, SIZE, REACH, BLUR, LOWEST, LENGTH, VISCOSITY, TAIL_BLUR, POWER = range(10)
LEAST = 10  #: the smallest gap that was solved
CLOSER = 1.6  #: as many times as dense lie phases where the nearest turn of the tail changes


@compiled()
def as_moment(touch: Any) -> None:
    """Put the moment ``p x n`` in place of the nearest point p, of one part (7,)."""
    p0, p1, p2 = touch[1], touch[2], touch[3]
    n0, n1, n2 = touch[4], touch[5], touch[6]
    touch[1], touch[2], touch[3] = p1 * n2 - p2 * n1, p2 * n0 - p0 * n2, p0 * n1 - p1 * n0


@compiled(fastmath=FAST, error_model="numpy")
def contact(
    boundary: Any, numbers: Any, body: Any, tail: Any, x: Any, q: Any, phase: Any, touch: Any,
    at: Any,
) -> None:  # fmt: skip
    """Write gap, moment, normal to touch (14,), and the normal's tilt and azimuth to at[:2].

    Of the body, then of the tail; what the swimmer does not have has an infinite gap.
    """
    n0, n1, n2 = to_lab(q, boundary[3], boundary[4], boundary[5], -1.0)
    height = 0.0
    for i in range(3):
        height += (x[i] - boundary[i]) * boundary[3 + i]
    across = np.sqrt(n1 * n1 + n2 * n2)
    azimuth = np.arctan2(n2, n1)
    for i in range(14):
        touch[i] = 0.0
    touch[0] = touch[7] = np.inf
    if body.shape[0] > 0:  # the support of the body in the direction -n
        where = np.arctan2(across, -n0) / np.pi * (body.shape[0] - 1)
        i = min(int(where), body.shape[0] - 2)
        part = where - i
        s = body[i, 0] + part * (body[i + 1, 0] - body[i, 0])
        rho = body[i, 1] + part * (body[i + 1, 1] - body[i, 1])
        touch[0] = height + s * n0 - rho * across
        touch[1] = s
        touch[2] = -rho * np.cos(azimuth)
        touch[3] = -rho * np.sin(azimuth)
    if tail.shape[0] > 0:
        turn = numbers[0] * phase
        ct, st = np.cos(turn), np.sin(turn)
        a, b = n1 * ct + n2 * st, n2 * ct - n1 * st
        lowest, k = np.inf, 0
        for i in range(tail.shape[0]):
            y = tail[i, 0] * n0 + tail[i, 1] * a + tail[i, 2] * b
            if y < lowest:
                lowest, k = y, i
        k = min(max(k, 1), tail.shape[0] - 2)  # a parabola through the lowest point
        y0 = tail[k - 1, 0] * n0 + tail[k - 1, 1] * a + tail[k - 1, 2] * b
        y1 = tail[k, 0] * n0 + tail[k, 1] * a + tail[k, 2] * b
        y2 = tail[k + 1, 0] * n0 + tail[k + 1, 1] * a + tail[k + 1, 2] * b
        bend = y0 + y2 - 2.0 * y1
        u = 0.0 if bend <= 0.0 else 0.5 * (y0 - y2) / bend
        if bend <= 0.0 and y2 < y0:
            u = 1.0
        elif bend <= 0.0:
            u = -1.0
        u = min(max(u, -1.0), 1.0)
        w0, w1, w2 = 0.5 * u * (u - 1.0), 1.0 - u * u, 0.5 * u * (u + 1.0)
        touch[7] = height + w0 * y0 + w1 * y1 + w2 * y2 - numbers[1]
        p0 = w0 * tail[k - 1, 0] + w1 * tail[k, 0] + w2 * tail[k + 1, 0]
        p1 = w0 * tail[k - 1, 1] + w1 * tail[k, 1] + w2 * tail[k + 1, 1]
        p2 = w0 * tail[k - 1, 2] + w1 * tail[k, 2] + w2 * tail[k + 1, 2]
        touch[8] = p0 - numbers[1] * n0
        touch[9] = p1 * ct - p2 * st - numbers[1] * n1
        touch[10] = p1 * st + p2 * ct - numbers[1] * n2
    for i in (4, 11):
        touch[i], touch[i + 1], touch[i + 2] = n0, n1, n2
    as_moment(touch[:7])
    as_moment(touch[7:])
    at[0], at[1] = np.arctan2(n0, across), azimuth


@compiled(fastmath=FAST, error_model="numpy")
def place(numbers: Any, kinks: Any, switch: Any, touch: Any, phase: Any, at: Any) -> None:
    """Write xi, sigma, psi, the lowest xi and the turn, in full turns from 0 to 1, to at[2:7].

    A gap below the smallest that was solved counts as it.
    """
    psi = phase - numbers[0] * at[1]
    kink = kinked(kinks, psi)
    gap = max(min(touch[0], touch[7]), numbers[LEAST])
    at[2] = max(np.log(gap / (gap + numbers[2])), numbers[5])
    tilt, right = at[0], 0.5 * np.pi
    if tilt >= kink:
        g = gap + numbers[4]
        at[3] = np.log1p(numbers[3] * (tilt - kink) / g)
        at[3] /= np.log1p(numbers[3] * (right - kink) / g)
    else:
        g = gap + numbers[8]
        at[3] = -np.log1p(numbers[3] * (kink - tilt) / g)
        at[3] /= np.log1p(numbers[3] * (right + kink) / g)
    at[4], at[5] = psi, numbers[5]
    half = 0.5 * (psi - switched(switch, min(tilt, kink)))
    turns = np.arctan2(CLOSER * np.sin(half), np.cos(half)) / np.pi
    at[6] = turns - np.floor(turns)


@compiled()
def kinked(kinks: Any, psi: Any) -> Any:
    """Return the tilt at which body and tail are equally near; `kinks` at equal steps of a turn."""
    turns = psi / (2.0 * np.pi)
    where = (turns - np.floor(turns)) * kinks.size
    i = int(where) % kinks.size
    part = where - np.floor(where)
    return kinks[i] + part * (kinks[(i + 1) % kinks.size] - kinks[i])


@compiled()
def switched(switch: Any, tilt: Any) -> Any:
    """Return the psi at which the nearest turn of the tail changes; 0 where it never does.

    `switch`: first and last tilt, then psi at equal steps between.
    """
    n = switch.size - 2
    if n < 2:
        return 0.0
    where = (min(tilt, switch[1]) - switch[0]) / (switch[1] - switch[0]) * (n - 1)
    i = min(max(int(where), 0), n - 2)
    return switch[2 + i] + (where - i) * (switch[3 + i] - switch[2 + i])


@compiled()
def weights(u: Any, n: int, w: Any) -> Any:
    """Write the four weights of uniform cubic B-splines at u in [0, 1] of n - 3 intervals.

    Returns the first coefficient.
    """
    intervals = n - 3
    where = min(max(u, 0.0), 1.0) * intervals
    i = min(int(where), intervals - 1)
    t = where - i
    r = 1.0 - t
    w[0], w[3] = r * r * r / 6.0, t * t * t / 6.0
    w[1] = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0
    w[2] = (3.0 * r * r * r - 6.0 * r * r + 4.0) / 6.0
    return i


@compiled(fastmath=FAST, error_model="numpy")
def free_factors(packed: Any, numbers: Any, at: Any, values: Any, work: Any) -> None:
    """Write log D (6,), M below its diagonal (15,) and z (6,) of free fluid at tilt and psi.

    `packed` as `stepping.pack` has it.
    """
    series, B, A = work[:27], work[27:63].reshape((6, 6)), work[63:99].reshape((6, 6))
    f, y = work[99:105], work[105:111]
    row(packed, at[4], series)
    sine, cosine, per = np.sin(at[0]), np.cos(at[0]), 1.0 / numbers[6]
    scale = per / numbers[7]
    for i in range(6):
        own = scale if i < 3 else scale * per
        f[i] = series[21 + i] * own * per
        for j in range(i + 1):
            B[i, j] = series[i * (i + 1) // 2 + j] * own * (1.0 if j < 3 else per)
            B[j, i] = B[i, j]
    for i in (0, 3):  # from s and q to n and t
        f[i], f[i + 1] = sine * f[i] + cosine * f[i + 1], cosine * f[i] - sine * f[i + 1]
        for j in range(6):
            along, across = B[i, j], B[i + 1, j]
            B[i, j], B[i + 1, j] = sine * along + cosine * across, cosine * along - sine * across
        for j in range(6):
            along, across = B[j, i], B[j, i + 1]
            B[j, i], B[j, i + 1] = sine * along + cosine * across, cosine * along - sine * across
    order = (0, 5, 1, 2, 3, 4)
    for k in range(6):
        y[k] = f[order[k]]
        for l in range(k + 1):
            A[k, l] = B[order[k], order[l]]
    for k in range(6):  # A = M D M', y = M D z
        D = A[k, k]
        for i in range(k + 1, 6):
            values[6 + i * (i - 1) // 2 + k] = A[i, k] / D
        for i in range(k + 1, 6):
            ratio = A[i, k] / D
            for j in range(k + 1, i + 1):
                A[i, j] -= ratio * A[j, k]
            y[i] -= ratio * y[k]
        values[k] = np.log(D)
        values[21 + k] = y[k] / D


@compiled(fastmath=FAST, error_model="numpy")
def interpolate(factors: Any, at: Any, values: Any, work: Any) -> None:
    """Add what the wall adds to log D (6,), M below its diagonal (15,), z (6,) and log P."""
    side = 0 if at[3] >= 0.0 else 1
    gaps, tilts, turns, count = factors.shape[1:]
    w, v, u = work[:4], work[4:8], work[8:12]
    i0 = weights(1.0 - at[2] / at[5], gaps, w)
    j0 = weights(abs(at[3]), tilts, v)
    k0 = weights(at[6], turns, u)
    for i in range(4):
        for j in range(4):
            here = factors[side, i0 + i, j0 + j]
            b = w[i] * v[j]
            b0, b1, b2, b3 = b * u[0], b * u[1], b * u[2], b * u[3]
            for m in range(count):
                values[m] += (
                    b0 * here[k0, m] + b1 * here[k0 + 1, m] + b2 * here[k0 + 2, m]
                    + b3 * here[k0 + 3, m]
                )  # fmt: skip


@compiled(fastmath=FAST, error_model="numpy")
def from_factors(numbers: Any, touch: Any, values: Any, R: Any, F: Any, work: Any) -> Any:
    """Write R = sum_k D_k m_k m_k' and F_p = sum_k D_k z_k m_k in the body frame.

    m_k, the columns of M, are turned from (n, t, r) of the wall into the body's axes. Returns
    ``F_p . R^-1 F_p = sum_k D_k z_k^2``.
    """
    moved = 0.0
    n0, n1, n2 = touch[4], touch[5], touch[6]
    across = np.sqrt(n1 * n1 + n2 * n2)
    cosine = n1 / across if across > 1e-12 else 1.0
    sine = n2 / across if across > 1e-12 else 0.0
    a, mu = numbers[6], numbers[7]
    m = work[:6]
    for i in range(6):
        F[i] = 0.0
        for j in range(6):
            R[i, j] = 0.0
    for k in range(6):
        m[0], m[1], m[2], m[3], m[4], m[5] = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        m[k] = 1.0
        for i in range(k + 1, 6):
            m[i] = values[6 + i * (i - 1) // 2 + k]
        fn, tr, ft, fr, tn, tt = m[0], a * m[1], m[2], m[3], a * m[4], a * m[5]
        m[0] = n0 * fn + across * ft
        m[1] = n1 * fn - n0 * cosine * ft - sine * fr
        m[2] = n2 * fn - n0 * sine * ft + cosine * fr
        m[3] = n0 * tn + across * tt
        m[4] = n1 * tn - n0 * cosine * tt - sine * tr
        m[5] = n2 * tn - n0 * sine * tt + cosine * tr
        D = mu * a * np.exp(values[k])
        moved += D * (a * values[21 + k]) ** 2
        for i in range(6):
            F[i] += a * D * values[21 + k] * m[i]
            for j in range(i + 1):
                R[i, j] += D * m[i] * m[j]
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return moved
