"""A gait at every pose about whatever bounds the fluid, and where the swimmer touches that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from microswim.calibration.poses import any_shape, layout, tube, wall
from microswim.calibration.poses.scattered import Scatter
from microswim.calibration.poses.solved import SolvedPoses
from microswim.gait.poses.table import TUBE, WALL, PoseTable
from microswim.numerics.array import Array
from microswim.path.march import gaps_along
from microswim.swimmer.swimmer import Swimmer


def around(
    swimmer: Swimmer,
    *,
    level: str | None = None,
    progress: Callable[[int, int], None] | None = None,
    **options: Any,
) -> SolvedPoses:
    """Solve a swimmer at poses beside its wall or in its tube, and interpolate between them.

    Parameters
    ----------
    swimmer
        With a `wall` or a `channel`.
    level
        Of the boundary elements; by default one of few patches.
    progress
        Called with (solved, all).
    options
        As `wall.beside_wall` or `tube.in_tube` take them.

    Raises
    ------
    SpecError
        If it has neither, or is of another kind than is known there.
    MicroswimError
        If a pose cannot be solved.
    """
    solve: Any = wall.beside_wall if swimmer.channel is None else tube.in_tube
    found: SolvedPoses = solve(swimmer, level=level, progress=progress, **options)
    return found


@dataclass(frozen=True, eq=False)
class Outline:
    """Where a swimmer touches its wall or tube, known before any pose is solved.

    Parameters
    ----------
    table
        Of `gap` alone.
    start
        Position and quaternion of the pose that the spec states.
    """

    table: PoseTable
    start: tuple[Array, Array]

    def gap(self, position: Any, quaternion: Any, phase: float) -> float:
        """Return the smallest distance of the surface to the boundary."""
        found, at = np.empty(1), (np.array([v], float) for v in (position, quaternion, phase))
        gaps_along(self.table, *at, found)
        return float(found[0])


def outline(swimmer: Swimmer) -> Outline | None:
    """Return where a swimmer touches its boundary; None if there is none, or its poses are unknown.

    Raises
    ------
    SpecError
        If it is of another kind than is known there.
    """
    channel, ground = swimmer.channel, np.array([0.0, 0, 0, 0, 0, 1])
    if channel is not None and channel.is_cylinder:
        shape = tube.in_a_tube(swimmer, Scatter.smallest)
        axis = np.array([0.0, 0, 0, 1, 0, 0, 0.5 * channel.diameter])
        numbers = tube.numbers_of(shape, Scatter.smallest)
        return Outline(_bare(TUBE, axis, numbers, shape, shape.kinks), tube.start_of(swimmer))
    if channel is not None or swimmer.wall is None:
        return None
    start = wall.start_of(swimmer.wall)
    if layout.has_three(swimmer):
        shape = layout.shape_of(swimmer, wall.Grid.smallest)
        return Outline(_bare(WALL, ground, shape.numbers, shape, shape.kinks), start)
    if not any_shape.is_known(swimmer):
        return None
    any_one = any_shape.shape_of(swimmer, Scatter.smallest)
    known = np.zeros((2, 1, 1))
    return Outline(_bare(WALL, ground, any_one.numbers, any_one, np.zeros(0), known), start)


def _bare(
    kind: int, boundary: Array, numbers: Array, shape: Any, kinks: Array, *known: Array
) -> PoseTable:
    """Return the table of a swimmer about a boundary, without a solve."""
    alone, added = np.zeros((1, 27)), np.zeros((0, 0, 0, 0, 0))
    return PoseTable(kind, alone, boundary, numbers, shape.body, shape.tail, kinks, added, *known)


def same_poses(swimmer: Swimmer) -> str:
    """Return what poses depend on: body, tail and boundary, not where the swimmer starts."""
    bounds: Any = None if swimmer.wall is None else "wall"
    if swimmer.channel is not None:
        bounds = swimmer.channel.shape, swimmer.channel.diameter
    seen = (swimmer.body, swimmer.tail, swimmer.fluid, swimmer.motion, bounds)
    return repr((*seen, swimmer.coefficients, swimmer.interaction))


def started(poses: SolvedPoses, swimmer: Swimmer) -> SolvedPoses:
    """Return poses that start where the wall or the channel of a swimmer says."""
    if swimmer.channel is not None:
        return replace(poses, start=tube.start_of(swimmer))
    return replace(poses, start=wall.start_of(swimmer.wall))
