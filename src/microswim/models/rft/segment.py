"""Compiled kernels of resistive force theory: one segment, one tail.

The theory stands in rft; here are the sums. Everything stays analytic (no abs, no conjugates), so
that complex-step derivatives run through the same kernels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import FAST, compiled

HELIX, PLANE_WAVE = 0, 1
#: What the kernels know of a wave tail: where its numbers stand in an array p (11, ...), read as
#: constants. Length L along s, amplitude b and wavenumber k of the wave, the ramp's share of L,
#: sign g of a helix's hand, resistances of a segment (tangential, normal, about itself) with their
#: interaction coefficients, offset of the joint from the body's centre, spin of a section per phase
#: rate, drag of the tip: called as the fields of tail, coefficients and body are.
LENGTH, AMPLITUDE, WAVENUMBER, RAMP, SIGN, C_T, C_N, C_R, OFFSET, SPIN, TIP = range(11)
PARAMETERS = 11
SUMS = 28  #: what a `segment` adds to

#: Amplitude times wavenumber up to which plane waves are resolved.
STEEPEST = 25.0
#: Most nodes of a tail: thousands of turns, unless they are steep.
MOST_NODES = 100_000


@compiled(error_model="numpy")
def node_numbers(kind: int, waves: Any, bk: Any, ramp: Any) -> tuple[Any, Any]:
    """Return nodes on the ramp and on the rest that reach rounding error (plane wave: about 1e-12).

    The integrand of a helix holds products of two sines: Gauss-Legendre needs a little more than
    ``pi`` nodes a wave, and some for the tail of its convergence. The arc length of a plane wave,
    ``sqrt(1 + (bk cos)^2)``, is analytic only to ``arsinh(1/bk)/k`` off the axis, which takes
    nodes in inverse proportion.
    """
    bk = np.minimum(bk, STEEPEST)
    per_wave = 8.0 if kind == HELIX else np.maximum(8.0, 40.0 / np.arcsinh(1.0 / bk))
    on_ramp = (ramp > 0) * np.floor(14.0 + per_wave * waves * ramp + 4.0 * bk)
    return on_ramp, (ramp < 1) * np.floor(14.0 + per_wave * waves * (1.0 - ramp))


@compiled(fastmath=FAST)
def cosine_sine(x: Any) -> tuple[Any, Any]:
    """Return ``cos x`` and ``sin x`` to rounding, by the series at ``x/16`` within half a turn.

    Plain arithmetic, which the compiler does for several nodes at once.
    """
    y = (x - 2.0 * np.pi * np.rint(x.real / (2.0 * np.pi))) / 16.0
    z = y * y
    c = 1.0 - z / 2.0 * (1.0 - z / 12.0 * (1.0 - z / 30.0 * (1.0 - z / 56.0 * (1.0 - z / 90.0))))
    s = 1.0 - z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * (1.0 - z / 110.0))))
    s = s * y
    for _ in range(4):
        c, s = c * c - s * s, 2.0 * s * c
    return c, s


@compiled(fastmath=FAST, forceinline=True)
def in_plane(a: Any, a_s: Any, k: Any, c: Any, d: Any) -> tuple[Any, Any, Any]:
    """Return ``q = a c``, slope ``a' c - a k d``, velocity ``a d``; c, d of ``k s - phase``."""
    u = a * d
    return a * c, a_s * c - k * u, u


@compiled(fastmath=FAST, forceinline=True)
def out_of_plane(g: Any, a_s: Any, k: Any, q: Any, u: Any, d: Any) -> tuple[Any, Any, Any]:
    """Return ``r = -g a d``, its slope ``-g (a' d + a k c)`` and velocity ``g a c``, from those of
    q.
    """
    return -g * u, -g * (a_s * d + k * q), g * q


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def resistances(ds: Any, v2: Any, arc: bool, c: Any) -> tuple[Any, Any, Any]:
    """Return ``n = c_n dl``, ``d = (c_t - c_n) dl / v^2``, ``w = c_r dl / v^2``; c holds the three.

    v is the length of the tangent; the line element is ``dl = v ds``, or ds without `arc`.
    """
    c_n, d_c, c_r = c
    v = np.sqrt(v2) if arc else 1.0 + 0 * v2
    per_v = ds / v if arc else ds / v2
    return c_n * ds * v, d_c * per_v, c_r * per_v


