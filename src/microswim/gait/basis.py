"""What the quantities of one gait are made of, each part computed when it is asked for."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.screw import average_radius, screw
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

    @cached_property
    def _bent(self) -> tuple[Any, Any]:
        return self._screw.bent(average_radius(self.gait, self._screw))

    @property
    def path_curvature(self) -> Any:
        return self._bent[0]

    @property
    def path_torsion(self) -> Any:
        return self._bent[1]

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


#: Share of what a number is made of, below which it is rounding.
ROUNDING = 1e-12


class Rounded(Basis):
    """The same for people and files: what is but rounding of sums that cancel is zero."""

    @cached_property
    def _lever(self) -> Any:
        R = np.real(np.diagonal(self.gait.resistance_series[0]))
        return np.sqrt(R[3:].max() / R[:3].max())

    @cached_property
    def _sizes(self) -> np.ndarray:
        """Largest velocity and rate of rotation at any time, each over the swimmer's length too."""
        length = self._lever
        most = np.abs(self.gait.mean_velocity) + np.abs(self.gait.velocity_amplitude)
        size = max(most[:3].max(), length * most[3:].max())
        return np.repeat([size, size / length], 3)

    @cached_property
    def mean_velocity(self) -> np.ndarray:
        return _settled(self.gait.mean_velocity, self._sizes)

    @cached_property
    def velocity_amplitude(self) -> np.ndarray:
        return _settled(self.gait.velocity_amplitude, self._sizes)

    @property
    def swimming_speed(self) -> Any:
        return _settled(self._screw.speed, self._screw.path_speed)

    @property
    def path_radius(self) -> Any:
        return _settled(self._screw.radius, self._lever)

    @property
    def path_curvature(self) -> Any:
        return _settled(self._bent[0], 1.0 / self._lever)

    @property
    def path_pitch(self) -> Any:
        return 0.0 * self._screw.angle if self.swimming_speed == 0.0 else self._screw.pitch

    @property
    def path_torsion(self) -> Any:
        return 0.0 * self._screw.angle if self.swimming_speed == 0.0 else self._bent[1]


def _settled(value: Any, size: Any) -> Any:
    return np.where(np.abs(value) <= ROUNDING * size, 0.0, value)[()]
