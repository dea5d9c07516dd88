"""Compiled evaluation of a region calibration: corrected R, F_p, G of many designs, and twists.

Depends on blocks, kriging, shaded.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from . import blocks, shaded
from .gait import MIRROR_Q
from .kriging import predict
from .mobility import solve

SAMPLES = 12  #: phases over a period of a plane wave
HALF = SAMPLES // 2


@njit(cache=True, nogil=True)
def helices(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, ramp_rule: Any, rule: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Corrected R, F, G of rigid helices at phase 0, and the axial force on the body."""
    n = p.shape[0]
    R = np.empty((n, 1, 6, 6), dtype=p.dtype)
    F = np.empty((n, 1, 6), dtype=p.dtype)
    G = np.empty((n, 1), dtype=p.dtype)
    extra = np.empty((n, 3), dtype=p.dtype)
    for d in range(n):
        y = mean.astype(p.dtype)
        predict(y, Z[d], N[d], nodes, tips, lengths, phasors, cut, alpha)
        R0, F0, G0 = shaded.shaded_tail(0, p[d], mu[d], 0.0, ramp_rule, rule)
        for i in range(6):
            R0[i, i] += D[d, i]
        a = p[d, 8]
        extra[d, 0] = D[d, 0] * np.exp(y[10])
        extra[d, 1] = y[11] * mu[d] * a * a
        extra[d, 2] = y[12] * mu[d] * a * a
        for i in range(12):
            y[10 + i] = y[13 + i]
        r, f, g = blocks.decode_helix(y, R0, F0, G0, a, mu[d], D[d, 3])
        G[d, 0] = g
        for i in range(6):
            F[d, 0, i] = f[i]
            for j in range(6):
                R[d, 0, i, j] = r[i, j]
    return R, F, G, extra


@njit(cache=True)
def scales(R0: Any, F0: Any, G0: Any) -> Any:
    """Scales of F_s, F_q, T_r and G of a plane wave, from samples over half a period."""
    out = np.empty(4, dtype=R0.dtype)
    thrust, power, across, turn = 0 * G0[0], 0 * G0[0], 0 * G0[0], 0 * G0[0]
    for j in range(len(G0)):
        thrust += F0[j, 0] / len(G0)
        power += G0[j] / len(G0)
        across += R0[j, 1, 1] / len(G0)
        turn += R0[j, 5, 5] / len(G0)
    out[0], out[3] = thrust, power
    out[1], out[2] = np.sqrt(power * across), np.sqrt(power * turn)
    return out


@njit(cache=True)
def wave_base(p: Any, D: Any, mu: Any, ramp_rule: Any, rule: Any) -> Any:
    """Base R, F, G of a plane wave at the phases of half a period."""
    R0 = np.empty((HALF, 6, 6), dtype=p.dtype)
    F0 = np.empty((HALF, 6), dtype=p.dtype)
    G0 = np.empty(HALF, dtype=p.dtype)
    for j in range(HALF):
        R0[j], F0[j], G0[j] = shaded.shaded_tail(1, p, mu, np.pi * j / HALF, ramp_rule, rule)
        for i in range(6):
            R0[j, i, i] += D[i]
    return R0, F0, G0


@njit(cache=True)
def beat(y: Any, phase: float) -> Any:
    """Corrections (16,) at a phase from the harmonics, packed as `region` fits them."""
    out = np.empty(16, dtype=y.dtype)
    c1, s1 = np.cos(phase), np.sin(phase)
    c2, s2, c3, s3 = np.cos(2 * phase), np.sin(2 * phase), np.cos(3 * phase), np.sin(3 * phase)
    for i in range(len(blocks.EVEN)):
        out[blocks.EVEN[i]] = y[i] + c2 * y[10 + 2 * i] - s2 * y[11 + 2 * i]
    for i in range(len(blocks.ODD)):
        first = c1 * y[30 + 2 * i] - s1 * y[31 + 2 * i]
        out[blocks.ODD[i]] = first + c3 * y[42 + 2 * i] - s3 * y[43 + 2 * i]
    return out


@njit(cache=True, nogil=True)
def waves(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, ramp_rule: Any, rule: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Corrected R, F, G of plane waves at uniform phases of the whole period."""
    n = p.shape[0]
    R = np.empty((n, SAMPLES, 6, 6), dtype=p.dtype)
    F = np.empty((n, SAMPLES, 6), dtype=p.dtype)
    G = np.empty((n, SAMPLES), dtype=p.dtype)
    extra = np.zeros((n, 3), dtype=p.dtype)
    for d in range(n):
        y = mean.astype(p.dtype)
        predict(y, Z[d], N[d], nodes, tips, lengths, phasors, cut, alpha)
        R0, F0, G0 = wave_base(p[d], D[d], mu[d], ramp_rule, rule)
        scale = scales(R0, F0, G0)
        extra[d, 0] = D[d, 0]
        for j in range(HALF):
            now = beat(y, np.pi * j / HALF)
            r, f, g = blocks.decode_wave(now, R0[j], F0[j], G0[j], p[d, 8], scale)
            G[d, j] = G[d, j + HALF] = g
            for i in range(6):
                F[d, j, i] = f[i]
                F[d, j + HALF, i] = MIRROR_Q[i] * f[i]
                for m in range(6):
                    R[d, j, i, m] = r[i, m]
                    R[d, j + HALF, i, m] = MIRROR_Q[i] * MIRROR_Q[m] * r[i, m]
    return R, F, G, extra


@njit(cache=True, nogil=True)
def twists(R: Any, F: Any, free: Any) -> Any:
    """``V = -R^-1 F`` on the free degrees of freedom, of many designs and phases."""
    V = -F
    A = np.empty_like(R)
    A[:] = R
    for d in range(R.shape[0]):
        for j in range(R.shape[1]):
            solve(A[d, j], V[d, j], free)
    return V
