"""A closed surface of triangles as curved patches: quadratic, flat where the surface is flat.

Each edge gets a point in its middle from the normals at its ends,

    m = (a + b)/2 + (t_a - t_b)/8,   t = d - (d . n) n,  d = b - a,

Hermite's cubic at one half, t the chord laid into the tangent plane. Edges that two faces meet at
more than `SHARP` stay sharp: along them t is the tangent of their own polygon. Two triangles that
share a smooth edge make a patch of four sides and eight points (bilinear blend of its edges); one
that is left over makes three.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet

Indices = NDArray[np.int64]

#: Angle between faces from which on their edge is sharp (rad); turn of a sharp polygon from which
#: on its corner is one; sine of the angle below which neighbouring faces are one flat.
SHARP, CORNER, FLAT = np.radians(38.0), np.radians(50.0), 1e-3


def _unit(v: Array) -> Array:
    size = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(size > 0, size, 1.0)


@dataclass(frozen=True, eq=False)
class Triangles:
    """A closed oriented surface.

    Parameters
    ----------
    points
        Corners (n, 3).
    faces
        Indices (m, 3), counter-clockwise seen from the fluid.
    """

    points: Array
    faces: Indices

    @cached_property
    def area_vectors(self) -> Array:
        """Normal times area of each face, (m, 3)."""
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        return 0.5 * np.cross(b - a, c - a)

    @cached_property
    def area(self) -> float:
        return float(np.linalg.norm(self.area_vectors, axis=1).sum())

    @cached_property
    def volume(self) -> float:
        return float(np.einsum("ij,ij->", self.points[self.faces[:, 0]], self.area_vectors) / 3.0)

    @cached_property
    def centroid(self) -> Array:
        """Middle of the volume, (3,): that of the tetrahedra from the origin to each face."""
        P = self.points[self.faces]
        share = np.einsum("ij,ij->i", P[:, 0], self.area_vectors) / 3.0
        return (share[:, None] * P.sum(axis=1) / 4.0).sum(axis=0) / share.sum()

    @cached_property
    def _edges(self) -> tuple[Indices, Indices, Indices]:
        """Edges (e, 2), the faces beside them (e, 2), the edges of each face (m, 3)."""
        halves = self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        edges, which = np.unique(np.sort(halves, axis=1), axis=0, return_inverse=True)
        which = which.reshape(-1)
        order = np.argsort(which, kind="stable")
        beside = (order // 3).reshape(-1, 2)
        return edges, beside, which.reshape(-1, 3)

    @cached_property
    def _is_sharp(self) -> NDArray[np.bool_]:
        normal = _unit(self.area_vectors)
        one, other = normal[self._edges[1]].transpose(1, 0, 2)
        return np.einsum("ij,ij->i", one, other) < np.cos(SHARP)

    @cached_property
    def _corner_normals(self) -> Array:
        """Normal at each corner of each face, (m, 3, 3), by the faces it joins smoothly.

        Weighted by angle and by the area of the flat a face belongs to: where a large flat ends in
        a fillet the normal is that of the flat.
        """
        normal = _unit(self.area_vectors)
        weight = self._flat_areas()[:, None] * self._angles()
        group = self._smooth_corners()
        sums = np.zeros((group.max() + 1, 3))
        np.add.at(sums, group.ravel(), (weight[..., None] * normal[:, None]).reshape(-1, 3))
        return _unit(sums)[group]

    def _angles(self) -> Array:
        P = self.points[self.faces]
        out, back = _unit(np.roll(P, -1, axis=1) - P), _unit(np.roll(P, 1, axis=1) - P)
        return np.arccos(np.clip(np.einsum("ijk,ijk->ij", out, back), -1.0, 1.0))

    def _components(self, pairs: Indices, count: int) -> Indices:
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        return np.asarray(connected_components(graph, directed=False)[1], np.int64)

    def _flat_areas(self) -> Array:
        """Area of the flat that each face belongs to."""
        normal = _unit(self.area_vectors)
        beside = self._edges[1]
        turn = np.linalg.norm(np.cross(normal[beside[:, 0]], normal[beside[:, 1]]), axis=1)
        flat = self._components(beside[(turn < FLAT) & ~self._is_sharp], len(self.faces))
        area = np.linalg.norm(self.area_vectors, axis=1)
        return np.bincount(flat, area)[flat].astype(float)

    def _smooth_corners(self) -> Indices:
        """Group of each corner (m, 3): corners at one point that smooth edges join."""
        edges, beside, _ = self._edges
        smooth = ~self._is_sharp
        pairs = []
        for end in (0, 1):
            at = edges[smooth, end]
            corner = [np.argmax(self.faces[beside[smooth, k]] == at[:, None], axis=1)
                      for k in (0, 1)]  # fmt: skip
            pairs.append(np.stack([3 * beside[smooth, k] + corner[k] for k in (0, 1)], axis=1))
        return self._components(np.concatenate(pairs), self.faces.size).reshape(-1, 3)

    @cached_property
    def middles(self) -> Array:
        """Point of the surface in the middle of each edge, (e, 3)."""
        edges = self._edges[0]
        a, b = self.points[edges[:, 0]], self.points[edges[:, 1]]
        laid = [self._laid(k) for k in (0, 1)]
        bulge = (laid[0] - laid[1]) / 8.0
        size, long = np.linalg.norm(bulge, axis=1), np.linalg.norm(b - a, axis=1)
        bulge *= np.minimum(1.0, 0.2 * long / np.maximum(size, 1e-300))[:, None]
        return 0.5 * (a + b) + bulge

    def _laid(self, end: int) -> Array:
        """The chord of each edge laid into the surface at one of its ends, (e, 3)."""
        edges, beside, _ = self._edges
        d = self.points[edges[:, 1]] - self.points[edges[:, 0]]
        first = beside[:, 0]
        corner = np.argmax(self.faces[first] == edges[:, end][:, None], axis=1)
        n = self._corner_normals[first, corner]
        laid = d - np.einsum("ij,ij->i", d, n)[:, None] * n
        sharp = np.nonzero(self._is_sharp)[0]
        laid[sharp] = self._along_sharp(sharp, edges[sharp, end], d[sharp])
        return laid

    def _along_sharp(self, sharp: Indices, at: Indices, d: Array) -> Array:
        """The chord of sharp edges turned into the tangent of their polygon at a point."""
        edges = self._edges[0][sharp]
        count = np.bincount(edges.ravel(), minlength=len(self.points))
        sums = np.zeros((len(self.points), 3, 3))
        unit = _unit(d)
        for end in (0, 1):
            np.add.at(sums, edges[:, end], unit[:, :, None] * unit[:, None, :])
        value, vector = np.linalg.eigh(sums[at])
        tangent = vector[:, :, 2]
        along = np.einsum("ij,ij->i", d, tangent)[:, None] * tangent
        turn = np.sqrt(np.maximum(value[:, 1], 0.0))  # sqrt(2) sin of half the turn
        regular = (count[at] == 2) & (turn < np.sqrt(2.0) * np.sin(0.5 * CORNER))
        return np.where(regular[:, None], along, d)

    def patches(self) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Return corners (k, 4, 3), edge middles (k, 4, 3) and whether each edge is sharp (k, 4).

        Side j leads from corner j to corner j + 1, counter-clockwise seen from the fluid.
        """
        of_face = self._edges[2]
        quads, alone = self._paired()
        corners, middles, sharp = [], [], []
        for one, other, edge in quads:
            # the corner of each face across the shared edge, and where its sides begin
            i = int(np.argmax(of_face[one] == edge)) + 1
            j = int(np.argmax(of_face[other] == edge)) + 1
            f, g = self.faces[one], self.faces[other]
            corners.append(self.points[[f[i % 3], f[(i + 1) % 3], g[j % 3], g[(j + 1) % 3]]])
            sides = [of_face[one][i % 3], of_face[one][(i + 1) % 3],
                     of_face[other][j % 3], of_face[other][(j + 1) % 3]]  # fmt: skip
            middles.append(self.middles[sides])
            sharp.append(self._is_sharp[sides])
        for face in alone:
            for part in self._thirds(face):
                for held, value in zip((corners, middles, sharp), part):
                    held.append(value)
        return np.array(corners), np.array(middles), np.array(sharp)

    def _thirds(self, face: int) -> list[tuple[Array, Array, NDArray[np.bool_]]]:
        """Three patches of a curved triangle with six points."""
        of = self._edges[2][face]
        six = np.concatenate([self.points[self.faces[face]], self.middles[of]])
        parts = []
        for k in range(3):
            at = np.eye(3)[[k, (k + 1) % 3, (k + 2) % 3]]
            a, half = at[0], [0.5 * (at[0] + at[1]), 0.5 * (at[0] + at[2])]
            centre = np.full(3, 1.0 / 3.0)
            own = np.array([a, half[0], centre, half[1]])
            between = 0.5 * (own + np.roll(own, -1, axis=0))
            sharp = self._is_sharp[[of[k], of[k], of[(k + 2) % 3], of[(k + 2) % 3]]]
            parts.append((_quadratic(six, own), _quadratic(six, between),
                          sharp & np.array([True, False, False, True])))  # fmt: skip
        return parts

    def _paired(self) -> tuple[list[tuple[int, int, int]], list[int]]:
        """Pairs of faces with their shared edge, best quadrilaterals first, and faces left over."""
        beside = self._edges[1]
        score = self._squareness()
        free = np.ones(len(self.faces), bool)
        pairs = []
        for edge in np.argsort(-score, kind="stable"):
            one, other = beside[edge]
            if score[edge] > 0.0 and free[one] and free[other]:
                free[[one, other]] = False
                pairs.append((int(one), int(other), int(edge)))
        return pairs, [int(f) for f in np.nonzero(free)[0]]

    def _squareness(self) -> Array:
        """How square the two faces beside each edge are together: 1, down to 0 and below."""
        edges, beside, of_face = self._edges
        angles = self._angles()
        where = [np.argmax(of_face[beside[:, k]] == np.arange(len(edges))[:, None], axis=1)
                 for k in (0, 1)]  # fmt: skip
        own = [angles[beside[:, k]] for k in (0, 1)]
        row = np.arange(len(edges))
        start = [own[k][row, where[k]] for k in (0, 1)]
        end = [own[k][row, (where[k] + 1) % 3] for k in (0, 1)]
        tip = [own[k][row, (where[k] + 2) % 3] for k in (0, 1)]
        four = np.stack([start[0] + end[1], end[0] + start[1], tip[0], tip[1]])
        worst = 1.0 - np.abs(four - 0.5 * np.pi).max(axis=0) / (0.42 * np.pi)
        return np.where(self._is_sharp, -1.0, worst)


