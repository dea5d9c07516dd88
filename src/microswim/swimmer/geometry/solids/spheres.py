"""The unit sphere in patches: a cubed sphere, half of one, and a grid of the two angles."""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet


def cube_face(normal: Array, first: Array, second: Array, u: Array, v: Array) -> Facet:
    """Return Equiangular face of a cubed sphere: n + tan(u) e1 + tan(v) e2, e1 x e2 = n, as
    direction.
    """

    def chart(u: Array, v: Array) -> Array:
        d = normal + np.tan(u)[..., None] * first + np.tan(v)[..., None] * second
        return d / np.linalg.norm(d, axis=-1, keepdims=True)

    return Facet(chart, u, v)


def cubed_sphere(side: int) -> list[Facet]:
    """Return six faces of `side` x `side` patches."""
    edges, unit = np.linspace(-np.pi / 4, np.pi / 4, side + 1), np.eye(3)
    faces = []
    for axis in range(3):
        n, e1, e2 = unit[axis], unit[(axis + 1) % 3], unit[(axis + 2) % 3]
        faces += [cube_face(n, e1, e2, edges, edges), cube_face(-n, e2, e1, edges, edges)]
    return faces


def half_sphere(axis: Array, first: Array, second: Array, side: int) -> list[Facet]:
    """Return the hemisphere about `axis`: cube top and four half sides."""
    full = np.linspace(-np.pi / 4, np.pi / 4, side + 1)
    half = np.linspace(0, np.pi / 4, max(1, (side + 1) // 2) + 1)
    parts = [cube_face(axis, first, second, full, full)]
    for n in (first, second, -first, -second):
        parts.append(cube_face(n, np.cross(axis, n), axis, full, half))
    return parts


def octant(signs: Array) -> list[Facet]:
    """Return eighth of the sphere where each coordinate has the sign of `signs`: three patches."""
    eighth = np.array([0.0, np.pi / 4])
    parts = []
    for axis in range(3):
        n, e1, e2 = (signs[k % 3] * np.eye(3)[k % 3] for k in (axis, axis + 1, axis + 2))
        if np.prod(signs) < 0:
            e1, e2 = e2, e1
        parts.append(cube_face(n, e1, e2, eighth, eighth))
    return parts


def sphere_grid(rings: int, around: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points (rings x around, 3) from the pole at -s to that at +s, and quadrilaterals (m,
    4).
    """
    polar = np.linspace(0.0, np.pi, rings)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)[None, :]
    flat = np.sin(polar)
    unit = np.stack(
        np.broadcast_arrays(-np.cos(polar), flat * np.cos(angle), flat * np.sin(angle)), axis=-1
    )
    return unit.reshape(-1, 3), closed_grid(rings, around)


def closed_grid(rows: int, columns: int) -> np.ndarray:
    """Return quadrilaterals (m, 4) of a grid of points that closes along its columns."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    k = (j + 1) % columns
    corners = [i * columns + j, i * columns + k, (i + 1) * columns + k, (i + 1) * columns + j]
    return np.stack(corners, axis=-1).reshape(-1, 4)
