"""Patches of a body out of which several tails grow: a cell of the sphere about each root.

The directions of the body's unit sphere are shared out among the roots and among points between
them, each to the nearest: cells whose sides are great circles. About a root, rings lead from the
joint to the sides of its cell; any other cell is cut into a quadrilateral for each of its corners.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import SphericalVoronoi

from microswim.errors import SpecError
from microswim.models.bem.patches.surface import grid_boxes, sample_adapted
from microswim.models.joint import Joint
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body

#: Largest angle of a direction from the middle of its cell; corners that lie closer together than
#: this share of it are one; rounds in which the middles without a root spread evenly.
WIDEST, ONE_CORNER, ROUNDS = 0.9, 0.35, 30
#: Room that a root has in its cell, in angles of its joint.
ROOM = 1.25


@dataclass(frozen=True)
class Cell:
    """A part of the unit sphere between great circles.

    Parameters
    ----------
    middle
        Unit vector within (3,).
    corners
        Unit vectors counter-clockwise, seen from outside (n, 3).
    """

    middle: Array
    corners: Array

    def normal(self, side: int) -> Array:
        """Return the unit vector across the side from a corner to the next, to the inside (3,)."""
        n = np.cross(self.corners[side], self.corners[(side + 1) % len(self.corners)])
        return n / np.linalg.norm(n)

    @property
    def width(self) -> float:
        """Least angle from the middle to a side."""
        sides = range(len(self.corners))
        return float(min(np.arcsin(np.clip(self.normal(k) @ self.middle, -1, 1)) for k in sides))

    def kites(self) -> list[Array]:
        """Return the quadrilaterals (4, 3) of middle, side, corner, side."""
        half = self.corners + np.roll(self.corners, -1, axis=0)
        half /= np.linalg.norm(half, axis=-1, keepdims=True)
        before = np.roll(half, 1, axis=0)
        return [np.array([self.middle, a, c, b]) for a, c, b in zip(before, self.corners, half)]


def cells_about(poles: Array) -> list[Cell]:
    """Return cells that cover the unit sphere, those about the poles (n, 3) first."""
    middles = _middles(poles)
    parts = SphericalVoronoi(middles)
    corners, which = _merged(parts.vertices)
    return [_cell(m, corners, which[r]) for m, r in zip(middles, parts.regions, strict=True)]


def _middles(poles: Array) -> Array:
    """Poles and points between them, none of the sphere farther than `WIDEST` from all."""
    n = 2000
    k = np.arange(n) + 0.5
    z, turn = 1.0 - 2.0 * k / n, np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    dense = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=-1)
    middles = poles
    while len(middles) < 4 or np.max(dense @ middles.T, axis=1).min() < np.cos(WIDEST):
        far = np.argmin(np.max(dense @ middles.T, axis=1))
        middles = np.vstack([middles, dense[far]])
    for _ in range(ROUNDS):
        nearest = np.argmax(dense @ middles.T, axis=1)
        for i in range(len(poles), len(middles)):
            mean = dense[nearest == i].sum(axis=0)
            middles[i] = mean / np.linalg.norm(mean)
    return middles


def _merged(corners: Array) -> tuple[Array, NDArray[np.intp]]:
    """Corners, those that nearly coincide made one, and of each the one it became."""
    near = corners @ corners.T > np.cos(ONE_CORNER * WIDEST)
    which = np.arange(len(corners))
    for i in range(len(corners)):
        for j in np.flatnonzero(near[i, :i]):
            which[which == which[i]] = which[j]
    kept = np.unique(which)
    mean = np.array([corners[which == k].sum(axis=0) for k in kept])
    return mean / np.linalg.norm(mean, axis=-1, keepdims=True), np.searchsorted(kept, which)


def _cell(middle: Array, corners: Array, of: NDArray[np.intp]) -> Cell:
    own = corners[np.unique(of)]
    first = np.eye(3)[np.argmin(np.abs(middle))]
    first = first - first @ middle * middle
    turn = np.arctan2(own @ np.cross(middle, first), own @ first * np.linalg.norm(middle))
    return Cell(middle, own[np.argsort(turn)])


def shell(
    body: Body,
    joints: list[Joint],
    side: int,
    rings: Callable[[Joint, float], tuple[Array, Callable[[float, float], int]]],
) -> Array:
    """Return positions (e, q, q, 3) of the patches of a body with several roots.

    Parameters
    ----------
    body
        Any that is given by a formula.
    joints
        Where the tails leave it.
    side
        Patches along a quarter of its circumference.
    rings
        Of a joint with a gap (rad) to the sides of its cell: fractions 0 to 1 of that way where
        rings end, and the number of patches per quarter of a ring between two of them.

    Raises
    ------
    SpecError
        If two roots are so close that their joints have no room.
    """
    parts = []
    cells = cells_about(np.array([joint.pole for joint in joints]))
    for n, (joint, cell) in enumerate(zip(joints, cells)):
        reach = float(joint.angle(np.linspace(0.0, 2.0 * np.pi, 64)).max())
        if cell.width < ROOM * reach:
            raise SpecError(
                f"tail[{n}].position: so close to another root that the joints have no room; "
                "move them apart, or use thinner filaments"
            )
        parts += _about_root(body, joint, cell, rings)
    for cell in cells[len(joints) :]:
        parts += [_kite(body, corners, side) for corners in cell.kites()]
    return np.concatenate(parts)


def _about_root(body: Body, joint: Joint, cell: Cell, rings: Callable) -> list[Array]:
    turns = np.arctan2(cell.corners @ joint.second, cell.corners @ joint.first)
    start = np.argsort(turns)
    corners, turns = cell.corners[start], np.sort(turns)
    cell = Cell(cell.middle, corners)
    around, mean = np.linspace(0.0, 2.0 * np.pi, 64), float(joint.series[0, 0].real)
    sides = [cell.normal(k) for k in range(len(corners))]
    far = np.min([_angle_to(joint, n, around) for n in sides], axis=0)
    t, per_quarter = rings(joint, float(far.mean()) - mean)
    parts = []
    for k, normal in enumerate(sides):
        low, high = turns[k], turns[k + 1] if k + 1 < len(turns) else turns[0] + 2.0 * np.pi

        def chart(t: Array, psi: Array, normal: Array = normal) -> Array:
            inner, outer = joint.angle(psi), _angle_to(joint, normal, psi)
            return body.surface_point(joint.sphere_point(inner * (1 - t) + outer * t, psi))

        for a, b in zip(t[:-1], t[1:]):
            count = max(1, round((high - low) / (0.5 * np.pi) * per_quarter(a, b)))
            edges = np.linspace(low, high, count + 1)
            parts.append(sample_adapted(chart, grid_boxes(np.array([a, b]), edges)))
    return parts


def _angle_to(joint: Joint, normal: Array, psi: Array) -> Array:
    """Polar angle at which the great circle from the pole at azimuth psi meets a side."""
    out = np.cos(psi) * (normal @ joint.first) + np.sin(psi) * (normal @ joint.second)
    return np.arctan2(normal @ joint.pole, -out)


def _kite(body: Body, corners: Array, side: int) -> Array:
    """Patches of a quadrilateral with great circles as sides."""
    long = max(np.arccos(np.clip(a @ b, -1, 1)) for a, b in zip(corners, np.roll(corners, 1, 0)))
    count = max(1, round(long * side / (0.5 * np.pi)))
    edges = np.linspace(0.0, 1.0, count + 1)

    def chart(u: Array, v: Array) -> Array:
        u, v = u[..., None], v[..., None]
        X = (1 - v) * ((1 - u) * corners[0] + u * corners[1]) + v * (
            (1 - u) * corners[3] + u * corners[2]
        )
        return body.surface_point(X / np.linalg.norm(X, axis=-1, keepdims=True))

    return sample_adapted(chart, grid_boxes(edges, edges))