def _quadratic(six: Array, at: Array) -> Array:
    """Points of a triangle with corners and edge middles `six` at barycentric coordinates."""
    a, b, c = at.T
    shape = np.stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c,
                      4 * c * a], axis=-1)  # fmt: skip
    return shape @ six


def facets_of(surface: Triangles, size: float, layers: int) -> list[Facet]:
    """Return the curved patches no longer than `size`, with `layers` of a third each towards sharp
    edges.
    """
    parts = []
    for corners, middles, sharp in zip(*surface.patches()):
        long = [_length(corners, middles, j) for j in range(4)]
        # sides 0, 2 run along u, sides 1, 3 along v; side 3 lies at u = -1, side 0 at v = -1
        u = _cuts(max(long[0], long[2]), size, layers, bool(sharp[3]), bool(sharp[1]))
        v = _cuts(max(long[1], long[3]), size, layers, bool(sharp[0]), bool(sharp[2]))
        parts.append(Facet(_eight_points(corners, middles), u, v))
    return parts


def _length(corners: Array, middles: Array, side: int) -> float:
    a, m, b = corners[side], middles[side], corners[(side + 1) % 4]
    return float(np.linalg.norm(m - a) + np.linalg.norm(b - m))


def _cuts(long: float, size: float, layers: int, low: bool, high: bool) -> Array:
    """Edges on [-1, 1] of pieces no longer than `size`, thinner towards sharp ends."""
    whole = np.linspace(0.0, 1.0, max(1, int(np.ceil(long / size - 0.15))) + 1)
    thin = np.array([size / long / 3.0**k for k in range(1, layers + 1)])
    thin = thin[thin < 0.4]
    cuts = [whole, thin] if low else [whole]
    cuts += [1.0 - thin] if high else []
    return 2.0 * np.unique(np.concatenate(cuts)) - 1.0


