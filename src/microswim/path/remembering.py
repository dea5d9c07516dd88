"""The path of a swimmer whose elastic tail remembers: pose and shape from rest on, in time.

Loads that turn or pull in the lab (a magnetic field, gravity, a flow, a wall) act on every piece of
the filament, so there is no gait to follow: pose and strains are marched together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.gait.units import unit
from microswim.models.elastic.unsteady.march import LOOSEST, Shape, at_rest, marched
from microswim.models.elastic.unsteady.numbers import units_of
from microswim.numerics.array import Array
from microswim.path import keeping, outcome
from microswim.path.repeating import repeats_after
from microswim.path.trajectory import dataset
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

CHUNKS, PERIODS = 48, 2.0  #: of a path that are kept: at most so many, of so many periods at least
LOOSE = 30.0  #: times the tolerance, or a part of it: a second march, for the error of the first
REPULSION = 0.01  #: range over the length


@dataclass(frozen=True)
class Remembered:
    """What such a path is by: a model and units."""

    units: str
    model: str = "elastic"


def remembers(swimmer: Swimmer) -> bool:
    """Return whether a swimmer has an elastic tail whose beat is not that of its drive alone.

    Nothing may drive it, or a field, weight, a wall or a flow that is not the same everywhere pull
    at it; of a swimmer that is held somewhere also one that is.
    """
    tail: Any = swimmer.tail
    if not tail.settles or swimmer.noise is not None:
        return bool(tail.settles) and (tail.drive == "none" or tail.is_magnetic)
    flow = swimmer.flow
    sheared = flow is not None and (flow.bends or bool(np.any(flow.gradient)))
    dragged = flow is not None and not all(swimmer.motion.mask[:3])
    loaded = swimmer.gravity is not None or swimmer.wall is not None or sheared or dragged
    return tail.drive == "none" or tail.is_magnetic or loaded


def period_of(swimmer: Swimmer) -> float:
    """Return the period of the drive or the field, whichever is shorter, or of slackening."""
    return 2.0 * np.pi * units_of(swimmer).time


def remember(
    swimmer: Swimmer,
    times: Array,
    *,
    position: Array,
    quaternion: Array,
    phase: float,
    tolerance: float,
    keep: Path | None,
    progress: Callable[[int, int], None] | None,
    force: Array,
    torque: Array,
) -> xr.Dataset:
    """Return the path of a swimmer whose elastic tail starts from its shape at rest.

    Arguments as of `microswim.path.following.path`.

    Raises
    ------
    SpecError
        If the swimmer has what is not followed so, or `keep` holds another path.
    MicroswimError
        If the path cannot be followed.
    """
    start = at_rest(swimmer, position, quaternion, phase)
    more = {"force": force, "torque": torque}
    cuts = _cuts(swimmer, times)
    digest = sha256(repr((swimmer, times.tolist(), start, tolerance, more)).encode()).hexdigest()
    known = _kept(keep, digest) if keep is not None and keep.exists() else None
    shapes, places = known or ([start], np.empty((0, 0, 3)))
    begun = int(np.searchsorted(cuts, len(shapes) - 1))
    for i in range(begun, len(cuts) - 1):
        part = times[cuts[i] : cuts[i + 1] + 1]
        found = marched(swimmer, shapes[-1], part, tolerance, float(part[0]), **more)
        shapes += found.shapes[1:]
        places = found.places if not len(places) else np.concatenate([places, found.places[1:]])
        if keep is not None:
            _keep(keep, digest, shapes, places)
        if progress is not None:
            progress(i + 1, len(cuts) - 1)
    ends = times[[0, -1]]
    other = LOOSE * tolerance if LOOSE * tolerance <= LOOSEST else min(tolerance, LOOSEST) / LOOSE
    again = marched(swimmer, start, ends, other, float(ends[0]), **more).shapes[-1]
    off = float(np.linalg.norm(again.position - shapes[-1].position))
    return _told(swimmer, times, shapes, places, off)


def _cuts(swimmer: Swimmer, times: Array) -> Array:
    """Indices of the times at which parts of the path begin and end."""
    periods = (times[-1] - times[0]) / period_of(swimmer)
    parts = int(np.clip(periods // PERIODS, 1, min(CHUNKS, times.size - 1)))
    return np.unique(np.linspace(0, times.size - 1, parts + 1).astype(int))


def _told(
    swimmer: Swimmer, times: Array, shapes: list[Shape], places: Array, off: float
) -> xr.Dataset:
    x, q = (np.array([getattr(s, n) for s in shapes]) for n in ("position", "quaternion"))
    angle = np.array([s.phase for s in shapes])
    data = dataset(Remembered(swimmer.units), times, x, q, angle)
    about = {"units": unit(swimmer.units, "length"), "long_name": "filament, root to tip, lab"}
    data = data.assign(filament=(("time", "point", "axis"), places, about))
    spent = np.array([s.work for s in shapes])
    told: dict[str, Any] = {"motor_work": spent[:, 0], "dissipated": spent[:, 1]}
    gaps = np.full(1, np.inf)
    if swimmer.wall is not None:
        gaps = told["gap"] = _gaps(swimmer, x, q, places)
    radius, turn = outcome.circling(x, np.array([0.0, 0.0, 1.0]))
    sense = None if turn is None else ("counterclockwise" if turn > 0 else "clockwise")
    reach, length = REPULSION * float(swimmer.tail.length), float(swimmer.body_length)  # type: ignore[attr-defined]
    length += float(swimmer.tail.apparent_length)
    numbers = {
        "outcome": outcome.ended(gaps, float(gaps.min()), length, reach, turn),
        "circle_radius": np.nan if radius is None else radius,
        "circle_sense": sense or "",
        "gap_mean": float(gaps.mean()) if swimmer.wall is not None else np.nan,
        "drift": (x[-1] - x[0]) / (times[-1] - times[0]),
        "position_error": off,
        "steps": times.size - 1,
        "contact": reach,
        "repeats_after": repeats_after(times, _bends(shapes), period_of(swimmer)),
    }
    return outcome.with_numbers(data, told, numbers)


def _bends(shapes: list[Shape]) -> Array:
    """Strains and the hook's turn at each time, (n, d)."""
    most = max(s.strains.shape[1] for s in shapes)
    rows = [
        np.append(np.pad(s.strains, ((0, 0), (0, most - s.strains.shape[1]))), s.hook)
        for s in shapes
    ]
    return np.array(rows)


