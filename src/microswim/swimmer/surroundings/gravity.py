"""Gravity and buoyancy: what a swimmer weighs in its fluid, and where that weight acts.

Each part of density rho_i and volume V_i weighs ``(rho_i - rho_f) V_i g``, in the middle of its
volume; the body may carry its mass off its middle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.magnetism.applied_field import unit, vector

STANDARD = 9.80665  #: m/s^2, standard acceleration of gravity


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Gravity:
    """Gravity on a swimmer: densities of its parts, direction and size.

    Parameters
    ----------
    density
        Of the whole swimmer, in place of the next two.
    body_density, tail_density
        Of body and tail; both are needed without `density`.
    direction
        In which things fall, a vector in the lab of any length.
    acceleration
        Of gravity; by default 9.80665 m/s^2, and to be given for a swimmer without units.
    centre_of_mass
        Of the body from the middle of its volume, ``(s, q, r)`` (length): not zero for a body that
        is heavier on one side.

    Raises
    ------
    SpecError
        If densities are missing or out of range, or a direction is none.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Gravity(density=1250.0).densities
    (1250.0, 1250.0)
    """

    density: float | None = None
    body_density: float | None = None
    tail_density: float | None = None
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    acceleration: float | None = None
    centre_of_mass: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        parts = (self.body_density, self.tail_density)
        if (self.density is None) == (parts == (None, None)) or (
            self.density is None and None in parts
        ):
            raise SpecError("gravity: give density, or both body_density and tail_density")
        for name in ("density", "body_density", "tail_density"):
            if getattr(self, name) is not None:
                checks.positive(f"gravity.{name}", getattr(self, name), "density")
        if self.acceleration is not None:
            checks.positive("gravity.acceleration", self.acceleration, "acceleration")
        object.__setattr__(self, "direction", vector("gravity.direction", self.direction))
        allowed = "three lengths [s, q, r]"
        checks.numbers("gravity.centre_of_mass", self.centre_of_mass, 3, allowed)
        object.__setattr__(self, "centre_of_mass", tuple(map(float, self.centre_of_mass)))

    @property
    def densities(self) -> tuple[Any, Any]:
        """Density of the body and of the tail."""
        if self.density is not None:
            return self.density, self.density
        return self.body_density, self.tail_density

    @property
    def vector(self) -> np.ndarray:
        """Acceleration (3,) in the lab frame."""
        size = STANDARD if self.acceleration is None else self.acceleration
        return size * unit(self.direction)

    def check_units(self, units: str, fluid_density: float) -> None:
        """Refuse gravity without the numbers that it needs: its size, and the fluid's density.

        Raises
        ------
        SpecError
            If one is missing.
        """
        if units != "SI" and self.acceleration is None:
            raise SpecError("gravity.acceleration: missing; give it, the spec has no units")
        if units == "SI" and not fluid_density:
            raise SpecError("fluid.density: missing; the buoyancy needs it, so add it")
