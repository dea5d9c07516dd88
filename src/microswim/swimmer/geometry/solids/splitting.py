"""Triangles cut: flat ones, so that a surface of few of them has some about each of many roots,
and long ones of curved parts, so that fewer have corners to choose from.
"""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.triangles import Indices, Triangles

#: Most cuts.
MOST = 400
#: Distance of a side's middle from its chord, in lengths, up to which the side is straight.
STRAIGHT = 1e-4
#: Rounds in which every long side is halved.
HALVINGS = 8


def shortened(surface: Triangles, longest: float) -> Triangles:
    """Return the surface with no side longer than a length where it is curved.

    New corners are the middles of curved sides.
    """
    for _ in range(HALVINGS):
        edges, _, of_face = surface.edges
        ends = surface.points[edges]
        long = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > longest
        long &= surface.is_bent[surface.edges[1]].any(axis=1)
        if not long.any():
            break
        number = np.full(len(edges), -1)
        number[long] = len(surface.points) + np.arange(int(long.sum()))
        parts = [_halved(f, new) for f, new in zip(surface.faces, number[of_face])]
        points = np.vstack([surface.points, surface.middles[long]])
        surface = Triangles(points, np.concatenate(parts).astype(np.int64))
    return surface


def _halved(face: Indices, new: Indices) -> Indices:
    """Triangles of one with new points on its sides ab, bc, ca, -1 for none."""
    count = int((new >= 0).sum())
    if count == 0:
        return face[None]
    if count == 3:
        (a, b, c), (p, q, r) = face, new
        return np.array([[a, p, r], [p, b, q], [r, q, c], [p, q, r]])
    # the side before the one whose follower is whole, or the only one halved, comes first
    turn = int(np.argmax(new >= 0)) if count == 1 else (int(np.argmax(new < 0)) + 1) % 3
    (a, b, c), (p, q, _) = np.roll(face, -turn), np.roll(new, -turn)
    if count == 1:
        return np.array([[a, p, c], [p, b, c]])
    return np.array([[a, p, q], [p, b, q], [a, q, c]])


def split(surface: Triangles, at: Array, reach: float) -> Triangles:
    """Return the surface with no straight side longer than a length near some points of it.

    Parameters
    ----------
    surface
        Whose sides are cut in the middle, the longest first, where no curved side is beside them.
    at
        Points (n, 3).
    reach
        Longest side within twice that distance from one of them.
    """
    for _ in range(MOST):
        edges, beside, of_face = surface.edges
        side = _longest(surface, edges, beside, of_face, at, reach)
        if side < 0:
            break
        surface = _cut(surface, edges[side], beside[side])
    return surface


def _longest(
    surface: Triangles, edges: Indices, beside: Indices, of_face: Indices, at: Array, reach: float
) -> int:
    """The longest side that is to be cut, -1 if none is."""
    a, b = surface.points[edges[:, 0]], surface.points[edges[:, 1]]
    long = np.linalg.norm(b - a, axis=1)
    bow = np.linalg.norm(surface.middles - 0.5 * (a + b), axis=1)
    flat = (bow < STRAIGHT * long)[of_face].all(axis=1)
    along = np.clip(
        np.einsum("eij,ej->ei", at[None] - a[:, None], b - a) / long[:, None] ** 2, 0, 1
    )
    nearest = a[:, None] + along[..., None] * (b - a)[:, None]
    near = np.linalg.norm(nearest - at[None], axis=-1).min(axis=1) < 2.0 * reach
    long = np.where(flat[beside].all(axis=1) & near, long, 0.0)
    best = int(np.argmax(long))
    return best if long[best] > reach else -1


def _cut(surface: Triangles, edge: Indices, beside: Indices) -> Triangles:
    new = len(surface.points)
    middle = surface.points[edge].mean(axis=0)
    made = []
    for face in surface.faces[beside]:
        made += [np.where(face == end, new, face) for end in edge]
    rest = np.delete(surface.faces, beside, axis=0)
    corners = None if surface.corners is None else np.append(surface.corners, -1)
    return Triangles(
        np.vstack([surface.points, middle]), np.vstack([rest, made]), surface.finer, corners
    )
