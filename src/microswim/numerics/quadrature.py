"""Rules of quadrature on [0, 1]."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

#: Nodes of a panel where one rule would take too many: a rule of n nodes costs n^3 to make.
PANEL = 32


@lru_cache(512)
def gauss(nodes: float) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss-Legendre nodes and weights on [0, 1]; none for an empty panel."""
    if nodes == 0:
        return np.empty(0), np.empty(0)
    xi, weight = np.polynomial.legendre.leggauss(int(nodes))
    return (xi + 1.0) / 2.0, weight / 2.0


@lru_cache(64)
def panels(nodes: float) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss-Legendre with at least so many nodes: one rule up to two panels, else equal
    panels.

    A panel of 32 nodes converges like one long rule as long as the integrand needs more of them
    than that: at four waves a panel, or a singularity at 0.4 of its half width, to 1e-12.
    """
    if nodes <= 2 * PANEL:
        return gauss(nodes)
    count = int(np.ceil(nodes / PANEL))
    xi, weight = gauss(PANEL)
    return (np.arange(count)[:, None] + xi).ravel() / count, np.tile(weight / count, count)
