"""A box with rounded edges: flat faces, quarter cylinders, eighths of spheres.

The box is all points within the fillet e of the smaller box with half sides ``h - e``. A direction
is mapped to the point of the surface that it meets from the centre.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, ClassVar, Self

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet, Opening, check_fillet, towards_both
from microswim.swimmer.geometry.solids.solved import SolvedBody
from microswim.swimmer.geometry.solids.spheres import octant

#: Edge of a box whose fillet is not given, in its smallest half side.
FILLET = 0.2
#: Radius of the round opening about a root, in half sides of the flat square about it; largest
#: share of it that a root may cover.
ROUND, ROOM = 0.75, 0.9


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Box(SolvedBody):
    """Rectangular box with rounded edges, its sides along s, q, r: a magnet block.

    Parameters
    ----------
    size
        ``(s, q, r)``: its sides (length), positive.
    edge
        Radius of the rounded edges (length), positive; a fifth of the smallest half side by
        default, half the smallest side at most.

    Raises
    ------
    SpecError
        If a side is not positive, or the edge does not fit.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Box(size=(2.0, 1.0, 1.0)).fillet
    0.1
    """

    size: tuple[float, float, float]
    edge: float | None = None
    shape: ClassVar[str] = "box"
    of_revolution: ClassVar[bool] = False

    def __post_init__(self) -> None:
        checks.numbers("body.size", self.size, 3, "three positive lengths [s, q, r]", above=0.0)
        object.__setattr__(self, "size", tuple(self.size))
        if self.edge is not None:
            check_fillet(self.edge, 0.5 * min(self.size))

    @property
    def fillet(self) -> float:
        """Radius of the rounded edges."""
        return 0.5 * FILLET * min(self.size, key=np.real) if self.edge is None else self.edge

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        a, b, c = self.size
        return (0.5 * a, 0.5 * b, 0.5 * c)

    @property
    def is_axisymmetric(self) -> bool:
        return False

    @property
    def corners(self) -> Array:
        return self._flat * np.array(list(product((-1.0, 1.0), repeat=3)))

    def scaled(self, factor: float) -> Self:
        a, b, c = self.size
        edge = None if self.edge is None else self.edge * factor
        return replace(self, size=(a * factor, b * factor, c * factor), edge=edge)

    def level(self, X: Array) -> Array:
        h, e = np.real(np.array(self.semi_axes3)), float(np.real(self.fillet))
        beyond = np.abs(np.asarray(X, float) - self.centre) - (h - e)
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return outside + np.minimum(beyond.max(axis=-1), 0.0) - e

    def surface_point(self, direction: Array) -> Array:
        low = np.zeros(direction.shape[:-1])
        high = np.full_like(low, float(np.linalg.norm(self.semi_axes3)))
        for _ in range(54):
            middle = 0.5 * (low + high)
            out = self.level(self.centre + middle[..., None] * direction) > 0.0
            low, high = np.where(out, low, middle), np.where(out, middle, high)
        return self.centre + (0.5 * (low + high))[..., None] * direction

    def direction(self, X: Array) -> Array:
        return (X - self.centre) / np.linalg.norm(X - self.centre)

    @property
    def stretch(self) -> float:
        return float(np.linalg.norm(self.semi_axes3) ** 2 / min(self.semi_axes3))

    @property
    def _flat(self) -> Array:
        """Half sides of the flat faces."""
        return np.real(np.array(self.semi_axes3)) - float(np.real(self.fillet))

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        """Return a circle in the flat of the rear face."""
        depth, across = float(np.real(self.semi_axes3[0])), self._flat[1:].min()
        room = np.arctan(ROUND * across / depth)
        own = float(np.arccos(np.clip(pole[0], -1.0, 1.0)))
        if own + reach > ROOM * room:
            at, far = (
                measured(depth * np.tan(angle))
                for angle in (min(own, 1.5), max(ROOM * room - reach, 0.0))
            )
            raise SpecError(
                f"tail: its root, {at} from the axis, reaches over the flat of the body's rear "
                f"face; bring it within {far} of the axis (a ramp or a smaller amplitude), thin "
                "the filament or round the edges less"
            )
        return Opening(np.eye(3), room, room * (1.0 - ROUND))

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        """Return faces, edges, corners; the rear face about an opening in four patches and
        rectangles.
        """
        parts = []
        for axis, sign in product(range(3), (1.0, -1.0)):
            u, v = (self._edges(k, splits) for k in _across(axis, sign))
            at = self._face(axis, sign)
            if opening is not None and axis == 0 and sign > 0:
                parts += self._around(at, opening, u, v)
            else:
                parts.append(Facet(at, u, v))
        for axis in range(3):
            parts += self._long_edges(axis, splits)
        return parts + self._corners()

    def _edges(self, axis: int, splits: int) -> Array:
        """Edges of patches along one axis of the flat faces, graded towards the fillet."""
        side = 0.5 * np.pi / splits * float(np.median(self.semi_axes3))
        return towards_both(
            self._flat[axis], side, 0.5 * np.pi * float(np.real(self.fillet)) / splits
        )

    def _face(self, axis: int, sign: float) -> Callable[[Array, Array], Array]:
        first, second = _across(axis, sign)

        def at(u: Array, v: Array) -> Array:
            X = np.zeros((*np.shape(u), 3))
            X[..., axis] = sign * float(np.real(self.semi_axes3[axis]))
            X[..., first], X[..., second] = u, v
            return self.centre + X

        return at

    def _around(
        self, at: Callable[[Array, Array], Array], opening: Opening, u: Array, v: Array
    ) -> list[Facet]:
        """The rear face beyond the circle: four sides of a square, and what is left of the face."""
        radius = float(np.real(self.semi_axes3[0])) * np.tan(opening.angle)
        half = self._flat[1:].min()
        parts = []
        for k in range(4):
            c, s = np.cos(0.5 * np.pi * k), np.sin(0.5 * np.pi * k)

            def side(t: Array, turn: Array, c: float = c, s: float = s) -> Array:
                a = (1 - t) * radius * np.cos(turn) + t * half
                b = (1 - t) * radius * np.sin(turn) + t * half * np.tan(turn)
                return at(c * a - s * b, s * a + c * b)

            turn = np.linspace(-0.25 * np.pi, 0.25 * np.pi, 3)
            parts.append(Facet(side, np.array([0.0, 1.0]), turn))
        for edges, other, is_u in ((u, v, True), (v, u, False)):
            if edges[-1] > half * (1 + 1e-9):
                for low, high in ((-edges[-1], -half), (half, edges[-1])):
                    cut = np.concatenate([[low], edges[(edges > low) & (edges < high)], [high]])
                    parts.append(Facet(at, cut, other) if is_u else Facet(at, other, cut))
        return parts

    def _long_edges(self, axis: int, splits: int) -> list[Facet]:
        """Four quarter cylinders along an axis."""
        e, flat = float(np.real(self.fillet)), self._flat
        first, second = _across(axis, 1.0)
        along = self._edges(axis, splits)
        turn = np.linspace(0.0, 0.5 * np.pi, max(1, splits // 2) + 1)
        parts = []
        for a, b in product((1.0, -1.0), repeat=2):

            def chart(t: Array, x: Array, a: float = a, b: float = b) -> Array:
                # X_t x X_x is a b times the normal: run the other way where a b < 0
                X = np.zeros((*np.shape(t), 3))
                X[..., axis] = x if a * b > 0 else -x
                X[..., first] = a * (flat[first] + e * np.cos(t))
                X[..., second] = b * (flat[second] + e * np.sin(t))
                return self.centre + X

            parts.append(Facet(chart, turn, along))
        return parts

    def _corners(self) -> list[Facet]:
        """Eight eighths of spheres."""
        parts = []
        for signs in product((1.0, -1.0), repeat=3):
            at = self.centre + np.array(signs) * self._flat
            parts += [f.mapped(lambda d, at=at: at + float(np.real(self.fillet)) * d)
                      for f in octant(np.array(signs))]  # fmt: skip
        return parts


def _across(axis: int, sign: float) -> tuple[int, int]:
    """The two other axes, so that with the outward normal they are right-handed."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    return (first, second) if sign > 0 else (second, first)
