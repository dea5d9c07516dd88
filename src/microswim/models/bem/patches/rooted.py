"""Patches of a body from a surface file out of which tails grow: a hole in its triangles for each.

Triangles about a root are left out until those that bound the hole are seen from it one after the
other. In the plane of the root, rings grow geometrically from the joint to a circle, and lead from
there to the sides of the hole; both are lifted onto the surface of the file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from microswim.errors import SpecError
from microswim.models.bem.patches.surface import grid_boxes, sample_adapted, sampled
from microswim.models.bem.patches.triangles import Thinned, for_a_tail
from microswim.models.joint import Joint
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.paired import facets_of, graded_cuts
from microswim.swimmer.geometry.solids.rooted_surface import RootedSurface
from microswim.swimmer.geometry.solids.splitting import split
from microswim.swimmer.geometry.solids.triangles import Triangles

#: Distance within which triangles are left out, in reaches of the joint and in sides of a triangle;
#: least distance of a hole's sides, in reaches; cosine of the angle that triangles may turn away.
CLEAR, OPEN, FREE, FACING = 1.6, 0.5, 1.4, 0.1
#: Radius of the circle in least distances of the sides, and in reaches of the joint.
CIRCLE, ROUND = 0.6, 1.2
#: Longest side of flat triangles between roots, in distances of these.
APART = 0.4
#: Least sine of the angle between a side and the ray from the root; rounds in which holes grow, and
#: distances that are tried.
SEEN, ROUNDS, TRIES = 0.12, 40, 6

Rings = Callable[[Joint, float], tuple[Array, Callable[[float, float], int]]]


@dataclass(frozen=True, eq=False)
class Hole:
    """What is left out about a root.

    Parameters
    ----------
    faces
        Of the triangles (m,).
    sides
        Ends and middles of its sides (n, 3, 3), counter-clockwise.
    sharp
        Which of them are sharp (n,).
    """

    faces: NDArray[np.bool_]
    sides: Array
    sharp: NDArray[np.bool_]


def shell(surface: Triangles, joints: list[Joint], level: str, rings: Rings) -> Array:
    """Return positions (e, q, q, 3) of the patches of a body from a file with its roots.

    Parameters
    ----------
    surface
        The triangles of the file.
    joints
        Where tails leave it.
    level
        How fine its patches are.
    rings
        Of a joint with a gap (rad) to the end of the rings, see `mesh`.

    Raises
    ------
    SpecError
        If a root has no room.
    """
    thin = for_a_tail(surface, level)
    if len(joints) > 1:
        roots = np.array([_chart(joint).surface_point(joint.pole) for joint in joints])
        near = split(thin.triangles, roots, APART * float(pdist(roots).min()))
        thin = replace(thin, triangles=near)
    holes = [_hole(thin.triangles, joint, n) for n, joint in enumerate(joints)]
    out = np.sum([hole.faces for hole in holes], axis=0)
    if (out > 1).any():
        raise SpecError("tail.position: two roots are so close on the surface from the file that "
                        "their joints have no room; move them apart")  # fmt: skip
    parts = []
    for joint, hole in zip(joints, holes):
        parts += _about(joint, hole, rings, thin)
    rest = facets_of(thin.triangles, thin.size, thin.layers, out == 0)
    return np.concatenate([*parts, thin.onto(sampled(rest))] if rest else parts)


def _chart(joint: Joint) -> RootedSurface:
    return cast("RootedSurface", joint.body.as_it_stands)


def _hole(triangles: Triangles, joint: Joint, number: int) -> Hole:
    chart = _chart(joint)
    root, reach = chart.surface_point(joint.pole), _reach(joint).max()
    start = triangles.nearest_face(root)
    allowed = triangles.sheet(start, chart.sheet.axes[0], FACING)
    corners = chart.sheet.laid(triangles.points)[triangles.faces][..., 1:] - chart.at
    side = np.sqrt(4.0 / np.sqrt(3.0) * np.linalg.norm(triangles.area_vectors[start]))
    away = _distance(corners)
    for least in np.linspace(max(CLEAR * reach, OPEN * side), FREE * reach, TRIES):
        faces = allowed & (away < least)
        faces[start] = True
        hole = _grown(triangles, faces, allowed, chart, FREE * reach)
        if hole is not None:
            return hole
    raise SpecError(
        f"tail[{number}]: its root on the surface from the file is too close to an edge or a bend; "
        "take a thinner filament, or set tail.position to a place farther from edges"
    )


def _grown(
    triangles: Triangles, faces: NDArray[np.bool_], allowed: NDArray[np.bool_],
    chart: RootedSurface, least: float,
) -> Hole | None:  # fmt: skip
    """The hole of some faces and of those beyond sides that are not seen; none if there is none."""
    for _ in range(ROUNDS):
        sides, sharp = triangles.border(faces)
        wrong = _hidden(chart.sheet.laid(sides)[..., 1:] - chart.at, least)
        if not wrong.any():
            return Hole(faces, sides, sharp)
        more = triangles.across(faces, wrong) & allowed & ~faces
        if not more.any():
            return None
        faces = faces | more
    return None


def _reach(joint: Joint) -> Array:
    """Plane distance of the joint from the root at equal steps of the azimuth."""
    return _chart(joint).reach * joint.angle(np.linspace(0.0, 2.0 * np.pi, 64))


def _distance(corners: Array) -> Array:
    """Distance of plane triangles (m, 3, 2) from the origin."""
    a, b = corners, np.roll(corners, -1, axis=1)
    along = np.sum(a * (a - b), axis=-1) / np.maximum(np.sum((a - b) ** 2, axis=-1), 1e-300)
    nearest = np.linalg.norm(a + np.clip(along, 0.0, 1.0)[..., None] * (b - a), axis=-1)
    turn = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    within = (turn > 0.0).all(axis=1) | (turn < 0.0).all(axis=1)
    return np.where(within, 0.0, nearest.min(axis=1))


def _hidden(sides: Array, least: float) -> NDArray[np.bool_]:
    """Which sides (n, 3, 2) are not seen from the root, or are closer to it than `least`."""
    t = np.linspace(0.0, 1.0, 9)
    X = _along(sides, t)
    step = np.gradient(X, t, axis=1)
    turn = X[..., 0] * step[..., 1] - X[..., 1] * step[..., 0]
    size = np.linalg.norm(X, axis=-1)
    seen = turn > SEEN * size * np.linalg.norm(step, axis=-1)
    return ~(seen & (size > least)).all(axis=1)


def _along(sides: Array, t: Array) -> Array:
    """Points (n, len(t), c) of sides with ends and middles (n, 3, c), t from 0 to 1."""
    shape = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=-1)
    return shape @ sides


def _about(joint: Joint, hole: Hole, rings: Rings, thin: Thinned) -> list[Array]:
    """Patches between the joint and the sides of its hole."""
    chart = _chart(joint)
    sides = chart.sheet.laid(hole.sides)[..., 1:] - chart.at
    nearest = np.linalg.norm(_along(sides, np.linspace(0, 1, 9)), axis=-1).min()
    circle = float(max(CIRCLE * nearest, ROUND * _reach(joint).max()))
    parts = _to_circle(joint, circle, rings)
    for side, sharp in zip(hole.sides, hole.sharp):
        parts.append(_to_side(chart, circle, side, bool(sharp), thin))
    return parts


def _to_circle(joint: Joint, circle: float, rings: Rings) -> list[Array]:
    chart = _chart(joint)
    end = circle / chart.reach

    def place(t: Array, psi: Array) -> Array:
        return chart.surface_point(joint.sphere_point(joint.angle(psi) * (1 - t) + end * t, psi))

    t, per_quarter = rings(joint, end - float(joint.series[0, 0].real))
    parts = []
    for low, high in zip(t[:-1], t[1:], strict=True):
        turn = np.linspace(0.0, 2.0 * np.pi, 4 * per_quarter(low, high) + 1)
        parts.append(sample_adapted(place, grid_boxes(np.array([low, high]), turn)))
    return parts


def _to_side(chart: RootedSurface, circle: float, side: Array, sharp: bool, thin: Thinned) -> Array:
    """Patches between the circle and one side of the hole, ends and middle (3, 3)."""

    def end_at(along: Array) -> tuple[Array, Array]:
        X = thin.onto(_along(side[None], along.ravel())[0]).reshape(*along.shape, 3)
        return X, chart.sheet.laid(X)[..., 1:] - chart.at

    def place(t: Array, along: Array) -> Array:
        X, end = end_at(along)
        start = circle * end / np.linalg.norm(end, axis=-1, keepdims=True)
        t = t[..., None]
        there = chart.sheet.lifted(chart.at + (1 - t) * start + t * end)
        return there + t * (X - chart.sheet.lifted(chart.at + end))

    own = end_at(np.array([0.0, 0.5, 1.0]))[1]
    long = float(np.linalg.norm(own[2] - own[0]))
    far = float(np.linalg.norm(own, axis=-1).mean()) - circle
    outward = 0.5 * (1.0 + graded_cuts(far, thin.size, thin.layers, False, sharp))
    across = np.linspace(0.0, 1.0, max(1, round(long / thin.size)) + 1)
    return sample_adapted(place, grid_boxes(outward, across))
