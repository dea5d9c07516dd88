"""Maps of starts: which end orbiting, trapped, escaping, over start pose and design.

Each point is a path of its own (`microswim.path.following.path`); poses beside a boundary are
solved once for each body, tail and boundary. The map is on disk as it grows, and a call that finds
it there goes on.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from itertools import product
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim import checks
from microswim.calibration.poses.around import around, same_poses, started
from microswim.errors import MicroswimError, SpecError
from microswim.gait import doors
from microswim.gait.poses.face import FreePoses
from microswim.gait.units import unit
from microswim.jobs.processes import answers, counted
from microswim.jobs.worker import Lost
from microswim.numerics.files import write
from microswim.path.following import at_every_pose, path
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

#: What of a start may vary, beside every field of the spec.
STARTS = {"x": "length", "y": "length", "z": "length", "tilt": "angle", "phase": "angle"}
#: What is told of each path, with its unit.
TOLD = {"circle_radius": "length", "gap_mean": "length", "gap_least": "length"}
DRIFT = ("x", "y", "z")
INSIDE = "inside"  #: outcome of a start that reaches into the boundary
MOST = 100_000


def _grid(name: str, value: Any) -> None:
    """Refuse what is no grid of starts."""
    if not isinstance(value, Mapping) or not value:
        raise SpecError(name, value, 'names and values, such as {"z": [1.0, 2.0], "tilt": [0.1]}')
    for key, values in value.items():
        if not isinstance(key, str) or not (key in STARTS or "." in key):
            allowed = f"one of {', '.join(STARTS)}, or a field such as gravity.density"
            raise SpecError(f"{name}: name", key, allowed)
        if isinstance(values, str) or not np.ndim(values) == 1 or not len(values):
            raise SpecError(f"{name}[{key!r}]", values, "a list of one value or more")


@checks.given(
    swimmer=checks.swimmer,
    time=checks.above_zero("time"),
    over=_grid,
    model=checks.text,
    poses=at_every_pose,
    keep=checks.place,
    progress=checks.function,
)
def starts(
    swimmer: Swimmer,
    time: float,
    over: Mapping[str, Sequence[Any]],
    *,
    model: doors.Model = "auto",
    poses: Any = None,
    keep: str | PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Follow a swimmer from every start of a grid, and tell how each path ends.

    Parameters
    ----------
    swimmer
        Without noise.
    time
        How long each path is.
    over
        Names and values; the grid of all combinations. ``x``, ``y``, ``z`` (of the body's centre,
        lab frame), ``tilt`` (rad) and ``phase`` (rad) of the start, as `path` has them, and fields
        of the swimmer by their dotted names.
    model
        Of the gait in free fluid; beside a boundary poses are solved.
    poses
        A gait at every pose, if neither body nor tail varies, nor the width of a tube.
    keep
        File in which the map is kept while it grows; a call that finds it there goes on.
    workers
        Processes; all cores by default, 0 for this one alone.
    progress
        Called with the paths done and of all.

    Returns
    -------
    xarray.Dataset
        Over the names: ``outcome`` as of `path`, or ``"inside"`` where the start reaches into the
        boundary, or the reason why there is no path; ``circle_radius``, ``circle_sense``,
        ``gap_mean``, ``gap_least`` and ``drift`` (axis).

    Raises
    ------
    SpecError
        If an argument is out of range, or the swimmer has noise.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix")
    >>> found = ms.starts(robot, 1.0, {"tilt": [0.0, 0.5]}, model="rft", workers=0)
    >>> found.outcome.values.tolist()
    ['free', 'free']
    """
    if swimmer.noise is not None:
        raise SpecError("noise: leave it out; of a map each start has one path")
    axes = {name: np.asarray(values) for name, values in over.items()}
    grid = list(product(*(a.tolist() for a in axes.values())))
    if len(grid) > MOST:
        raise SpecError("over", f"{len(grid)} starts", f"at most {MOST}")
    count, place = counted(workers), None if keep is None else Path(keep)
    named = [dict(zip(axes, point, strict=True)) for point in grid]
    changed = [_changed(swimmer, point) for point in named]
    digest = _digest(swimmer, time, axes, model)
    rows: dict[str, Any] = {} if place is None else _kept(place, digest)
    left = [i for i in range(len(grid)) if str(i) not in rows]
    if progress is not None:
        progress(len(grid) - len(left), len(grid))
    known = _Poses(model, poses, swimmer)
    jobs = ((changed[i], float(time), known.of(changed[i]), _start(named[i])) for i in left)
    for k, found in answers(followed, jobs, count if len(left) > 1 else 0):
        rows[str(left[k])] = {"outcome": found.reason} if isinstance(found, Lost) else found
        if place is not None:
            write(place, json.dumps({"digest": digest, "rows": rows}).encode())
        if progress is not None:
            progress(len(rows), len(grid))
    return _told(swimmer, axes, [rows[str(i)] for i in range(len(grid))], float(time))


