"""Compiled evaluation of a region calibration: corrected R, F_p, G of many designs, and twists."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region import positive_definite as blocks
from microswim.calibration.region.kriging import predict
from microswim.numerics.compiled import njit, prange
from microswim.numerics.cores import loop
from microswim.numerics.fourier import MIRROR_Q
from microswim.numerics.solve6 import solve

SAMPLES = 12  #: phases over a period of a plane wave
HALF = SAMPLES // 2
PHASES = tuple(np.pi * np.arange(HALF) / HALF)
BLOCK = 16  #: designs that share scratch arrays


@loop()
def helices(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, sizes: Any, ramp_rule: Any, xi: Any, weight: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Return the corrected R, F, G of rigid helices at phase 0, and the axial force on the body."""
    n = p.shape[0]
    R = np.empty((n, 1, 6, 6), dtype=p.dtype)
    F = np.empty((n, 1, 6), dtype=p.dtype)
    G = np.empty((n, 1), dtype=p.dtype)
    extra = np.empty((n, 3), dtype=p.dtype)
    for block in prange((n + BLOCK - 1) // BLOCK):
        y, work = np.empty(len(mean), dtype=p.dtype), np.empty((2, alpha.shape[1]), dtype=p.dtype)
        for d in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            predict(y, Z[d], N[d], nodes, tips, lengths, phasors, cut, alpha, mean, work)
            tail = shaded.table(p[d], sizes[d], ramp_rule, xi, weight)
            G0 = shaded.fill_base(R[d, 0], F[d, 0], p[d], D[d], tail, 0.0, 1.0)
            a = p[d, 8]
            extra[d, 0] = D[d, 0] * np.exp(y[10])
            extra[d, 1] = y[11] * mu[d] * a * a
            extra[d, 2] = y[12] * mu[d] * a * a
            for i in range(12):
                y[10 + i] = y[13 + i]
            G[d, 0] = blocks.decode_helix(y, R[d, 0], F[d, 0], G0, a, mu[d], D[d, 3])
    return R, F, G, extra


@njit(cache=True)
def scales(R0: Any, F0: Any, G0: Any) -> Any:
    """Return scales of F_s, F_q, T_r and G of a plane wave, from samples over half a period."""
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
def beat(y: Any, phase: float) -> Any:
    """Return corrections (16,) at a phase from the harmonics, packed as `region` fits them."""
    out = np.empty(16, dtype=y.dtype)
    c1, s1 = np.cos(phase), np.sin(phase)
    c2, s2, c3, s3 = np.cos(2 * phase), np.sin(2 * phase), np.cos(3 * phase), np.sin(3 * phase)
    for i in range(len(blocks.EVEN)):
        out[blocks.EVEN[i]] = y[i] + c2 * y[10 + 2 * i] - s2 * y[11 + 2 * i]
    for i in range(len(blocks.ODD)):
        first = c1 * y[30 + 2 * i] - s1 * y[31 + 2 * i]
        out[blocks.ODD[i]] = first + c3 * y[42 + 2 * i] - s3 * y[43 + 2 * i]
    return out


@loop()
def waves(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, sizes: Any, ramp_rule: Any, xi: Any, weight: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Return the corrected R, F, G of plane waves at uniform phases of the whole period."""
    n = p.shape[0]
    R = np.empty((n, SAMPLES, 6, 6), dtype=p.dtype)
    F = np.empty((n, SAMPLES, 6), dtype=p.dtype)
    G = np.empty((n, SAMPLES), dtype=p.dtype)
    extra = np.zeros((n, 3), dtype=p.dtype)
    for block in prange((n + BLOCK - 1) // BLOCK):
        y, work = np.empty(len(mean), dtype=p.dtype), np.empty((2, alpha.shape[1]), dtype=p.dtype)
        for d in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            predict(y, Z[d], N[d], nodes, tips, lengths, phasors, cut, alpha, mean, work)
            tail = shaded.table(p[d], sizes[d], ramp_rule, xi, weight)
            r, f, g = R[d, :HALF], F[d, :HALF], G[d, :HALF]
            for j in range(HALF):
                g[j] = shaded.fill_base(r[j], f[j], p[d], D[d], tail, PHASES[j], 0.0)
            scale = scales(r, f, g)
            extra[d, 0] = D[d, 0]
            for j in range(HALF):
                now = beat(y, PHASES[j])
                g[j] = blocks.decode_wave(now, r[j], f[j], g[j], p[d, 8], scale)
                G[d, j + HALF] = g[j]
                for i in range(6):
                    F[d, j + HALF, i] = MIRROR_Q[i] * f[j, i]
                    for k in range(6):
                        R[d, j + HALF, i, k] = MIRROR_Q[i] * MIRROR_Q[k] * r[j, i, k]
    return R, F, G, extra


@njit(cache=True, nogil=True)
def twists(R: Any, F: Any, free: Any) -> Any:
    """Return ``V = -R^-1 F`` on the free degrees of freedom, of many designs and phases."""
    V = -F
    A = np.empty_like(R)
    A[:] = R
    for d in range(R.shape[0]):
        for j in range(R.shape[1]):
            solve(A[d, j], V[d, j], free)
    return V
