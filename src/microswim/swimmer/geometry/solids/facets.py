"""Smooth parts of a surface, as charts of rectangles, and how finely they are to be cut.

``X(u, v)`` of a facet is smooth, and ``X_u x X_v`` points into the fluid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import measured
from microswim.numerics.array import Array

#: How much a patch may grow per length that separates it from a smaller one.
GROWTH = 0.8


@dataclass(frozen=True, eq=False)
class Facet:
    """A smooth part of a surface.

    Parameters
    ----------
    chart
        X(u, v), shape broadcast(u, v) + (3,).
    u, v
        Edges of its patches, increasing.
    """

    chart: Callable[[Array, Array], Array]
    u: Array
    v: Array

    def mapped(self, onto: Callable[[Array], Array]) -> Facet:
        """Return the facet whose points are carried on by a map that keeps the orientation."""
        return Facet(lambda u, v: onto(self.chart(u, v)), self.u, self.v)


@dataclass(frozen=True, eq=False)
class Opening:
    """A circle on the unit sphere: the directions at `angle` from the first of three axes.

    Parameters
    ----------
    axes
        Orthonormal, (3, 3); the first is the circle's.
    angle
        From the axis (rad).
    last
        Angle of the patches that end at the circle, infinite where they need not be small.
    """

    axes: Array
    angle: float
    last: float = float("inf")


def check_fillet(value: Any, most: float) -> None:
    """Refuse a radius of rounded edges that is not above zero, or for which there is no room."""
    allowed = f"above zero and at most {measured(most, 'body.edge')}, which the body has room for"
    checks.number("body.edge", value, allowed, above=0.0, most=most * (1.0 + 1e-12))


def graded(edges: Array, wanted: Array, at: Array) -> Array:
    """Return edges of patches between given edges, of a wanted length that is known on a grid.

    Parameters
    ----------
    edges
        Where patches must end, increasing.
    wanted
        Wanted length at the points `at`, before it is made to grow by no more than `GROWTH`.
    at
        Increasing, from the first to the last edge.
    """
    after = np.minimum.accumulate(wanted - GROWTH * at) + GROWTH * at
    before = np.minimum.accumulate((wanted + GROWTH * at)[::-1])[::-1] - GROWTH * at
    h = np.minimum(after, before)
    share = np.concatenate([[0.0], np.cumsum(0.5 * (1 / h[1:] + 1 / h[:-1]) * np.diff(at))])
    pieces = np.interp(edges, at, share)
    cuts = [np.zeros(1)]
    for low, high in zip(pieces[:-1], pieces[1:]):
        count = max(1, int(np.ceil(high - low - 0.25)))
        cuts.append(np.linspace(low, high, count + 1)[1:])
    return np.interp(np.concatenate(cuts), share, at)


def towards_both(half: float, size: float, end: float) -> Array:
    """Return edges from -half to half, of length `size`, and of length `end` at both ends."""
    at = np.linspace(-half, half, 801)
    wanted = np.minimum(size, end + GROWTH * (half - np.abs(at)))
    return graded(np.array([-half, half]), wanted, at)


def sampled_quads(facets: list[Facet], side: int) -> tuple[np.ndarray, np.ndarray]:
    """Return corners (n, 3) and quadrilaterals (m, 4) of `side` x `side` cells of every patch."""
    points, quads, count = [], [], 0
    for facet in facets:
        u, v = (_refined(edges, side) for edges in (facet.u, facet.v))
        X = facet.chart(*np.meshgrid(u, v, indexing="ij"))
        i, j = np.meshgrid(np.arange(u.size - 1), np.arange(v.size - 1), indexing="ij")
        first = (i * v.size + j).ravel() + count
        quads.append(np.stack([first, first + v.size, first + v.size + 1, first + 1], axis=-1))
        points.append(X.reshape(-1, 3))
        count += u.size * v.size
    return np.concatenate(points), np.concatenate(quads)


def _refined(edges: Array, side: int) -> Array:
    steps = np.arange(side * (edges.size - 1) + 1) / side
    return np.interp(steps, np.arange(edges.size), edges)
