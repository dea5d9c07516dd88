"""The path of a swimmer under everything that its spec says acts on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.held import warn_if_held
from microswim.gait.poses.face import FreePoses, Poses
from microswim.gait.poses.table import FREE, TUBE
from microswim.gait.stepping import length_of
from microswim.numerics.array import Array
from microswim.path import outcome
from microswim.path.by_torque import check_alone, follow_motors
from microswim.path.contact import REACH
from microswim.path.course import Course, Followed, follow
from microswim.path.loads import loads_of
from microswim.path.march import gaps_along
from microswim.path.remembering import period_of, remember, remembers
from microswim.path.samples import sampled
from microswim.path.start import (
    check_bounds,
    check_clear,
    check_count,
    check_early,
    pose_at_start,
    rest_start,
    three,
)
from microswim.path.trajectory import dataset
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

TURNS = 0.1  #: rad that noise turns the swimmer by in a step, at most (root mean square)
TURNED = 0.4  #: rad that the field does, with noise
_LOOSE = 30.0  #: times the tolerance: the second march, for the error of the first


def at_every_pose(name: str, value: Any) -> None:
    """Refuse what is no gait as a function of the pose."""
    if not all(hasattr(value, part) for part in ("gait", "table", "start", "gap")):
        raise SpecError(name, value, "a gait at every pose", "for one in free fluid give gait")


@checks.given(
    swimmer=checks.swimmer,
    time=checks.above_zero("time"),
    model=checks.text,
    level=checks.one_of("coarse", "standard", "fine"),
    gait=checks.gait,
    poses=at_every_pose,
    position=checks.series,
    quaternion=checks.series,
    tilt=checks.series,
    phase=checks.series,
    force=checks.series,
    torque=checks.series,
    samples=checks.at_least(2),
    tolerance=checks.above_zero("number"),
    contact=checks.above_zero("length"),
    paths=checks.at_least(1),
    seed=checks.at_least(0),
    step=checks.above_zero("time"),
    keep=checks.place,
    memory=checks.truth,
    progress=checks.function,
)
def path(
    swimmer: Swimmer,
    time: float,
    *,
    model: doors.Model = "auto",
    level: Literal["coarse", "standard", "fine"] | None = None,
    gait: Gait | None = None,
    poses: Poses | None = None,
    position: Any = None,
    quaternion: Any = None,
    tilt: float | None = None,
    phase: float = 0.0,
    force: Any = (0.0, 0.0, 0.0),
    torque: Any = (0.0, 0.0, 0.0),
    samples: int | None = None,
    tolerance: float = 1e-6,
    contact: float | None = None,
    paths: int = 1,
    seed: int = 0,
    step: float | None = None,
    memory: bool | None = None,
    keep: str | PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Follow a swimmer in time: its motor, magnetic field, gravity, flow and thermal noise.

    Parameters
    ----------
    swimmer
        With its `magnet` and `field`, `gravity`, `flow` and `noise`; what it has not does not act.
    time
        How long.
    model, gait
        Model of the gait, or the gait itself. Beside a wall and in a tube poses are solved by
        boundary elements, whatever the model, and kept in the user's cache: minutes, once.
    level
        Of boundary and finite elements, and of poses; by default that of each.
    poses
        A gait at every pose, as beside a wall or in a tube, in place of `gait`.
    position, quaternion, phase
        Pose at the start, lab frame, and phase of the motor. By default the origin and the lab's
        axes, in which the swimmer heads for -x; beside a wall, which is the plane z = 0, as the
        wall says; in a tube, whose axis is the x axis, as the channel says.
    tilt
        Angle (rad) by which it noses down at the start, in place of `quaternion`; in a tube as
        `Channel` has it.
    force, torque
        Further ones on the body about its centre, constant, lab frame (3,).
    samples
        Times at which the path is kept, evenly spaced; by default 16 in a period of the motor, and
        whole periods where these would be more than 4000.
    tolerance
        Error of a time step, in lengths of the swimmer and in radians.
    contact
        Range of the repulsion that keeps the swimmer off a boundary (length); by default a
        hundredth of the body's half width.
    paths
        Number of paths with noise; more than one adds a dimension ``path``.
    seed
        Of the noise: the same seed, the same path.
    step
        Time step with noise; by default 1/24 of a period, and short enough that noise turns the
        swimmer by less than 0.1 rad and the field by less than 0.4.
    memory
        Whether an elastic tail is followed from its shape at rest, every piece of it under the
        loads; otherwise the swimmer has the beat that its tail settles to in still fluid. By
        default where its drive alone does not make its beat: ``drive = "none"``, a magnetic
        filament, gravity, a wall, a flow that is not uniform, or a flow past one that is held. Of a
        wall such a tail knows a short-range repulsion alone; there is no noise.
    keep
        File in which the path is kept while it grows; a call that finds it there goes on.
    progress
        Called with the parts done and of all.

    Returns
    -------
    xarray.Dataset
        With a `Motor` that gives a torque: what `own_motors` gives, ``phase`` (time, tail) among
        it, in still free fluid, by resistive force theory or boundary elements; otherwise
        ``position`` (time, axis), ``quaternion`` (time, wxyz) and ``phase`` as of `trajectory`;
        ``gap`` to the boundary; with memory ``filament`` (time, point, axis), points along the
        filament in the lab; without noise ``motor_work`` and ``dissipated`` since the start;
        as attributes ``outcome``, ``circle_radius``, ``circle_sense`` (seen from above; in a tube
        about its axis, seen from +x),
        ``gap_mean``, ``drift`` and ``position_error`` (of the last place, by the time steps alone);
        with memory ``repeats_after``, the periods of the drive (of the field, where that is faster)
        after which the shape comes back: 1, 2 (it period-doubles), up to 8; 0: it does not.

    Raises
    ------
    SpecError
        If an argument is out of range, or the gait holds at one pose.
    MicroswimError
        If the path cannot be followed.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix").with_({"tail.frequency": 1.0})
    >>> found = ms.path(swimmer, time=2.0)
    >>> found.attrs["outcome"], bool(found.position[-1, 0] < 0)
    ('free', True)
    """
    if memory is None:
        memory = gait is None and poses is None and remembers(swimmer)
    if memory:
        pushes = {"force": three("force", force), "torque": three("torque", torque)}
        start = pose_at_start(swimmer, rest_start(swimmer), position, quaternion, tilt)
        return remember(
            swimmer, sampled(period_of(swimmer), time, samples), position=start[0],
            quaternion=start[1], phase=float(phase), tolerance=float(tolerance),
            keep=None if keep is None else Path(keep), progress=progress, **pushes,
        )  # fmt: skip
    if poses is None and gait is None and swimmer.motor is not None:
        check_alone(swimmer, model, np.any(force) or np.any(torque), step=step, contact=contact)
        if paths > 1:
            raise SpecError("paths", paths, "1 with [motor]", "all paths would be the same")
        begin = pose_at_start(swimmer, rest_start(swimmer), position, quaternion, tilt)
        more: Any = {"model": model, "level": level, "tolerance": float(tolerance)}
        more |= {"keep": None if keep is None else Path(keep), "progress": progress}
        return follow_motors(swimmer, lambda T: sampled(T, time, samples), begin, phase, **more)
    if poses is None and gait is None:
        begins = {"position": position, "quaternion": quaternion, "tilt": tilt}
        check_early(swimmer, phase, paths, **begins)
    if poses is None:
        poses = _poses(swimmer, model, gait, level, progress)
    check_bounds(poses, swimmer)
    made = poses.gait
    if swimmer.field is not None and swimmer.magnet is not None:
        warn_if_held(made, swimmer.magnet.magnetic)
    check_count(swimmer, paths)
    loads = loads_of(swimmer.settled, made, three("force", force), three("torque", torque), contact)
    start = pose_at_start(swimmer, poses.start, position, quaternion, tilt)
    check_clear(poses, *start, phase)
    times = sampled(float(made.period), time, samples)
    energy = swimmer.noise.energy(swimmer.units) if swimmer.noise is not None else 0.0
    length = length_of(made)
    course = Course(
        table=poses.table,
        loads=loads,
        times=times,
        position=np.tile(start[0], (paths, 1)),
        quaternion=np.tile(start[1], (paths, 1)),
        phase=float(phase),
        length=length,
        tolerance=float(tolerance),
        longest=_longest(made, loads, times, energy, step, _pull(swimmer, times, start[0])),
        energy=energy,
        seed=int(seed),
        field=_in_space(swimmer),
        tumbles=swimmer.noise.tumbles if swimmer.noise is not None else None,
    )
    found = follow(course, None if keep is None else Path(keep), progress)
    return _told(swimmer, made, poses, course, found)


