"""Boundary-element patches through the triangles of a file: how many, of which order.

The file's own triangles as far as they go into a level's unknowns, two to a patch, else fewer of
them; large ones cut, towards sharp edges thrice as finely at each step.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from microswim.errors import SpecError
from microswim.models.bem.patches.surface import Surface, sampled, still
from microswim.models.bem.system import Quadrature
from microswim.swimmer.geometry.solids.coarsening import coarsened
from microswim.swimmer.geometry.solids.facets import Facet
from microswim.swimmer.geometry.solids.paired import facets_of
from microswim.swimmer.geometry.solids.triangles import Triangles

RULE = Quadrature(points=4, near=2.0, far=6.0)


@dataclass(frozen=True)
class Fineness:
    """Most unknowns of a level, patches of an even shape, and steps towards sharp edges."""

    unknowns: int
    patches: int
    layers: int


LEVELS = {
    "coarse": Fineness(2500, 60, 1),
    "standard": Fineness(7500, 150, 2),
    "fine": Fineness(14000, 350, 3),
}


#: The same of a body with tails, whose order is the tails': patches in all, and most of them; share
#: of the volume from which on triangles are too few for the shape, however many patches there are.
TOO_FEW = 0.006
WITH_TAIL = {
    "coarse": Fineness(100, 40, 1),
    "standard": Fineness(150, 50, 2),
    "fine": Fineness(350, 150, 3),
}


@lru_cache(maxsize=16)
def for_a_tail(triangles: Triangles, level: str) -> tuple[Triangles, float, int]:
    """Return the triangles of a body that a tail grows out of, and how `facets_of` cuts them."""
    wanted, whole = WITH_TAIL[level], triangles.curved_volume
    size = 1.5 * float(np.sqrt(triangles.area / wanted.patches))
    for _ in range(4):
        count = _count(facets_of(triangles, size, wanted.layers))
        if count <= wanted.unknowns:
            break
        fewer = coarsened(triangles, int(0.8 * len(triangles.faces) * wanted.unknowns / count))
        if fewer is triangles or abs(fewer.curved_volume / whole - 1.0) > TOO_FEW:
            break
        triangles = fewer
    return triangles, size, wanted.layers


def surface_of(triangles: Triangles, level: str = "standard") -> tuple[Surface, Triangles]:
    """Return the closed surface of patches at a level, and the triangles that they go through.

    Raises
    ------
    SpecError
        If there is no such level.
    """
    if level not in LEVELS:
        raise SpecError("level", level, "coarse, standard or fine")
    wanted = LEVELS[level]
    for _ in range(4):
        facets = _cut(triangles, wanted)
        count = _count(facets)
        if 3 * count <= wanted.unknowns:
            break
        fewer = coarsened(
            triangles, int(0.8 * len(triangles.faces) * wanted.unknowns / (3 * count))
        )
        if fewer is triangles:
            break
        triangles = fewer
    order = 2 if 12 * count <= wanted.unknowns else 1
    return still(sampled(facets), order), triangles


#: Change of the volume up to which fewer triangles are still the shape, and the shares tried.
KEPT, SHARES = 3e-3, (0.5, 0.75, 0.875)


def fewer(triangles: Triangles, level: str, order: int) -> Surface | None:
    """Return a level's surface on fewer triangles, None where all faces are flat and few do.

    On half of them if those keep the volume, else on more: what that changes bounds what the
    triangles leave out of a curved shape.
    """
    if not triangles.is_curved:
        return None
    made = triangles
    for share in SHARES:
        made = coarsened(triangles, int(share * len(triangles.faces)))
        if abs(made.curved_volume / triangles.curved_volume - 1.0) < KEPT:
            break
    return still(sampled(_cut(made, LEVELS[level])), order)


def recut(triangles: Triangles, level: str, order: int) -> tuple[Surface, float] | None:
    """Return other cuts towards the sharp edges, and the error over what they change.

    None where no edge is sharp. From level to level that error falls to a fifth or so; coarse,
    which has no level below, is compared with the cuts of the next finer one.
    """
    if not triangles.is_sharp.any():
        return None
    names = list(LEVELS)
    at = names.index(level)
    facets = _cut(triangles, LEVELS[names[at - 1 if at else 1]])
    if 3 * order**2 * _count(facets) > LEVELS["standard"].unknowns:
        order = 1
    return still(sampled(facets), order), 0.25 if at else 1.4


def _cut(triangles: Triangles, wanted: Fineness) -> list[Facet]:
    size = 1.5 * float(np.sqrt(triangles.area / wanted.patches))
    return facets_of(triangles, size, wanted.layers)


def _count(facets: list[Facet]) -> int:
    return sum((f.u.size - 1) * (f.v.size - 1) for f in facets)
