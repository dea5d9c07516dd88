"""A gait at every pose about whatever bounds the fluid."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from microswim.calibration.poses.solved import SolvedPoses
from microswim.calibration.poses.tube import in_tube
from microswim.calibration.poses.wall import beside_wall
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
        As `beside_wall` or `in_tube` take them.

    Raises
    ------
    SpecError
        If it has neither, or is of another kind than is known there.
    MicroswimError
        If a pose cannot be solved.
    """
    solve: Any = beside_wall if swimmer.channel is None else in_tube
    found: SolvedPoses = solve(swimmer, level=level, progress=progress, **options)
    return found