def _in_space(swimmer: Swimmer) -> AppliedField | None:
    """Return the field if it is more than a wave in time and there is what it acts on."""
    field = swimmer.field
    if field is None or field.is_periodic or swimmer.magnet is None:
        return None
    return field


def _poses(
    swimmer: Swimmer, model: str, gait: Gait | None, level: str | None, progress: Any
) -> Poses:
    """Return the gait at every pose: solved by a wall or in a tube, the same in free fluid."""
    if gait is None and (swimmer.wall is not None or swimmer.channel is not None):
        around: Poses = doors.go(doors.AT_POSES, swimmer, level=level, progress=progress)
        return around
    how: Any = {} if level is None else {"level": level}
    free: Any = FreePoses(swimmer.gait(model, **how) if gait is None else gait)  # type: ignore[arg-type]
    return free


def _pull(swimmer: Swimmer, times: Array, place: Array) -> float:
    """Return the largest torque of the field on the magnet at the place where it starts."""
    if swimmer.field is None or swimmer.magnet is None:
        return 0.0
    some = np.linspace(times[0], times[-1], 64)
    B = np.linalg.norm(swimmer.field.at(some, np.broadcast_to(place, (64, 3))), axis=-1).max()
    magnet = swimmer.magnet
    return float(B * (np.linalg.norm(magnet.vector) + B * np.linalg.norm(magnet.softness, 2)))


