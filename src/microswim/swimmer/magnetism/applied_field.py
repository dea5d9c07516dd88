"""Fields that do not depend on place: uniform, rotating, oscillating. Lab frame.

A magnetic moment m feels the torque ``m x B`` and the force ``grad(m . B)``; the second is zero
here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError


class AppliedField(ABC):
    """A magnetic field. Use `RotatingField` or another of its kinds.

    Attributes
    ----------
    kind
        Word of the spec.
    is_periodic
        Whether it is ``B_0 + B_1 cos(w t) + B_2 sin(w t)``, the same everywhere.
    needs_si
        Whether it is one of SI alone, since the vacuum's permeability is in it.
    """

    kind: ClassVar[str]
    is_periodic: ClassVar[bool] = True
    needs_si: ClassVar[bool] = False

    @abstractmethod
    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at times (...) and places (..., 3), lab frame."""

    def gradient(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return ``dB_i/dx_j`` (..., 3, 3); zero where the field does not depend on place."""
        shape = np.broadcast_shapes(np.shape(times), np.shape(places)[:-1])
        return np.zeros((*shape, 3, 3))

    def felt(self, time: float, place: Any = (0.0, 0.0, 0.0)) -> dict[str, np.ndarray]:
        """Return what a stepper takes for a step that begins at a time and a place (..., 3).

        ``field``, and ``field_rate`` if it turns, or ``field_gradient`` and ``field_place`` if it
        depends on place.
        """
        return {"field": self.at(time, place), "field_rate": self.angular_velocity}

    @property
    def angular_velocity(self) -> np.ndarray:
        """Vector (3,) with which the field turns, rad per time; zero if it does not."""
        return np.zeros(3)

    @property
    def rate(self) -> float:
        """How fast it changes (rad per time)."""
        return 0.0


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class UniformField(AppliedField):
    """A field that stays as it is.

    Parameters
    ----------
    strength
        Size of B, positive: T, or of a swimmer without units.
    direction
        Vector in the lab, of any length.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.UniformField(strength=5e-3, direction=(0, 0, 2)).at(1.0)
    array([0.   , 0.   , 0.005])
    """

    kind: ClassVar[str] = "uniform"

    strength: float
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checks.positive("field.strength", self.strength)
        object.__setattr__(self, "direction", vector("field.direction", self.direction))

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at the times, the same everywhere."""
        return self.strength * unit(self.direction) * np.ones_like(times, float)[..., None]


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class RotatingField(AppliedField):
    """A field that turns steadily about an axis.

    ``B = strength (sin(cone) a + cos(cone) (e1 cos(w t) + e2 sin(w t)))`` with the unit vector a
    of the axis; e1, e2 and a are a right-handed set. About x, e1 is y and e2 is z.

    Parameters
    ----------
    strength
        Size of B, positive: T, or of a swimmer without units.
    frequency
        Turns per time, not zero; negative: the other way round.
    axis
        Vector in the lab, of any length.
    cone
        Angle (rad) by which the field leans out of its plane, towards the axis; zero: it turns in
        the plane.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> field = ms.RotatingField(strength=5e-3, frequency=10.0)
    >>> field.at(0.025).round(6)
    array([0.   , 0.   , 0.005])
    """

    kind: ClassVar[str] = "rotating"

    strength: float
    frequency: float
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    cone: float = 0.0

    def __post_init__(self) -> None:
        checks.positive("field.strength", self.strength)
        checks.number("field.frequency", self.frequency, "a finite number")
        if self.frequency == 0:
            raise SpecError(
                "field.frequency", self.frequency, "other than zero", 'or kind = "uniform"'
            )
        object.__setattr__(self, "axis", vector("field.axis", self.axis))
        most = 1.5707
        checks.number("field.cone", self.cone, "below a right angle (rad)", least=-most, most=most)

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at the times, the same everywhere."""
        angle = 2.0 * np.pi * self.frequency * np.asarray(times, float)[..., None]
        first, second = across(self.axis)
        round_it = np.cos(angle) * first + np.sin(angle) * second
        lean = np.sin(self.cone) * unit(self.axis)
        return self.strength * (lean + np.cos(self.cone) * round_it)

    @property
    def angular_velocity(self) -> np.ndarray:
        """Vector (3,) with which the field turns, rad per time."""
        return 2.0 * np.pi * self.frequency * unit(self.axis)

    @property
    def rate(self) -> float:
        """How fast it turns (rad per time)."""
        return abs(2.0 * np.pi * self.frequency)


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class OscillatingField(AppliedField):
    """A field that goes to and fro along a line, ``strength cos(w t)``.

    Parameters
    ----------
    strength
        Largest size of B, positive: T, or of a swimmer without units.
    frequency
        Cycles per time, positive.
    direction
        Vector in the lab, of any length.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.OscillatingField(strength=2.0, frequency=1.0).at([0.0, 0.5]).round(6)[:, 0]
    array([ 2., -2.])
    """

    kind: ClassVar[str] = "oscillating"

    strength: float
    frequency: float
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checks.positive("field.strength", self.strength)
        checks.positive("field.frequency", self.frequency)
        object.__setattr__(self, "direction", vector("field.direction", self.direction))

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at the times, the same everywhere."""
        angle = 2.0 * np.pi * self.frequency * np.asarray(times, float)[..., None]
        return self.strength * unit(self.direction) * np.cos(angle)

    @property
    def rate(self) -> float:
        """How fast it changes (rad per time)."""
        return 2.0 * np.pi * self.frequency


def unit(vector: Any) -> np.ndarray:
    """Return a vector of length one."""
    v = np.asarray(vector) + 0.0
    return v / np.sqrt(v @ v)


def across(axis: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors that make a right-handed set with an axis: e1, e2, a."""
    a = unit(axis)
    start = np.eye(3)[1 if abs(a[0]) > 0.9 else 0]
    first = unit(start - (start @ a) * a)
    return first, np.cross(a, first)


def vector(field: str, value: Any) -> tuple[float, ...]:
    """Return a vector of the lab as three numbers; refuse what is none, or zero."""
    checks.numbers(field, value, 3, "three numbers [x, y, z]")
    vector = tuple(float(x) for x in value)
    if not any(vector):
        raise SpecError(field, value, "a vector other than zero")
    return vector
