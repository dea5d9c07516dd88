"""How near surfaces come, and finer patches where they are near.

Between surfaces a gap h apart the pressure peaks over a width sqrt(h a), a the radius of curvature;
a patch that is at most `WIDEST` times as long as its distance from the other surface resolves it.
Patches are halved until all are; a halved patch is the same polynomial map on half the square.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from microswim.errors import SpecError, measured
from microswim.models.bem.patches.near_wall import halved
from microswim.models.bem.patches.surface import Surface, positions
from microswim.numerics.array import Array

#: Longest patch in units of its distance from the other surface, and rounds of halving: two spheres
#: a tenth of their radius apart take six, a hundredth twelve.
WIDEST, ROUNDS = 2.5, 12
#: Points a side of a patch that distances are taken between, and how many of the nearest must see
#: a point behind them for it to lie inside.
SIDE, WITNESSES = 7, 4


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points of a surface, so many a side of every patch.

    Parameters
    ----------
    points : (e, side, side, 3)
    """

    points: Array

    @property
    def patches(self) -> Array:
        """The points (e, m, 3) of each patch."""
        return self.points.reshape(len(self.points), -1, 3)

    @cached_property
    def normals(self) -> Array:
        """Unit normals at the points, (e, m, 3)."""
        along, across = np.gradient(self.points, axis=(1, 2))
        normal = np.cross(along, across)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return normal.reshape(self.patches.shape)

    @cached_property
    def sides(self) -> tuple[Array, Array]:
        """Lengths (e,) of the patches along u and along v, where they are longest."""
        X = self.points
        u = np.linalg.norm(np.diff(X, axis=1), axis=-1).sum(axis=1).max(axis=1)
        v = np.linalg.norm(np.diff(X, axis=2), axis=-1).sum(axis=2).max(axis=1)
        return u, v

    @cached_property
    def balls(self) -> tuple[Array, Array]:
        """Centres (e, 3), each the middle one of a patch's points, and radii of balls about it."""
        middle = self.patches[:, self.patches.shape[1] // 2]
        return middle, np.linalg.norm(self.patches - middle[:, None], axis=-1).max(axis=1)


def check_apart(clouds: Sequence[Cloud]) -> None:
    """Refuse surfaces of which one reaches into another.

    Of patches whose balls meet none of the other surface the middle alone is looked at.

    Raises
    ------
    SpecError
        With the two swimmers.
    """
    for j, other in enumerate(clouds):
        tree, normals = KDTree(other.patches.reshape(-1, 3)), other.normals.reshape(-1, 3)
        for i, own in enumerate(clouds):
            if i == j:
                continue
            meets = (_least(own.balls, other.balls) <= 0.0).any(axis=1)
            seen = np.concatenate([own.patches[meets].reshape(-1, 3), own.balls[0][~meets]])
            _, nearest = tree.query(seen, WITNESSES)
            arm = seen[:, None, :] - tree.data[nearest]
            if (np.sum(arm * normals[nearest], axis=-1) < 0).all(axis=1).any():
                first, second = sorted((i, j))
                raise SpecError(
                    f"swimmer[{second}].position: swimmer {second} overlaps or touches swimmer "
                    f"{first}; move it away"
                )


def _least(one: tuple[Array, Array], other: tuple[Array, Array]) -> Array:
    """Return the least distance (e, f) that points in each two balls can have."""
    return cdist(one[0], other[0]) - one[1][:, None] - other[1]


def distances(clouds: Sequence[Cloud]) -> list[Array]:
    """Return how far each patch is from the nearest other surface, (e,) for each surface.

    Of patches that are neither among the nearest nor so near that it matters for their length, a
    lower bound.
    """
    found = []
    for own in clouds:
        others = [c for c in clouds if c is not own]
        centres, radii = (np.concatenate([c.balls[k] for c in others]) for k in (0, 1))
        points = np.concatenate([c.patches for c in others])
        least = _least(own.balls, (centres, radii))
        most = (least + own.balls[1][:, None] + radii).min(axis=1)
        away = least.min(axis=1)
        matters = away < np.maximum(np.max(own.sides, axis=0) / WIDEST, most.min())
        for e in np.flatnonzero(matters):
            near = points[least[e] <= most[e]].reshape(-1, 3)
            away[e] = cdist(own.patches[e], near).min()
        found.append(away)
    return found


def refined(surfaces: Sequence[Surface]) -> tuple[list[Surface], float]:
    """Return surfaces with finer patches where they are near each other, and the smallest gap.

    Surfaces that are far enough apart come back as they are.

    Raises
    ------
    SpecError
        If two overlap, or are too near to be resolved.
    """
    now = list(surfaces)
    if len(now) == 1:
        return now, float("inf")
    for _ in range(ROUNDS + 1):
        clouds = [Cloud(positions(s, SIDE)) for s in now]
        check_apart(clouds)
        away = distances(clouds)
        finer = [_finer(s, c, d) for s, c, d in zip(now, clouds, away, strict=True)]
        if all(a is b for a, b in zip(finer, now, strict=True)):
            return now, float(min(d.min() for d in away))
        now = finer
    n = int(np.argmin([d.min() for d in away]))
    raise SpecError(
        f"swimmer[{n}].position: another swimmer is {measured(away[n].min())} away, nearer than "
        "its patches can resolve; move them apart"
    )


def _finer(surface: Surface, cloud: Cloud, away: Array) -> Surface:
    """Return the surface with patches that are too long for their distances halved across."""
    (u, v), longest = cloud.sides, WIDEST * away
    in_u, in_v = (u > longest) & (u >= v), (v > longest) & (v > u)
    return halved(surface, in_u, in_v) if (in_u | in_v).any() else surface
