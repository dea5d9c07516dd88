"""A gait as a function of the pose: what a swimmer's R and F_p are wherever it is.

    R(x, q, phi) V + F_p(x, q, phi) rate = W_external

In free fluid only the phase matters. A plane wall and a tube are fixed in the lab, so that what the
swimmer feels changes along its path: `microswim.path` asks at every step. Where the boundary is:

- The wall of ``[wall]`` is the plane z = 0 of the lab, the fluid above it. A path starts with the
  body's centre at ``(0, 0, distance)`` and the s axis along +x (turned up or down by the tilt), so
  that the swimmer sets off towards -x as it does in free fluid; the azimuth is its turn about s.
- The axis of the tube of ``[channel]`` is the x axis of the lab, whose axes are the channel's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.poses.table import TUBE, WORK, PoseTable, free_table, resist
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import rotation_matrix


class Poses(Protocol):
    """What follows a path asks of a gait that depends on the pose.

    Positions are of the body's centre, lab frame; quaternions ``wxyz``, body to lab; phases in
    radians; R and F_p in the body frame about the body's centre.
    """

    @property
    def gait(self) -> Gait:
        """The gait in free fluid: its rate, free axes, units and activity hold everywhere."""
        ...

    @property
    def table(self) -> PoseTable:
        """Plain arrays for the compiled `pose_table.resist`."""
        ...

    @property
    def start(self) -> tuple[Array, Array]:
        """Position (3,) and quaternion (4,) of the pose that the spec states."""
        ...

    @property
    def expected_error(self) -> dict[str, Any]:
        """How far R and F_p may be from what was interpolated, and how that is known."""
        ...

    def at(self, position: Any, quaternion: Any, phase: float) -> tuple[Array, Array]:
        """Return R (6, 6), symmetric positive definite, and F_p (6,) per unit phase rate."""
        ...

    def touch(self, position: Any, quaternion: Any, phase: float) -> tuple[float, Array, Array]:
        """Return the gap, the surface's nearest point (3,) and the boundary's normal (3,) there.

        Point from the body's centre and unit normal into the fluid, both in the body frame; both
        zero in free fluid.
        """
        ...

    def gap(self, position: Any, quaternion: Any, phase: float) -> float:
        """Return the smallest distance of the surface to the boundary, infinite in free fluid."""
        ...


class Tabulated:
    """`Poses` by way of their table: `at`, `touch` and `gap`."""

    table: PoseTable

    def _asked(self, position: Any, quaternion: Any, phase: float) -> tuple[Array, Array, Array]:
        R, F, touch = np.empty((6, 6)), np.empty(6), np.empty(14)
        x, q = (np.asarray(v, float) for v in (position, quaternion))
        resist(self.table, x, q / np.linalg.norm(q), float(phase), R, F, touch, np.empty(WORK))
        return R, F, touch

    def at(self, position: Any, quaternion: Any, phase: float) -> tuple[Array, Array]:
        """Return R (6, 6), symmetric positive definite, and F_p (6,) per unit phase rate."""
        return self._asked(position, quaternion, phase)[:2]

    def touch(self, position: Any, quaternion: Any, phase: float) -> tuple[float, Array, Array]:
        """Return the gap, the surface's nearest point (3,) and the boundary's normal (3,) there."""
        touch = self._asked(position, quaternion, phase)[2]
        x, q = (np.asarray(v, float) for v in (position, quaternion))
        return float(touch[0]), _nearest(self.table, x, q / np.linalg.norm(q), touch), touch[4:7]

    def gap(self, position: Any, quaternion: Any, phase: float) -> float:
        """Return the smallest distance of the surface to the boundary, infinite in free fluid."""
        return self.touch(position, quaternion, phase)[0]


def _nearest(table: PoseTable, x: Array, q: Array, touch: Array) -> Array:
    """Return the point (3,) at which a force along the normal has its moment, at the gap."""
    gap, moment, n = touch[0], touch[1:4], touch[4:7]
    square = float(n @ n)
    if not np.isfinite(gap) or not square > 0.0:
        return np.zeros(3)
    axis = table.boundary[3:6]
    away = x - table.boundary[:3]
    if table.kind == TUBE:
        away = away - (away @ axis) * axis
        level = table.boundary[6] - gap
    else:
        level = -gap
    own = np.asarray(rotation_matrix(q)).T @ away
    along = (-level - own @ n / np.sqrt(square)) / np.sqrt(square)
    return np.asarray(np.cross(n, moment) / square + along * n)


@dataclass(frozen=True, eq=False)
class FreePoses(Tabulated):
    """A gait in free fluid, the same at every pose.

    Parameters
    ----------
    gait
        Of any model.

    Raises
    ------
    SpecError
        If the gait holds at one pose, beside a wall or in a channel.
    """

    gait: Gait

    def __post_init__(self) -> None:
        self.gait.check_path()

    @cached_property
    def table(self) -> PoseTable:  # type: ignore[override]
        """Plain arrays for the compiled `pose_table.resist`."""
        return free_table(self.gait)

    @property
    def start(self) -> tuple[Array, Array]:
        """Position (3,) and quaternion (4,): the lab's origin and axes."""
        return np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])

    @property
    def expected_error(self) -> dict[str, Any]:
        """The gait's own expected error, which interpolation adds nothing to."""
        return dict(self.gait.info.get("expected_error") or {})
