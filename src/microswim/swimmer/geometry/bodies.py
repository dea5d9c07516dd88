"""Bodies by their words, and the ellipsoids with their exact isolated resistance.

Holds the resistance of an ellipsoid (Oberbeck 1876 for translation, Edwardes 1892 and Perrin
1934 for rotation) through Carlson's symmetric integrals, and Eqs. (18), (19) of the paper as an
option of the spheroid. The frame is ``sqr``: the body touches the origin (the joint) with its
rear pole, its centre is at ``(-r_s, 0, 0)``.

All formulas accept arrays and complex numbers (for the complex-step derivative); the fields are
checked on construction.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from microswim import checks
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.box import Box
from microswim.swimmer.geometry.solids.facets import Facet, Opening
from microswim.swimmer.geometry.solids.round import Capsule, Cylinder, Revolution
from microswim.swimmer.geometry.solids.spheres import cubed_sphere, half_sphere, sphere_grid
from microswim.swimmer.geometry.solids.surface_file import SurfaceFile


def ellipsoid_resistance(semi_axes: tuple[Any, Any, Any], viscosity: Any) -> tuple[Any, ...]:
    r"""Return six diagonal resistances of an isolated ellipsoid, ``(s, q, r)`` force then torque.

    .. math:: \chi = \int_0^\infty d\lambda/\Delta, \quad
              \alpha_i = \int_0^\infty d\lambda/((a_i^2+\lambda)\Delta), \quad
              \Delta^2 = \prod_i (a_i^2 + \lambda)

    .. math:: D_{N,i} = 16\pi\mu/(\chi + \alpha_i a_i^2), \quad
              D_{R,i} = 16\pi\mu (a_j^2+a_k^2) / (3(a_j^2\alpha_j + a_k^2\alpha_k))

    with :math:`\chi = 2 R_F` and :math:`\alpha_i = \tfrac23 R_D` (Kim & Karrila,
    Microhydrodynamics, 1991, table 3.3; Carlson's integrals).
    """
    from scipy.special import elliprd, elliprf  # a tenth of a second that a sphere need not wait

    a2 = [np.asarray(a) ** 2 for a in semi_axes]
    chi = 2.0 * elliprf(*a2)
    shape = [a2[i] * (2.0 / 3.0) * elliprd(a2[i - 2], a2[i - 1], a2[i]) for i in range(3)]
    force = [16.0 * np.pi * viscosity / (chi + shape[i]) for i in range(3)]
    torque = [
        16.0 * np.pi * viscosity * (a2[i - 2] + a2[i - 1]) / (3.0 * (shape[i - 2] + shape[i - 1]))
        for i in range(3)
    ]
    return (*force, *torque)


class EllipsoidalBody(Body):
    """A body whose surface is an ellipsoid: the unit sphere stretched along s, q, r."""

    is_ellipsoid: ClassVar[bool] = True

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        return ellipsoid_resistance(self.semi_axes3, viscosity)

    def level(self, X: Array) -> Array:
        scaled = (X - np.real(self.centre)) / np.real(np.asarray(self.semi_axes3))
        return np.sum(scaled**2, axis=-1) - 1.0

    def surface_point(self, direction: Array) -> Array:
        return self.centre + np.asarray(self.semi_axes3, float) * direction

    def direction(self, X: Array) -> Array:
        scaled = (X - self.centre) / np.asarray(self.semi_axes3, float)
        return scaled / np.linalg.norm(scaled)

    @property
    def stretch(self) -> float:
        return float(max(self.semi_axes3))

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        """Return the equator about the root: an ellipsoid has no edges."""
        return Opening(np.array([pole, first, np.cross(pole, first)]), 0.5 * np.pi)

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        """Return a cubed sphere, stretched; beyond the equator half of one."""
        side = splits + int(max(self.semi_axes3) > 1.5 * min(self.semi_axes3))
        if opening is None:
            return [f.mapped(self.surface_point) for f in cubed_sphere(side)]
        pole, first, second = opening.axes
        return [f.mapped(self.surface_point) for f in half_sphere(-pole, second, first, side)]

    def drawing(self, fineness: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        """Return a grid of the two angles."""
        points, quads = sphere_grid(int(24 * fineness) + 1, int(36 * fineness))
        return points * np.array(self.semi_axes3), quads


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Sphere(EllipsoidalBody):
    """Sphere of the given radius, Stokes resistance ``6 pi mu a`` and ``8 pi mu a^3``.

    Parameters
    ----------
    radius
        Radius (length), positive.

    Raises
    ------
    SpecError
        If the radius is not a positive number.

    Examples
    --------
    >>> import microswim as ms
    >>> float(ms.Sphere(radius=0.5).resistance(100.0)[0, 0].round(1))
    942.5
    """

    radius: float
    shape: ClassVar[str] = "sphere"

    def __post_init__(self) -> None:
        checks.positive("body.radius", self.radius, "length")

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        return (self.radius, self.radius, self.radius)

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        force = 6.0 * np.pi * viscosity * self.radius
        torque = 8.0 * np.pi * viscosity * self.radius**3
        return (force,) * 3 + (torque,) * 3


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Spheroid(EllipsoidalBody):
    """Spheroid of revolution about s, prolate or oblate.

    Parameters
    ----------
    semi_axes
        ``(r_s, r_q)``: half length along s, half width (length), both positive.
    drag
        ``"exact"`` (Oberbeck, Perrin; default) or ``"slender"``: the slender limit that the
        paper uses, Eqs. (18), (19), with the companion formulas across the axis (Berg, Random
        walks in biology, 1993). It needs ``r_s > r_q``; for a 3:1 spheroid Eq. (18) is 10 % high
        and Eq. (19) 11 % low.

    Raises
    ------
    SpecError
        If a semi-axis is not positive, or ``drag="slender"`` on a body that is not prolate.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Spheroid(semi_axes=(1.38, 0.405), drag="slender").is_axisymmetric
    True
    """

    semi_axes: tuple[float, float]
    drag: Literal["exact", "slender"] = "exact"
    shape: ClassVar[str] = "spheroid"

    def __post_init__(self) -> None:
        checks.numbers(
            "body.semi_axes", self.semi_axes, 2, "two positive lengths [r_s, r_q]", above=0.0
        )
        object.__setattr__(self, "semi_axes", tuple(self.semi_axes))
        checks.choice("body.drag", self.drag, ("exact", "slender"))
        r_s, r_q = self.semi_axes
        if self.drag == "slender" and r_s <= r_q:
            raise checks.SpecError(
                "body.semi_axes",
                self.semi_axes,
                'prolate (r_s > r_q) for drag = "slender"',
                'use drag = "exact"',
            )

    @property
    def exact(self) -> Body:
        return self if self.drag == "exact" else replace(self, drag="exact")

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        r_s, r_q = self.semi_axes
        return (r_s, r_q, r_q)

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        """Return six isolated resistances, exact or the paper's.

        ``D_N,s = 4 pi mu r_s / (log(2 r_s / r_q) - 1/2)``   [Tabak Eq. 18]
        ``D_R,s = (16/3) pi mu r_s r_q^2``                   [Tabak Eq. 19]
        """
        if self.drag == "exact":
            return super().diagonal(viscosity)
        r_s, r_q = self.semi_axes
        log = np.log(2.0 * r_s / r_q)
        along = 4.0 * np.pi * viscosity * r_s / (log - 0.5)
        across = 8.0 * np.pi * viscosity * r_s / (log + 0.5)
        roll = 16.0 / 3.0 * np.pi * viscosity * r_s * r_q**2
        turn = 8.0 / 3.0 * np.pi * viscosity * r_s**3 / (log - 0.5)
        return (along, across, across, roll, turn, turn)


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Ellipsoid(EllipsoidalBody):
    """Ellipsoid with three semi-axes along s, q, r.

    Parameters
    ----------
    semi_axes
        ``(r_s, r_q, r_r)`` (length), all positive.

    Raises
    ------
    SpecError
        If a semi-axis is not positive.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Ellipsoid(semi_axes=(1.0, 0.5, 0.25)).resistance(1.0).shape
    (6, 6)
    """

    semi_axes: tuple[float, float, float]
    shape: ClassVar[str] = "ellipsoid"
    of_revolution: ClassVar[bool] = False

    def __post_init__(self) -> None:
        checks.numbers(
            "body.semi_axes", self.semi_axes, 3, "three positive lengths [r_s, r_q, r_r]", above=0.0
        )
        object.__setattr__(self, "semi_axes", tuple(self.semi_axes))

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        return self.semi_axes


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class NoBody(Body):
    """No body: an isolated tail. The reference point is the near end of its axis.

    Examples
    --------
    >>> import microswim as ms
    >>> float(ms.NoBody().resistance(1.0).sum())
    0.0
    """

    shape: ClassVar[str] = "none"
    is_absent: ClassVar[bool] = True

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        return (0.0, 0.0, 0.0)

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        return (0.0 * viscosity,) * 6

    def level(self, X: Array) -> Array:
        return np.full(np.shape(X)[:-1], np.inf)

    def surface_point(self, direction: Array) -> Array:
        raise self._nothing()

    def direction(self, X: Array) -> Array:
        raise self._nothing()

    @property
    def stretch(self) -> float:
        return 0.0

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        raise self._nothing()

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        return []

    def drawing(self, fineness: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        return np.empty((0, 3)), np.empty((0, 4), int)

    def _nothing(self) -> checks.SpecError:
        return checks.SpecError("body.shape", "none", "a body here", "it has no surface")


SHAPES: dict[str, type[Body]] = {
    b.shape: b
    for b in (Sphere, Spheroid, Ellipsoid, Capsule, Cylinder, Box, Revolution, SurfaceFile, NoBody)
}
