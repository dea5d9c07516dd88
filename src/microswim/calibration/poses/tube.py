"""Poses in an endless round tube, solved by boundary elements: `in_tube` returns `SolvedPoses`."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from microswim.calibration.poses import scattered
from microswim.calibration.poses.alike import to_digits
from microswim.calibration.poses.layout import Shape, shape_of
from microswim.calibration.poses.scattered import Scatter
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
from microswim.gait.poses.beside_wall import REACH
from microswim.gait.poses.table import TUBE, PoseTable
from microswim.gait.stepping import length_of, pack
from microswim.models.bem.solution import middle_of
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.rigid_motion import quaternion_of
from microswim.numerics.sobol import points
from microswim.swimmer.geometry.surroundings import Channel
from microswim.swimmer.swimmer import Swimmer

#: Fluid between the swimmer and the closed ends of the tube in which a pose is solved, in radii:
#: what is sent back by them falls as exp(-2 * 2.6 * ends).
ENDS = 1.5
#: Share of the poses that need not be solved: body and tail both all but touch, or the side of a
#: cylinder does in a tight tube. What is left is judged by the poses left out.
LOST = 0.1
#: Poses at random among which each that is solved is chosen; those that are looked at at once.
AMONG, LOOK = 2, 2**14
#: Share of the poses of which the tail is close to the tube; draws of these; their least gap over
#: their own, at which it is close no more.
CLOSE, FIRST_CLOSE, MOST_LOOKS, TOO_FAR = 0.25, 500_000, 100, 0.1


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
    scatter = Scatter() if scatter is None else scatter
    swimmer = to_digits(swimmer)
    channel = _tube_of(swimmer)
    start = start_of(swimmer)
    shape = shape_of(swimmer, scatter.smallest)
    radius = 0.5 * channel.diameter
    numbers = numbers_of(shape, scatter.smallest)
    lines, Z = with_close_ones(shape, numbers, radius, max(scatter.poses, Scatter.poses))
    some = _first(len(lines), scatter.poses)  # of fewer the solves are found by more
    lines, Z = lines[some], Z[some]
    out = np.zeros((0, 6))
    if scatter.left_out:
        out, _ = places(shape, numbers, radius, scatter.left_out, among=scatter.left_out, seed=1)
    free_swimmer = replace(swimmer, wall=None, channel=None)
    asked = [beside(free_swimmer, radius, line) for line in np.concatenate([lines, out])]
    on, off = asked[: len(lines)], asked[len(lines) :]
    with kept_in(folder) as place:
        for count in scatter.parts:
            some = _first(len(lines), count)
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


def _first(whole: int, count: int) -> NDArray[np.int64]:
    """Indices of the first poses of `with_close_ones`, as many of those close in proportion."""
    if count >= whole:
        return np.arange(whole)
    close, of_all = int(CLOSE * count), whole - int(CLOSE * whole)
    return np.concatenate([np.arange(count - close), of_all + np.arange(close)])


def _table(
    shape: Shape, numbers: Array, radius: float, made: Solves, lines: Array, Z: Array
) -> PoseTable:
    """Return the table of solves at lines (n, 6) of features Z (n, 14)."""
    free, root = made.best, root_of(made.free)
    there = [i for i, gait in enumerate(made.poses) if gait is not None]
    Y = np.array([targets(gait, root) for gait in made.there])
    C = np.array([carried(g, lines[i], radius) for i, g in zip(there, made.there, strict=True)])
    known, weights = scattered.known_of_both(Z[there], np.concatenate([Y, C], axis=1))
    return PoseTable(
        TUBE, np.ascontiguousarray(pack(free)), np.array([0.0, 0, 0, 1, 0, 0, radius]), numbers,
        shape.body, shape.tail, np.zeros(0), np.zeros((0, 0, 0, 0, 0)),
        known, weights[: Y.shape[1]].copy(), weights[Y.shape[1] :].copy(), root_of(free),
    )  # fmt: skip


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


def places(
    shape: Shape, numbers: Array, radius: float, count: int, among: int, seed: int = 0
) -> tuple[Array, Array]:
    """Return lines (count, 6) and their features (count, 14), far from one another.

    Raises
    ------
    SpecError
        If the swimmer does not fit into the tube.
    """
    lines: list[Array] = []
    Z: list[Array] = []
    for found, z, _ in _that_fit(shape, numbers, radius, 1000 * seed):
        lines.append(found)
        Z.append(z)
        if sum(map(len, lines)) >= among:
            break
    if not lines:
        raise SpecError(
            "channel.diameter", 2.0 * radius, "wide enough for the swimmer to move in it"
        )
    all_lines, all_z = np.concatenate(lines)[:among], np.concatenate(Z)[:among]
    chosen = scattered.spread(all_z[:, : inside.WHERE], count)
    return all_lines[chosen], all_z[chosen]


def with_close_ones(shape: Shape, numbers: Array, radius: float, count: int) -> tuple[Array, Array]:
    """Return what `places` does; of a part of the poses the tail is close to the tube.

    There velocities change most from pose to pose, and few poses at random lie there: these are
    spread evenly in the logarithm of the tail's gap.
    """
    lines, Z = places(shape, numbers, radius, count, AMONG * count)
    close = int(CLOSE * count)
    if not len(shape.tail) or not close:
        return lines, Z
    lines, Z = lines[: count - close], Z[: count - close]
    found: list[Array] = []
    features: list[Array] = []
    for n, (some, z, gaps) in enumerate(_that_fit(shape, numbers, radius, FIRST_CLOSE)):
        odds = numbers[inside.LEAST] / gaps[:, 1]
        keep = (odds > points(LOOK, 1, FIRST_CLOSE + n)[: len(some), 0]) & (odds > TOO_FAR)
        found.append(some[keep])
        features.append(z[keep])
        if sum(map(len, found)) >= AMONG * close or n == MOST_LOOKS:
            break
    some, z = np.concatenate(found)[: AMONG * close], np.concatenate(features)[: AMONG * close]
    where = slice(0, inside.WHERE)
    chosen = scattered.spread(z[:, where], close, others=Z[:, where])
    return np.concatenate([lines, some[chosen]]), np.concatenate([Z, z[chosen]])


def _that_fit(
    shape: Shape, numbers: Array, radius: float, first: int
) -> Iterator[tuple[Array, Array, Array]]:
    """Yield lines at random that fit, their features and the gaps of body and tail."""
    widest, steep, some = radius - numbers[inside.LEAST], 1.0, False
    for more in range(400):
        found, z, gaps = _drawn(shape, numbers, radius, first + more, (widest, steep))
        fits = gaps.min(axis=1) > numbers[inside.LEAST]
        if fits.sum() < MANY and not some:  # a narrow tube: what is steep does not fit
            least = found[fits, 0].min() if fits.any() else 1.0 - steep / 4.0
            steep = min(1.5 * (1.0 - least), 0.5 * steep) if fits.any() else steep / 4.0
            if steep < 1e-9:
                widest, steep = _room(shape, numbers, radius, first)
                some = True
            continue
        some = True
        if not fits.any():
            break
        yield found[fits], z[fits], gaps[fits]


#: Lines that have to fit among those that are looked at.
MANY = 2**8


def _room(shape: Shape, numbers: Array, radius: float, first: int) -> tuple[float, float]:
    """Return how far the body's centre may be from the axis of a tight tube, and 1 - cos(tilt).

    From bounds that hold for any swimmer, then with a margin about what fits.
    """
    widest = radius - numbers[inside.LEAST] - (numbers[inside.LENGTH] if len(shape.body) else 0.0)
    slope = min(1.0, (widest + radius) / max(float(numbers[REACH]), 1e-300))
    steep = 1.0 - np.sqrt(1.0 - slope * slope)
    for _ in range(20):
        found, _, gaps = _drawn(shape, numbers, radius, first, (widest, steep))
        fits = gaps.min(axis=1) > numbers[inside.LEAST]
        if fits.sum() >= MANY:
            break
        if fits.sum() < MANY // 8:
            widest, steep = widest / 1.2, steep / 1.5
            continue
        away = np.linalg.norm(found[fits, 3:], axis=1).max()
        widest, steep = min(widest, 1.2 * away), min(steep, 1.5 * (1.0 - found[fits, 0].min()))
    return widest, steep


def _drawn(
    shape: Shape, numbers: Array, radius: float, draw: int, room: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Return lines at random, their features and the gaps of body and tail."""
    found = _lines(points(LOOK, 4, draw), *room)
    gaps, z = np.empty((len(found), 2)), np.empty((len(found), inside.FEATURES))
    with settled(True):
        inside.of_lines(found, shape.body, shape.tail, numbers, radius, gaps, z)
    return found, z, gaps


