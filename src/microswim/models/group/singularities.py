"""The flow of many point singularities at one another: forces, dipoles, near ones' quadrupoles.

    8 pi mu u_i = G_ij F_j - D_jk d_k G_ij + 1/2 Q_jkl d_k d_l G_ij      [Kim Karrila 1991]
    G_ij = delta_ij phi - x_i d_j phi,  phi = 1/r

From some thousands on forces and dipoles are summed by FMM3D's Stokes kernels, whose work grows
like their number [Greengard Rokhlin 1987]; fewer, or without it, pair by pair.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import njit

#: Singularities from which on the fast sum is the faster one, and its precision.
MANY, PRECISION = 3000, 1e-3


def flow(X: Array, F: Array, D: Array, viscosity: float) -> tuple[Array, Array]:
    """Return the velocity (n, 3) and its gradient (n, 3, 3) at each place by all others.

    Parameters
    ----------
    X
        Places (n, 3).
    F, D
        Forces (n, 3) and dipoles (n, 3, 3), ``D[j, k] = f_j x_k``.
    viscosity
        Of the fluid.

    Returns
    -------
    tuple
        u_i, and d_k u_i as ``[:, i, k]``.
    """
    fast = _fast_sum() if len(X) >= MANY else None
    if fast is not None:
        return _by_fmm(fast, X, F, D, viscosity)
    every = np.stack(np.triu_indices(len(X), 1), axis=1)
    return flow_of_pairs(X, F, D, every, np.ones(len(every)), viscosity)


def flow_of_pairs(
    X: Array, F: Array, D: Array, pairs: np.ndarray, weight: Array, viscosity: float
) -> tuple[Array, Array]:
    """Return the same by some pairs (m, 2) alone, both ways, each times its weight (m,)."""
    u, g = np.zeros((len(X), 3)), np.zeros((len(X), 3, 3))
    near_dipoles(*map(np.ascontiguousarray, (X, F, D, pairs, weight)), u, g)
    return u / (8.0 * np.pi * viscosity), g / (8.0 * np.pi * viscosity)


def flow_of_quadrupoles(
    X: Array, Q: Array, pairs: np.ndarray, weight: Array, viscosity: float
) -> tuple[Array, Array]:
    """Return the same of quadrupoles (n, 3, 3, 3), ``Q[j, k, l] = f_j x_k x_l``."""
    u, g = np.zeros((len(X), 3)), np.zeros((len(X), 3, 3))
    near_quadrupoles(*map(np.ascontiguousarray, (X, Q, pairs, weight)), u, g)
    return u / (8.0 * np.pi * viscosity), g / (8.0 * np.pi * viscosity)


def _fast_sum() -> Any:
    """Return FMM3D's Stokes sum, None where it is not installed."""
    try:
        from fmm3dpy import stfmm3d
    except ImportError:
        return None
    return stfmm3d


def _by_fmm(fast: Any, X: Array, F: Array, D: Array, viscosity: float) -> tuple[Array, Array]:
    """Sum by FMM3D: its kernel is G/(8 pi), its doublet of s and v twice ``-s_j v_k d_k G_ij``."""
    strength, direction = _doublets(D)
    n, many = len(X), len(strength)
    force = np.zeros((many, 3, n))
    force[0] = F.T
    found = fast(
        eps=PRECISION,
        sources=np.asfortranarray(X.T),
        stoklet=np.asfortranarray(force.squeeze(0) if many == 1 else force),
        doublet=np.asfortranarray(strength.squeeze(0) if many == 1 else strength),
        doubvec=np.asfortranarray(direction.squeeze(0) if many == 1 else direction),
        ifppreg=3,
        nd=many,
    )
    u = found.pot.reshape(many, 3, n).sum(axis=0)
    g = found.grad.reshape(many, 3, 3, n).sum(axis=0)  # [k, i, n]
    return u.T / viscosity, g.transpose(2, 1, 0) / viscosity


def _doublets(D: Array) -> tuple[Array, Array]:
    """Return strengths and directions (m, 3, n) of so few doublets as make dipoles (n, 3, 3).

    ``D - c I`` drives the same flow, G being free of divergence; with the middle principal value
    for c that of a swimmer which is the same from all sides is one doublet.
    """
    middle = np.linalg.eigvalsh(0.5 * (D + D.transpose(0, 2, 1)))[:, 1]
    left, size, right = np.linalg.svd(D - middle[:, None, None] * np.eye(3))
    many = max(1, int(np.count_nonzero((size > 1e-9 * size.max()).any(axis=0))))
    strength = 0.5 * (left * size[:, None, :]).transpose(2, 1, 0)[:many]
    return strength, right.transpose(1, 2, 0)[:many]


