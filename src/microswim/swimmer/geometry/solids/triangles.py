"""A closed surface of triangles, curved between its corners, flat where the surface is flat.

Each edge gets a point in its middle from the normals at its ends,

    m = (a + b)/2 + (t_a - t_b)/8,   t = d - (d . n) n,  d = b - a,

Hermite's cubic at one half, t the chord laid into the tangent plane. Edges that two faces meet at
more than `SHARP` stay sharp: along them t is the tangent of their own polygon.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from microswim.numerics.array import Array

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
    finer
        Surface that this one has its corners from, which knows the normals there.
    corners
        Indices (n,) of the points in it, -1 of points in flat parts that it has not.
    """

    points: Array
    faces: Indices
    finer: Triangles | None = None
    corners: Indices | None = None

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
    def curved_volume(self) -> float:
        """Volume within the curved patches: flat faces and their quarters, extrapolated."""
        a, b, c = self.faces.T
        ab, bc, ca = (len(self.points) + self.edges[2]).T
        four = np.stack([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]).transpose(0, 2, 1)
        finer = Triangles(np.vstack([self.points, self.middles]), four.reshape(-1, 3))
        return (4.0 * finer.volume - self.volume) / 3.0

    @cached_property
    def centroid(self) -> Array:
        """Middle of the volume, (3,): that of the tetrahedra from the origin to each face."""
        P = self.points[self.faces]
        share = np.einsum("ij,ij->i", P[:, 0], self.area_vectors) / 3.0
        return (share[:, None] * P.sum(axis=1) / 4.0).sum(axis=0) / share.sum()

    @cached_property
    def edges(self) -> tuple[Indices, Indices, Indices]:
        """Edges (e, 2), the faces beside them (e, 2), the edges of each face (m, 3)."""
        halves = self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        edges, which = np.unique(np.sort(halves, axis=1), axis=0, return_inverse=True)
        which = which.reshape(-1)
        order = np.argsort(which, kind="stable")
        beside = (order // 3).reshape(-1, 2)
        return edges, beside, which.reshape(-1, 3)

    @cached_property
    def is_sharp(self) -> NDArray[np.bool_]:
        """Which edges are sharp, (e,)."""
        if self.finer is not None:
            return self._turns_sharply()
        normal = _unit(self.area_vectors)
        one, other = normal[self.edges[1]].transpose(1, 0, 2)
        return np.einsum("ij,ij->i", one, other) < np.cos(SHARP)

    @cached_property
    def is_curved(self) -> bool:
        """Whether some faces meet smoothly at an angle, so that the surface between bends."""
        return bool((self._turn > FLAT)[~self.is_sharp].any())

    @cached_property
    def is_bent(self) -> NDArray[np.bool_]:
        """Which faces meet some neighbour smoothly at an angle, (m,)."""
        bent: NDArray[np.bool_] = (self._turn > FLAT) & ~self.is_sharp
        return np.asarray(bent[self.edges[2]].any(axis=1))

    @cached_property
    def _turn(self) -> Array:
        """Sine of the angle between the faces beside each edge, (e,)."""
        one, other = _unit(self.area_vectors)[self.edges[1]].transpose(1, 0, 2)
        return np.linalg.norm(np.cross(one, other), axis=1)

    def _turns_sharply(self) -> NDArray[np.bool_]:
        """Edges at whose ends the normals of both faces, those of the finer surface, differ."""
        edges, beside, _ = self.edges
        sharp = np.zeros(len(edges), bool)
        for end in (0, 1):
            one, other = (
                self._corner_normals[f, np.argmax(self.faces[f] == edges[:, end][:, None], axis=1)]
                for f in beside.T
            )
            sharp |= np.einsum("ij,ij->i", one, other) < np.cos(SHARP)
        return sharp

    @cached_property
    def _corner_normals(self) -> Array:
        """Normal at each corner of each face, (m, 3, 3), by the faces it joins smoothly.

        Weighted by angle and by the area of the flat a face belongs to: where a large flat ends in
        a fillet the normal is that of the flat.
        """
        normal = _unit(self.area_vectors)
        if self.finer is not None and self.corners is not None:
            return self.finer._normals_at(self.corners[self.faces], normal)
        weight = self._flat_areas()[:, None] * self.angles()
        group = self._smooth_corners()
        sums = np.zeros((group.max() + 1, 3))
        np.add.at(sums, group.ravel(), (weight[..., None] * normal[:, None]).reshape(-1, 3))
        return _unit(sums)[group]

    def _normals_at(self, corners: Indices, facing: Array) -> Array:
        """Normal (m, 3, 3) at points (m, 3): of those there, the nearest to a direction (m, 3)."""
        order = np.argsort(self.faces, axis=None, kind="stable")
        start = np.searchsorted(self.faces.ravel()[order], np.arange(len(self.points) + 1))
        all_normals = self._corner_normals.reshape(-1, 3)[order]
        out = np.empty((*corners.shape, 3))
        for face, row in enumerate(corners.tolist()):
            for k, point in enumerate(row):
                if point < 0:
                    out[face, k] = facing[face]
                    continue
                there = all_normals[start[point] : start[point + 1]]
                out[face, k] = there[np.argmax(there @ facing[face])]
        return out

    def angles(self) -> Array:
        """Return the angles at the corners of each face, (m, 3)."""
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
        alike = self.edges[1][(self._turn < FLAT) & ~self.is_sharp]
        flat = self._components(alike, len(self.faces))
        area = np.linalg.norm(self.area_vectors, axis=1)
        return np.bincount(flat, area)[flat].astype(float)

    def _smooth_corners(self) -> Indices:
        """Group of each corner (m, 3): corners at one point that smooth edges join."""
        edges, beside, _ = self.edges
        smooth = ~self.is_sharp
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
        edges = self.edges[0]
        a, b = self.points[edges[:, 0]], self.points[edges[:, 1]]
        laid = [self._laid(k) for k in (0, 1)]
        bulge = (laid[0] - laid[1]) / 8.0
        size, long = np.linalg.norm(bulge, axis=1), np.linalg.norm(b - a, axis=1)
        bulge *= np.minimum(1.0, 0.2 * long / np.maximum(size, 1e-300))[:, None]
        return 0.5 * (a + b) + bulge

    def _laid(self, end: int) -> Array:
        """The chord of each edge laid into the surface at one of its ends, (e, 3)."""
        edges, beside, _ = self.edges
        d = self.points[edges[:, 1]] - self.points[edges[:, 0]]
        first = beside[:, 0]
        corner = np.argmax(self.faces[first] == edges[:, end][:, None], axis=1)
        n = self._corner_normals[first, corner]
        laid = d - np.einsum("ij,ij->i", d, n)[:, None] * n
        sharp = np.nonzero(self.is_sharp)[0]
        laid[sharp] = self._along_sharp(sharp, edges[sharp, end], d[sharp])
        return laid

    def _along_sharp(self, sharp: Indices, at: Indices, d: Array) -> Array:
        """The chord of sharp edges turned into the tangent of their polygon at a point."""
        tangent, regular = (values[at] for values in self._lines)
        along = np.einsum("ij,ij->i", d, tangent)[:, None] * tangent
        return np.where(regular[:, None], along, d)

    @cached_property
    def _lines(self) -> tuple[Array, NDArray[np.bool_]]:
        """Tangent of the sharp edges at each point (n, 3), and whether two go on in it (n,)."""
        edges = self.edges[0][self.is_sharp]
        count = np.bincount(edges.ravel(), minlength=len(self.points))
        sums = np.zeros((len(self.points), 3, 3))
        unit = _unit(self.points[edges[:, 1]] - self.points[edges[:, 0]])
        for end in (0, 1):
            np.add.at(sums, edges[:, end], unit[:, :, None] * unit[:, None, :])
        value, vector = np.linalg.eigh(sums)
        turn = np.sqrt(np.maximum(value[:, 1], 0.0))  # sqrt(2) sin of half the turn
        regular = (count == 2) & (turn < np.sqrt(2.0) * np.sin(0.5 * CORNER))
        return vector[:, :, 2], regular

    @cached_property
    def kinds(self) -> Indices:
        """Of each point: 0 in a smooth part, 1 along a sharp edge, 2 where those meet or turn."""
        on_sharp = np.zeros(len(self.points), bool)
        on_sharp[self.edges[0][self.is_sharp]] = True
        return np.where(on_sharp, np.where(self._lines[1], 1, 2), 0)

    @cached_property
    def is_closed(self) -> bool:
        """Whether two faces meet in every edge, in opposite directions."""
        halves = self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        count = int(self.faces.max()) + 1
        one, other = (np.sort(halves @ [a, b]) for a, b in ((count, 1), (1, count)))
        return bool((one == other).all() and (np.diff(one) > 0).all())

    def border(self, of: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
        """Return the edges that bound a set of faces (m,), and which of them are sharp.

        Ends and middle in between (n, 3, 3), the faces of the set to their left.
        """
        _, beside, of_face = self.edges
        inside = of[beside]
        own = np.flatnonzero(inside[:, 0] != inside[:, 1])
        face = beside[own, np.argmax(inside[own], axis=1)]
        first = np.argmax(of_face[face] == own[:, None], axis=1)
        start = self.faces[face, first]
        end = self.faces[face, (first + 1) % 3]
        X = np.stack([self.points[start], self.middles[own], self.points[end]], axis=1)
        return X, self.is_sharp[own]

    def across(self, of: NDArray[np.bool_], sides: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the faces (m,) beyond some of the edges that bound a set of faces."""
        _, beside, _ = self.edges
        inside = of[beside]
        own = np.flatnonzero(inside[:, 0] != inside[:, 1])[sides]
        beyond = np.zeros(len(self.faces), bool)
        beyond[beside[own, np.argmin(inside[own], axis=1)]] = True
        return beyond

    def nearest_face(self, X: Array) -> int:
        """Return the face that a point (3,) is nearest to."""
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        n = self.area_vectors
        square = 2.0 * np.maximum(np.sum(n * n, axis=1), 1e-300)
        share = np.stack([np.sum(n * np.cross(q - X, r - X), axis=1) / square
                          for q, r in ((b, c), (c, a), (a, b))])  # fmt: skip
        share = np.clip(share, 0.0, 1.0)
        share /= share.sum(axis=0)
        near = share[0, :, None] * a + share[1, :, None] * b + share[2, :, None] * c
        return int(np.argmin(np.sum((near - X) ** 2, axis=1)))

    def facing(self, start: int, reach: float) -> Array:
        """Return the mean unit normal (3,) of the faces within a reach of a face, on its side."""
        middle, normal = self.points[self.faces].mean(axis=1), _unit(self.area_vectors)
        near = np.linalg.norm(middle - middle[start], axis=1) < reach
        near &= normal @ normal[start] > 0.0
        near[start] = True
        return _unit(self.area_vectors[near].sum(axis=0))

    def sheet(self, start: int, axis: Array, least: float) -> NDArray[np.bool_]:
        """Return the faces (m,) that hang together smoothly with a face and face a way.

        axis, least
            The way (3,), and the cosine of the angle by which their normals may differ from it.
        """
        normal, beside = _unit(self.area_vectors), self.edges[1]
        alike = normal @ axis > least
        alike[start] = True
        pairs = beside[alike[beside].all(axis=1) & ~self.is_sharp]
        part = self._components(pairs, len(self.faces))
        return alike & (part == part[start])
