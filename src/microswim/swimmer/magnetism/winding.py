"""A round coil without a core by its measures: loops of wire spread over a winding, by magpylib.

The turns are spread evenly over the winding's length and thickness; the sum over them is a Gauss
quadrature over loops, whose error falls fast with the distance from the winding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.magnetism.applied_field import across, unit
from microswim.swimmer.magnetism.outside import gradient, magpylib

ALONG, THROUGH = 8, 4  #: loops over the length and the thickness


@dataclass(frozen=True)
class Winding:
    """A round coil at unit current.

    Parameters
    ----------
    name
        Its name in the file.
    position, axis
        Its centre (m), and the vector about which the current runs right-handed; lab frame.
    diameter
        Mean of the winding's inner and outer diameter (m).
    length, thickness
        Of the winding (m), along the axis and across it.
    turns
        Of the wire.
    """

    name: str
    position: tuple[float, float, float]
    axis: tuple[float, float, float]
    diameter: float
    length: float
    thickness: float
    turns: float

    @property
    def loops(self) -> list[tuple[float, float, Array]]:
        """Radius (m), turns and centre (3,) of each loop, the centre in the lab frame."""
        z, along = _nodes(ALONG if self.length else 1)
        x, through = _nodes(THROUGH if self.thickness else 1)
        centre, axis = np.array(self.position), unit(self.axis)
        return [
            (
                (self.diameter + self.thickness * x[j]) / 2.0,
                self.turns * along[i] * through[j],
                centre + self.length * z[i] / 2.0 * axis,
            )
            for i in range(len(z))
            for j in range(len(x))
        ]

    @cached_property
    def _loops(self) -> list[Any]:
        loop, axis = magpylib().current.Circle, unit(self.axis)
        return [
            loop(
                diameter=2.0 * radius,
                current=turns,
                position=(0.0, 0.0, (place - np.array(self.position)) @ axis),
            )
            for radius, turns, place in self.loops
        ]

    def _own(self, places: Array) -> Array:
        return np.reshape(magpylib().getB(self._loops, places, sumup=True), places.shape)

    @cached_property
    def _frame(self) -> Array:
        """Axes of the coil as columns, the last its own axis."""
        return np.stack([*across(self.axis), unit(self.axis)], axis=-1)

    def field(self, places: Any) -> Array:
        """Return B per ampere (..., 3)."""
        r = (np.asarray(places, float) - np.array(self.position)) @ self._frame
        return self._own(r.reshape(-1, 3)).reshape(r.shape) @ self._frame.T

    def gradient(self, places: Any) -> Array:
        """Return ``dB_i/dx_j`` per ampere (..., 3, 3); NaN within the winding."""
        r = (np.asarray(places, float) - np.array(self.position)) @ self._frame
        flat = r.reshape(-1, 3)
        J = gradient(self._own, flat, self._distance(flat)).reshape(*r.shape, 3)
        return self._frame @ J @ self._frame.T

    def both(self, places: Any) -> tuple[Array, Array]:
        """Return B (..., 3) and ``dB_i/dx_j`` (..., 3, 3) per ampere."""
        return self.field(places), self.gradient(places)

    def _distance(self, r: Array) -> Array:
        """Distance (n,) of places (n, 3) from the winding, negative within."""
        side = np.abs(np.hypot(r[:, 0], r[:, 1]) - self.diameter / 2.0) - self.thickness / 2.0
        end = np.abs(r[:, 2]) - self.length / 2.0
        outside = np.hypot(np.maximum(side, 0.0), np.maximum(end, 0.0))
        return np.where(outside > 0.0, outside, np.maximum(side, end))


def _nodes(n: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes on -1 to 1, weights that add up to one."""
    x, w = np.polynomial.legendre.leggauss(n)
    return x, w / 2.0
