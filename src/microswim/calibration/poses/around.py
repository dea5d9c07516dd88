"""A gait at every pose about whatever bounds the fluid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from microswim.calibration.poses import tube, wall
from microswim.calibration.poses.solved import SolvedPoses
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
