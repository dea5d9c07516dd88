"""Poses beside a plane wall, solved by boundary elements: `beside_wall` returns `SolvedPoses`."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

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

    gaps: int = 8
    tilts: int = 11
    phases: int = 12
    smallest: float = 0.01
    left_out: int = 16


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
    asked = [beside(free_swimmer, shape, *p) for p in _places(shape, grid)]
    made = solved(
        free_swimmer, asked, grid.left_out, level, folder=folder, workers=workers, progress=progress
    )
    free, on = made.best, len(made.poses)
    values = _values(shape, grid, asked[:on], made.there, made.free)
    numbers = shape.numbers.copy()
    numbers[POWER] = power_of(free)
    table = PoseTable(
        WALL, np.ascontiguousarray(pack(free)), np.array([0.0, 0, 0, 0, 0, 1]), numbers,
        shape.body, shape.tail, shape.kinks, coefficients(values), switch=shape.switch,
    )  # fmt: skip
    error = error_of(table, free, [start_of(s.wall) for s in asked[on:]], made.judged)
    return SolvedPoses(free, table, start, error)


def _places(shape: Shape, grid: Grid) -> list[tuple[float, float, float]]:
    """Return xi, sigma, turn of the grid, whose sides share sigma = 0, and of those left out.

    One turn alone of what has no tail.
    """
    lowest = float(shape.numbers[5])
    xis = lowest * (1.0 - np.arange(grid.gaps - 1) / (grid.gaps - 1))
    sigmas = np.linspace(-1.0, 1.0, 2 * grid.tilts - 1)
    phases = grid.phases if len(shape.tail) else 1
    turns = 2.0 * np.pi * np.arange(phases) / phases
    on = [(x, s, p) for x in xis for s in sigmas for p in turns]
    u = points(grid.left_out, 3, 1) if grid.left_out else np.zeros((0, 3))
    out = [(0.98 * lowest * (1 - a), 0.9 * (2 * b - 1), 2 * np.pi * c) for a, b, c in u]
    return [(float(x), float(s), float(p)) for x, s, p in on + out]


def beside(swimmer: Swimmer, shape: Shape, xi: float, sigma: float, turn: float) -> Swimmer:
    """Return the swimmer with its wall such that phase 0 of the tail is the pose (xi, sigma, turn).

    Where the tail stays, the wall is turned about s: azimuth ``-sign psi``.
    """
    gap, tilt, psi = shape.pose(xi, sigma, turn)
    tilt = float(np.clip(tilt, -0.5 * np.pi, 0.5 * np.pi))
    height = gap + shape.touch(tilt, psi)
    wall = Wall(height, tilt=tilt, azimuth=float(-swimmer.tail.sign * psi))
    return replace(swimmer, wall=wall)


def _values(shape: Shape, grid: Grid, asked: list[Swimmer], found: list[Gait], free: Gait) -> Array:
    """Return what the wall adds (2, gaps, tilts, phases, 28) on the grid; 0 at the last gap."""
    units = float(shape.numbers[6]), float(shape.numbers[7])
    added = []
    for swimmer, gait in zip(asked, found, strict=True):
        assert swimmer.wall is not None
        normal = np.array(swimmer.wall.normal)
        near, far = (factors(g.resistance(0.0), g.propulsion(0.0), normal, *units)
                     for g in (gait, free))  # fmt: skip
        added.append(np.append(near - far, added_power(gait, power_of(free))))
    on = np.array(added).reshape(grid.gaps - 1, 2 * grid.tilts - 1, -1, 28)
    on = np.repeat(on, grid.phases // on.shape[2], axis=2)
    on = np.concatenate([on, np.zeros((1, *on.shape[1:]))])
    return np.stack([on[:, grid.tilts - 1 :], on[:, grid.tilts - 1 :: -1]])


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