def _eight_points(corners: Array, middles: Array) -> Callable[[Array, Array], Array]:
    """Chart of a patch through its corners and the middles of its sides (serendipity)."""
    at = ((-1, -1), (1, -1), (1, 1), (-1, 1))

    def chart(u: Array, v: Array) -> Array:
        X = np.zeros((*np.shape(u), 3))
        X = X + sum(
            (0.25 * (1 + a * u) * (1 + b * v) * (a * u + b * v - 1))[..., None] * corner
            for (a, b), corner in zip(at, corners)
        )
        sides = ((1 - u * u) * (1 - v), (1 + u) * (1 - v * v), (1 - u * u) * (1 + v),
                 (1 - u) * (1 - v * v))  # fmt: skip
        return X + sum((0.5 * f)[..., None] * m for f, m in zip(sides, middles))

    return chart


def coarsened(surface: Triangles, most: int) -> Triangles:
    """Return the surface with at most `most` triangles, as far as its shape lets it.

    Its corners are corners of the surface (edge collapses by manifold3d).
    """
    if len(surface.faces) <= most:
        return surface
    import manifold3d

    middle, size = surface.points.mean(axis=0), float(np.ptp(surface.points, axis=0).max())
    points = np.asarray((surface.points - middle) / size, np.float32)
    solid = manifold3d.Manifold(manifold3d.Mesh(points, surface.faces.astype(np.uint32)))
    low, high, best = 1e-6, 0.1, solid
    for _ in range(12):
        epsilon = np.sqrt(low * high)
        made = solid.simplify(epsilon)
        if 8 <= made.num_tri() <= most:
            best, high = made, epsilon
        else:
            low, high = (low, epsilon) if made.num_tri() < 8 else (epsilon, high)
    if best.num_tri() >= len(surface.faces) or best.num_tri() < 8:
        return surface
    mesh = best.to_mesh()
    at = np.asarray(mesh.vert_properties[:, :3], float) * size + middle
    return Triangles(at, np.asarray(mesh.tri_verts, np.int64))
