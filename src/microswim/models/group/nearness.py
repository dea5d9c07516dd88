"""How near surfaces come, and finer patches where they are near.

Between surfaces a gap h apart the pressure peaks over a width sqrt(h a), a the radius of curvature;
a patch that is at most `WIDEST` times as long as its distance from the other surface resolves it.
Patches are halved until all are; a halved patch is the same polynomial map on half the square.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import KDTree

from microswim.errors import SpecError
from microswim.models.bem.patches.near_wall import halved
from microswim.models.bem.patches.surface import Surface, positions
from microswim.numerics.array import Array

#: Longest patch in units of its distance from the other surface, and rounds of halving: two spheres
#: a tenth of their radius apart take six, a hundredth twelve.
WIDEST, ROUNDS = 2.5, 12
#: Points a side of a patch that distances are taken between, and how many of the nearest must see
#: a point behind them for it to lie inside.
SIDE, WITNESSES = 7, 4


def cloud(surface: Surface) -> tuple[Array, Array]:
    """Return points (n, 3) of a surface and its unit normals there."""
    X = positions(surface, SIDE)
    along, across = np.gradient(X, axis=(1, 2))
    normal = np.cross(along, across)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return X.reshape(-1, 3), normal.reshape(-1, 3)


def sides(surface: Surface) -> tuple[Array, Array]:
    """Return the lengths (e,) of the patches along u and along v, where they are longest."""
    X = positions(surface, SIDE)
    u = np.linalg.norm(np.diff(X, axis=1), axis=-1).sum(axis=1).max(axis=1)
    v = np.linalg.norm(np.diff(X, axis=2), axis=-1).sum(axis=2).max(axis=1)
    return u, v


def check_apart(clouds: Sequence[tuple[Array, Array]]) -> None:
    """Refuse surfaces of which one reaches into another.

    Raises
    ------
    SpecError
        With the two swimmers.
    """
    for j, (points, normals) in enumerate(clouds):
        tree = KDTree(points)
        for i, (others, _) in enumerate(clouds):
            if i == j:
                continue
            _, nearest = tree.query(others, WITNESSES)
            arm = others[:, None, :] - points[nearest]
            if (np.sum(arm * normals[nearest], axis=-1) < 0).all(axis=1).any():
                first, second = sorted((i, j))
                raise SpecError(
                    f"swimmer[{second}].position: swimmer {second} overlaps or touches swimmer "
                    f"{first}; move it away"
                )


def distances(surfaces: Sequence[Surface]) -> list[Array]:
    """Return how far each patch is from the nearest other surface, (e,) for each surface.

    Raises
    ------
    SpecError
        If two of them overlap.
    """
    clouds = [cloud(s) for s in surfaces]
    check_apart(clouds)
    found = []
    for i, (surface, (own, _)) in enumerate(zip(surfaces, clouds, strict=True)):
        others = [points for j, (points, _) in enumerate(clouds) if j != i]
        away, _ = KDTree(np.concatenate(others)).query(own)
        found.append(away.reshape(surface.patches, -1).min(axis=1))
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
        away = distances(now)
        finer = [_finer(s, WIDEST * d) for s, d in zip(now, away, strict=True)]
        if all(a is b for a, b in zip(finer, now, strict=True)):
            return now, float(min(d.min() for d in away))
        now = finer
    n = int(np.argmin([d.min() for d in away]))
    raise SpecError(
        f"swimmer[{n}].position: another swimmer is {away[n].min():.3g} away, nearer than its "
        "patches can resolve; move them apart"
    )


def _finer(surface: Surface, longest: Array) -> Surface:
    """Return the surface with patches longer than `longest` (e,) halved across their long side."""
    u, v = sides(surface)
    in_u, in_v = (u > longest) & (u >= v), (v > longest) & (v > u)
    return halved(surface, in_u, in_v) if (in_u | in_v).any() else surface