def _gaps(swimmer: Swimmer, x: Array, q: Array, places: Array) -> Array:
    """Smallest distance of the surface from the plane z = 0 at each time."""
    w, a, b, c = q.T  # third row of the rotation matrix: z by the body's axes
    up = np.stack([2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a**2 + b**2)], axis=1)
    girth = np.linalg.norm(up * np.array(swimmer.body.semi_axes3, float), axis=1)
    thick = float(swimmer.tail.radius)  # type: ignore[arg-type]
    return np.minimum(x[:, 2] - girth, places[..., 2].min(axis=1) - thick)


_POSE, _SHAPE = ("position", "quaternion", "phase", "work"), ("strains", "hook", "places")


def _keep(place: Path, digest: str, shapes: list[Shape], places: Array) -> None:
    last, pose = shapes[-1], {n: np.array([getattr(s, n) for s in shapes]) for n in _POSE}
    keeping.keep(place, digest, places=places, strains=last.strains, hook=last.hook, **pose)


def _kept(place: Path, digest: str) -> tuple[list[Shape], Array]:
    """Return what a file holds of this path: poses, of which the last has its shape."""
    found = keeping.kept(place, digest, _POSE + _SHAPE)
    strains, hook = found["strains"], found["hook"]
    poses = zip(*(found[n] for n in _POSE))
    return [Shape(x, q, float(p), strains, hook, w) for x, q, p, w in poses], found["places"]
