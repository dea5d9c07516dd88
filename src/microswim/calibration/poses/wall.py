"""Poses beside a plane wall, solved by boundary elements: `beside_wall` returns `SolvedPoses`."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from microswim.calibration.poses.alike import to_digits
from microswim.calibration.poses.any_shape import beside_wall_of_any_shape
from microswim.calibration.poses.fit import coefficients, factors
from microswim.calibration.poses.layout import Shape, has_three, shape_of
from microswim.calibration.poses.solved import (
    SolvedPoses,
    added_power,
    error_of,
    power_of,
    solved,
)
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.poses.beside_wall import POWER
from microswim.gait.poses.table import WALL, PoseTable
from microswim.gait.stepping import pack
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import quaternion_of
from microswim.numerics.sobol import points
from microswim.swimmer.geometry.surroundings import Wall
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True)
class Grid:
    """Numbers of poses.

    Parameters
    ----------
    gaps
        From `smallest` to infinity, which the gait in free fluid gives.
    tilts
        On either side of where body and tail are equally near, that included.
    phases
        Of the tail against the wall.
    smallest
        Smallest gap, in the body's smaller half axes.
    left_out
        Poses between, that measure the error.
    """

    gaps: int = 9
    tilts: int = 13
    phases: int = 16
    smallest: float = 0.01
    left_out: int = 16

    @property
    def is_fine(self) -> bool:
        """Whether half of the phases, and far off of the tilts, is enough where little changes."""
        return self.phases >= 16 and self.phases % 2 == 0 and self.tilts % 2 == 1


def beside_wall(
    swimmer: Swimmer,
    *,
    level: str | None = None,
    grid: Grid | None = None,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> SolvedPoses:
    """Solve a swimmer at poses beside its wall, and interpolate between them.

    Parameters
    ----------
    swimmer
        With a `wall`; a body of revolution with a helical tail or none, or as of `any_shape`.
    level
        Of the boundary elements; by default one of few patches, as many poses want it.
    grid
        How many poses, of a body of revolution with a helical tail.
    folder
        Where solves are kept and looked for; a folder of the user's cache by default.
    workers
        Processes; all cores by default.
    progress
        Called with (solved, all).

    Raises
    ------
    SpecError
        If the swimmer is of another kind, or has no wall.
    MicroswimError
        If a pose cannot be solved.
    """
    start = start_of(swimmer.wall)
    swimmer = to_digits(swimmer)
    if not has_three(swimmer) and grid is None:
        return beside_wall_of_any_shape(
            swimmer, start, level=level, folder=folder, workers=workers, progress=progress
        )
    grid = Grid() if grid is None else grid
    shape = shape_of(swimmer, grid.smallest)
    free_swimmer = replace(swimmer, wall=None, channel=None)
    among = _solved_of(shape, grid)
    places = _places(shape, grid, among)
    asked = [beside(free_swimmer, shape, *shape.pose(*p)) for p in places]
    made = solved(
        free_swimmer, asked, grid.left_out, level, folder=folder, workers=workers, progress=progress
    )
    free, on = made.best, len(made.poses)
    values = _values(shape, among, asked[:on], made.there, made.free)
    numbers = shape.numbers.copy()
    numbers[POWER] = power_of(free)
    table = PoseTable(
        WALL, np.ascontiguousarray(pack(free)), np.array([0.0, 0, 0, 0, 0, 1]), numbers,
        shape.body, shape.tail, shape.kinks, coefficients(values), switch=shape.switch,
    )  # fmt: skip
    error = error_of(table, free, [start_of(s.wall) for s in asked[on:]], made.judged)
    return SolvedPoses(free, table, start, error)


def _solved_of(shape: Shape, grid: Grid) -> NDArray[np.bool_]:
    """Return which poses (gaps, sides, phases) of the grid are solved, whose sides share sigma = 0.

    One phase alone of what has no tail. Of a fine grid every other phase at the last three gaps
    and, but for the first two tilts, where the body is nearest; at the last two gaps every other
    tilt.
    """
    among = np.ones((grid.gaps - 1, 2 * grid.tilts - 1, grid.phases), bool)
    if not len(shape.tail):
        among[:, :, 1:] = False
    elif grid.is_fine:
        among[-3:, :, 1::2] = False
        among[:, grid.tilts + 1 :, 1::2] = False
        among[-2:, 1::2] = False
    return among


def _places(shape: Shape, grid: Grid, among: NDArray[np.bool_]) -> list[tuple[float, float, float]]:
    """Return xi, sigma, turn of what is solved of the grid, and of those left out."""
    lowest = float(shape.numbers[5])
    xis = lowest * (1.0 - np.arange(grid.gaps - 1) / (grid.gaps - 1))
    sigmas = np.linspace(-1.0, 1.0, 2 * grid.tilts - 1)
    turns = 2.0 * np.pi * np.arange(grid.phases) / grid.phases
    on = [(xis[i], sigmas[j], turns[k]) for i, j, k in np.argwhere(among)]
    u = points(grid.left_out, 3, 1) if grid.left_out else np.zeros((0, 3))
    out = [(0.98 * lowest * (1 - a), 0.9 * (2 * b - 1), 2 * np.pi * c) for a, b, c in u]
    return [(float(x), float(s), float(p)) for x, s, p in on + out]


def beside(swimmer: Swimmer, shape: Shape, gap: float, tilt: float, psi: float) -> Swimmer:
    """Return the swimmer with its wall such that phase 0 of the tail is the pose (gap, tilt, psi).

    Where the tail stays, the wall is turned about s: azimuth ``-sign psi``.
    """
    tilt = float(np.clip(tilt, -0.5 * np.pi, 0.5 * np.pi))
    height = float(gap + shape.touch(tilt, psi))
    return replace(swimmer, wall=Wall(height, tilt=tilt, azimuth=float(-swimmer.tail.sign * psi)))


def _values(
    shape: Shape, among: NDArray[np.bool_], asked: list[Swimmer], found: list[Gait], free: Gait
) -> Array:
    """Return what the wall adds (2, gaps, tilts, phases, 28) on the grid; 0 at the last gap."""
    units = float(shape.numbers[6]), float(shape.numbers[7])
    added = []
    for swimmer, gait in zip(asked, found, strict=True):
        assert swimmer.wall is not None
        normal = np.array(swimmer.wall.normal)
        near, far = (factors(g.resistance(0.0), g.propulsion(0.0), normal, *units)
                     for g in (gait, free))  # fmt: skip
        added.append(np.append(near - far, added_power(gait, power_of(free))))
    on = np.full((*among.shape, 28), np.nan)
    on[among] = added
    on = np.concatenate([on, np.zeros((1, *on.shape[1:]))])
    zero = on.shape[1] // 2
    return _filled(np.stack([on[:, zero:], on[:, zero::-1]]))


def _filled(values: Array) -> Array:
    """Return values (..., tilts, phases, 28) with splines of the others where NaN stands.

    Over one turn, where it stands at every other phase, and over the tilts.
    """
    tilts, phases = values.shape[-3:-1]
    for pose in values.reshape(-1, tilts, phases, 28):
        known = ~np.isnan(pose[..., 0])
        for row, k in zip(pose, known, strict=True):
            if k.any():
                at = np.flatnonzero(k)
                turn = np.concatenate([row[at], row[at[:1]]])
                row[:] = CubicSpline([*at, phases], turn)(np.arange(phases))
        there = np.flatnonzero(known.any(axis=1))
        pose[:] = CubicSpline(there, pose[there])(np.arange(tilts))
    return values


def start_of(wall: Wall | None) -> tuple[Array, Array]:
    """Return position and quaternion at which the wall z = 0 lies as the spec states it.

    The s axis, along the wall, points along +x.

    Raises
    ------
    SpecError
        If there is no wall.
    """
    if wall is None:
        raise SpecError("wall: missing; give [wall] with its distance from the body's centre")
    n = np.array(wall.normal)
    along = np.array([1.0, 0.0, 0.0]) - n[0] * n
    if np.linalg.norm(along) < 1e-9:
        along = np.array([0.0, 1.0, 0.0])
    x = along / np.linalg.norm(along)
    Q = np.stack([x, np.cross(n, x), n])  # rows: the lab's axes in the body's
    return np.array([0.0, 0.0, wall.distance]), quaternion_of(Q)
