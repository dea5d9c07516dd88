"""A closed surface with sides of about one length (Botsch and Kobbelt, Proc. SGP 2004).

Short sides collapse, the shortest first; sides flip where the two triangles beside them are better
cut the other way; corners move to the middle of their neighbours and back onto the surface. Sharp
edges collapse along themselves alone, and where they meet or turn corners stay.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.coarsening import of_corners
from microswim.swimmer.geometry.solids.nearest import Nearest
from microswim.swimmer.geometry.solids.splitting import shortened
from microswim.swimmer.geometry.solids.triangles import Indices, Triangles

#: Sides that collapse and sides that may come of it, in lengths, and of longer ones in what they
#: were; spacing of the corners to choose from; rounds.
SHORT, LONG, LONGER, SPACING, ROUNDS = 0.8, 1.45, 1.1, 0.4, 4
#: Least cosine between a triangle's normal and the surface's where its corners move.
UPRIGHT = 0.5
#: What a corner is: within a smooth part, along a sharp edge, where those meet or turn.
SMOOTH, LINE, FIXED = 0, 1, 2


def remeshed(surface: Triangles, length: float) -> Triangles | None:
    """Return the surface with sides of about a length, corners and normals of it.

    None where that does not keep it closed.
    """
    dense = shortened(surface, SPACING * length)
    mesh = _Mesh(dense, length)
    onto = Nearest(dense)
    for _ in range(ROUNDS):
        mesh.collapse()
        mesh.flip()
        mesh.relax(onto)
    mesh.flip()
    points, faces = mesh.packed()
    return of_corners(dense, points, faces) if len(faces) >= 8 else None


class _Mesh:
    """Triangles that change: points, corners of each face, and the faces at each point."""

    def __init__(self, surface: Triangles, length: float) -> None:
        self.length = length
        self.points = surface.points.copy()
        self.faces = dict(enumerate(map(tuple, surface.faces.tolist())))
        self.at: list[set[int]] = [set() for _ in range(len(self.points))]
        for number, face in self.faces.items():
            for corner in face:
                self.at[corner].add(number)
        sharp = surface.edges[0][surface.is_sharp]
        self.sharp = {(a, b) for a, b in sharp.tolist()}
        self.kind = surface.kinds

    def _around(self, a: int) -> set[int]:
        return {c for f in self.at[a] for c in self.faces[f]} - {a}

    def _normal(self, face: tuple[int, ...]) -> Array:
        a, b, c = (self.points[k] for k in face)
        u, v = b - a, c - a
        return np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]])  # fmt: skip

    def _sides(self) -> Iterator[tuple[int, int]]:
        for a, b, c in self.faces.values():
            for one, other in ((a, b), (b, c), (c, a)):
                if one < other:
                    yield one, other

    def _long(self, a: int, b: int) -> float:
        d = self.points[b] - self.points[a]
        return float(np.sqrt(d @ d))

    def collapse(self) -> None:
        """Thin out: sides shorter than most collapse onto one of their ends."""
        most = SHORT * self.length
        queue = [(long, *side) for side in self._sides() if (long := self._long(*side)) < most]
        heapq.heapify(queue)
        while queue:
            _, a, b = heapq.heappop(queue)
            if not self.at[a] or not self.at[b] or not self.at[a] & self.at[b]:
                continue
            for gone, kept in ((a, b), (b, a)) if self.kind[a] <= self.kind[b] else ((b, a),):
                if self._may(gone, kept):
                    self._merge(gone, kept)
                    for c in self._around(kept):
                        if (long := self._long(kept, c)) < most:
                            heapq.heappush(queue, (long, min(kept, c), max(kept, c)))
                    break

    def _may(self, gone: int, kept: int) -> bool:
        """Whether a corner may collapse onto another without a fold, a gap or a long side."""
        kind = self.kind[gone]
        if kind == FIXED or (kind == LINE and (min(gone, kept), max(gone, kept)) not in self.sharp):
            return False
        beside = self._around(gone)
        if len(beside & self._around(kept)) != 2:
            return False
        for c in beside - {kept}:
            if self._long(kept, c) > max(LONG * self.length, LONGER * self._long(gone, c)):
                return False
        for f in self.at[gone] - self.at[kept]:
            face = self.faces[f]
            before = self._normal(face)
            after = self._normal(tuple(kept if c == gone else c for c in face))
            if before @ after <= UPRIGHT * np.sqrt((before @ before) * (after @ after)):
                return False
        return True

    def _merge(self, gone: int, kept: int) -> None:
        for f in self.at[gone] & self.at[kept]:
            for c in self.faces.pop(f):
                self.at[c].discard(f)
        for f in self.at[gone]:
            self.faces[f] = tuple(kept if c == gone else c for c in self.faces[f])
            self.at[kept].add(f)
        self.at[gone] = set()
        for side in [s for s in self.sharp if gone in s] if self.kind[gone] == LINE else []:
            self.sharp.discard(side)
            other = side[0] + side[1] - gone
            if other != kept:
                self.sharp.add((min(other, kept), max(other, kept)))

    def flip(self) -> None:
        """Turn the side between two triangles where their angles across are more than half a
        turn.
        """
        for a, b in sorted(self._sides()):
            both = self.at[a] & self.at[b]
            if (a, b) in self.sharp or len(both) != 2:
                continue
            one, other = sorted(both)
            face = self.faces[one]
            k = face.index(a)
            if face[(k + 1) % 3] != b:
                one, other = other, one
            c = sum(self.faces[one]) - a - b
            d = sum(self.faces[other]) - a - b
            if self.at[c] & self.at[d] or self._apex(c, a, b) + self._apex(d, a, b) <= np.pi + 0.02:
                continue
            # a, b, c run as `one` does
            new = (a, d, c), (d, b, c)
            old = self._normal((a, b, c)) + self._normal((b, a, d))
            made = [self._normal(f) for f in new]
            if any(n @ old <= UPRIGHT * np.sqrt((n @ n) * (old @ old)) for n in made):
                continue
            self.faces[one], self.faces[other] = new
            self.at[b].discard(one)
            self.at[a].discard(other)
            self.at[d].add(one)
            self.at[c].add(other)

    def _apex(self, at: int, a: int, b: int) -> float:
        u, v = self.points[a] - self.points[at], self.points[b] - self.points[at]
        return float(np.arccos(np.clip(u @ v / np.sqrt((u @ u) * (v @ v)), -1.0, 1.0)))

    def relax(self, onto: Nearest) -> None:
        """Take corners of smooth parts to the middle of their neighbours, along the surface."""
        own = [a for a in range(len(self.points)) if self.at[a] and self.kind[a] == SMOOTH]
        if not own:
            return
        moved = np.array([self.points[list(self._around(a))].mean(axis=0) for a in own])
        moved = onto(moved)
        for a, X in zip(own, moved):
            before = [self._normal(self.faces[f]) for f in self.at[a]]
            old = self.points[a].copy()
            self.points[a] = X
            after = [self._normal(self.faces[f]) for f in self.at[a]]
            if any(p @ q <= UPRIGHT * np.sqrt((p @ p) * (q @ q)) for p, q in zip(before, after)):
                self.points[a] = old

    def packed(self) -> tuple[Array, Indices]:
        """Return the points that are left, and the faces (m, 3)."""
        faces = np.array(list(self.faces.values()), np.int64)
        used, faces = np.unique(faces, return_inverse=True)
        return self.points[used], faces.reshape(-1, 3)
