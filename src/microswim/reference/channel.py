"""The vessel around a swimmer: a cylindrical channel or a box, closed or open at its ends.

A plain description; the finite elements (`fem`) build its mesh. Depends on checks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import SpecError


@dataclass(frozen=True, kw_only=True)
class Channel:
    """A channel whose axis is parallel to the swimmer's, unless the swimmer is tilted.

    Parameters
    ----------
    diameter
        Diameter of the cylinder, or width and height of the box (length).
    length
        Length along the axis (length).
    shape
        ``"cylinder"`` or ``"box"``.
    position
        ``(s, q, r)`` of the swimmer's middle (half-way from the nose to the tail's tip) from the
        middle of the channel, in the channel's axes (length).
    tilt
        Angle (rad) by which the swimmer is turned about r against the channel's axis.
    ends
        ``"closed"``: walls, no slip. ``"open"``: free of traction (cylinder and box).

    Raises
    ------
    SpecError
        If a length is not positive, the tilt is beyond a right angle or a word is unknown.

    Examples
    --------
    >>> Channel(diameter=10.0, length=10.0).centred
    True
    """

    diameter: float = 10.0
    length: float = 10.0
    shape: Literal["cylinder", "box"] = "cylinder"
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilt: float = 0.0
    ends: Literal["closed", "open"] = "closed"

    def __post_init__(self) -> None:
        checks.positive("channel.diameter", self.diameter, "length")
        checks.positive("channel.length", self.length, "length")
        checks.choice("channel.shape", self.shape, ("cylinder", "box"))
        checks.choice("channel.ends", self.ends, ("closed", "open"))
        checks.numbers("channel.position", self.position, 3, "three lengths [s, q, r]")
        object.__setattr__(self, "position", tuple(float(x) for x in self.position))
        quarter = math.pi / 2
        checks.number("channel.tilt", self.tilt, "within a right angle (rad)", most=quarter)
        checks.number("channel.tilt", self.tilt, "within a right angle (rad)", least=-quarter)

    @property
    def centred(self) -> bool:
        """Whether a swimmer on the axis of a cylinder sees the same channel from every side."""
        aside = any(self.position[1:])
        return self.shape == "cylinder" and self.tilt == 0.0 and not aside

    @property
    def axes(self) -> np.ndarray:
        """Channel axes (columns: along, across, up) in the swimmer's frame."""
        c, n = math.cos(self.tilt), math.sin(self.tilt)
        return np.array([[c, n, 0.0], [-n, c, 0.0], [0.0, 0.0, 1.0]])

    def clearance(self, points: np.ndarray) -> np.ndarray:
        """Distance to the nearest wall of points (n, 3) in the channel's axes from its middle.

        Negative outside; open ends count as walls.
        """
        end = 0.5 * self.length - np.abs(points[..., 0])
        across = points[..., 1:]
        if self.shape == "cylinder":
            side = 0.5 * self.diameter - np.linalg.norm(across, axis=-1)
        else:
            side = 0.5 * self.diameter - np.max(np.abs(across), axis=-1)
        return np.minimum(end, side)

    def check_fits(self, points: np.ndarray, radii: np.ndarray) -> None:
        """Refuse a swimmer, given as balls (n, 3) and (n,), that touches a wall."""
        if np.min(self.clearance(points) - radii) <= 0:
            raise SpecError(
                "channel.diameter, channel.length",
                (self.diameter, self.length),
                "large enough for the swimmer where it lies",
                "widen the channel or move the swimmer towards its middle",
            )

    @classmethod
    def around(cls, swimmer: Any) -> Channel:
        """The default: ten body diameters wide, and as long (or three swimmers, if longer).

        Table 1 of the paper for its base case [Tabak Sec. 2.2].
        """
        widest = 2.0 * max(swimmer.body.semi_axes3) or swimmer.tail.apparent_length / 2.0
        whole = 2.0 * swimmer.body.semi_axes3[0] + swimmer.tail.apparent_length
        return cls(diameter=10.0 * widest, length=max(10.0 * widest, 3.0 * whole))
