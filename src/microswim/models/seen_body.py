"""A body in the frame of a tail that stands elsewhere than at the joint, where its root is traced.

Directions stay those of the body's own unit sphere; points are moved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.geometry import attachment
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.facets import Facet, Opening
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.geometry.tails.placement import Placement


def seen_from(body: Body, tail: Tail) -> Body:
    """Return the body in the own frame of a tail."""
    if not tail.is_placed:
        return body
    return SeenBody(body, tail.placement, attachment.continued(body, tail))


@dataclass(frozen=True)
class SeenBody(Body):
    """A body moved into the frame of a tail.

    Parameters
    ----------
    body
        As it stands in ``sqr``.
    place
        Of the tail there.
    behind
        Length behind the tail's root over which it may be continued.
    """

    body: Body
    place: Placement
    behind: float = 0.0  # type: ignore[override]
    shape: ClassVar[str] = "seen"

    @property
    def as_it_stands(self) -> Body:
        return self.body

    @property
    def is_absent(self) -> bool:  # type: ignore[override]
        return self.body.is_absent

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        """The largest of its half lengths, whichever way it is seen."""
        return (max(self.body.semi_axes3),) * 3

    @property
    def centre(self) -> np.ndarray:
        return self.place.seen(self.body.centre)

    @property
    def stretch(self) -> float:
        return self.body.stretch

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        return self.body.diagonal(viscosity)

    def about(self, X: Array, size: float) -> Body:
        return SeenBody(self.body.about(self.place.placed(X), size), self.place, self.behind)

    def level(self, X: Array) -> Array:
        return self.body.level(self.place.placed(X))

    def surface_point(self, direction: Array) -> Array:
        return self.place.seen(self.body.surface_point(direction))

    def direction(self, X: Array) -> Array:
        return self.body.direction(self.place.placed(X))

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        return self.body.opening(pole, first, reach)

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        return [f.mapped(self.place.seen) for f in self.body.facets(splits, opening)]
