"""The rigid helix, fast: closed integrals where its amplitude is constant, few nodes on its ramp.

With ``theta = k s - phase``, ``c = cos theta``, ``d = sin theta``, the sign g of the hand and x
measured from the body's centre, position, tangent and velocity per unit phase rate are

    X = (x, a c, -g a d),   v t = (1, a' c - a k d, -g (a' d + a k c)),   u = (0, a d, g a c)

Behind the ramp a = b is constant, ``v^2 = 1 + b^2 k^2`` too, and the sums of `segment.segment`
are combinations of ``int x^m {1, c, d} dx`` (m = 0, 1) and ``int x^m {1, c^2, d^2, c d} dx``
(m = 0, 1, 2). On the ramp the integrand is smooth: Gauss-Legendre. Both equal the plain quadrature
of segment to rounding; a test holds them to it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.models.rft.segment import (
    AMPLITUDE,
    C_N,
    C_R,
    C_T,
    HELIX,
    LENGTH,
    OFFSET,
    RAMP,
    SIGN,
    SPIN,
    WAVENUMBER,
    add_sums,
    add_tip,
    in_plane,
    nothing,
    out_of_plane,
    plus,
    resistances,
    segment,
)
from microswim.numerics.compiling.compiled import FAST, compiled

#: Below this number of waves the closed integrals lose digits to cancellation.
FEWEST_WAVES = 0.05
#: On its ramp; a design that needs more takes the plain quadrature.
MOST_ON_RAMP = 96


@compiled()
def ramp_nodes(turns: Any, bk: Any, digits: float) -> Any:
    """Return nodes on the ramp for a number of digits, in fours; `turns` are the waves on it.

    The sines take nodes in proportion to the turns; the arc length, analytic to a distance
    ``1/bk`` of the ramp's root, takes some more. Found by trial for 8 and 12 digits, and linear
    between; tests/test_rft.py holds it to what it promises.
    """
    x = (digits - 8.0) / 4.0
    more = (2.6 + 1.6 * x) * np.sqrt(turns * np.minimum(bk, 14.0))
    needed = 5.0 + x + (3.5 + 0.5 * x) * turns + more
    return (turns > 0) * 4.0 * np.maximum(1.0, np.ceil(needed / 4.0))


@compiled(fastmath=FAST, error_model="numpy")
def add_constant_part(R: Any, F: Any, p: Any, phase: Any, arc: bool) -> Any:
    """Add the part behind the ramp to the lower triangle of ``B_t`` and to ``F_p``; returns G.

    p as in `segment`. With ``B = b k`` the resistances per length along x
    are ``N = c_n v``, ``D = (c_t - c_n)/v``, ``S = c_r/v`` (`arc`; without it, over v more).
    """
    L, b, k, ramp, g = p[LENGTH], p[AMPLITUDE], p[WAVENUMBER], p[RAMP], p[SIGN]
    offset, spin = p[OFFSET], p[SPIN]
    B = b * k
    v2 = 1.0 + B * B
    v = np.sqrt(v2) if arc else 1.0 + 0 * B
    N, D, S = p[C_N] * v, (p[C_T] - p[C_N]) * v / v2, p[C_R] * v / v2
    s = ramp * L
    x0, x1 = s + offset, L + offset
    c0, d0 = np.cos(k * s - phase), np.sin(k * s - phase)
    c1, d1 = np.cos(k * L - phase), np.sin(k * L - phase)
    # int x^m, and int x^m {cos, sin} by parts
    l, x, xx = x1 - x0, (x1 * x1 - x0 * x0) / 2.0, (x1 * x1 * x1 - x0 * x0 * x0) / 3.0
    h = 1.0 / k
    c, d = h * (d1 - d0), h * (c0 - c1)
    xc, xd = h * (x1 * d1 - x0 * d0 - d), h * (x0 * c0 - x1 * c1 + c)
    # the same of the double angle, and from them c^2, d^2, c d
    h = h / 2.0
    c0, d0, c1, d1 = c0 * c0 - d0 * d0, 2.0 * c0 * d0, c1 * c1 - d1 * d1, 2.0 * c1 * d1
    e, f = h * (d1 - d0), h * (c0 - c1)
    xe, xf = h * (x1 * d1 - x0 * d0 - f), h * (x0 * c0 - x1 * c1 + e)
    xxe = h * (x1 * x1 * d1 - x0 * x0 * d0 - 2.0 * xf)
    xxf = h * (x0 * x0 * c0 - x1 * x1 * c1 + 2.0 * xe)
    cc, dd, cd = (l + e) / 2.0, (l - e) / 2.0, f / 2.0
    xcc, xdd, xcd = (x + xe) / 2.0, (x - xe) / 2.0, xf / 2.0
    xxcc, xxdd, xxcd = (xx + xxe) / 2.0, (xx - xxe) / 2.0, xxf / 2.0

    M = N + D * B * B
    R[0, 0] += (D + N) * l
    R[1, 0] -= D * B * d
    R[1, 1] += D * B * B * dd + N * l
    R[2, 0] -= D * g * B * c
    R[2, 1] += D * g * B * B * cd
    R[2, 2] += D * B * B * cc + N * l
    R[3, 0] -= D * g * b * B * l
    R[3, 1] += M * g * b * d
    R[3, 2] += M * b * c
    R[3, 3] += (M * b * b + S) * l
    R[4, 0] += D * g * (B * xc - b * d) - N * g * b * d
    R[4, 1] -= D * g * B * (B * xcd - b * dd)
    R[4, 2] -= D * B * (B * xcc - b * cd) + N * x
    R[4, 3] -= D * b * B * (B * xc - b * d) + N * b * xc + S * B * d
    R[4, 4] += D * (B * B * xxcc - 2.0 * b * B * xcd + b * b * dd) + N * xx
    R[4, 4] += (N * b * b + S * B * B) * dd
    R[5, 0] -= D * (B * xd + b * c) + N * b * c
    R[5, 1] += D * B * (B * xdd + b * cd) + N * x
    R[5, 2] += D * g * B * (B * xcd + b * cc)
    R[5, 3] += g * (D * b * B * (B * xd + b * c) + N * b * xd - S * B * c)
    R[5, 4] += g * ((N * b * b + S * B * B) * cd)
    R[5, 4] -= g * D * (B * B * xxcd + b * B * (xcc - xdd) - b * b * cd)
    R[5, 5] += D * (B * B * xxdd + 2.0 * b * B * xcd + b * b * cc) + N * xx
    R[5, 5] += (N * b * b + S * B * B) * cc
    F[0] -= D * b * B * l
    F[1] += M * b * d
    F[2] += M * g * b * c
    F[3] += g * M * b * b * l + S * spin * l
    F[4] += g * D * b * b * B * d - M * g * b * xc - S * spin * B * d
    F[5] += D * b * b * B * c + M * b * xd - S * spin * g * B * c
    return (M * b * b + S * spin * spin) * l


@compiled(fastmath=FAST)
def fill_trig(trig: Any, xi: Any, turn: Any, phase: Any) -> None:
    """Fill in cos and sin of ``turn xi - phase`` on nodes that lie in pairs about the middle."""
    m = xi.size
    c, d = np.cos(turn / 2.0 - phase), np.sin(turn / 2.0 - phase)
    for i in range((m + 1) // 2):
        e, f = np.cos(turn * (xi[i] - 0.5)), np.sin(turn * (xi[i] - 0.5))
        trig[0, i], trig[1, i] = c * e - d * f, d * e + c * f
        trig[0, m - 1 - i], trig[1, m - 1 - i] = c * e + d * f, d * e - c * f


@compiled(fastmath=FAST, error_model="numpy")
def add_ramp(R: Any, F: Any, p: Any, phase: Any, arc: bool, rule: Any, trig: Any) -> Any:
    """Add the ramp, ``a = b s/(ramp L)``, likewise; `trig` is scratch, (2, nodes).

    Without stores in the loop the compiler takes several nodes at once.
    """
    xi, weight = rule
    s, b, k, g = p[RAMP] * p[LENGTH], p[AMPLITUDE], p[WAVENUMBER], p[SIGN]
    offset, spin = p[OFFSET], p[SPIN]
    if xi.size == 0:
        return 0 * b
    fill_trig(trig, xi, k * s, phase)
    slope, local = b / s, (p[C_N] * s, (p[C_T] - p[C_N]) * s, p[C_R] * s)

    sums = nothing(0 * b)
    for i in range(xi.size):
        c, d, a, x = trig[0, i], trig[1, i], b * xi[i], s * xi[i] + offset
        q, q_s, u = in_plane(a, slope, k, c, d)
        r, r_s, v = out_of_plane(g, slope, k, q, u, d)
        n, D, S = resistances(weight[i], 1.0 + q_s * q_s + r_s * r_s, arc, local)
        sums = plus(sums, segment((x, q, r), (1.0, q_s, r_s), (0.0, u, v), n, D, S, spin))
    add_sums(R, F, sums[:21], sums[21:27])
    return sums[27]


@compiled()
def helix_tail(arc: bool, p: Any, phase: Any, ramp_rule: Any) -> Any:
    """Return ``(B_t, F_p, G)`` of a rigid helix at one phase; p as in `segment`."""
    R = np.zeros((6, 6, *p.shape[1:]), dtype=p.dtype)
    F = np.zeros((6, *p.shape[1:]), dtype=p.dtype)
    trig = np.empty((2, ramp_rule[0].size, *p.shape[1:]), dtype=p.dtype)
    G = add_ramp(R, F, p, phase, arc, ramp_rule, trig) + add_constant_part(R, F, p, phase, arc)
    G += add_tip(HELIX, R, F, p, phase)
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return R, F, G
