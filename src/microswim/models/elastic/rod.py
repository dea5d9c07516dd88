"""A rod of length 1 that cannot stretch, by the Legendre series of its curvature.

With the tangent angle ``theta(s) = theta_0 + sum_k q_k Phi_k(s)``, ``Phi_k' = p_k`` orthonormal
Legendre polynomials on [0, 1], the bending energy of stiffness 1 is ``sum q_k^2 / 2``; that the
length stays holds by itself, and a free end needs no condition. A base that can turn has one
coordinate more, ``Phi = 1``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from microswim.numerics.quadrature import gauss


@dataclass(frozen=True, eq=False)
class Rod:
    """Nodes and shapes of a rod; the last node is its free end, with no weight.

    Parameters
    ----------
    s
        Gauss-Legendre nodes on [0, 1], then 1; shape (m,).
    weight
        Of each node, shape (m,).
    along
        Integration from 0 to each node, shape (m, m).
    shapes
        ``Phi_k`` at the nodes, shape (m, n).
    curvatures
        ``p_k`` at the nodes, shape (m, n).
    stiffness
        Of each coordinate, shape (n,): 1 for bending, the base's own for its turning.
    """

    s: np.ndarray
    weight: np.ndarray
    along: np.ndarray
    shapes: np.ndarray
    curvatures: np.ndarray
    stiffness: np.ndarray

    @property
    def end(self) -> np.ndarray:
        """1 at the free end, 0 at the other nodes, (m,)."""
        return np.where(self.s == 1.0, 1.0, 0.0)

    @property
    def count(self) -> int:
        """Number of coordinates n."""
        return len(self.stiffness)


@lru_cache(64)
def rod(modes: int, base: float | None = None) -> Rod:
    """Return a rod of so many curvatures.

    Parameters
    ----------
    modes
        Legendre polynomials of the curvature.
    base
        Stiffness of the base's turning, torque per angle; 0 for a hinge, None for a clamp.
    """
    x, w = gauss(2 * modes + 8)
    m = len(x)
    degree = np.sqrt(2.0 * np.arange(m) + 1.0)
    values = legendre.legvander(2.0 * x - 1.0, m - 1) * degree
    along = np.zeros((m + 1, m + 1))
    along[:m, :m] = integrals(x, m) * degree @ (values.T * w)
    along[m, :m] = w
    s = np.append(x, 1.0)
    shapes = integrals(s, modes) * degree[:modes]
    curvatures = legendre.legvander(2.0 * s - 1.0, modes - 1) * degree[:modes]
    stiffness = np.ones(modes)
    if base is not None:
        shapes = np.column_stack([np.ones(m + 1), shapes])
        curvatures = np.column_stack([np.zeros(m + 1), curvatures])
        stiffness = np.append(base, stiffness)
    return Rod(s, np.append(w, 0.0), along, shapes, curvatures, stiffness)


def integrals(s: np.ndarray, count: int) -> np.ndarray:
    """Return ``int_0^s P_k(2 x - 1) dx = (P_{k+1} - P_{k-1}) / (2 (2 k + 1))``, and ``s`` for k =
    0.
    """
    P = legendre.legvander(2.0 * s - 1.0, count)
    out = np.empty((len(s), count))
    out[:, 0] = s
    k = np.arange(1, count)
    out[:, 1:] = (P[:, 2:] - P[:, :-2]) / (2.0 * (2.0 * k + 1.0))
    return out