def followed(swimmer: Swimmer, time: float, poses: Any, start: dict[str, Any]) -> dict[str, Any]:
    """Return how one path ended."""
    place = np.array(poses.start[0], float)
    for k, name in enumerate(DRIFT):
        place[k] = start.pop(name, place[k])
    try:
        if not poses.gap(place, *_attitude(swimmer, poses, start)) > 0.0:
            return {"outcome": INSIDE}
        found = path(swimmer, time, poses=poses, position=place, **start)
    except MicroswimError as error:
        return {"outcome": str(error)}
    about = found.attrs
    least = float(found.gap.min()) if "gap" in found else np.nan
    return {
        "outcome": about["outcome"], "circle_radius": float(about["circle_radius"]),
        "circle_sense": about["circle_sense"], "gap_mean": float(about["gap_mean"]),
        "gap_least": least, "drift": np.asarray(about["drift"], float).tolist(),
    }  # fmt: skip


def _attitude(swimmer: Swimmer, poses: Any, start: dict[str, Any]) -> tuple[Any, float]:
    from microswim.path.start import pose_at_start

    q = pose_at_start(swimmer, poses.start, None, None, start.get("tilt"))[1]
    return q, float(start.get("phase", 0.0))


def is_bounded(swimmer: Swimmer) -> bool:
    """Return whether a wall or a tube is there."""
    return swimmer.wall is not None or swimmer.channel is not None


def with_poses(swimmer: Swimmer, over: Mapping[str, Sequence[Any]]) -> list[Swimmer]:
    """Return the designs of a grid of starts whose poses are solved, each once."""
    names = [name for name in over if name not in STARTS]
    points = product(*(np.asarray(over[name]).tolist() for name in names))
    found = [_changed(swimmer, dict(zip(names, point, strict=True))) for point in points]
    return list({same_poses(one): one for one in found if is_bounded(one)}.values())


class _Poses:
    """Gaits at every pose, once for each body, tail and boundary."""

    def __init__(self, model: str, given: Any, own: Swimmer) -> None:
        self.model, self.given, self.bounds = model, given, (own.wall, own.channel)
        self.made: dict[str, Any] = {}

    def of(self, swimmer: Swimmer) -> Any:
        """Return the gait at every pose of a swimmer."""
        if self.given is not None:
            same = (swimmer.wall, swimmer.channel) == self.bounds
            return self.given if same else started(self.given, swimmer)
        key, bounded = same_poses(swimmer), is_bounded(swimmer)
        if key not in self.made:
            self.made[key] = (
                around(swimmer) if bounded else FreePoses(swimmer.gait(self.model))  # type: ignore[arg-type]
            )
        return started(self.made[key], swimmer) if bounded else self.made[key]


def _changed(swimmer: Swimmer, point: dict[str, Any]) -> Swimmer:
    fields = {name: value for name, value in point.items() if "." in name}
    return swimmer.with_(fields) if fields else replace(swimmer)


def _start(point: dict[str, Any]) -> dict[str, Any]:
    return {name: float(value) for name, value in point.items() if name in STARTS}


def _digest(swimmer: Swimmer, time: float, axes: Mapping[str, Any], model: str) -> str:
    seen = [repr(swimmer), float(time), {k: a.tolist() for k, a in axes.items()}, model]
    return sha256(repr(seen).encode()).hexdigest()[:20]


def _kept(place: Path, digest: str) -> dict[str, Any]:
    """Return the rows that a file holds.

    Raises
    ------
    SpecError
        If it is of another map, or cannot be read.
    """
    if not place.exists():
        return {}
    try:
        held = json.loads(place.read_text("utf-8"))
        known, rows = held["digest"], dict(held["rows"])
    except (OSError, ValueError, KeyError, TypeError):
        raise SpecError(f"{place}: no map that can be gone on with; begin anew") from None
    if known != digest:
        raise SpecError(f"{place}: holds another map than the one asked for; begin anew")
    return rows


def _told(
    swimmer: Swimmer, axes: Mapping[str, Any], rows: list[dict[str, Any]], time: float
) -> xr.Dataset:
    """Return the map."""
    import xarray as xr

    shape, units = tuple(len(a) for a in axes.values()), swimmer.units
    found = xr.Dataset(attrs={"units": units, "time": time})
    for name, values in axes.items():
        own = unit(units, STARTS[name]) if name in STARTS else ""
        found[name] = (name, values, {"units": own})
    dims = tuple(axes)
    for name in ("outcome", "circle_sense"):
        found[name] = (dims, np.array([r.get(name, "") for r in rows], str).reshape(shape))
    for name, kind in TOLD.items():
        values = np.array([r.get(name, np.nan) for r in rows], float).reshape(shape)
        found[name] = (dims, values, {"units": unit(units, kind)})
    drift = np.array([r.get("drift", [np.nan] * 3) for r in rows], float).reshape(*shape, 3)
    found["drift"] = ((*dims, "axis"), drift, {"units": unit(units, "speed")})
    return found.assign_coords(axis=list(DRIFT))
