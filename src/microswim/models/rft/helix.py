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
    cosine_sine,
    in_plane,
    out_of_plane,
    plus,
    resistances,
    segment,
    tip,
)
from microswim.numerics.compiling.compiled import FAST, compiled

#: Below this number of waves the closed integrals lose digits to cancellation.
FEWEST_WAVES = 0.05
#: On its ramp; a design that needs more takes the plain quadrature.
MOST_ON_RAMP = 96


@compiled()
def ramp_nodes(turns: Any, bk: Any, digits: float) -> Any:
    """Return nodes on the ramp for a number of digits, in pairs; `turns` are the waves on it.

    The sines take nodes in proportion to the turns; the arc length, analytic to a distance
    ``1/bk`` of the ramp's root, takes some more. Found by trial for 8 and 12 digits, and linear
    between; tests/test_rft.py holds it to what it promises.
    """
    x = (digits - 8.0) / 4.0
    more = (2.6 + 1.6 * x) * np.sqrt(turns * np.minimum(bk, 14.0))
    needed = 5.0 + x + (3.5 + 0.5 * x) * turns + more
    return (turns > 0) * 2.0 * np.ceil(needed / 2.0)


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def behind_ramp(p: Any, at_ramp: Any, at_end: Any, arc: bool) -> Any:
    """Return the `segment` sums of all that is behind the ramp, in closed form.

    p as in `segment`; cosine and sine of ``k s - phase`` at the ramp's end and at the tail's. With
    ``B = b k`` the resistances per length along x are ``N = c_n v``, ``D = (c_t - c_n)/v``,
    ``S = c_r/v`` (`arc`; without it, over v more).
    """
    L, b, k, ramp, g = p[LENGTH], p[AMPLITUDE], p[WAVENUMBER], p[RAMP], p[SIGN]
    offset, spin = p[OFFSET], p[SPIN]
    c0, d0 = at_ramp
    c1, d1 = at_end
    B = b * k
    v2 = 1.0 + B * B
    v = np.sqrt(v2) if arc else 1.0 + 0 * B
    N, D, S = p[C_N] * v, (p[C_T] - p[C_N]) * v / v2, p[C_R] * v / v2
    x0, x1 = ramp * L + offset, L + offset
    # int x^m, and int x^m {cos, sin} by parts
    l, x, xx = x1 - x0, (x1 * x1 - x0 * x0) / 2.0, (x1 * x1 * x1 - x0 * x0 * x0) / 3.0
    h = 1.0 / k
    c, d = h * (d1 - d0), h * (c0 - c1)
    xc, xd = h * (x1 * d1 - x0 * d0 - d), h * (x0 * c0 - x1 * c1 + c)
    # the same of the double angle, and from them c^2, d^2, c d
    h2 = h / 2.0
    e0, f0, e1, f1 = c0 * c0 - d0 * d0, 2.0 * c0 * d0, c1 * c1 - d1 * d1, 2.0 * c1 * d1
    e, f = h2 * (f1 - f0), h2 * (e0 - e1)
    xe, xf = h2 * (x1 * f1 - x0 * f0 - f), h2 * (x0 * e0 - x1 * e1 + e)
    xxe = h2 * (x1 * x1 * f1 - x0 * x0 * f0 - 2.0 * xf)
    xxf = h2 * (x0 * x0 * e0 - x1 * x1 * e1 + 2.0 * xe)
    cc, dd, cd = (l + e) / 2.0, (l - e) / 2.0, f / 2.0
    xcc, xdd, xcd = (x + xe) / 2.0, (x - xe) / 2.0, xf / 2.0
    xxcc, xxdd, xxcd = (xx + xxe) / 2.0, (xx - xxe) / 2.0, xxf / 2.0

    M, b2, B2, gD = N + D * B * B, b * b, B * B, g * D
    T, turned = N * b2 + S * B2, S * spin
    return (
        (D + N) * l,
        *(-D * B * d, D * B2 * dd + N * l),
        *(-gD * B * c, gD * B2 * cd, D * B2 * cc + N * l),
        *(-gD * b * B * l, M * g * b * d, M * b * c, (M * b2 + S) * l),
        gD * (B * xc - b * d) - N * g * b * d,
        -gD * B * (B * xcd - b * dd),
        -D * B * (B * xcc - b * cd) - N * x,
        -D * b * B * (B * xc - b * d) - N * b * xc - S * B * d,
        D * (B2 * xxcc - 2.0 * b * B * xcd + b2 * dd) + N * xx + T * dd,
        -D * (B * xd + b * c) - N * b * c,
        D * B * (B * xdd + b * cd) + N * x,
        gD * B * (B * xcd + b * cc),
        g * (D * b * B * (B * xd + b * c) + N * b * xd - S * B * c),
        g * T * cd - gD * (B2 * xxcd + b * B * (xcc - xdd) - b2 * cd),
        D * (B2 * xxdd + 2.0 * b * B * xcd + b2 * cc) + N * xx + T * cc,
        *(-D * b * B * l, M * b * d, M * g * b * c),
        g * M * b2 * l + turned * l,
        gD * b2 * B * d - M * g * b * xc - turned * B * d,
        D * b2 * B * c + M * b * xd - turned * g * B * c,
        (M * b2 + turned * spin) * l,
    )


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def on_ramp(p: Any, slope: Any, xi: Any, weight: Any, at: Any, arc: bool) -> Any:
    """Return the `segment` sums of one node of the ramp, at the share xi of it, likewise."""
    c, d = at
    s = p[RAMP] * p[LENGTH]
    local = (p[C_N] * s, (p[C_T] - p[C_N]) * s, p[C_R] * s)
    q, q_s, u = in_plane(p[AMPLITUDE] * xi, slope, p[WAVENUMBER], c, d)
    r, r_s, v = out_of_plane(p[SIGN], slope, p[WAVENUMBER], q, u, d)
    n, D, S = resistances(weight, 1.0 + q_s * q_s + r_s * r_s, arc, local)
    X = (s * xi + p[OFFSET], q, r)
    return segment(X, (1.0, q_s, r_s), (0.0, u, v), n, D, S, p[SPIN])


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def pair_on_ramp(p: Any, middle: Any, xi: Any, weight: Any, arc: bool) -> Any:
    """Return the sums of the two nodes of a rule that lie about the ramp's middle alike.

    The nodes are at the shares xi and ``1 - xi`` of the ramp, where ``a = b s/(ramp L)``; `middle`
    is cosine and sine of ``k s - phase`` halfway.
    """
    c, d = middle
    s = p[RAMP] * p[LENGTH]
    slope = p[AMPLITUDE] / (s + (s == 0))
    e, f = cosine_sine(p[WAVENUMBER] * s * (0.5 - xi))
    near = on_ramp(p, slope, xi, weight, (c * e + d * f, d * e - c * f), arc)
    far = on_ramp(p, slope, 1.0 - xi, weight, (c * e - d * f, d * e + c * f), arc)
    return plus(near, far)


@compiled(fastmath=FAST, error_model="numpy")
def helix_tail(arc: bool, p: Any, phase: Any, ramp_rule: Any) -> Any:
    """Return ``(B_t, F_p, G)`` of a rigid helix at one phase; p as in `segment`.

    The rule has an even number of nodes. Without stores in the loop over them the compiler takes
    several at once.
    """
    xi, weight = ramp_rule
    R = np.zeros((6, 6, *p.shape[1:]), dtype=p.dtype)
    F = np.zeros((6, *p.shape[1:]), dtype=p.dtype)
    L, k, turn = p[LENGTH], p[WAVENUMBER], p[WAVENUMBER] * p[RAMP] * p[LENGTH]
    at_ramp = np.cos(turn - phase), np.sin(turn - phase)
    at_end = np.cos(k * L - phase), np.sin(k * L - phase)
    middle = np.cos(0.5 * turn - phase), np.sin(0.5 * turn - phase)
    sums = plus(behind_ramp(p, at_ramp, at_end, arc), tip(HELIX, p, at_end))
    for i in range(xi.size // 2):
        sums = plus(sums, pair_on_ramp(p, middle, xi[i], weight[i], arc))
    add_sums(R, F, sums[:21], sums[21:27])
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return R, F, sums[27]
