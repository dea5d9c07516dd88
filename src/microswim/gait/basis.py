"""What the quantities of one gait are made of, each part computed when it is asked for."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.screw import screw
from microswim.gait.turning.driven_speed import driven_velocity
from microswim.gait.turning.step_out import Drive, fastest, onset
from microswim.numerics.rigid_motion import ScrewMotion


class Basis:
    """What the quantities of one gait are made of; each part is computed when it is asked for.

    Parameters
    ----------
    gait
        Of any model; its series may be complex.
    body_length
        Length of the body along s, for what is counted in body lengths.
    drive
        Magnet and rotating field, for step-out and the like.
    """

    def __init__(self, gait: Gait, body_length: Any = None, drive: Drive | None = None) -> None:
        self.gait, self._length, self._drive = gait, body_length, drive

    def __getattr__(self, name: str) -> Any:
        """Return a number that the gait itself states."""
        return getattr(self.gait, name)

    @cached_property
    def _screw(self) -> ScrewMotion:
        return screw(self.gait)

    @property
    def swimming_speed(self) -> Any:
        return self._screw.speed

    @property
    def path_speed(self) -> Any:
        return self._screw.path_speed

    @property
    def path_radius(self) -> Any:
        return self._screw.radius

    @property
    def path_pitch(self) -> Any:
        return self._screw.pitch

    @property
    def rotation_per_period(self) -> Any:
        return self._screw.angle

    @property
    def efficiency(self) -> Any:
        """Eq. (24); NaN if the model did not tell the body's share."""
        return np.nan if self.gait.body_resistance_series is None else self.gait.efficiency

    @cached_property
    def fastest(self) -> tuple[Any, Any]:
        return fastest(self.gait, self._driven)

    @cached_property
    def onset(self) -> Any:
        return onset(self.gait, self._driven)

    @cached_property
    def driven_velocity(self) -> Any:
        return driven_velocity(self.gait, self._driven)

    @property
    def _driven(self) -> Drive:
        if self._drive is None:
            raise SpecError(
                "quantity: this one needs a swimmer with [magnet] and a rotating [field]"
            )
        return self._drive

    @property
    def body_length(self) -> Any:
        if self._length is None:
            raise SpecError("quantity: what is counted in body lengths needs the swimmer")
        return self._length
