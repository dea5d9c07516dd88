"""Rules of quadrature."""

from __future__ import annotations

from functools import cache

import numpy as np


@cache
def gauss(nodes: float) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [0, 1]; none for an empty panel."""
    if nodes == 0:
        return np.empty(0), np.empty(0)
    xi, weight = np.polynomial.legendre.leggauss(int(nodes))
    return (xi + 1.0) / 2.0, weight / 2.0
