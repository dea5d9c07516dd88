"""Poses in an endless round tube, solved by boundary elements: `in_tube` returns `SolvedPoses`."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from microswim.calibration.poses import scattered
from microswim.calibration.poses.alike import to_digits
from microswim.calibration.poses.layout import Shape, shape_of
from microswim.calibration.poses.lines import first, with_close_ones
from microswim.calibration.poses.scattered import OF_L, Scatter
from microswim.calibration.poses.solved import (
    SolvedPoses,
    Solves,
    added_power,
    error_of,
    kept_in,
    power_of,
    solved,
)
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.poses import in_tube as inside
from microswim.gait.poses.table import TUBE, PoseTable
from microswim.gait.poses.tail_near_tube import near_tail
from microswim.gait.stepping import length_of, pack
from microswim.models.bem.solution import middle_of
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.rigid_motion import quaternion_of
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.geometry.surroundings import Channel
from microswim.swimmer.swimmer import Swimmer

#: Fluid between the swimmer and the closed ends of the tube in which a pose is solved, in radii:
#: what is sent back by them falls as exp(-2 * 2.6 * ends).
ENDS = 1.5
#: Share of the poses that need not be solved: body and tail both all but touch, or the side of a
#: cylinder does in a tight tube. What is left is judged by the poses left out.
LOST = 0.1
#: Poses at most, unless asked for more.
POSES = 750


def in_tube(
    swimmer: Swimmer,
    *,
    level: str | None = None,
    scatter: Scatter | None = None,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> SolvedPoses:
    """Solve a swimmer at poses in its tube, and interpolate between them.

    Parameters
    ----------
    swimmer
        With a `channel` that is a cylinder, taken as endless; a body of revolution with a helical
        tail or none.
    level
        Of the boundary elements; by default one of few patches, as many poses want it.
    scatter
        How many poses, at most: with fewer it is done if these meet others well enough.
    folder
        Where solves are kept and looked for; a folder of the user's cache by default.
    workers
        Processes; all cores by default.
    progress
        Called with (solved, all of this part): more follow where these are not enough.

    Raises
    ------
    SpecError
        If the swimmer is of another kind, has no tube or does not fit into it.
    MicroswimError
        If a pose cannot be solved.
    """
    scatter = Scatter(poses=POSES) if scatter is None else scatter
    swimmer = to_digits(swimmer)
    channel = _tube_of(swimmer)
    start = start_of(swimmer)
    shape = in_a_tube(swimmer, scatter.smallest)
    radius = 0.5 * channel.diameter
    numbers = numbers_of(shape, scatter.smallest)
    lines, Z = with_close_ones(shape, numbers, radius, max(scatter.poses, POSES))
    some = first(shape, len(lines), scatter.poses)  # of fewer the solves are found by more
    lines, Z = lines[some], Z[some]
    out = np.zeros((0, 6))
    if scatter.left_out:
        out, _ = with_close_ones(shape, numbers, radius, scatter.left_out, among=1, seed=1)
    free_swimmer = replace(swimmer, wall=None, channel=None)
    asked = [beside(free_swimmer, radius, line) for line in np.concatenate([lines, out])]
    on, off = asked[: len(lines)], asked[len(lines) :]
    with kept_in(folder) as place:
        for count in scatter.parts:
            some = first(shape, len(lines), count)
            made = solved(
                free_swimmer, [on[i] for i in some] + off, len(off), level, folder=place,
                workers=workers, progress=progress, lost=LOST,
            )  # fmt: skip
            table = _table(shape, numbers, radius, made, lines[some], Z[some])
            error = error_of(table, made.best, [start_of(s) for s in off], made.judged)
            unknowns = [gait.info.get("unknowns", 0) for gait in made.there]
            if scatter.enough(error, unknowns):
                break
    return SolvedPoses(made.best, table, start, error)


def in_a_tube(swimmer: Swimmer, smallest: float) -> Shape:
    """Return what of a swimmer touches a tube: of a cylinder or a capsule `rings`."""
    shape, body = shape_of(swimmer, smallest), swimmer.body
    circle = body.rim
    if circle is None:
        return shape
    s, rho, thick = (float(np.real(v)) for v in circle)
    return replace(shape, body=np.array([[s, rho, thick], [-s, rho, thick]]))


def _table(
    shape: Shape, numbers: Array, radius: float, made: Solves, lines: Array, Z: Array
) -> PoseTable:
    """Return the table of solves at lines (n, 6) of features Z (n, 18)."""
    free, root = made.best, root_of(made.free)
    there = [i for i, gait in enumerate(made.poses) if gait is not None]
    near = [of_tail(shape, numbers, radius, lines[i]) for i in there]
    share = _share(made.there, near, root)
    near = [(share * R, share * F) for R, F in near]
    Y = np.array([targets(g, root, part) for g, part in zip(made.there, near, strict=True)])
    C = np.array([carried(g, lines[i], radius) for i, g in zip(there, made.there, strict=True)])
    known, weights = scattered.known_of_each(Z[there], Y[:, :OF_L], Y[:, OF_L:], C)
    best = root_of(free)
    best[inside.SHARED] = share
    return PoseTable(
        TUBE, np.ascontiguousarray(pack(free)), np.array([0.0, 0, 0, 1, 0, 0, radius]), numbers,
        shape.body, shape.tail, np.zeros(0), np.zeros((0, 0, 0, 0, 0)),
        known, np.concatenate(weights[:2]), weights[2], best,
    )  # fmt: skip


def of_tail(shape: Shape, numbers: Array, radius: float, line: Array) -> tuple[Array, Array]:
    """Return what a tail close to the tube adds to R (6, 6) and F_p (6,), see `tail_near_tube`."""
    R, F = np.zeros((6, 6)), np.zeros(6)
    with settled(True):
        near_tail(line, shape.tail, numbers, radius, 1.0, R, F, np.zeros(51))
    return R, F


#: Least eigenvalue of R in units of that in free fluid, once the tail's part is taken off.
WELL_ABOVE = 0.5


def _share(gaits: list[Gait], near: list[tuple[Array, Array]], root: Array) -> float:
    """Return how much of that can be taken off such that at every pose R stays well above zero."""
    inverse = np.linalg.inv(root[:6])
    for share in (1.0, 0.5, 0.25):
        left = [g.resistance(0.0) - share * R for g, (R, _) in zip(gaits, near, strict=True)]
        if np.linalg.eigvalsh(inverse @ np.array(left) @ inverse.T).min() > WELL_ABOVE:
            return share
    return 0.0


def _tube_of(swimmer: Swimmer) -> Channel:
    channel = swimmer.channel
    if channel is None:
        raise SpecError("channel: missing; give [channel] with its diameter and length")
    if not channel.is_cylinder:
        raise SpecError("channel.shape", channel.shape, '"cylinder" for a path')
    return channel


def start_of(swimmer: Swimmer) -> tuple[Array, Array]:
    """Return position and quaternion in the axes of the swimmer's channel, about its middle."""
    assert swimmer.channel is not None
    axes = swimmer.channel.axes
    centre = np.asarray(swimmer.body.centre, float)
    return axes.T @ (centre - middle_of(swimmer)), quaternion_of(axes.T)


