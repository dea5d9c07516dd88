"""The curved patches of a surface of triangles: two triangles to a patch, where they find partners.

A patch has four sides and eight points (bilinear blend of its sides); a triangle that is left over
makes three.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet
from microswim.swimmer.geometry.solids.triangles import Triangles


def patches(
    surface: Triangles, kept: NDArray[np.bool_] | None = None
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return corners (k, 4, 3), edge middles (k, 4, 3) and whether each edge is sharp (k, 4).

    Of all faces, or of those that are `kept` (m,). Side j leads from corner j to corner j + 1,
    counter-clockwise seen from the fluid.
    """
    of_face = surface.edges[2]
    quads, alone = _paired(surface, np.ones(len(surface.faces), bool) if kept is None else kept)
    corners, middles, sharp = [], [], []
    for one, other, edge in quads:
        # the corner of each face across the shared edge, and where its sides begin
        i = int(np.argmax(of_face[one] == edge)) + 1
        j = int(np.argmax(of_face[other] == edge)) + 1
        f, g = surface.faces[one], surface.faces[other]
        corners.append(surface.points[[f[i % 3], f[(i + 1) % 3], g[j % 3], g[(j + 1) % 3]]])
        sides = [of_face[one][i % 3], of_face[one][(i + 1) % 3],
                 of_face[other][j % 3], of_face[other][(j + 1) % 3]]  # fmt: skip
        middles.append(surface.middles[sides])
        sharp.append(surface.is_sharp[sides])
    for face in alone:
        for part in _thirds(surface, face):
            for held, value in zip((corners, middles, sharp), part):
                held.append(value)
    return np.array(corners), np.array(middles), np.array(sharp)


def _thirds(surface: Triangles, face: int) -> list[tuple[Array, Array, NDArray[np.bool_]]]:
    """Three patches of a curved triangle with six points."""
    of = surface.edges[2][face]
    six = np.concatenate([surface.points[surface.faces[face]], surface.middles[of]])
    parts = []
    for k in range(3):
        at = np.eye(3)[[k, (k + 1) % 3, (k + 2) % 3]]
        a, half = at[0], [0.5 * (at[0] + at[1]), 0.5 * (at[0] + at[2])]
        centre = np.full(3, 1.0 / 3.0)
        own = np.array([a, half[0], centre, half[1]])
        between = 0.5 * (own + np.roll(own, -1, axis=0))
        sharp = surface.is_sharp[[of[k], of[k], of[(k + 2) % 3], of[(k + 2) % 3]]]
        parts.append((_quadratic(six, own), _quadratic(six, between),
                      sharp & np.array([True, False, False, True])))  # fmt: skip
    return parts


def _paired(
    surface: Triangles, kept: NDArray[np.bool_]
) -> tuple[list[tuple[int, int, int]], list[int]]:
    """Pairs of faces with their shared edge, best quadrilaterals first, and faces left over."""
    beside = surface.edges[1]
    score = _squareness(surface)
    neighbours: dict[int, list[tuple[int, int]]] = {int(f): [] for f in np.flatnonzero(kept)}
    partner: dict[int, tuple[int, int]] = {}
    for edge in np.argsort(-score, kind="stable").tolist():
        one, other = beside[edge].tolist()
        if score[edge] > 0.0 and kept[one] and kept[other]:
            neighbours[one].append((other, edge))
            neighbours[other].append((one, edge))
            if one not in partner and other not in partner:
                partner[one], partner[other] = (other, edge), (one, edge)
    for face in neighbours:
        if face not in partner:
            _pair_anew(face, neighbours, partner)
    pairs = [(f, g, edge) for f, (g, edge) in partner.items() if f < g]
    return pairs, [f for f in neighbours if f not in partner]


