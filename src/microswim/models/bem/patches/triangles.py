"""Boundary-element patches through the triangles of a file: how many, of which order.

The file's own triangles as far as they go into a level's unknowns, two to a patch, else fewer of
them; large ones cut, towards sharp edges thrice as finely at each step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from microswim.errors import SpecError
from microswim.models.bem.patches.surface import Surface, sampled, still
from microswim.models.bem.system import Quadrature
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.coarsening import coarsened
from microswim.swimmer.geometry.solids.facets import Facet
from microswim.swimmer.geometry.solids.nearest import Nearest
from microswim.swimmer.geometry.solids.paired import facets_of
from microswim.swimmer.geometry.solids.remeshing import remeshed
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


#: The same of a body with tails, whose order is the tails': most patches, those of an even shape.
WITH_TAIL = {
    "coarse": Fineness(100, 50, 1),
    "standard": Fineness(150, 100, 2),
    "fine": Fineness(350, 200, 3),
}
#: How far a file's corners may lie from fewer triangles, in lengths of a side, and by what share
#: these may miss the volume; what sides are shortened by for it, and tries.
AWAY, MISSED, SHORTER, TRIES = 0.06, 0.02, 0.8, 8
#: Size of a patch in lengths of a side.
PATCH = 1.3


@dataclass(frozen=True, eq=False)
class Thinned:
    """Triangles of a body that a tail grows out of, near its surface.

    Parameters
    ----------
    triangles
        Few, of about one length where the file's are too many.
    size, layers
        How `facets_of` cuts them.
    onto
        Moves points of their patches onto the surface.
    """

    triangles: Triangles
    size: float
    layers: int
    onto: Callable[[Array], Array]

    @property
    def count(self) -> int:
        """Number of patches."""
        return _count(facets_of(self.triangles, self.size, self.layers))


@lru_cache(maxsize=16)
def for_a_tail(triangles: Triangles, level: str) -> Thinned:
    """Return the triangles of a body that a tail grows out of: the file's, or as few as are near
    its surface everywhere.
    """
    wanted = WITH_TAIL[level]
    length = float(np.sqrt(triangles.area / (wanted.patches * np.sqrt(0.75))))
    whole = Thinned(triangles, PATCH * length, wanted.layers, np.asarray)
    count = whole.count
    for _ in range(TRIES if count > wanted.unknowns else 0):
        made = remeshed(triangles, length)
        if made is not None and _near(made, triangles, length):
            few = replace(whole, triangles=made, onto=Nearest(triangles))
            return few if few.count < count else whole
        length *= SHORTER
    return whole


def _near(fewer: Triangles, triangles: Triangles, length: float) -> bool:
    """Whether fewer triangles with sides of a length are near a surface everywhere."""
    if abs(fewer.curved_volume / triangles.curved_volume - 1.0) > MISSED:
        return False
    away = Nearest(fewer)(triangles.points) - triangles.points
    near = float(np.linalg.norm(away, axis=1).max()) <= AWAY * length
    sharp, whole = (float(_curved_lengths(t)[t.is_sharp].sum()) for t in (fewer, triangles))
    return near and abs(sharp - whole) <= SHARP_KEPT * whole


def _curved_lengths(triangles: Triangles) -> Array:
    """Length of each curved side, from its chord and the two halves of it."""
    a, b = (triangles.points[triangles.edges[0][:, k]] for k in (0, 1))
    half = sum(np.linalg.norm(triangles.middles - end, axis=1) for end in (a, b))
    return (4.0 * half - np.linalg.norm(b - a, axis=1)) / 3.0


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
    linear = _linear(triangles, wanted)
    if linear is not None:
        return linear
    facets, used, order = _fitted(triangles, wanted, wanted.layers + 1)
    if not (_like(used, triangles) and _as_sharp(used, triangles)):
        facets, used, order = _fitted(triangles, wanted, wanted.layers)
    return still(sampled(facets), order), used


def _linear(triangles: Triangles, wanted: Fineness) -> tuple[Surface, Triangles] | None:
    """Linear densities on as few triangles as flat faces need, None where those are still too many.

    A flat part that was cut into many triangles is solved as well as from few.
    """
    used = triangles
    for _ in range(0 if triangles.is_curved else ROUNDS):
        facets = _pieces(used, wanted, wanted.layers)
        share = wanted.unknowns / (12 * _count(facets))
        if share >= 1.0:
            return still(sampled(facets), 2), used
        fewer = coarsened(used, int(0.85 * max(share, 0.3) * len(used.faces)))
        if fewer is used or not _same(fewer, triangles):
            return None
        used = fewer
    return None


def _fitted(
    triangles: Triangles, wanted: Fineness, layers: int
) -> tuple[list[Facet], Triangles, int]:
    """Patches within a level's unknowns, their triangles, fewer if need be, and the order.

    Constant densities take so many `layers` at sharp edges.
    """
    for _ in range(4):
        order, facets = 2, _pieces(triangles, wanted, wanted.layers)
        if 12 * _count(facets) > wanted.unknowns:
            order, facets = 1, _pieces(triangles, wanted, layers)
        count = 3 * order**2 * _count(facets)
        if count <= wanted.unknowns:
            break
        fewer = coarsened(triangles, int(0.8 * len(triangles.faces) * wanted.unknowns / count))
        if fewer is triangles:
            break
        triangles = fewer
    return facets, triangles, order


#: Change of the volume up to which fewer triangles bound the same flat faces, and tries.
ROUNDING, ROUNDS = 1e-6, 5
#: Error over what other cuts at sharp edges change: the cuts of the level below, also for constant
#: densities, and those of the level above.
OF_RECUT, OF_RECUT_CONSTANT, OF_FINER_CUTS = 0.3, 0.5, 1.8
#: Change of the volume and of the length of sharp edges up to which fewer triangles are still the
#: shape, and the shares tried.
KEPT, SHARP_KEPT, SHARES = 3e-3, 1e-2, (0.5, 0.75, 0.875)


#: Largest error of smooth shapes from files at a level, measured where formulas or structured
#: patches know the answer, and of sharp ones, with one node a patch at `fine` hardly below
#: `standard` (docs/cad.md). Other cuts may agree better, so no less is told.
LEAST = {"coarse": 5e-3, "standard": 3.5e-3, "fine": 1.5e-3}
LEAST_SHARP, LEAST_CONSTANT = {"coarse": 1e-2, "standard": 4.5e-3, "fine": 1.5e-3}, 3.5e-3


def least_error(triangles: Triangles, level: str, order: int) -> float:
    """Return the least error that is told of a level's surface of an order."""
    if not triangles.is_sharp.any():
        return LEAST[level]
    return max(LEAST_SHARP[level], LEAST_CONSTANT if order == 1 else 0.0)


