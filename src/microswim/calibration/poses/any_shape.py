"""Poses beside a wall of a swimmer that is no body of revolution with a rigid tail.

A waving tail, a box, an ellipsoid of three axes: the wall's normal in the body frame, the gap and
the phase are four coordinates, whose poses lie scattered (`microswim.gait.poses.any_shape`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike

import numpy as np

from microswim.calibration.poses import scattered
from microswim.calibration.poses.layout import LINE, SIZE, body_length, meridian_of
from microswim.calibration.poses.scattered import Scatter
from microswim.calibration.poses.solved import (
    SolvedPoses,
    added_power,
    error_of,
    power_of,
    solved,
)
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.poses import any_shape, beside_wall
from microswim.gait.poses.table import WALL, PoseTable
from microswim.gait.stepping import pack
from microswim.models.swimmer_surface import smooth_centreline
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.series.fourier import MIRROR_Q
from microswim.numerics.sobol import points
from microswim.swimmer.geometry.bodies import Body
from microswim.swimmer.geometry.surroundings import Wall
from microswim.swimmer.swimmer import Swimmer

#: Phases of the gait in free fluid and of the centreline; harmonics smaller than this are left out.
FREE_PHASES, PHASES, SMALL = 12, 64, 1e-7
#: Poses that are solved where nothing is said, one coordinate more than in a tube; share of them
#: that is close. Velocities change most there: where the tip of a steep tail is near, say.
POSES, CLOSE = 1600, 0.25
#: The furthest pose, as xi of its gap, 20 half axes; of those that are close, half of one.
FURTHEST, NEAR = -0.2, -2.3


@dataclass(frozen=True, eq=False)
class Shape:
    """What of a swimmer touches a wall: as `PoseTable` has it, of any shape."""

    body: Array
    tail: Array
    numbers: Array


def is_known(swimmer: Swimmer) -> bool:
    """Return whether poses beside a wall can be solved at every phase, and where it touches."""
    body, tail = swimmer.body, swimmer.tail
    has_formula = body.is_axisymmetric or body.is_ellipsoid or body.corners is not None
    plain = tail.is_rigid or tail.is_absent or tail.half_period_signs is not None
    return plain and not tail.is_placed and not tail.settles and has_formula


def shape_of(swimmer: Swimmer, smallest: float) -> Shape:
    """Return what of a swimmer touches a wall.

    Parameters
    ----------
    swimmer
        With one tail.
    smallest
        Smallest gap that is solved, in units of the body's smaller half axis.
    """
    body, tail = swimmer.body, swimmer.tail
    length = body_length(swimmer)
    reach = float(tail.apparent_length - body.centre[0])
    numbers = np.zeros(16)
    numbers[beside_wall.TAIL_RADIUS] = max(np.real(tail.half_axes)) if not tail.is_absent else 0.0
    numbers[beside_wall.SIZE] = SIZE * length
    numbers[beside_wall.REACH], numbers[beside_wall.LENGTH] = reach, length
    numbers[beside_wall.LOWEST] = np.log(smallest / (smallest + SIZE))
    numbers[beside_wall.VISCOSITY] = swimmer.fluid.viscosity
    numbers[beside_wall.LEAST] = smallest * length
    if body.corners is not None:
        numbers[any_shape.EDGE] = float(np.real(body.fillet))  # type: ignore[attr-defined]
    signs = tail.half_period_signs
    numbers[any_shape.MIRROR_R] = tail.is_planar
    numbers[any_shape.MIRROR_Q] = signs is not None and np.array_equal(signs, MIRROR_Q)
    numbers[any_shape.TURNED] = tail.is_rigid
    numbers[any_shape.SHEARED] = not tail.is_absent and tail.sections == "sheared"
    return Shape(_surface(body), _centreline(swimmer), numbers)


def _surface(body: Body) -> Array:
    """Return the body as `any_shape.support` has it."""
    if body.is_absent:
        return np.zeros((0, 2))
    if body.is_axisymmetric:
        return meridian_of(body)
    if body.corners is None:
        return np.real(np.array([body.semi_axes3], float))
    return np.ascontiguousarray(body.corners)


def _centreline(swimmer: Swimmer) -> Array:
    """Return the series (m, 3 + 6 H) of the tail's points from the body's centre."""
    tail = swimmer.tail
    if tail.is_absent:
        return np.zeros((0, 3))
    many = LINE * max(2, int(np.ceil(float(tail.number_of_waves))))
    s = np.linspace(0.0, float(tail.apparent_length), many + 1)
    at = 2.0 * np.pi * np.arange(PHASES) / PHASES
    P = np.array([np.real(smooth_centreline(tail, s, float(a)).P) for a in at])
    P = P - np.real(np.asarray(swimmer.body.centre, float))
    c = np.fft.rfft(P, axis=0) / PHASES
    size = np.abs(c[1:]).max(axis=(1, 2))
    most = 1 + int(np.max(np.flatnonzero(size > SMALL * float(tail.apparent_length)), initial=-1))
    parts = [c[0].real]
    for h in range(1, most + 1):
        parts += [2.0 * c[h].real, -2.0 * c[h].imag]
    return np.ascontiguousarray(np.concatenate(parts, axis=1))


def beside_wall_of_any_shape(
    swimmer: Swimmer,
    start: tuple[Array, Array],
    *,
    level: str | None = None,
    scatter: Scatter | None = None,
    folder: str | PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> SolvedPoses:
    """Solve a swimmer at scattered poses beside its wall, and interpolate between them.

    Parameters
    ----------
    swimmer
        With a `wall`; helix or straight plane wave on a body of revolution, an ellipsoid or a box.
    start
        Position and quaternion of the pose that the spec states.
    level, folder, workers, progress
        As of `wall.beside_wall`.
    scatter
        How many poses.

    Raises
    ------
    SpecError
        If the swimmer is of another kind.
    MicroswimError
        If a pose cannot be solved.
    """
    scatter = Scatter(poses=POSES) if scatter is None else scatter
    if not is_known(swimmer):
        raise SpecError(
            "wall: a path beside it is known for one helical tail or straight plane wave, or none, "
            "on the axis of a body of revolution, an ellipsoid or a box; ask at this one pose "
            "(microswim run, with --model bem), or leave [wall] out"
        )
    shape = shape_of(swimmer, scatter.smallest)
    poses, Z, H = with_close_ones(shape, scatter.poses)
    out = np.zeros((0, 5))
    if scatter.left_out:
        out, _, _ = places(shape, scatter.left_out, scatter.left_out, seed=1)
    free_swimmer = replace(swimmer, wall=None, channel=None)
    asked = [beside(free_swimmer, pose) for pose in np.concatenate([poses, out])]
    made = solved(
        free_swimmer, asked, len(out), level, folder=folder, workers=workers, progress=progress,
        free_phases=FREE_PHASES,
    )  # fmt: skip
    Y = np.array([targets(g, made.free, *at) for g, *at in zip(made.there, poses, H, strict=True)])
    free = made.best
    known, weights = scattered.known_of_both(Z, Y)
    table = PoseTable(
        WALL, np.ascontiguousarray(pack(free)), np.array([0.0, 0, 0, 0, 0, 1]), shape.numbers,
        shape.body, shape.tail, np.zeros(0), np.zeros((0, 0, 0, 0, 0)), known, weights,
        root=powers(free),
    )  # fmt: skip
    error = error_of(table, free, [start_at(p) for p in out], made.judged)
    return SolvedPoses(free, table, start, error)


def with_close_ones(shape: Shape, count: int) -> tuple[Array, Array, Array]:
    """Return what `places` does; a part of the poses is close to the wall."""
    close = int(CLOSE * count)
    usual = places(shape, count - close, 2 * (count - close))
    near = places(shape, 4 * close, 4 * close, seed=11, furthest=NEAR)
    chosen = scattered.spread(near[1], close, others=usual[1])
    poses, Z, H = (np.concatenate([a, b[chosen]]) for a, b in zip(usual, near, strict=True))
    return poses, Z, H


def places(
    shape: Shape, count: int, among: int, seed: int = 0, furthest: float = FURTHEST
) -> tuple[Array, Array, Array]:
    """Return poses (count, 5), their features and h, far from one another.

    A pose is n of the body frame, on the side that is asked, the height of the body's centre and
    the phase: evenly in direction and phase, in the logarithm of the gap near the wall.
    """
    u = points(2 ** int(np.ceil(np.log2(among))), 4, 7000 + seed)[:among]
    numbers = shape.numbers
    n0 = 2.0 * u[:, 0] - 1.0
    turn, across = 2.0 * np.pi * u[:, 1], np.sqrt(1.0 - n0 * n0)
    n = np.stack([n0, across * np.cos(turn), across * np.sin(turn)], axis=-1)
    phase = 2.0 * np.pi * u[:, 2]
    xi = numbers[beside_wall.LOWEST] * (1.0 - u[:, 3]) + furthest * u[:, 3]
    poses = np.empty((among, 5))
    for k in range(among):
        with settled(False):
            _, _, at = any_shape.folded(numbers, n[k], phase[k])
        poses[k, :3], poses[k, 3], poses[k, 4] = n[k], 0.0, at % (2.0 * np.pi)
    gaps, Z, H = np.empty((among, 2)), np.empty((among, any_shape.FEATURES)), np.empty(among)
    of = shape.body, shape.tail, numbers, gaps, Z, H
    with settled(True):
        any_shape.of_poses(poses, *of)
        gap = numbers[beside_wall.SIZE] * np.exp(xi) / (1.0 - np.exp(xi))
        poses[:, 3] = gap - gaps.min(axis=1)
        any_shape.of_poses(poses, *of)
    chosen = scattered.spread(Z, count)
    return poses[chosen], Z[chosen], H[chosen]


def beside(swimmer: Swimmer, pose: Array) -> Swimmer:
    """Return the swimmer with its wall such that phase 0 is the pose (5,)."""
    n, height, phase = pose[:3], float(pose[3]), float(pose[4])
    wall = Wall(
        height,
        tilt=float(np.arcsin(np.clip(n[0], -1.0, 1.0))),
        azimuth=float(np.arctan2(n[2], n[1])),
    )
    tail = swimmer.tail
    if not tail.is_absent:
        ahead = float(np.remainder(np.real(tail.ahead) + phase, 2.0 * np.pi))
        tail = replace(tail, phase=ahead)  # type: ignore[type-var,call-arg]
    return replace(swimmer, wall=wall, tail=tail)


def powers(free: Gait) -> Array:
    """Return the series (1 + 2 H, 1) of `power_of` over the phase in free fluid."""
    at = 2.0 * np.pi * np.arange(2 * FREE_PHASES + 1) / (2 * FREE_PHASES + 1)
    c = np.fft.rfft([power_of(free, float(a)) for a in at]) / len(at)
    rows = [c[0].real]
    for h in range(1, len(c)):
        rows += [2.0 * c[h].real, -2.0 * c[h].imag]
    return np.array(rows)[:, None]


def targets(gait: Gait, free: Gait, pose: Array, h: float) -> Array:
    """Return L by the rows of its lower triangle (21), w (6) and log of P over free fluid's, by h.

    Raises
    ------
    numpy.linalg.LinAlgError
        If R is not positive definite.
    """
    phase = float(pose[4])
    R, F = gait.resistance(0.0), gait.propulsion(0.0)
    there, driven = free.resistance(phase), free.propulsion(phase)
    inverse = np.linalg.inv(np.linalg.cholesky(there))
    E = inverse @ R @ inverse.T
    values, vectors = np.linalg.eigh(0.5 * (E + E.T))
    if not values[0] > 0.0:
        raise np.linalg.LinAlgError("a resistance beside the wall is not positive definite")
    L = (vectors * np.log(values)) @ vectors.T
    w = np.linalg.solve(R, F) - np.linalg.solve(there, driven)
    more = added_power(gait, power_of(free, phase))
    return np.concatenate([L[np.tril_indices(6)], w, [more]]) / h


def start_at(pose: Array) -> tuple[Array, Array, float]:
    """Return position, quaternion and phase of a pose (5,) beside the wall z = 0."""
    from microswim.calibration.poses.wall import start_of

    n = pose[:3]
    x, q = start_of(
        Wall(float(pose[3]), tilt=float(np.arcsin(np.clip(n[0], -1, 1))),
             azimuth=float(np.arctan2(n[2], n[1])))
    )  # fmt: skip
    return x, q, float(pose[4])