@compiled(fastmath=FAST)
def wave_nodes(kind: int, x: Any, phase: Any, on_ramp: Any, p: Any) -> Any:
    """Return the centreline, slope and velocity at ``s = x L`` [Tabak Eqs. 11, 12]."""
    L, b, k = p[LENGTH], p[AMPLITUDE], p[WAVENUMBER]
    ramp, g, s = p[RAMP], p[SIGN], x * L
    if on_ramp:
        amplitude, slope = b * x / ramp, b / (ramp * L)
    else:
        amplitude, slope = b + 0 * x, 0 * b
    c, d = np.cos(k * s - phase), np.sin(k * s - phase)
    q, q_s, q_phase = in_plane(amplitude, slope, k, c, d)
    if kind == PLANE_WAVE:
        return s, q, 0 * q, q_s, 0 * q, q_phase, 0 * q
    r, r_s, r_phase = out_of_plane(g, slope, k, q, q_phase, d)
    return s, q, r, q_s, r_s, q_phase, r_phase


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def segment(X: Any, T: Any, U: Any, n: Any, d: Any, w: Any, spin: Any) -> Any:
    """Return what one segment adds: 21 entries of ``B_t`` row by row, 6 of ``F_p``, and to G.

    ``X`` position from the body's centre, ``T`` tangent of any length, ``U`` velocity per unit
    phase rate; n, d, w its `resistances`. With
    ``m = X x T`` a rotation W moves the segment along T at ``m . W``:
    B_t = n [I, -X^; X^, |X|^2 I - X X'] + d [T; m] [T; m]' + w [0; T] [0; T]'.
    """
    x, y, z = X
    t0, t1, t2 = T
    u0, u1, u2 = U
    m0, m1, m2 = y * t2 - z * t1, z * t0 - x * t2, x * t1 - y * t0
    nx, ny, nz = n * x, n * y, n * z
    d0, d1, d2, D0, D1, D2 = d * t0, d * t1, d * t2, d * m0, d * m1, d * m2
    w0, w1, w2 = w * t0, w * t1, w * t2
    along = d0 * u0 + d1 * u1 + d2 * u2
    f0, f1, f2 = n * u0 + along * t0, n * u1 + along * t1, n * u2 + along * t2
    twist = w0 * spin
    return (
        d0 * t0 + n,
        *(d1 * t0, d1 * t1 + n),
        *(d2 * t0, d2 * t1, d2 * t2 + n),
        *(D0 * t0, D0 * t1 - nz, D0 * t2 + ny, D0 * m0 + ny * y + nz * z + w0 * t0),
        *(D1 * t0 + nz, D1 * t1, D1 * t2 - nx, D1 * m0 - nx * y + w1 * t0),
        D1 * m1 + nx * x + nz * z + w1 * t1,
        *(D2 * t0 - ny, D2 * t1 + nx, D2 * t2, D2 * m0 - nx * z + w2 * t0),
        *(D2 * m1 - ny * z + w2 * t1, D2 * m2 + nx * x + ny * y + w2 * t2),
        *(f0, f1, f2),
        *(y * f2 - z * f1 + twist * t0, z * f0 - x * f2 + twist * t1, x * f1 - y * f0 + twist * t2),
        f0 * u0 + f1 * u1 + f2 * u2 + twist * t0 * spin,
    )


@compiled(forceinline=True)
def nothing(zero: Any) -> Any:
    """Return the sums of no segment."""
    row = (zero, zero, zero, zero, zero, zero, zero)
    return row + row + row + row


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def plus(a: Any, b: Any) -> Any:
    """Return the sums of two segments: numbers of their own, which a loop keeps in registers."""
    return (
        *(a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]),
        *(a[6] + b[6], a[7] + b[7], a[8] + b[8], a[9] + b[9], a[10] + b[10], a[11] + b[11]),
        *(a[12] + b[12], a[13] + b[13], a[14] + b[14], a[15] + b[15], a[16] + b[16]),
        *(a[17] + b[17], a[18] + b[18], a[19] + b[19], a[20] + b[20], a[21] + b[21]),
        *(a[22] + b[22], a[23] + b[23], a[24] + b[24], a[25] + b[25], a[26] + b[26]),
        a[27] + b[27],
    )


@compiled(forceinline=True)
def numbers(P: Any, l: int) -> Any:
    """Return the parameters of the design in lane l of P (11, lanes)."""
    return (
        *(P[0, l], P[1, l], P[2, l], P[3, l], P[4, l], P[5, l], P[6, l], P[7, l]),
        *(P[8, l], P[9, l], P[10, l]),
    )


@compiled(forceinline=True)
def sums_at(S: Any, l: int) -> Any:
    """Return the sums that lane l of S (28, lanes) keeps."""
    return (
        *(S[0, l], S[1, l], S[2, l], S[3, l], S[4, l], S[5, l], S[6, l], S[7, l]),
        *(S[8, l], S[9, l], S[10, l], S[11, l], S[12, l], S[13, l], S[14, l], S[15, l]),
        *(S[16, l], S[17, l], S[18, l], S[19, l], S[20, l], S[21, l], S[22, l], S[23, l]),
        *(S[24, l], S[25, l], S[26, l], S[27, l]),
    )