def _lines(u: Array, widest: float, steep: float) -> Array:
    """Lines (n, 6) of points (n, 4) of the unit cube: evenly in direction and in place."""
    t0 = 1.0 - steep * u[:, 0]
    across = np.sqrt(1.0 - t0 * t0)
    c, s = np.cos(2.0 * np.pi * u[:, 1]), np.sin(2.0 * np.pi * u[:, 1])
    t = np.stack([t0, across * c, across * s], axis=-1)
    first = np.stack([-across, t0 * c, t0 * s], axis=-1)
    second = np.stack([0.0 * c, -s, c], axis=-1)
    away, turn = widest * np.sqrt(u[:, 2]), 2.0 * np.pi * u[:, 3]
    b = (away * np.cos(turn))[:, None] * first + (away * np.sin(turn))[:, None] * second
    return np.ascontiguousarray(np.concatenate([t, b], axis=-1))


def beside(swimmer: Swimmer, radius: float, line: Array) -> Swimmer:
    """Return the swimmer in a closed tube such that phase 0 of the tail is the pose of a line."""
    t, b = line[:3], line[3:]
    tilt, azimuth = np.arccos(np.clip(t[0], -1.0, 1.0)), np.arctan2(-t[2], -t[1])
    whole = 2.0 * float(swimmer.body.semi_axes3[0]) + float(swimmer.tail.apparent_length)
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
    """Return `PoseTable.root` (8, 6): S of ``R = S exp(L) S'``, R^-1 F_p and P in free fluid."""
    R, F = free.resistance(0.0), free.propulsion(0.0)
    unit = np.repeat([1.0, length_of(free)], 3)
    values, vectors = np.linalg.eigh(R / np.outer(unit, unit))
    S = unit[:, None] * ((vectors * np.sqrt(values)) @ vectors.T)
    w = np.linalg.solve(R, F)
    power = np.zeros(6)
    power[0] = power_of(free)
    return np.concatenate([S, w[None], power[None]])


