"""A surface of triangles about the root of a tail: heights over a plane there.

The faces that hang together smoothly with the one at the root, and face its way, are a sheet

    X(x, y) = O + x e_1 + y e_2 + h(x, y) N,

N the mean normal there, h from the curved patches through the faces. A direction at the angle t
from N is mapped to the plane distance L t from the root.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np

from microswim.errors import SpecError, measured
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.facets import Facet, Opening
from microswim.swimmer.geometry.solids.paired import eight_shapes, patches
from microswim.swimmer.geometry.solids.triangles import Indices, Triangles

#: Cosine of the angle by which a sheet may turn away from its plane.
LEAN = 0.3
#: Half widths of the tail over which the plane's normal is the mean of the faces'.
AROUND = 2.0
#: Samples along a side of a patch; the nearest few start Newton's method; steps of it.
SIDE, STARTS, STEPS = 5, 6, 7


@dataclass(frozen=True, eq=False)
class Sheet:
    """A part of a surface as heights over a plane.

    Parameters
    ----------
    origin
        Of the plane (3,).
    axes
        Its normal and two directions in it, orthonormal (3, 3).
    points
        Corners and middles of the sides of the curved patches (k, 8, 3), by those axes.
    border
        Distance from each end of the edges that bound it, in the plane (n, 2).
    """

    origin: Array
    axes: Array
    points: Array
    border: Array

    def laid(self, X: Array) -> Array:
        """Return points (..., 3) by the sheet's axes: height, then two plane coordinates."""
        return (X - self.origin) @ self.axes.T

    def lifted(self, plane: Array) -> Array:
        """Return the points (..., 3) of the surface over plane points (..., 2).

        Beyond the sheet at the height of its nearest edge.
        """
        flat = plane.reshape(-1, 2)
        return (self.origin + self._heights(flat) @ self.axes).reshape(*plane.shape[:-1], 3)

    @cached_property
    def _samples(self) -> tuple[Any, Array, Array]:
        from scipy.spatial import KDTree  # only tails on such bodies wait for it

        x = np.linspace(-0.9, 0.9, SIDE)
        u, v = (a.ravel() for a in np.meshgrid(x, x, indexing="ij"))
        at = eight_shapes(u, v) @ self.points
        return KDTree(at[..., 1:].reshape(-1, 2)), u, v

    def _heights(self, plane: Array) -> Array:
        """Return (n, 3): height and plane coordinates."""
        tree, u0, v0 = self._samples
        starts = min(STARTS, tree.n)
        _, near = tree.query(plane, k=starts)
        near = np.reshape(near, (len(plane), starts))
        left, out = np.arange(len(plane)), np.column_stack([np.full(len(plane), np.inf), plane])
        outside = np.full(len(plane), np.inf)
        for k in range(starts):
            patch, start = np.divmod(near[left, k], SIDE * SIDE)
            height, beyond = self._newton(plane[left], patch, u0[start], v0[start])
            better = beyond < outside[left]
            at = left[better]
            out[at, 0], outside[at] = height[better], beyond[better]
            left = left[outside[left] > 1e-6]
            if not left.size:
                break
        return out

    def _newton(self, plane: Array, patch: Indices, u: Array, v: Array) -> tuple[Array, Array]:
        """Heights at plane points by one patch each, and how far beyond its sides they lie."""
        P, h = self.points[patch], 1e-30
        for _ in range(STEPS):
            at, in_u, in_v = (
                np.einsum("nk,nkc->nc", eight_shapes(a, b), P)[:, 1:]
                for a, b in ((u, v), (u + 1j * h, v), (u, v + 1j * h))
            )
            in_u, in_v, miss = in_u.imag / h, in_v.imag / h, at - plane
            det = in_u[:, 0] * in_v[:, 1] - in_u[:, 1] * in_v[:, 0]
            det = np.where(np.abs(det) > 1e-12, det, 1e-12)
            u = np.clip(u - (miss[:, 0] * in_v[:, 1] - miss[:, 1] * in_v[:, 0]) / det, -1.5, 1.5)
            v = np.clip(v - (in_u[:, 0] * miss[:, 1] - in_u[:, 1] * miss[:, 0]) / det, -1.5, 1.5)
        beyond = np.maximum(np.maximum(np.abs(u), np.abs(v)) - 1.0, 0.0)
        u, v = np.clip(u, -1.0, 1.0), np.clip(v, -1.0, 1.0)
        return np.einsum("nk,nk->n", eight_shapes(u, v), P[..., 0]), beyond