@compiled(forceinline=True)
def keep_sums(S: Any, l: int, a: Any) -> None:
    """Put sums into lane l of S (28, lanes)."""
    S[0, l], S[1, l], S[2, l], S[3, l] = a[0:4]
    S[4, l], S[5, l], S[6, l], S[7, l] = a[4:8]
    S[8, l], S[9, l], S[10, l], S[11, l] = a[8:12]
    S[12, l], S[13, l], S[14, l], S[15, l] = a[12:16]
    S[16, l], S[17, l], S[18, l], S[19, l] = a[16:20]
    S[20, l], S[21, l], S[22, l], S[23, l] = a[20:24]
    S[24, l], S[25, l], S[26, l], S[27, l] = a[24:28]


@compiled(fastmath=FAST)
def add_sums(R: Any, F: Any, sums: Any, forces: Any) -> None:
    """Add the 21 sums, row by row, to the lower triangle of R, and the six forces to F."""
    n = 0
    for i in range(6):
        for j in range(i + 1):
            R[i, j] += sums[n]
            n += 1
        F[i] += forces[i]


@compiled(fastmath=FAST, error_model="numpy", forceinline=True)
def tip(kind: int, p: Any, at: Any) -> Any:
    """Return the `segment` sums of the tip, a point at ``s = L`` that resists alike in all
    directions; cosine and sine of ``k L - phase``.
    """
    c, d = at
    q, _, u = in_plane(p[AMPLITUDE], 0.0, p[WAVENUMBER], c, d)
    g = 0.0 * p[SIGN] if kind == PLANE_WAVE else p[SIGN]
    none = 0 * q
    X, T, U = (p[LENGTH] + p[OFFSET], q, -g * u), (1.0 + none, none, none), (none, u, g * q)
    return segment(X, T, U, p[TIP] + none, none, none, none)


@compiled(fastmath=FAST)
def add_tip(kind: int, R: Any, F: Any, p: Any, phase: Any) -> Any:
    """Add the `tip` to R and F; returns its part of G."""
    end = p[WAVENUMBER] * p[LENGTH] - phase
    sums = tip(kind, p, (np.cos(end), np.sin(end)))
    add_sums(R, F, sums[:21], sums[21:27])
    return sums[27]


@compiled(fastmath=FAST)
def wave_tail(kind: int, arc: bool, p: Any, phase: Any, ramp_rule: Any, rule: Any) -> Any:
    """Return ``(B_t, F_p, G)`` of a wave tail at one phase; p from `LENGTH` to `TIP`."""
    R = np.zeros((6, 6, *p.shape[1:]), dtype=p.dtype)
    F = np.zeros((6, *p.shape[1:]), dtype=p.dtype)
    L, ramp, offset, spin = p[LENGTH], p[RAMP], p[OFFSET], p[SPIN]
    c = p[C_N], p[C_T] - p[C_N], p[C_R]
    sums = nothing(0 * L)
    for panel in range(2):
        xi, weight = ramp_rule if panel == 0 else rule
        start = 0 * ramp if panel == 0 else ramp
        width = ramp if panel == 0 else 1.0 - ramp
        for i in range(xi.size):
            s, q, r, q_s, r_s, u, v = wave_nodes(kind, start + width * xi[i], phase, panel == 0, p)
            ds, v2 = weight[i] * width * L, 1.0 + q_s * q_s + r_s * r_s
            n, d, w = resistances(ds, v2, arc, c)
            X, T, U = (s + offset, q, r), (1.0, q_s, r_s), (0.0, u, v)
            sums = plus(sums, segment(X, T, U, n, d, w, spin))
    add_sums(R, F, sums[:21], sums[21:27])
    G = sums[27] + add_tip(kind, R, F, p, phase)
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return R, F, G


@compiled(fastmath=FAST)
def centreline_tail(X: Any, P_s: Any, U_all: Any, ds: Any, arc: bool, c: Any, spin: float) -> Any:
    """Return ``(B_t, F_p, G)`` from a centreline on nodes: arrays (n, 3), quadrature weights ds
    (n,).
    """
    R = np.zeros((6, 6, *X.shape[2:]), dtype=X.dtype)
    F = np.zeros((6, *X.shape[2:]), dtype=X.dtype)
    sums, local = nothing(0 * X[0, 0]), (c[1], c[0] - c[1], c[2])
    for i in range(ds.size):
        T, U = (P_s[i, 0], P_s[i, 1], P_s[i, 2]), (U_all[i, 0], U_all[i, 1], U_all[i, 2])
        v2 = T[0] * T[0] + T[1] * T[1] + T[2] * T[2]
        n, d, w = resistances(ds[i], v2, arc, local)
        sums = plus(sums, segment((X[i, 0], X[i, 1], X[i, 2]), T, U, n, d, w, spin))
    add_sums(R, F, sums[:21], sums[21:27])
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return R, F, sums[27]
