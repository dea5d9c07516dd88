"""Background flows of Stokes' equations: uniform, linear, Poiseuille's. Lab frame.

    u(x) = u_0 + A (x - p) - U (|y|^2 / a^2) e,    y the part of x - p across the axis e

with a gradient A free of trace; the last term is that of a tube of radius a alone.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.magnetism.applied_field import unit, vector


class Flow(ABC):
    """A background flow. Use `ShearFlow` or another of its kinds.

    Attributes
    ----------
    kind
        Word of the spec.
    bends
        Whether its gradient depends on place.
    """

    kind: ClassVar[str]
    bends: ClassVar[bool] = False

    @abstractmethod
    def at(self, places: Any) -> np.ndarray:
        """Return the velocity (..., 3) at places (..., 3)."""

    @property
    def at_origin(self) -> np.ndarray:
        """Velocity (3,) at the lab's origin."""
        return self.at(np.zeros(3))

    @property
    def gradient(self) -> np.ndarray:
        """``du_i/dx_j`` (3, 3) of the part that is linear in place."""
        return np.zeros((3, 3))


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class UniformFlow(Flow):
    """A flow that is the same everywhere.

    Parameters
    ----------
    speed
        Of the fluid.
    direction
        Vector in the lab, of any length.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.UniformFlow(speed=2.0, direction=(0, 0, 3)).at((1.0, 0.0, 0.0))
    array([0., 0., 2.])
    """

    kind: ClassVar[str] = "uniform"

    speed: float
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checks.number("flow.speed", self.speed, "a finite speed")
        object.__setattr__(self, "direction", vector("flow.direction", self.direction))

    def at(self, places: Any) -> np.ndarray:
        """Return the velocity (..., 3) at places (..., 3), the same everywhere."""
        return self.speed * unit(self.direction) + 0.0 * np.asarray(places)


class LinearFlow(Flow):
    """A flow whose gradient is the same everywhere, at rest at the lab's origin."""

    def at(self, places: Any) -> np.ndarray:
        """Return the velocity (..., 3) at places (..., 3)."""
        return np.asarray(places) @ self.gradient.T


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class ShearFlow(LinearFlow):
    """A simple shear: layers that slide over one another, at rest at the lab's origin.

    Parameters
    ----------
    rate
        Change of velocity per distance between layers (1/time).
    direction
        In which the layers slide, a vector in the lab.
    across
        From layer to layer, a vector perpendicular to it; above a floor z.

    Raises
    ------
    SpecError
        If a field is out of range, or the two directions are not perpendicular.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.ShearFlow(rate=2.0).at((0.0, 0.0, 3.0))
    array([6., 0., 0.])
    """

    kind: ClassVar[str] = "shear"

    rate: float
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    across: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        checks.number("flow.rate", self.rate, "a finite rate")
        for name in ("direction", "across"):
            object.__setattr__(self, name, vector(f"flow.{name}", getattr(self, name)))
        if abs(unit(self.direction) @ unit(self.across)) > 1e-9:
            raise SpecError("flow.across", self.across, "perpendicular to flow.direction")

    @property
    def gradient(self) -> np.ndarray:
        """``du_i/dx_j`` (3, 3)."""
        return self.rate * np.outer(unit(self.direction), unit(self.across))


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class StrainFlow(LinearFlow):
    """A pure strain: the fluid is drawn out along one direction, at rest at the lab's origin.

    Parameters
    ----------
    rate
        Rate of stretching (1/time); negative: the fluid is pressed together along `direction`.
    direction
        Along which it stretches, a vector in the lab.
    compression
        Along which it is pressed together in turn, perpendicular to it (planar strain); by default
        evenly from all sides (axisymmetric strain).

    Raises
    ------
    SpecError
        If a field is out of range, or the two directions are not perpendicular.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.StrainFlow(rate=2.0).at((1.0, 1.0, 0.0))
    array([ 2., -1.,  0.])
    """

    kind: ClassVar[str] = "strain"

    rate: float
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    compression: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        checks.number("flow.rate", self.rate, "a finite rate")
        object.__setattr__(self, "direction", vector("flow.direction", self.direction))
        if self.compression is not None:
            other = vector("flow.compression", self.compression)
            object.__setattr__(self, "compression", other)
            if abs(unit(self.direction) @ unit(other)) > 1e-9:
                raise SpecError("flow.compression", other, "perpendicular to flow.direction")

    @property
    def gradient(self) -> np.ndarray:
        """``du_i/dx_j`` (3, 3), symmetric and free of trace."""
        d = unit(self.direction)
        along = np.outer(d, d)
        if self.compression is None:
            return self.rate * (1.5 * along - 0.5 * np.eye(3))
        c = unit(self.compression)
        return self.rate * (along - np.outer(c, c))


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class RotationFlow(LinearFlow):
    """A fluid that turns like a rigid body about an axis through the lab's origin.

    Parameters
    ----------
    rate
        Angular velocity (rad per time), half of the vorticity.
    axis
        Vector in the lab, of any length.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.RotationFlow(rate=2.0).at((1.0, 0.0, 0.0))
    array([0., 2., 0.])
    """

    kind: ClassVar[str] = "rotation"

    rate: float
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        checks.number("flow.rate", self.rate, "a finite rate")
        object.__setattr__(self, "axis", vector("flow.axis", self.axis))

    @property
    def gradient(self) -> np.ndarray:
        """``du_i/dx_j`` (3, 3), antisymmetric."""
        return self.rate * np.cross(np.eye(3), unit(self.axis))


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class PoiseuilleFlow(Flow):
    """The flow of a long round tube, ``speed (1 - (r / a)^2)`` along its axis.

    Parameters
    ----------
    speed
        On the axis, twice the mean.
    diameter
        Of the tube, 2 a (length).
    axis
        Direction of the flow, a vector in the lab.
    centre
        A point of the axis, lab frame (length).

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.PoiseuilleFlow(speed=1.0, diameter=4.0).at((7.0, 0.0, 1.0))
    array([0.75, 0.  , 0.  ])
    """

    kind: ClassVar[str] = "poiseuille"
    bends: ClassVar[bool] = True

    speed: float
    diameter: float
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checks.number("flow.speed", self.speed, "a finite speed")
        checks.positive("flow.diameter", self.diameter, "length")
        object.__setattr__(self, "axis", vector("flow.axis", self.axis))
        checks.numbers("flow.centre", self.centre, 3, "three lengths [x, y, z]")
        object.__setattr__(self, "centre", tuple(map(float, self.centre)))

    def at(self, places: Any) -> np.ndarray:
        """Return the velocity (..., 3) at places (..., 3), as if the tube had no wall."""
        e, away = unit(self.axis), np.asarray(places) - self.centre
        across = away - (away @ e)[..., None] * e
        share = np.sum(across**2, axis=-1) * (2.0 / self.diameter) ** 2
        return self.speed * (1.0 - share)[..., None] * e


FLOWS: dict[str, type[Flow]] = {
    f.kind: f for f in (UniformFlow, ShearFlow, StrainFlow, RotationFlow, PoiseuilleFlow)
}
