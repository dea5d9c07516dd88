"""Axial multipoles: the field of a coil as its calibration has it.

    B = -grad Phi        Phi = sum_n (A_n r^n + B_n r^(-n-1)) P_n(cos(theta))

r from the source's place, theta from its direction d [Petruska et al. 2017]. The solid harmonics
``R_n = r^n P_n`` are polynomials in ``z = r . d`` and r^2, by

    (n + 1) R_{n+1} = (2 n + 1) z R_n - n r^2 R_{n-1}

and their gradients and second derivatives by the same recurrence, differentiated; the outer ones
are ``R_n / r^(2n+1)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.numerics.array import Array

Solid = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Source:
    """Multipoles at a place.

    Parameters
    ----------
    inner, outer
        A_n and B_n for n = 1, 2, ... (SI, per ampere).
    position, direction
        Place (m) and unit vector of the axis.
    """

    inner: tuple[float, ...]
    outer: tuple[float, ...]
    position: tuple[float, float, float]
    direction: tuple[float, float, float]

    def derivatives(self, places: Any) -> tuple[Array, Array]:
        """Return gradient (..., 3) and second derivatives (..., 3, 3) of Phi."""
        r = np.asarray(places, float) - np.array(self.position)
        slope, bend = np.zeros(r.shape), np.zeros((*r.shape, 3))
        most = max(len(self.inner), len(self.outer))
        for n, solid in enumerate(solids(r, np.array(self.direction), most), start=1):
            if n <= len(self.inner):
                slope += self.inner[n - 1] * solid[1]
                bend += self.inner[n - 1] * solid[2]
            if n <= len(self.outer):
                far = outward(r, solid, 2 * n + 1)
                slope += self.outer[n - 1] * far[1]
                bend += self.outer[n - 1] * far[2]
        return slope, bend


@dataclass(frozen=True)
class Coil:
    """A coil at unit current.

    Parameters
    ----------
    name
        Its name in the calibration.
    sources
        Its multipoles.
    """

    name: str
    sources: tuple[Source, ...]

    def both(self, places: Any) -> tuple[Array, Array]:
        """Return B (..., 3) and ``dB_i/dx_j`` (..., 3, 3) per ampere."""
        slopes, bends = zip(*(s.derivatives(places) for s in self.sources))
        return -np.sum(slopes, axis=0), -np.sum(bends, axis=0)

    def field(self, places: Any) -> Array:
        """Return B per ampere (..., 3)."""
        return self.both(places)[0]

    def gradient(self, places: Any) -> Array:
        """Return ``dB_i/dx_j`` per ampere (..., 3, 3)."""
        return self.both(places)[1]


def solids(r: Array, d: Array, most: int) -> list[Solid]:
    """Return value, gradient and second derivatives of R_n for n = 1 to `most`."""
    z, square = r @ d, np.sum(r * r, axis=-1)
    one = np.eye(3)
    before: Solid = (np.ones_like(z), np.zeros(r.shape), np.zeros((*r.shape, 3)))
    here: Solid = (z, np.broadcast_to(d, r.shape), np.zeros((*r.shape, 3)))
    found = [here]
    for n in range(1, most):
        (a, da, dda), (b, db, ddb) = here, before
        value = (2 * n + 1) * z * a - n * square * b
        zda = d * a[..., None] + z[..., None] * da
        sdb = 2.0 * r * b[..., None] + square[..., None] * db
        slope = (2 * n + 1) * zda - n * sdb
        mixed = d[:, None] * da[..., None, :]
        zdda = mixed + np.swapaxes(mixed, -1, -2) + z[..., None, None] * dda
        cross = 2.0 * r[..., :, None] * db[..., None, :]
        sddb = 2.0 * one * b[..., None, None] + cross + np.swapaxes(cross, -1, -2)
        sddb = sddb + square[..., None, None] * ddb
        bend = (2 * n + 1) * zdda - n * sddb
        before, here = here, (value / (n + 1), slope / (n + 1), bend / (n + 1))
        found.append(here)
    return found


def outward(r: Array, solid: Solid, power: int) -> Solid:
    """Return value, gradient and second derivatives of ``R / r^power``."""
    value, slope, bend = solid
    square = np.sum(r * r, axis=-1)
    f = square ** (-power / 2.0)
    df = -power * r * (f / square)[..., None]
    pair = r[..., :, None] * r[..., None, :] / square[..., None, None]
    ddf = -power * (f / square)[..., None, None] * (np.eye(3) - (power + 2) * pair)
    mixed = slope[..., :, None] * df[..., None, :]
    both = f[..., None, None] * bend + mixed + np.swapaxes(mixed, -1, -2)
    return (
        value * f,
        f[..., None] * slope + value[..., None] * df,
        both + value[..., None, None] * ddf,
    )
