"""What bounds the fluid: a plane wall, or a vessel (a cylindrical channel or a box).

Plain descriptions, fixed in the swimmer's frame: a gait beside a wall holds at that pose. The
boundary elements know the wall and the tube, the finite elements the vessel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.numerics.array import Array
from microswim.swimmer.geometry.extent import nose_to_tip

ALONG = 1e-9  # a component of a unit vector below this is rounding


@checks.by_name
@dataclass(frozen=True)
class Wall:
    """A plane no-slip wall beside the swimmer; ``model = "bem"`` knows it.

    Parameters
    ----------
    distance
        From the body's centre to the wall (length; without a body: from the joint).
    tilt
        Angle (rad) between the s axis and the wall; positive: the body noses towards the wall.
    azimuth
        Angle (rad) about s from q to the side that faces away from the wall.

    Raises
    ------
    SpecError
        If the distance is not positive or an angle is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Wall(2.0).normal
    (0.0, 1.0, 0.0)
    """

    distance: float
    tilt: float = 0.0
    azimuth: float = 0.0

    def __post_init__(self) -> None:
        checks.positive("wall.distance", self.distance, "length")
        _angle("wall.tilt", self.tilt, math.pi / 2, "within a right angle (rad)")
        _angle("wall.azimuth", self.azimuth, 2 * math.pi, "within a full turn (rad)")

    @property
    def normal(self) -> tuple[float, float, float]:
        """Unit normal of the wall, into the fluid, in the body's axes (s, q, r)."""
        flat = math.cos(self.tilt)
        across = flat * math.cos(self.azimuth), flat * math.sin(self.azimuth)
        return (math.sin(self.tilt), *across)

    def plane(self, centre: Any) -> Array:
        """Return the point and unit normal (6,) of the wall for a body centred at `centre`."""
        n = np.array(self.normal)
        return np.concatenate([np.asarray(centre, float) - self.distance * n, n])

    def stays(self, free: Sequence[bool]) -> bool:
        """Return whether the wall stays where it is, seen from a swimmer with these freedoms.

        It does if the swimmer slides along the wall and turns about nothing but its normal.
        """
        across = np.abs(self.normal) > ALONG
        slides = not (across & np.array(free[:3])).any()
        turns = across.sum() > 1 or (~across & np.array(free[3:])).any()
        return bool(slides and not (turns and any(free[3:])))

    def check_clear(self, points: Array, centre: Any) -> None:
        """Refuse a swimmer, given by points (n, 3) of its surface, that reaches into the wall."""
        plane = self.plane(centre)
        gap = float(((points - plane[:3]) @ plane[3:]).min())
        if gap <= 0:
            raise SpecError(
                "wall.distance",
                self.distance,
                f"more than {measured(self.distance - gap, 'wall.distance')}, where the swimmer "
                "touches the wall",
                "move the wall away or tilt the swimmer",
            )


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Channel:
    """A vessel whose axis is parallel to the swimmer's, unless tilted.

    ``model = "fem"`` knows it, and ``model = "bem"`` if it is a cylinder.

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
    azimuth
        Angle (rad) about s of the axis about which it is turned by the tilt, from r.
    ends
        ``"closed"``: walls, no slip. ``"open"``: free of traction (by boundary elements: into fluid
        at rest).

    Raises
    ------
    SpecError
        If a length is not positive, the tilt is beyond a right angle or a word is unknown.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Channel(diameter=10.0, length=10.0).centred
    True
    """

    diameter: float = 10.0
    length: float = 10.0
    shape: Literal["cylinder", "box"] = "cylinder"
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilt: float = 0.0
    azimuth: float = 0.0
    ends: Literal["closed", "open"] = "closed"

    def __post_init__(self) -> None:
        checks.positive("channel.diameter", self.diameter, "length")
        checks.positive("channel.length", self.length, "length")
        checks.choice("channel.shape", self.shape, ("cylinder", "box"))
        checks.choice("channel.ends", self.ends, ("closed", "open"))
        checks.numbers("channel.position", self.position, 3, "three lengths [s, q, r]")
        object.__setattr__(self, "position", tuple(float(x) for x in self.position))
        _angle("channel.tilt", self.tilt, math.pi / 2, "within a right angle (rad)")
        _angle("channel.azimuth", self.azimuth, 2 * math.pi, "within a full turn (rad)")

    @property
    def is_cylinder(self) -> bool:
        """Whether it is a tube, else a box."""
        return self.shape == "cylinder"

    @property
    def centred(self) -> bool:
        """Whether a swimmer on the axis of a cylinder sees the same channel from every side."""
        aside = any(self.position[1:])
        return self.is_cylinder and self.tilt == 0.0 and not aside

    def stays(self, free: Sequence[bool]) -> bool:
        """Return whether the channel stays where it is, seen from a swimmer with these freedoms.

        It does on the axis of a cylinder (as long as the swimmer does not leave it), and for a
        swimmer that does nothing but slide along a channel which is not tilted.
        """
        return self.centred or not any(free[0 if self.tilt else 1 :])

    @property
    def axes(self) -> np.ndarray:
        """Channel axes (columns: along, across, up) in the swimmer's frame."""
        c, n = math.cos(self.tilt), math.sin(self.tilt)
        a, b = math.cos(self.azimuth), math.sin(self.azimuth)
        return np.array([[c, n, 0.0], [-n * a, c * a, -b], [-n * b, c * b, a]])

    def clearance(self, points: np.ndarray) -> np.ndarray:
        """Return the distance to the nearest wall of points (n, 3) in the channel's axes from its
        middle.

        Negative outside; open ends count as walls.
        """
        end = 0.5 * self.length - np.abs(points[..., 0])
        across = points[..., 1:]
        if self.is_cylinder:
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
        """Return the default: ten body diameters wide, and as long (or three swimmers, if longer).

        Table 1 of the paper for its base case [Tabak Sec. 2.2].
        """
        widest = 2.0 * max(swimmer.body.semi_axes3) or swimmer.tail.apparent_length / 2.0
        return cls(diameter=10.0 * widest, length=max(10.0 * widest, 3.0 * nose_to_tip(swimmer)))


def _angle(field: str, value: Any, most: float, allowed: str) -> None:
    checks.number(field, value, allowed, least=-most, most=most)
