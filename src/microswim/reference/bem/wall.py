"""A plane no-slip wall beside the swimmer, by Blake's image tensor.

Blake, J. R. (1971) Proc. Camb. Phil. Soc. 70, 303-310. The wall is fixed in the swimmer's frame: a
gait beside a wall holds at that pose. Depends on numpy, errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.errors import SpecError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Wall:
    """Plane wall in the frame `sqr`.

    Parameters
    ----------
    distance : float
        From the body's centre to the wall (without a body: from the joint).
    normal : tuple of 3
        Normal of the wall, into the fluid, in the body's axes (s, q, r); any length.
    """

    distance: float
    normal: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        if not self.distance > 0:
            raise SpecError("wall.distance", self.distance, "a positive length")
        if not np.linalg.norm(self.normal) > 0:
            raise SpecError("wall.normal", self.normal, "a direction of length above zero")

    @classmethod
    def tilted(cls, distance: float, tilt: float = 0.0, azimuth: float = 0.0) -> Wall:
        """Wall by the swimmer's pose above it.

        Parameters
        ----------
        distance : float
            From the body's centre to the wall.
        tilt : float
            Angle (rad) between the s axis and the wall; positive: the body noses towards the wall.
        azimuth : float
            Angle (rad) about s from q to the side that faces away from the wall.
        """
        flat = np.cos(tilt)
        normal = (np.sin(tilt), flat * np.cos(azimuth), flat * np.sin(azimuth))
        return cls(distance, tuple(float(n) for n in normal))

    def plane(self, centre: Array) -> Array:
        """Point and unit normal (6,) of the wall for a body centred at `centre`."""
        n = np.asarray(self.normal, float)
        n = n / np.linalg.norm(n)
        return np.concatenate([np.asarray(centre, float) - self.distance * n, n])

    def check(self, surface: Any, centre: Array) -> None:
        """Refuse a swimmer that reaches into the wall."""
        plane = self.plane(centre)
        gap = float(((surface.controls - plane[:3]) @ plane[3:]).min())
        if gap <= 0:
            raise SpecError(
                "wall.distance",
                self.distance,
                f"more than {self.distance - gap:.4g}, where the swimmer touches the wall",
                "move the wall away or tilt the swimmer",
            )
