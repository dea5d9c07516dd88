"""GMRES for several right-hand sides side by side, each with a Krylov space of its own.

    minimise |b - T Q y| over y, Q an orthonormal basis of b, T b, T^2 b, ...
                                                        [Saad & Schultz 1986]

The operator is applied to all columns at once, which is what makes it fast.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from microswim.numerics.array import Array


def gmres(
    apply: Callable[[Array], Array], b: Array, tolerance: float, most: int
) -> tuple[Array, int, float]:
    """Solve ``apply(x) = b`` for the columns of b (n, k).

    Returns
    -------
    tuple
        x (n, k), the steps taken, and the largest residual of a column relative to its b.
    """
    size = np.linalg.norm(b, axis=0)
    scale = np.where(size > 0, size, 1.0)
    basis = [b / scale]
    H = np.zeros((b.shape[1], most + 1, most))
    for m in range(most):
        w = apply(basis[m])
        for i, q in enumerate(basis):
            H[:, i, m] = np.einsum("nk,nk->k", q, w)
            w = w - q * H[:, i, m]
        length = np.linalg.norm(w, axis=0)
        H[:, m + 1, m] = length
        y, left = _least_squares(H[:, : m + 2, : m + 1])
        worst = float((left * (size > 0)).max(initial=0.0))
        if worst <= tolerance or m + 1 == most:
            break
        basis.append(np.divide(w, length, out=np.zeros_like(w), where=length > 1e-14))
    x = sum(q * y[:, i] for i, q in enumerate(basis))
    return np.asarray(x * size), m + 1, worst


def _least_squares(H: Array) -> tuple[Array, Array]:
    """Return y (k, m) that brings H y nearest to e_1, and how far each stays away."""
    Q, R = np.linalg.qr(H, mode="complete")
    m = H.shape[2]
    first, R = Q[:, 0, :], R[:, :m, :]
    diagonal = np.abs(np.einsum("kii->ki", R))
    tiny = diagonal <= 1e-14 * diagonal.max(axis=1, keepdims=True)
    R = R + np.einsum("ki,ij->kij", tiny * 1.0, np.eye(m))
    y = np.linalg.solve(R, np.where(tiny, 0.0, first[:, :m])[..., None])[..., 0]
    return y, np.abs(first[:, m])