def _longest(
    gait: Gait, loads: Any, times: Array, energy: float, step: float | None, pull: float
) -> float:
    """Longest step: a part of the period of motor and field, with noise a small turn."""
    if step is not None:
        return float(step)
    fastest = max(abs(loads.rate), loads.field_rate, np.abs(loads.gradient).max(), 1e-300)
    share = 24.0 if energy else 4.0
    limits = [2.0 * np.pi / fastest / share, (times[-1] - times[0]) / 16.0]
    if energy:
        M = np.linalg.inv(np.real(gait.resistance(0.0))[3:, 3:])
        limits.append(TURNS**2 / (2.0 * energy * float(np.trace(M))))
        limits.append(TURNED / max(pull * np.linalg.norm(M, 2), 1e-300))
    return float(min(limits))


def _told(
    swimmer: Swimmer, gait: Gait, poses: Poses, course: Course, found: Followed
) -> xr.Dataset:
    """Return what was found with its numbers."""
    times = course.times
    angle = course.phase + course.loads.rate * times
    many = len(course.position) > 1
    if many:
        data = dataset(gait, times, found.position, found.quaternion, angle)
    else:
        data = dataset(gait, times, found.position[0], found.quaternion[0], angle)
    bounded = poses.table.kind != FREE
    told: dict[str, Any] = {}
    if bounded:
        gaps = np.empty(found.position.shape[:2])
        for x, q, out in zip(found.position, found.quaternion, gaps):
            gaps_along(poses.table, x, q, angle, out)
        told["gap"] = gaps if many else gaps[0]
    if not course.energy:
        told["motor_work"], told["dissipated"] = found.spent[0].T
    return outcome.with_numbers(data, told, _ends(swimmer, course, found, bounded, told))


def _ends(
    swimmer: Swimmer, course: Course, found: Followed, bounded: bool, told: dict[str, Any]
) -> dict[str, Any]:
    """Return how each path ended, and its numbers."""
    x = found.position[0]
    if course.table.kind == TUBE:
        radius, turn = outcome.winding(x)
    else:
        radius, turn = outcome.circling(x, np.array([0.0, 0.0, 1.0]))
    sense = None if turn is None else ("counterclockwise" if turn > 0 else "clockwise")
    span = course.times[-1] - course.times[0]
    gaps = np.atleast_2d(told["gap"])[0] if bounded else np.full(1, np.inf)
    if bounded:
        gaps = np.append(gaps, found.least[0])  # between the samples as well
    length = float(nose_to_tip(swimmer))
    last = np.atleast_2d(told["gap"])[0] if bounded else gaps
    return {
        "outcome": outcome.ended(last, gaps.min(), length, course.loads.contact[REACH], turn),
        "circle_radius": np.nan if radius is None else radius,
        "circle_sense": sense or "",
        "gap_mean": float(np.mean(last)) if bounded else np.nan,
        "drift": (x[-1] - x[0]) / span,
        "position_error": np.nan if course.energy else _off(course, found),
        "steps": found.steps,
        "contact": course.loads.contact[REACH],
        "boundary": ("none", "wall", "tube")[course.table.kind],
        "tube_radius": float(course.table.boundary[6]) if course.table.kind == TUBE else np.nan,
    }


def _off(course: Course, found: Followed) -> float:
    """Distance by which a second march with looser steps ends elsewhere."""
    ends = course.times[[0, -1]]
    loose = replace(course, times=ends, tolerance=_LOOSE * course.tolerance)
    if loose.longest < 4.0 * (ends[1] - ends[0]):
        loose = replace(loose, longest=1.5 * course.longest)
    return float(np.linalg.norm(follow(loose).position[0, -1] - found.position[0, -1]))