def numbers_of(shape: Shape, smallest: float) -> Array:
    """Return `PoseTable.numbers` for a tube: `layout`'s, with scale and least of the gap."""
    numbers = shape.numbers.copy()
    numbers[inside.LEAST] = smallest * numbers[inside.LENGTH]
    numbers[inside.SIZE] = SIZE * numbers[inside.LENGTH]
    return numbers


#: Scale of the gap in half axes of the body.
SIZE = 2.0


def beside(swimmer: Swimmer, radius: float, line: Array) -> Swimmer:
    """Return the swimmer in a closed tube such that phase 0 of the tail is the pose of a line."""
    t, b = line[:3], line[3:]
    tilt, azimuth = np.arccos(np.clip(t[0], -1.0, 1.0)), np.arctan2(-t[2], -t[1])
    whole = float(nose_to_tip(swimmer))
    tube = Channel(
        diameter=2.0 * radius,
        length=whole + 2.0 * float(swimmer.tail.radius) + 2.0 * ENDS * radius,
        tilt=float(min(tilt, 0.5 * np.pi)),
        azimuth=float(azimuth),
    )
    own = middle_of(replace(swimmer, channel=tube)) - np.asarray(swimmer.body.centre, float)
    place = tube.axes.T @ (b + own)
    return replace(swimmer, channel=replace(tube, position=(0.0, *place[1:].tolist())))


def root_of(free: Gait) -> Array:
    """Return `PoseTable.root` (8, 6): S of ``R = S exp(L) S'``, S^-1 F_p and P in free fluid."""
    R, F = free.resistance(0.0), free.propulsion(0.0)
    unit = np.repeat([1.0, length_of(free)], 3)
    values, vectors = np.linalg.eigh(R / np.outer(unit, unit))
    S = unit[:, None] * ((vectors * np.sqrt(values)) @ vectors.T)
    power = np.zeros(6)
    power[0] = power_of(free)
    return np.concatenate([S, np.linalg.solve(S, F)[None], power[None]])


def targets(gait: Gait, root: Array, near: tuple[Array, Array] | None = None) -> Array:
    """Return L by the rows of its lower triangle (21), f (6) and log of P over that of free fluid.

    Parameters
    ----------
    gait, root
        Of a pose; in free fluid.
    near
        R and F_p that are told apart.

    Raises
    ------
    numpy.linalg.LinAlgError
        If R is not positive definite.
    """
    R, F = gait.resistance(0.0), gait.propulsion(0.0)
    if near is not None:
        R, F = R - near[0], F - near[1]
    inverse = np.linalg.inv(root[:6])
    E = inverse @ R @ inverse.T
    values, vectors = np.linalg.eigh(0.5 * (E + E.T))
    if not values[0] > 0.0:
        raise np.linalg.LinAlgError("a resistance beside the tube is not positive definite")
    L = (vectors * np.log(values)) @ vectors.T
    more = added_power(gait, float(root[7, 0]))
    return np.concatenate([L[np.tril_indices(6)], inverse @ F - root[6], [more]])


def carried(gait: Gait, line: Array, radius: float) -> Array:
    """Return D t' (18,): how Poiseuille's flow along t carries a pose, see `table.carry`."""
    t, b = line[:3], line[3:]
    V = np.linalg.solve(gait.resistance(0.0), np.asarray(gait.info["in_poiseuille"], float))
    V[:3] -= (1.0 - b @ b / radius**2) * t
    V[3:] += np.cross(b, t) / radius**2
    return np.outer(V, t).reshape(-1)