def targets(gait: Gait, root: Array) -> Array:
    """Return L by the rows of its lower triangle (21), w (6) and log of P over that of free fluid.

    Raises
    ------
    numpy.linalg.LinAlgError
        If R is not positive definite.
    """
    R, F = gait.resistance(0.0), gait.propulsion(0.0)
    inverse = np.linalg.inv(root[:6])
    E = inverse @ R @ inverse.T
    values, vectors = np.linalg.eigh(0.5 * (E + E.T))
    if not values[0] > 0.0:
        raise np.linalg.LinAlgError("a resistance beside the tube is not positive definite")
    L = (vectors * np.log(values)) @ vectors.T
    w = np.linalg.solve(R, F)
    more = added_power(gait, float(root[7, 0]))
    return np.concatenate([L[np.tril_indices(6)], w - root[6], [more]])


def carried(gait: Gait, line: Array, radius: float) -> Array:
    """Return D t' (18,): how Poiseuille's flow along t carries a pose, see `table.carry`."""
    t, b = line[:3], line[3:]
    V = np.linalg.solve(gait.resistance(0.0), np.asarray(gait.info["in_poiseuille"], float))
    V[:3] -= (1.0 - b @ b / radius**2) * t
    V[3:] += np.cross(b, t) / radius**2
    return np.outer(V, t).reshape(-1)
