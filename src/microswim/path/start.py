"""Where a path starts: the pose that is asked for, or that of the spec."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.gait import doors
from microswim.gait.poses.face import Poses
from microswim.gait.poses.table import TUBE, WALL
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply
from microswim.path import in_tube
from microswim.swimmer.in_units import as_units
from microswim.swimmer.swimmer import Swimmer


def three(name: str, value: Any) -> Array:
    """Return a vector, or refuse what is none."""
    checks.numbers(name, np.ravel(value).tolist(), 3, "three finite numbers [x, y, z]")
    return np.array(value, float).reshape(3)


def check_bounds(poses: Poses, swimmer: Swimmer) -> None:
    """Refuse poses beside another boundary than the swimmer's, or in a tube of another width."""
    table, channel = poses.table, swimmer.channel
    if channel is None and (swimmer.wall is None or table.kind == WALL):
        return
    width = 2.0 * float(table.boundary[6]) if table.kind == TUBE else 0.0
    if width and channel is not None and abs(width - channel.diameter) < 1e-6 * width:
        return
    with as_units(swimmer):
        tube = "in a tube of diameter"
        wanted = "beside a wall" if channel is None else f"{tube} {measured(channel.diameter)}"
        known = f"{tube} {measured(width)}" if width else "in free fluid"
    known = "beside a wall" if table.kind == WALL else known
    raise SpecError("poses", f"those {known}", f"those {wanted}, where the swimmer is")


MOST_PATHS = 1_000_000


def check_count(swimmer: Swimmer, paths: int) -> None:
    """Refuse many paths that would all be the same, or too many."""
    if paths > 1 and swimmer.noise is None:
        raise SpecError("paths", paths, "1 without [noise]", "all paths would be the same")
    if paths > MOST_PATHS:
        raise SpecError("paths", paths, f"at most {MOST_PATHS}")


def check_early(swimmer: Swimmer, phase: float = 0.0, paths: int = 1, **start: Any) -> None:
    """Refuse what no path begins with, before poses are solved for minutes.

    `start`: position, quaternion and tilt, as of `pose_at_start`.
    """
    in_tube.check(swimmer)
    check_count(swimmer, paths)
    around = doors.go(doors.OUTLINE, swimmer)
    if around is not None:
        asked = [start.get(name) for name in ("position", "quaternion", "tilt")]
        with as_units(swimmer):
            check_clear(around, *pose_at_start(swimmer, around.start, *asked), phase)


def check_clear(poses: Any, x: Array, q: Array, phase: float) -> None:
    """Refuse a start at which the swimmer reaches into the boundary."""
    gap = poses.gap(x, q, float(phase))
    if not gap > 0.0:
        place, into = ", ".join(map(measured, x)), measured(-gap)
        raise SpecError(
            f"position = ({place}): the swimmer would reach {into} into the boundary; start "
            "further from it, or tilt it otherwise"
        )


def pose_at_start(
    swimmer: Swimmer, usual: tuple[Array, Array], position: Any, quaternion: Any, tilt: float | None
) -> tuple[Array, Array]:
    """Return position (3,) and quaternion (4,): as asked for, else the usual ones.

    Raises
    ------
    SpecError
        If an argument is no pose.
    """
    x, q = usual
    if position is not None:
        x = three("position", position)
    if quaternion is not None and tilt is not None:
        raise SpecError("tilt, quaternion: give one of the two")
    if quaternion is not None:
        checks.numbers("quaternion", np.ravel(quaternion).tolist(), 4, "four numbers wxyz")
        q = np.array(quaternion, float).reshape(4)
        if not 0.99 < np.linalg.norm(q) < 1.01:
            raise SpecError("quaternion", quaternion, "a unit quaternion wxyz")
        q = q / np.linalg.norm(q)
    if tilt is not None:
        checks.number("tilt", tilt, "an angle (rad)", least=-7.0, most=7.0)
        q = _tilted(swimmer, tilt, q)
    return x, q


def _tilted(swimmer: Swimmer, tilt: float, q: Array) -> Array:
    """Return the attitude with another tilt: about y, in a tube about the axis of its tilt, z."""
    if swimmer.channel is not None:
        half = (tilt - swimmer.channel.tilt) / 2.0
        return multiply(np.array([np.cos(half), 0.0, 0.0, np.sin(half)]), q)
    half = ((swimmer.wall.tilt if swimmer.wall is not None else 0.0) - tilt) / 2.0
    return multiply(np.array([np.cos(half), 0.0, np.sin(half), 0.0]), q)


def rest_start(swimmer: Swimmer) -> tuple[Array, Array]:
    """Return the pose at the start of a tail that remembers: the wall's, or the origin."""
    if swimmer.wall is not None:
        beside: tuple[Array, Array] = doors.go(doors.START_BESIDE_WALL, swimmer.wall)
        return beside
    return np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