@lru_cache(maxsize=64)
def _sheet(surface: Triangles, face: int, size: float) -> Sheet:
    normal = surface.facing(face, AROUND * size)
    kept = surface.sheet(face, normal, LEAN)
    first = np.eye(3)[np.argmin(np.abs(normal))]
    first = first - first @ normal * normal
    first /= np.linalg.norm(first)
    axes = np.asarray(np.stack([normal, first, np.cross(normal, first)]), float)
    origin = surface.points[surface.faces[face]].mean(axis=0)
    corners, middles, _ = patches(surface, kept)
    points = (np.concatenate([corners, middles], axis=1) - origin) @ axes.T
    edges = (surface.border(kept)[0][:, [0, 2]] - origin) @ axes.T
    return Sheet(origin, axes, points, edges[..., 1:])


def rooted(surface: Triangles, X: Array, size: float) -> tuple[Sheet, Array]:
    """Return the sheet of a surface about a point of it for a tail of a half width, and that point
    in its plane (2,).
    """
    sheet = _sheet(surface, surface.nearest_face(X), size)
    return sheet, sheet.laid(X)[1:]


@dataclass(frozen=True, eq=False)
class RootedSurface(Body):
    """A body from a file as directions map to it about a root.

    Parameters
    ----------
    body
        All of it.
    sheet
        The surface about the root.
    at
        The root in the sheet's plane (2,).
    reach
        Plane distance that one radian stands for.
    """

    body: Body
    sheet: Sheet
    at: Array
    reach: float
    shape: ClassVar[str] = "mesh"
    is_balanced: ClassVar[bool] = False
    is_mirrored: ClassVar[bool] = False
    of_revolution: ClassVar[bool] = False

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        return self.body.semi_axes3

    @property
    def triangles(self) -> Triangles | None:
        return self.body.triangles

    @property
    def stretch(self) -> float:
        return 1.5 * self.reach

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        return self.body.diagonal(viscosity)

    def level(self, X: Array) -> Array:
        return self.body.level(X)

    def plane_point(self, direction: Array) -> Array:
        """Return the plane points (..., 2) that directions (..., 3) stand for."""
        d = direction @ self.sheet.axes.T
        across = np.linalg.norm(d[..., 1:], axis=-1)
        angle = np.arctan2(across, d[..., 0])
        size = np.where(across > 0.0, self.reach * angle / np.where(across > 0, across, 1.0), 0.0)
        return self.at + size[..., None] * d[..., 1:]

    def surface_point(self, direction: Array) -> Array:
        return self.sheet.lifted(self.plane_point(direction))

    def direction(self, X: Array) -> Array:
        d = self.sheet.laid(X)[1:] - self.at
        angle = float(np.linalg.norm(d)) / self.reach
        across = np.sinc(angle / np.pi) / self.reach * d
        return np.array([np.cos(angle), *across]) @ self.sheet.axes

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        a, b = self.sheet.border[:, 0] - self.at, self.sheet.border[:, 1] - self.at
        along = np.sum(a * (a - b), axis=1) / np.maximum(np.sum((a - b) ** 2, axis=1), 1e-300)
        nearest = a + np.clip(along, 0.0, 1.0)[:, None] * (b - a)
        room = float(np.linalg.norm(nearest, axis=1).min(initial=np.inf))
        if 1.05 * reach * self.reach > room:
            raise SpecError(
                "body.shape: the tail's root reaches a sharp edge of the surface from the file, "
                f"which is {measured(room)} away; take a thinner filament, or set tail.position to "
                "a place farther from edges"
            )
        axes = np.stack([pole, first, np.cross(pole, first)])
        return Opening(axes, reach)

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        return self.body.facets(splits)
