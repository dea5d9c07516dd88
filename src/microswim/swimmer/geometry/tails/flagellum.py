"""A wave of the tangent angle about a bent axis: how a flagellum with a mean curvature beats.

With s along the filament, which keeps its length, and the wave's amplitude and ramp as of the
straight wave ``q = b(s) cos(ks - phase)``, whose slope it takes for its angle [Friedrich et al.
2010, Eq. 1],

    psi = K s - k b(s) sin(ks - phase),   P = int_0^s (cos psi, sin psi) ds'

so that K is the mean curvature, and the tail leaves the joint along s if it has a ramp.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre


@dataclass(frozen=True, eq=False)
class Flagellum:
    """Shape of a tail by its tangent angle.

    Parameters
    ----------
    curvature, wavenumber
        K and k (1/length), along the filament.
    length
        Of the filament.
    envelope
        Amplitude b(s) (length).
    ramp
        s where the ramp ends, and b has a kink.
    """

    curvature: Any
    wavenumber: Any
    length: Any
    envelope: Callable[[Any], Any]
    ramp: Any

    def angle(self, s: Any, phase: Any) -> tuple[Any, Any]:
        """Return psi and its derivative in phase."""
        size, x = self.wavenumber * self.envelope(s), self.wavenumber * s - phase
        return self.curvature * s - size * np.sin(x), size * np.cos(x)

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position, derivative along s and in phase, each broadcast(s, phase) + (3,)."""
        s, phase = np.asarray(s), np.asarray(phase)
        points, column = np.unique(s, return_inverse=True)
        phases, row = np.unique(phase, return_inverse=True)
        place = np.broadcast_arrays(row.reshape(phase.shape), column.reshape(s.shape))
        P, P_phase = self._integrals(points, phases)
        psi = self.angle(points, phases[:, None])[0]
        return P[*place], _vector(np.cos(psi), np.sin(psi))[*place], P_phase[*place]

    def _integrals(self, s: np.ndarray, phase: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Integrals of the tangent and of its derivative in phase from the joint, (m, n, 3): by
        Legendre series on both sides of the ramp's end.
        """
        found: Any = 0.0
        ends = [0.0, *(x for x in (self.ramp,) if 0.0 < np.real(x) < np.real(self.length))]
        for a, b in zip(ends, [*ends[1:], self.length]):
            x, to_series = _legendre(self._terms(b - a))
            half = 0.5 * (b - a)
            psi, turn = self.angle(a + half * (1.0 + x), phase[:, None])
            c, d = np.cos(psi), np.sin(psi)
            series = np.stack([c, d, -turn * d, turn * c]) @ to_series
            y = (s - a) / half - 1.0
            y = np.where(np.real(y) > 1.0, 1.0, np.where(np.real(y) < -1.0, -1.0, y))
            found = found + half * (series @ _integrated(y, len(x)).T)
        return _vector(*found[:2]), _vector(*found[2:])

    def _terms(self, length: Any) -> int:
        """Terms that resolve the tangent over a length: by how far its angle turns there."""
        steep = 1.0 + np.abs(self.wavenumber * self.envelope(self.length))
        turned = np.abs(self.wavenumber * length) * steep + np.abs(self.curvature * length)
        return 20 + 8 * int(np.ceil(float(np.max(np.real(turned))) / 5.0))

    @property
    def alpha(self) -> Any:
        """Mean of the cosine of the angle to the bent axis: of apparent over actual length."""
        s = self.length * ((np.arange(64) + 0.5) / 64)[:, None]
        psi = self.angle(s, 2.0 * np.pi * np.arange(32) / 32)[0]
        return np.mean(np.cos(psi - self.curvature * s))


@cache
def _legendre(terms: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss nodes, and the matrix that takes values there to Legendre coefficients."""
    x, w = legendre.leggauss(terms)
    whole = w[:, None] * legendre.legvander(x, terms - 1) * (np.arange(terms) + 0.5)
    return x, whole


def _integrated(y: np.ndarray, terms: int) -> np.ndarray:
    """Integrals from -1 to y of Legendre's ``P_k``: ``(P_k+1 - P_k-1) / (2 k + 1)``, (n, terms)."""
    P = legendre.legvander(y, terms)
    inner = (P[:, 2:] - P[:, :-2]) / (2.0 * np.arange(1, terms) + 1.0)
    return np.concatenate([(y + 1.0)[:, None], inner], axis=1)


def _vector(s: Any, q: Any) -> np.ndarray:
    return np.stack([s, q, 0 * s], axis=-1)