def _squareness(surface: Triangles) -> Array:
    """How square the two faces beside each edge are together: 1, down to 0 and below."""
    edges, beside, of_face = surface.edges
    angles = surface.angles()
    where = [np.argmax(of_face[beside[:, k]] == np.arange(len(edges))[:, None], axis=1)
             for k in (0, 1)]  # fmt: skip
    own = [angles[beside[:, k]] for k in (0, 1)]
    row = np.arange(len(edges))
    start = [own[k][row, where[k]] for k in (0, 1)]
    end = [own[k][row, (where[k] + 1) % 3] for k in (0, 1)]
    tip = [own[k][row, (where[k] + 2) % 3] for k in (0, 1)]
    four = np.stack([start[0] + end[1], end[0] + start[1], tip[0], tip[1]])
    worst = 1.0 - np.abs(four - 0.5 * np.pi).max(axis=0) / (0.42 * np.pi)
    return np.where(surface.is_sharp, -1.0, worst)


def _pair_anew(
    alone: int, neighbours: dict[int, list[tuple[int, int]]], partner: dict[int, tuple[int, int]]
) -> None:
    """Pair a face that was left over, along a path on which pairs are exchanged, if there is one.

    From it to a neighbour, on to that one's partner, and so on to another face that is left over.
    """
    came: dict[int, tuple[int, int, int]] = {}
    ends, seen = [alone], {alone}
    for end in ends:
        for face, edge in neighbours[end]:
            if face in seen:
                continue
            seen.add(face)
            if face not in partner:
                partner[face], partner[end] = (end, edge), (face, edge)
                while end != alone:
                    end, face, edge = came[end]
                    partner[face], partner[end] = (end, edge), (face, edge)
                return
            other = partner[face][0]
            if other not in seen:
                seen.add(other)
                came[other] = (end, face, edge)
                ends.append(other)


def _quadratic(six: Array, at: Array) -> Array:
    """Points of a triangle with corners and edge middles `six` at barycentric coordinates."""
    a, b, c = at.T
    shape = np.stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c,
                      4 * c * a], axis=-1)  # fmt: skip
    return shape @ six


def facets_of(
    surface: Triangles, size: float, layers: int, kept: NDArray[np.bool_] | None = None
) -> list[Facet]:
    """Return the curved patches no longer than `size`, with `layers` of a third each towards sharp
    edges; of all faces, or of those that are `kept` (m,).
    """
    parts = []
    for corners, middles, sharp in zip(*patches(surface, kept)):
        long = [_length(corners, middles, j) for j in range(4)]
        # sides 0, 2 run along u, sides 1, 3 along v; side 3 lies at u = -1, side 0 at v = -1
        u = graded_cuts(max(long[0], long[2]), size, layers, bool(sharp[3]), bool(sharp[1]))
        v = graded_cuts(max(long[1], long[3]), size, layers, bool(sharp[0]), bool(sharp[2]))
        parts.append(Facet(_eight_points(corners, middles), u, v))
    return parts


def _length(corners: Array, middles: Array, side: int) -> float:
    a, m, b = corners[side], middles[side], corners[(side + 1) % 4]
    return float(np.linalg.norm(m - a) + np.linalg.norm(b - m))


def graded_cuts(long: float, size: float, layers: int, low: bool, high: bool) -> Array:
    """Return edges on [-1, 1] of pieces no longer than `size`, thinner towards sharp ends."""
    whole = np.linspace(0.0, 1.0, max(1, int(np.ceil(long / size - 0.15))) + 1)
    thin = np.array([size / long / 3.0**k for k in range(1, layers + 1)])
    thin = thin[thin < 0.4]
    cuts = [whole, thin] if low else [whole]
    cuts += [1.0 - thin] if high else []
    return 2.0 * np.unique(np.concatenate(cuts)) - 1.0


def _eight_points(corners: Array, middles: Array) -> Callable[[Array, Array], Array]:
    """Chart of a patch through its corners and the middles of its sides (serendipity)."""
    both = np.concatenate([corners, middles])
    return lambda u, v: eight_shapes(u, v) @ both


def eight_shapes(u: Any, v: Any) -> Any:
    """Return the shape functions (..., 8) of a patch's corners and of the middles of its sides."""
    at = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corners = [0.25 * (1 + a * u) * (1 + b * v) * (a * u + b * v - 1) for a, b in at]
    sides = ((1 - u * u) * (1 - v), (1 + u) * (1 - v * v), (1 - u * u) * (1 + v),
             (1 - u) * (1 - v * v))  # fmt: skip
    return np.stack([*corners, *(0.5 * f for f in sides)], axis=-1)
