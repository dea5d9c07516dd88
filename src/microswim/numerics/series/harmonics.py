"""Functions of several phases as sums of harmonics, fitted to values at scattered phases.

    f(phi) ~ c_0 + sum_h (a_h cos h.phi + b_h sin h.phi),    |h_1| + ... + |h_n| <= d

The phases are those of an additive sequence, which fills the torus evenly from its first on: more
of them only add to what was there.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from microswim.numerics.array import Array


def phases(count: int, n: int, start: int = 0) -> Array:
    """Return phases (count, n) of the sequence, from number `start` on.

    phi_k = 2 pi (1/2 + k (1/g, 1/g^2, ...)),  g^(n+1) = g + 1        [Roberts 2018]
    """
    g = 2.0
    for _ in range(64):
        g = (1.0 + g) ** (1.0 / (n + 1))
    steps = g ** -np.arange(1.0, n + 1.0)
    return 2.0 * np.pi * ((0.5 + np.arange(start, start + count)[:, None] * steps) % 1.0)


def harmonics(n: int, degree: int) -> Array:
    """Return the harmonics h (m, n) up to a degree, one of each pair h and -h, without zero."""
    sides = product(range(-degree, degree + 1), repeat=n)
    return np.array([h for h in sides if sum(map(abs, h)) <= degree and h > (0,) * n])


@dataclass(frozen=True, eq=False)
class Harmonics:
    """A sum of harmonics with values in (k,).

    Parameters
    ----------
    orders : (m, n)
        h.
    coefficients : (1 + 2 m, k)
        c_0, then all a, then all b.
    """

    orders: Array
    coefficients: Array

    def at(self, phase: Array) -> Array:
        """Return the values (k,) at phases (n,)."""
        angle = self.orders @ phase
        c, m = self.coefficients, len(angle)
        found: Array = c[0] + np.cos(angle) @ c[1 : m + 1] + np.sin(angle) @ c[m + 1 :]
        return found


def fitted(where: Array, values: Array, degree: int) -> Harmonics:
    """Return the sum up to a degree that meets values (m, k) at phases (m, n) best."""
    h = harmonics(where.shape[1], degree)
    angle = where @ h.T
    terms = np.concatenate([np.ones((len(where), 1)), np.cos(angle), np.sin(angle)], axis=1)
    best: Array = np.linalg.lstsq(terms, values, rcond=None)[0].astype(float)
    return Harmonics(h, best)
