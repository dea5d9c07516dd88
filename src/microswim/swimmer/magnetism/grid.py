"""A magnetic field known on a grid, from finite elements or a Gauss meter, between its points.

What is between is free of sources to rounding. The flux of B_x through all faces ``x = x_i`` up to
the node (y_j, z_k) is G_x there; with tensor splines I through the nodes

    B_x = d2/dydz I[G_x]      B_y = d2/dzdx I[G_y]      B_z = d2/dxdy I[G_z]
    div B = d3/dxdydz I[G_x + G_y + G_z] = 0

where the fluxes out of every cell of the grid add up to zero: then the sum is a sum of functions of
two coordinates each. Fluxes come from splines through the B given; what they lack of zero is taken
away by the smallest change of B through the faces (a projection). Splines are of degree 5, or 3
where an axis has fewer than 6 points: B is right to order 5 or 3 in the spacing, its gradient one
order less.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.numerics.array import Array, read_only

LEAST = 4  #: points along each axis


@read_only
@dataclass(frozen=True, eq=False)
class GridCoil:
    """Field of a coil at unit current, or of any source, by its values on a grid.

    Parameters
    ----------
    name
        Of the coil.
    x, y, z
        Coordinates of the grid's planes, increasing, at least four each (m).
    values
        B at the nodes (nx, ny, nz, 3), T.
    """

    name: str
    x: Array
    y: Array
    z: Array
    values: Array

    @property
    def axes(self) -> tuple[Array, Array, Array]:
        """The three axes."""
        return self.x, self.y, self.z

    @property
    def degree(self) -> int:
        """Degree of the splines."""
        return 5 if min(map(len, self.axes)) >= 6 else 3

    @cached_property
    def _fluxes(self) -> tuple[list[Array], float]:
        """G at the nodes for each component, and the change that made it free of sources."""
        whole = [_integral(axis, self.degree) for axis in self.axes]
        width = [np.diff(axis) for axis in self.axes]
        faces = []
        for i in range(3):
            G = self.values[..., i]
            for j in _others(i):
                G = _along(whole[j], G, j)
            for j in _others(i):
                G = np.diff(G, axis=j) / _shaped(width[j], j)
            faces.append(G)  # B through each face
        change = _projection(faces, width)
        size = np.sqrt(np.mean([np.mean(f**2) for f in faces])) or 1.0
        off = float(np.sqrt(np.mean([np.mean(c**2) for c in change])) / size)
        nodes = []
        for i, (face, less) in enumerate(zip(faces, change)):
            G = face - less
            for j in _others(i):
                G = np.cumsum(G * _shaped(width[j], j), axis=j)
                G = np.concatenate([np.zeros_like(np.take(G, [0], axis=j)), G], axis=j)
            nodes.append(G)
        return nodes, off

    @property
    def mended(self) -> float:
        """How far B as given was from a field without sources, relative to B (rms)."""
        return self._fluxes[1]

    @cached_property
    def splines(self) -> tuple[tuple[Array, Array, Array], list[Array]]:
        """Knots of the three axes, and coefficients (nx, ny, nz) of the three G."""
        from scipy.interpolate import make_interp_spline  # nobody waits for it without a grid

        k, made = self.degree, []
        for nodes in self._fluxes[0]:
            for j, axis in enumerate(self.axes):
                c = make_interp_spline(axis, np.moveaxis(nodes, j, 0), k).c
                nodes = np.moveaxis(c, 0, j)
            made.append(np.ascontiguousarray(nodes))
        knots = tuple(make_interp_spline(axis, axis, k).t for axis in self.axes)
        return knots, made  # type: ignore[return-value]

    def field(self, places: Any) -> Array:
        """Return B per ampere (..., 3).

        Raises
        ------
        MicroswimError
            If a place lies outside the grid.
        """
        return np.stack([self._derived(places, i, _ACROSS[i]) for i in range(3)], axis=-1)

    def gradient(self, places: Any) -> Array:
        """Return ``dB_i/dx_j`` per ampere (..., 3, 3).

        Raises
        ------
        MicroswimError
            If a place lies outside the grid.
        """
        rows = [
            [self._derived(places, i, _ACROSS[i] + np.eye(3, dtype=int)[j]) for j in range(3)]
            for i in range(3)
        ]
        return np.moveaxis(np.array(rows), (0, 1), (-2, -1))

    def both(self, places: Any) -> tuple[Array, Array]:
        """Return B (..., 3) and ``dB_i/dx_j`` (..., 3, 3) per ampere."""
        return self.field(places), self.gradient(places)

    def _derived(self, places: Any, which: int, orders: Array) -> Array:
        from scipy.interpolate import NdBSpline

        at = np.asarray(places, float)
        for name, axis, c in zip("xyz", self.axes, np.moveaxis(at, -1, 0)):
            if not (np.min(c) >= axis[0] and np.max(c) <= axis[-1]):
                out = np.min(c) if np.min(c) < axis[0] else np.max(c)
                raise MicroswimError(
                    f"the place {name} = {out:.4g} m lies outside the grid of B, which goes from "
                    f"{axis[0]:.4g} to {axis[-1]:.4g} m; give a larger grid or stay in it"
                )
        knots, made = self.splines
        return NdBSpline(knots, made[which], self.degree)(at, nu=tuple(map(int, orders)))


#: Orders of the derivatives of G that are B.
_ACROSS = np.array([[0, 1, 1], [1, 0, 1], [1, 1, 0]])


def _others(i: int) -> tuple[int, int]:
    return (i + 1) % 3, (i + 2) % 3


def _shaped(width: Array, axis: int) -> Array:
    """The widths of cells, to be multiplied with an array along an axis."""
    return width.reshape([-1 if j == axis else 1 for j in range(3)])


def _along(matrix: Array, values: Array, axis: int) -> Array:
    return np.moveaxis(np.tensordot(matrix, values, (1, axis)), 0, axis)


def _integral(axis: Array, degree: int) -> Array:
    """Matrix (n, n) of the integral from the first node to each, of the spline through values."""
    from scipy.interpolate import make_interp_spline

    return make_interp_spline(axis, np.eye(len(axis)), degree).antiderivative()(axis)


def _projection(faces: list[Array], width: list[Array]) -> list[Array]:
    """Return the smallest part of B through the faces without which no cell has a source.

    ``b = D' psi`` with ``D D' psi = D faces``, D the divergence; D D' is a sum over the axes, so
    the eigenvectors of each axis solve it.
    """
    D = [(np.eye(len(h), len(h) + 1, 1) - np.eye(len(h), len(h) + 1)) / h[:, None] for h in width]
    source: Any = sum(_along(D[i], faces[i], i) for i in range(3))
    values, vectors = zip(*(np.linalg.eigh(d @ d.T) for d in D))
    for i in range(3):
        source = _along(vectors[i].T, source, i)
    source = source / sum(_shaped(v, i) for i, v in enumerate(values))
    for i in range(3):
        source = _along(vectors[i], source, i)
    return [_along(D[i].T, source, i) for i in range(3)]