def fewer(triangles: Triangles, level: str, order: int) -> tuple[Surface, float] | None:
    """Return a level's surface on fewer triangles, and the error over what they change.

    None where all faces are flat and few do. Half of them if those keep the volume, else more: what
    n triangles leave out of a curved shape goes with 1/n, so a share f changes it by 1/f - 1.
    """
    if not triangles.is_curved:
        return None
    for share in SHARES:
        made = coarsened(triangles, int(share * len(triangles.faces)))
        if _like(made, triangles):
            break
    layers = LEVELS[level].layers + _more(triangles, level, order)
    surface = still(sampled(_pieces(made, LEVELS[level], layers)), order)
    return surface, share / (1.0 - share)


def recut(triangles: Triangles, level: str, order: int) -> tuple[Surface, float] | None:
    """Return other cuts towards the sharp edges, and the error over what they change.

    None where no edge is sharp. From level to level that error falls to a fifth or so, of constant
    densities to a third; coarse, which has no level below, is compared with the cuts of the next
    finer one.
    """
    if not triangles.is_sharp.any():
        return None
    names = list(LEVELS)
    at = names.index(level)
    other = LEVELS[names[at - 1 if at else 1]]
    facets = _pieces(triangles, other, other.layers + _more(triangles, level, order))
    if 3 * order**2 * _count(facets) > LEVELS["standard"].unknowns:
        order = 1
    share = OF_RECUT if order == 2 else OF_RECUT_CONSTANT
    return still(sampled(facets), order), share if at else OF_FINER_CUTS


def _same(fewer: Triangles, triangles: Triangles) -> bool:
    return abs(fewer.volume / triangles.volume - 1.0) < ROUNDING


def _like(fewer: Triangles, triangles: Triangles) -> bool:
    return abs(fewer.curved_volume / triangles.curved_volume - 1.0) < KEPT


def _as_sharp(fewer: Triangles, triangles: Triangles) -> bool:
    whole = _sharp_length(triangles)
    return abs(_sharp_length(fewer) - whole) <= SHARP_KEPT * whole


def _sharp_length(triangles: Triangles) -> float:
    ends = triangles.points[triangles.edges[0][triangles.is_sharp]]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())


def _more(triangles: Triangles, level: str, order: int) -> int:
    """Layers more at sharp edges for constant densities: one, where there is room."""
    wanted = LEVELS[level]
    thin = order == 1 and _count(_pieces(triangles, wanted, wanted.layers + 1))
    return int(0 < 3 * thin <= wanted.unknowns)


def _pieces(triangles: Triangles, wanted: Fineness, layers: int) -> list[Facet]:
    size = 1.5 * float(np.sqrt(triangles.area / wanted.patches))
    return facets_of(triangles, size, layers)


def _count(facets: list[Facet]) -> int:
    return sum((f.u.size - 1) * (f.v.size - 1) for f in facets)