@njit(cache=True, fastmath=True)
def near_dipoles(X, F, D, pairs, weight, u, g):
    """Add 8 pi mu times the flow of forces and dipoles between pairs (m, 2), both ways.

    g[:, i, k] = d_k u_i. With q = x.D.x, v = (D + D') x and w = (D - D') x the dipole's flow is
    ``u = w/r^3 + x (3 q/r^5 - tr D/r^3)``.
    """
    x, v, w = np.empty(3), np.empty(3), np.empty(3)
    for m in range(2 * len(pairs)):
        a, b, share = pairs[m // 2, m % 2], pairs[m // 2, 1 - m % 2], weight[m // 2]
        for i in range(3):
            x[i] = X[a, i] - X[b, i]
        i2 = 1.0 / (x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        i1 = np.sqrt(i2)
        i3 = i1 * i2
        i5 = i3 * i2
        q, trace, along = 0.0, 0.0, 0.0
        for i in range(3):
            up, down = 0.0, 0.0
            for k in range(3):
                up += D[b, i, k] * x[k]
                down += D[b, k, i] * x[k]
            v[i], w[i] = up + down, up - down
            q += x[i] * up
            trace += D[b, i, i]
            along += x[i] * F[b, i]
        size = 3.0 * q * i5 - trace * i3 + along * i3
        for i in range(3):
            u[a, i] += share * (F[b, i] * i1 + w[i] * i3 + x[i] * size)
            g[a, i, i] += share * size
            for k in range(3):
                slope = 3.0 * v[k] * i5 - 15.0 * q * x[k] * i5 * i2 + 3.0 * trace * x[k] * i5
                slope += F[b, k] * i3 - 3.0 * along * x[k] * i5
                turning = (D[b, i, k] - D[b, k, i]) * i3 - 3.0 * w[i] * x[k] * i5
                g[a, i, k] += share * (turning + x[i] * slope - F[b, i] * x[k] * i3)


@njit(cache=True, fastmath=True)
def near_quadrupoles(X, Q, pairs, weight, u, g):
    """Add 8 pi mu times the flow of quadrupoles between pairs (m, 2), both ways.

    u_i = Q_ikl phi_kl/2 - Q_jil phi_jl - x_i Q_jkl phi_jkl/2
    """
    x, two, three = np.empty(3), np.empty((3, 3)), np.empty((3, 3, 3))
    for m in range(2 * len(pairs)):
        a, b, share = pairs[m // 2, m % 2], pairs[m // 2, 1 - m % 2], weight[m // 2]
        for i in range(3):
            x[i] = X[a, i] - X[b, i]
        i2 = 1.0 / (x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        i3 = i2 * np.sqrt(i2)
        i5, i7, i9 = i3 * i2, i3 * i2 * i2, i3 * i2 * i2 * i2
        for j in range(3):
            for k in range(3):
                same = 1.0 if j == k else 0.0
                two[j, k] = 3.0 * x[j] * x[k] * i5 - same * i3
                for l in range(3):
                    mixed = same * x[l]
                    mixed += x[k] if j == l else 0.0
                    mixed += x[j] if k == l else 0.0
                    three[j, k, l] = 3.0 * mixed * i5 - 15.0 * x[j] * x[k] * x[l] * i7
        whole = 0.0
        for j in range(3):
            for k in range(3):
                for l in range(3):
                    whole += 0.5 * share * Q[b, j, k, l] * three[j, k, l]
        for i in range(3):
            u[a, i] -= x[i] * whole
            g[a, i, i] -= whole
            for k in range(3):
                for l in range(3):
                    own = share * (0.5 * Q[b, i, k, l] - Q[b, k, i, l])
                    u[a, i] += own * two[k, l]
                    for p in range(3):
                        g[a, i, p] += own * three[k, l, p]
        for p in range(3):
            slope = 0.0  # Q_jkl phi_jklp / 2
            for j in range(3):
                for k in range(3):
                    for l in range(3):
                        fourth = 105.0 * x[j] * x[k] * x[l] * x[p] * i9
                        if j == k:
                            fourth += 3.0 * i5 if l == p else 0.0
                            fourth -= 15.0 * x[l] * x[p] * i7
                        if j == l:
                            fourth += 3.0 * i5 if k == p else 0.0
                            fourth -= 15.0 * x[k] * x[p] * i7
                        if j == p:
                            fourth += 3.0 * i5 if k == l else 0.0
                            fourth -= 15.0 * x[k] * x[l] * i7
                        if k == l:
                            fourth -= 15.0 * x[j] * x[p] * i7
                        if k == p:
                            fourth -= 15.0 * x[j] * x[l] * i7
                        if l == p:
                            fourth -= 15.0 * x[j] * x[k] * i7
                        slope += 0.5 * share * Q[b, j, k, l] * fourth
            for i in range(3):
                g[a, i, p] -= x[i] * slope
