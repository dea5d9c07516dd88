"""Compiled evaluation of a region calibration: corrected R, F_p, G of many designs, and twists."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region import positive_definite as blocks
from microswim.calibration.region.beats import HALF, OTHER_HAND, PHASES, SAMPLES, beat, scales
from microswim.calibration.region.surfaces import Surfaces, predict, scratch
from microswim.numerics.array import lent
from microswim.numerics.compiling.compiled import njit, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.series.fourier import MIRROR_Q, MIRROR_R
from microswim.numerics.solve6 import solve
from microswim.swimmer.swimmer import Swimmer

BOTH = np.outer(MIRROR_R, MIRROR_R)
BLOCK = 16  #: designs that share scratch arrays


@njit(cache=True, nogil=True)
def corrections(
    Z: Any, N: Any, size: Any, nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any,
    alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Return the corrections (d, columns) of the designs of a block, to their size."""
    y = np.empty((len(Z), len(mean)), dtype=Z.dtype)
    predict(y, Z, N, nodes, tips, lengths, phasors, cut, alpha, mean, scratch(Z, nodes))
    for d in range(len(y)):
        for i in range(len(mean)):
            y[d, i] *= size[d, i]
    return y


@loop()
def helices(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, size: Any, sizes: Any, ramp_rule: Any, xi: Any,
    weight: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Return the corrected R, F, G of rigid helices at phase 0, and the axial force on the body."""
    n = p.shape[0]
    R = np.empty((n, 1, 6, 6), dtype=p.dtype)
    F = np.empty((n, 1, 6), dtype=p.dtype)
    G = np.empty((n, 1), dtype=p.dtype)
    extra = np.empty((n, 3), dtype=p.dtype)
    for block in prange((n + BLOCK - 1) // BLOCK):
        first, last = block * BLOCK, min(n, (block + 1) * BLOCK)
        here = Z[first:last], N[first:last], size[first:last]
        every = corrections(*here, nodes, tips, lengths, phasors, cut, alpha, mean)
        for d in range(first, last):
            y = every[d - first]
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


@loop()
def waves(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, size: Any, sizes: Any, ramp_rule: Any, xi: Any,
    weight: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Return the corrected R, F, G of plane waves at uniform phases of the whole period."""
    n = p.shape[0]
    R = np.empty((n, SAMPLES, 6, 6), dtype=p.dtype)
    F = np.empty((n, SAMPLES, 6), dtype=p.dtype)
    G = np.empty((n, SAMPLES), dtype=p.dtype)
    extra = np.zeros((n, 3), dtype=p.dtype)
    for block in prange((n + BLOCK - 1) // BLOCK):
        first, last = block * BLOCK, min(n, (block + 1) * BLOCK)
        here = Z[first:last], N[first:last], size[first:last]
        every = corrections(*here, nodes, tips, lengths, phasors, cut, alpha, mean)
        for d in range(first, last):
            y = every[d - first]
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


def matrices(many: Swimmer, Z: Any, N: Any, surfaces: Surfaces, size: Any = None) -> tuple:
    """Return R (n, m, 6, 6), F (n, m, 6), G (n, m) over the phases, and the body's share (n, 3).

    Parameters
    ----------
    many
        The designs, arrays of shape (n,) where they differ.
    Z, N
        Scaled features (n, f) and numbers of waves (n,).
    surfaces
        What predicts the corrections.
    size
        By what each correction is multiplied, (n, columns); one by default.
    """
    n = len(Z)
    mu = many.fluid.viscosity
    p, D = shaded.parameters(many), shaded.side_by_side(many.body.diagonal(mu))
    *packed, mean = surfaces.packed
    size = 1.0 if size is None else size
    kind = np.result_type(Z, p, D, mu, size, np.float64)
    arrays, shapes = [], ((11,), (6,), (), Z.shape[1:], (), mean.shape)
    for values, shape in zip((p, D, mu, Z, N, size), shapes):
        each = np.empty((n, *shape), dtype=kind)
        each[...] = values
        arrays.append(lent(each))
    turn = shaded.hand(many) > 0
    run = (helices if turn else waves).over(n)
    sizes = shaded.sizes(N)
    R, F, G, extra = run(*arrays, sizes, *shaded.rules(int(sizes.max())), *packed, mean)
    if turn and many.tail.sign < 0:
        R, F, extra = R * BOTH, F * MIRROR_R, extra * OTHER_HAND
    return R, F, G, extra
