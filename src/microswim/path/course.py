"""A course: everything that a path depends on, followed in chunks that may be kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from hashlib import sha256
from pathlib import Path

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.gait.poses.table import PoseTable
from microswim.numerics.array import Array
from microswim.path import brownian, keeping, noise_in_space
from microswim.path.in_space import follow_loads
from microswim.path.march import DONE, TOO_LONG, march
from microswim.path.tumbling import tumbled
from microswim.path.velocity import Loads
from microswim.swimmer.magnetism.applied_field import AppliedField

MOST_STEPS = 1e8
CHUNKS = 48  #: of a path, each kept when it is done
RUN_PARTS = 20.0  #: of a run, between which tumbles happen
_NUMBERS = 2_000_000  #: random ones drawn at a time


@dataclass(frozen=True, eq=False)
class Course:
    """What a path depends on.

    Parameters
    ----------
    table, loads
        The gait at every pose, and the loads.
    times
        At which the path is wanted (n,); it starts at the first.
    position, quaternion
        Start of each path, (m, 3) and (m, 4).
    phase
        Of the motor at the start.
    length
        Of the swimmer; errors of the place are measured by it.
    tolerance
        Error of a step, in lengths and in radians.
    longest
        Longest step.
    energy
        k_B T; zero: no noise.
    seed
        Of the noise.
    field
        One that depends on place or follows a table; none where the loads hold it.
    tumbles
        Mean time of a run and angle of a tumble.
    """

    table: PoseTable
    loads: Loads
    times: Array
    position: Array
    quaternion: Array
    phase: float
    length: float
    tolerance: float
    longest: float
    energy: float = 0.0
    seed: int = 0
    field: AppliedField | None = None
    tumbles: tuple[float, float] | None = None

    @property
    def digest(self) -> str:
        """Fingerprint of all that the path depends on."""
        whole = sha256()
        parts = (*self.table, *self.loads, self.times, self.position, self.quaternion)
        for part in (*parts, self.phase, self.length, self.tolerance, self.longest):
            whole.update(np.ascontiguousarray(part).tobytes())
        whole.update(repr((self.energy, self.seed, self.field)).encode())
        whole.update(repr(self.tumbles).encode() if self.tumbles else b"")
        named = getattr(self.field, "file", None)
        whole.update(Path(named).read_bytes() if named else b"")
        return whole.hexdigest()[:16]


@dataclass(eq=False)
class Followed:
    """A path as far as it is known: it grows chunk by chunk.

    Parameters
    ----------
    position, quaternion, spent
        At the times so far: (m, n, 3), (m, n, 4), and work of the motor and dissipated (m, n, 2).
    least
        Smallest gap of each path (m,).
    step
        Next step.
    chunks
        That are done.
    """

    position: Array
    quaternion: Array
    spent: Array
    least: Array
    step: float
    chunks: int = 0
    steps: int = 0
    stuck: list[float] = field(default_factory=list)


def follow(
    course: Course,
    keep: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Followed:
    """Follow a course to its end; what a killed process kept in the file `keep` is gone on from.

    Raises
    ------
    SpecError
        If the file holds another course.
    MicroswimError
        If the path cannot be followed: it would take too many steps, or leads into a boundary.
    """
    shortest = (course.times[-1] - course.times[0]) / course.longest
    if not shortest * (len(course.position) if course.energy else 1) <= MOST_STEPS:
        raise too_long()
    cuts = np.unique(np.linspace(0, course.times.size - 1, CHUNKS + 1).astype(int))
    found = _kept(course, keep) if keep is not None and keep.exists() else None
    known = found or _start(course)
    for i in range(known.chunks, cuts.size - 1):
        times = course.times[cuts[i] : cuts[i + 1] + 1]
        if course.energy:
            _scattered(course, known, times, i)
        else:
            (_marched if course.field is None else _marched_in_space)(course, known, times)
        known.chunks = i + 1
        if keep is not None:
            keeping.keep(keep, course.digest, **{n: getattr(known, n) for n in _ARRAYS + _PLAIN})
        if progress is not None:
            progress(i + 1, cuts.size - 1)
    return known


def _start(course: Course) -> Followed:
    m = len(course.position)
    first = course.position[:, None].copy(), course.quaternion[:, None].copy()
    h = course.longest / 16.0
    return Followed(*first, np.zeros((m, 1, 2)), np.full(m, np.inf), h)


def _phase(course: Course, time: float) -> float:
    return course.phase + course.loads.rate * (time - course.times[0])


def _marched(course: Course, known: Followed, times: Array) -> None:
    """One chunk without noise, every path."""
    m, n = len(course.position), times.size
    X, Q, spent = np.empty((m, n, 3)), np.empty((m, n, 4)), np.empty((m, n, 2))
    for k in range(m):
        x, q = known.position[k, -1].copy(), known.quaternion[k, -1].copy()
        most = MOST_STEPS - known.steps
        control = np.array(
            [known.step, course.longest, course.tolerance, course.length, most, known.least[k]]
        )
        phase = _phase(course, times[0])
        how, steps = march(
            *(course.table, course.loads, times, x, q, phase, control, X[k], Q[k], spent[k])
        )
        if how != DONE:
            raise _failed(how, known)
        known.steps += steps
        known.least[k] = control[5]
    known.step = control[0] if m == 1 else known.step
    _append(known, X[:, 1:], Q[:, 1:], spent[:, 1:] + known.spent[:, -1:])


def _marched_in_space(course: Course, known: Followed, times: Array) -> None:
    """One chunk of one path in a field that depends on place."""
    assert course.field is not None
    start = known.position[0, -1], known.quaternion[0, -1], _phase(course, times[0])
    control = course.tolerance, course.length, course.longest
    X, Q, spent = follow_loads(course.table, course.loads, course.field, times, start, control)
    known.steps += times.size - 1
    _append(known, X[None, 1:], Q[None, 1:], spent[None, 1:] + known.spent[:, -1:])


def too_long() -> SpecError:
    """Return the error of a path that would never end."""
    return SpecError(f"time: the path would take more than {MOST_STEPS:g} steps; shorten it")


def _failed(how: int, known: Followed) -> MicroswimError:
    if how == TOO_LONG:
        return too_long()
    if np.isfinite(known.least).any():
        return MicroswimError(
            "the path cannot be followed: the swimmer starts inside the boundary, or is pressed "
            "into it; start further away or raise the range of the contact"
        )
    return MicroswimError("the path cannot be followed: the loads change too fast")


def _scattered(course: Course, known: Followed, times: Array, chunk: int) -> None:
    """One chunk with noise, all paths at once."""
    rng = np.random.default_rng([course.seed, chunk])
    m, n = len(course.position), times.size
    X, Q = known.position[:, -1].copy(), known.quaternion[:, -1].copy()
    run: Callable[..., None] = brownian.scatter.over(m)
    if course.field is not None:
        run = partial(noise_in_space.scatter, field=course.field)
    places, turns = np.empty((m, n - 1, 3)), np.empty((m, n - 1, 4))
    for j in range(n - 1):
        whole = times[j + 1] - times[j]
        steps = max(1, int(np.ceil(whole / course.longest - 1e-9)))
        h, done = whole / steps, 0
        while done < steps:
            count = min(steps - done, max(1, _NUMBERS // (m * brownian.NORMALS)))
            if course.tumbles:
                count = min(count, max(1, int(course.tumbles[0] / (RUN_PARTS * h))))
            normals = rng.standard_normal((count, m, brownian.NORMALS))
            t = times[j] + done * h
            run(
                *(course.table, course.loads, course.energy, course.length, t, h, X, Q),
                *(_phase(course, t), normals, known.least),
            )
            done += count
            if course.tumbles:
                run_time, angle = course.tumbles
                Q = tumbled(Q, count * h / run_time, angle, rng)
        known.steps += steps
        places[:, j], turns[:, j] = X, Q
    if not np.isfinite(places).all():
        raise MicroswimError("the path cannot be followed: noise or loads are too large")
    _append(known, places, turns, np.zeros((m, n - 1, 2)))


def _append(known: Followed, X: Array, Q: Array, spent: Array) -> None:
    known.position = np.concatenate([known.position, X], axis=1)
    known.quaternion = np.concatenate([known.quaternion, Q], axis=1)
    known.spent = np.concatenate([known.spent, spent], axis=1)


_ARRAYS, _PLAIN = ("position", "quaternion", "spent", "least"), ("step", "chunks", "steps")


def _kept(course: Course, place: Path) -> Followed:
    """Return what a file holds of this course."""
    found = keeping.kept(place, course.digest, _ARRAYS + _PLAIN)
    return Followed(**found | {n: found[n].item() for n in _PLAIN})
