r"""What every body says of itself: its surface, its centre, its isolated resistance.

The frame is ``sqr``: the body touches the origin (the joint) with its rear pole, its centre is at
``(-r_s, 0, 0)``. A body is the image of the unit sphere under a map that takes the direction
``e_s`` to the joint; smooth parts of it are `Facet`\\ s. Whoever needs to know something of a body
asks here; nobody asks of what kind it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet, Opening, sampled_quads
from microswim.swimmer.geometry.solids.triangles import Triangles


class Body(ABC):
    """A body of any shape.

    Use `Sphere`, `Spheroid`, `Ellipsoid`, `Capsule`, `Cylinder`, `Box`, `Revolution` or `NoBody`.

    Attributes
    ----------
    shape
        Word of the spec.
    is_absent
        Whether there is no body, only a tail.
    is_ellipsoid
        Whether its surface is an ellipsoid with half lengths `semi_axes3`, whose resistance is
        known in closed form.
    is_balanced
        Whether its isolated resistance about its centre is diagonal.
    is_mirrored
        Whether the planes of s and q, and of s and r, mirror it into itself.
    of_revolution
        Whether every body of this shape is one of revolution about s.
    """

    shape: ClassVar[str]
    is_absent: ClassVar[bool] = False
    is_ellipsoid: ClassVar[bool] = False
    is_balanced: ClassVar[bool] = True
    is_mirrored: ClassVar[bool] = True
    of_revolution: ClassVar[bool] = True

    @property
    @abstractmethod
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        """Half lengths along s, q, r (length)."""

    @property
    def identity(self) -> str:
        """Text that says its whole shape."""
        return repr(self)

    @property
    def triangles(self) -> Triangles | None:
        """Triangles of a surface that is given by them, None for all others."""
        return None

    @property
    def corners(self) -> Array | None:
        """Points (m, 3) about the centre whose hull, as far out as a radius, is the body, or None.

        Of a box with rounded edges: `Box.fillet` is that radius.
        """
        return None

    @property
    def rim(self) -> tuple[Any, Any, Any] | None:
        """A circle about s on either side of the centre whose hull, as far out as a radius, is the
        body, or None: its distance from the centre, its radius, and how far out.
        """
        return None

    @property
    def exact(self) -> Body:
        """The same body with its exact isolated resistance."""
        return self

    @property
    def centre(self) -> np.ndarray:
        """Centre in the frame ``sqr``, shape (3,): ``(-r_s, 0, 0)``."""
        r_s = self.semi_axes3[0]
        return np.array([-r_s, 0.0 * r_s, 0.0 * r_s])

    @property
    def as_it_stands(self) -> Body:
        """The body in the frame ``sqr``, whoever sees it."""
        return self

    @property
    def behind(self) -> Any:
        """Length behind a tail's root over which the tail may be continued to leave the body."""
        return 2 * self.semi_axes3[0]

    @property
    def is_axisymmetric(self) -> bool:
        """Whether the body is a body of revolution about s."""
        _, r_q, r_r = self.semi_axes3
        return self.of_revolution or bool(np.all(r_q == r_r))

    @abstractmethod
    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        """Return six isolated resistances ``(F_s, F_q, F_r, T_s, T_q, T_r)`` about the centre."""

    def resistance(self, viscosity: float) -> np.ndarray:
        """Return isolated resistance matrix about the centre, shape (6, 6) (exact unless said)."""
        return np.diag(np.array(self.diagonal(viscosity)))

    @abstractmethod
    def level(self, X: Array) -> Array:
        """Return the level function at points (..., 3): negative inside the body, zero on its
        surface.
        """

    @abstractmethod
    def surface_point(self, direction: Array) -> Array:
        """Return points (..., 3) of the surface that unit directions (..., 3) are mapped to."""

    def about(self, X: Array, size: float) -> Body:
        """Return the body as directions map to it about a root.

        Parameters
        ----------
        X
            Where the tail leaves it (3,).
        size
            Half width of the tail.
        """
        return self

    @abstractmethod
    def direction(self, X: Array) -> Array:
        """Return the unit direction (3,) that is mapped to a point (3,) of the surface."""

    @property
    @abstractmethod
    def stretch(self) -> float:
        """Largest length on the surface per angle between directions."""

    @abstractmethod
    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        """Return circle on the unit sphere up to which the surface about a root is free of edges.

        Parameters
        ----------
        pole, first
            Direction of the root, and one across it, (3,) each.
        reach
            Largest angle from `pole` that the root covers.

        Raises
        ------
        SpecError
            If the root reaches an edge.
        """

    @abstractmethod
    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        """Return smooth parts of the surface, `splits` patches along a quarter of its girth.

        All of it, or what lies beyond an `opening`.
        """

    def drawing(self, fineness: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        """Return corners (n, 3) about the centre and quadrilaterals (m, 4), to draw or to write."""
        points, quads = sampled_quads(self.facets(2), max(2, int(6 * fineness)))
        return points - self.centre, quads
