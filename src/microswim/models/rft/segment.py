"""Compiled kernels of resistive force theory: one segment, one tail.

The theory stands in rft; here are the sums. Everything stays analytic (no abs, no conjugates), so
that complex-step derivatives run through the same kernels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.compiled import FAST, compiled

HELIX, PLANE_WAVE = 0, 1
#: Amplitude times wavenumber up to which plane waves are resolved.
STEEPEST = 25.0
#: Most nodes of a tail: thousands of turns, unless they are steep.
MOST_NODES = 100_000


@compiled(error_model="numpy")
def node_numbers(kind: int, waves: Any, bk: Any, ramp: Any) -> tuple[Any, Any]:
    """Nodes on the ramp and on the rest that reach rounding error (plane wave: about 1e-12).

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
    """``cos x`` and ``sin x`` to rounding, by the series at ``x/16`` within half a turn.

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


@compiled(fastmath=FAST)
def wave_nodes(kind: int, x: Any, phase: Any, on_ramp: Any, p: Any) -> Any:
    """Centreline, slope and velocity at ``s = x L`` [Tabak Eqs. 11, 12]; p as in `PARAMETERS`."""
    L, b, k, ramp, sign = p[0], p[1], p[2], p[3], p[4]
    s = x * L
    if on_ramp:
        amplitude, slope = b * x / ramp, b / (ramp * L)
    else:
        amplitude, slope = b + 0 * x, 0 * b
    c, d = np.cos(k * s - phase), np.sin(k * s - phase)
    q, q_s, q_phase = amplitude * c, slope * c - amplitude * k * d, amplitude * d
    if kind == PLANE_WAVE:
        return s, q, 0 * q, q_s, 0 * q, q_phase, 0 * q
    r, r_s = -sign * amplitude * d, -sign * (slope * d + amplitude * k * c)
    return s, q, r, q_s, r_s, q_phase, sign * amplitude * c


@compiled(fastmath=FAST)
def add_segment(R: Any, F: Any, X: Any, T: Any, U: Any, dl: Any, c: Any, spin: float) -> Any:
    """Add one segment of length dl to ``B_t`` and ``F_p``; returns its activity.

    ``X`` position from the body's centre, ``T`` unit tangent, ``U`` velocity per unit phase rate;
    ``c = (c_t, c_n, c_r)``. With ``m = X x t`` a rotation W moves the segment along t at ``m . W``:
    B_t = c_n [I, -X^; X^, |X|^2 I - X X'] + (c_t - c_n) [t; m] [t; m]' + c_r [0; t] [0; t]'.
    """
    x, y, z = X
    t0, t1, t2 = T
    n = c[1] * dl
    d = (c[0] - c[1]) * dl
    w = c[2] * dl
    g = (t0, t1, t2, y * t2 - z * t1, z * t0 - x * t2, x * t1 - y * t0)
    for i in range(6):
        for j in range(i + 1):
            R[i, j] += d * g[i] * g[j]
    for i in range(3):
        R[i, i] += n
        for j in range(i + 1):
            R[3 + i, 3 + j] += w * g[i] * g[j]
    R[3, 3] += n * (y * y + z * z)
    R[4, 4] += n * (x * x + z * z)
    R[5, 5] += n * (x * x + y * y)
    R[4, 3] -= n * x * y
    R[5, 3] -= n * x * z
    R[5, 4] -= n * y * z
    R[3, 1] -= n * z
    R[3, 2] += n * y
    R[4, 0] += n * z
    R[4, 2] -= n * x
    R[5, 0] -= n * y
    R[5, 1] += n * x
    along = d * (t0 * U[0] + t1 * U[1] + t2 * U[2])
    f0, f1, f2 = n * U[0] + along * t0, n * U[1] + along * t1, n * U[2] + along * t2
    twist = w * t0 * spin
    F[0] += f0
    F[1] += f1
    F[2] += f2
    F[3] += y * f2 - z * f1 + twist * t0
    F[4] += z * f0 - x * f2 + twist * t1
    F[5] += x * f1 - y * f0 + twist * t2
    return f0 * U[0] + f1 * U[1] + f2 * U[2] + twist * t0 * spin


@compiled(fastmath=FAST)
def add_sums(R: Any, F: Any, sums: Any, forces: Any) -> None:
    """Add the 21 sums, row by row, to the lower triangle of R, and the six forces to F."""
    n = 0
    for i in range(6):
        for j in range(i + 1):
            R[i, j] += sums[n]
            n += 1
        F[i] += forces[i]


PARAMETERS = ("L", "b", "k", "ramp", "sign", "c_t", "c_n", "c_r", "offset", "spin", "tip")


@compiled(fastmath=FAST)
def add_tip(kind: int, R: Any, F: Any, p: Any, phase: Any) -> Any:
    """Add the drag of the tip, a point at ``s = L`` that resists alike in all directions."""
    s, q, r, _, _, u, v = wave_nodes(kind, 1.0 + 0 * p[3], phase, False, p)
    X, T, U = (s + p[8], q, r), (1.0 + 0 * s, 0 * s, 0 * s), (0 * u, u, v)
    return add_segment(R, F, X, T, U, 1.0, (p[10], p[10], 0 * p[10]), 0.0)


@compiled(fastmath=FAST)
def wave_tail(kind: int, arc: bool, p: Any, phase: Any, ramp_rule: Any, rule: Any) -> Any:
    """``(B_t, F_p, G)`` of a wave tail at one phase; p as in `PARAMETERS`."""
    R = np.zeros((6, 6, *p.shape[1:]), dtype=p.dtype)
    F = np.zeros((6, *p.shape[1:]), dtype=p.dtype)
    G = 0 * p[0]
    c = (p[5], p[6], p[7])
    spin = p[9]
    for panel in range(2):
        xi, weight = ramp_rule if panel == 0 else rule
        start = 0 * p[3] if panel == 0 else p[3]
        width = p[3] if panel == 0 else 1.0 - p[3]
        for i in range(xi.size):
            s, q, r, q_s, r_s, u, v = wave_nodes(kind, start + width * xi[i], phase, panel == 0, p)
            speed = np.sqrt(1.0 + q_s * q_s + r_s * r_s)
            dl = weight[i] * width * p[0] * (speed if arc else 1.0)
            T = (1.0 / speed, q_s / speed, r_s / speed)
            G += add_segment(R, F, (s + p[8], q, r), T, (0 * u, u, v), dl, c, spin)
    G += add_tip(kind, R, F, p, phase)
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return R, F, G


@compiled(fastmath=FAST)
def centreline_tail(X: Any, P_s: Any, U: Any, ds: Any, arc: bool, c: Any, spin: float) -> Any:
    """``(B_t, F_p, G)`` from a centreline on nodes: arrays (n, 3), quadrature weights ds (n,)."""
    R = np.zeros((6, 6, *X.shape[2:]), dtype=X.dtype)
    F = np.zeros((6, *X.shape[2:]), dtype=X.dtype)
    G = 0 * X[0, 0]
    for i in range(ds.size):
        a, b, d = P_s[i, 0], P_s[i, 1], P_s[i, 2]
        speed = np.sqrt(a * a + b * b + d * d)
        T = (a / speed, b / speed, d / speed)
        x = (X[i, 0], X[i, 1], X[i, 2])
        u = (U[i, 0], U[i, 1], U[i, 2])
        G += add_segment(R, F, x, T, u, ds[i] * (speed if arc else 1.0), c, spin)
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return R, F, G
