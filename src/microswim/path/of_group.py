"""Paths of several swimmers in one fluid: their poses and phases in time.

    x' = Q u,   Q' = Q [w],   phase' = rate,   (u, w) by `Group.estimate` or `Group.solve`

Runge-Kutta steps of order 4 in position and in the rotation vector since the start of the step, so
that attitudes stay rotations (Munthe-Kaas 1999).
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.gait.units import unit
from microswim.numerics.array import Array, sealed
from microswim.path import keeping
from microswim.path.march import in_chart
from microswim.swimmer.group import LEVELS, Group
from microswim.swimmer.member import direction_and_roll

#: Steps in a period of the fastest motor, and the largest turn in a step (rad).
STEPS, TURN = 16, 0.35
#: Largest error of an estimate that a path is followed with.
WORST = 0.25


@checks.given(
    group=lambda name, value: checks.instance(name, value, "Group"),
    times=checks.series,
    model=checks.one_of("estimate", "bem"),
    level=LEVELS,
    max_step=checks.above_zero("time"),
    keep=checks.place,
    progress=checks.function,
)
def group_path(
    group: Group,
    times: Any,
    *,
    model: Literal["estimate", "bem"] = "estimate",
    level: Literal["coarse", "standard", "fine"] = "standard",
    max_step: float | None = None,
    keep: str | PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Follow several swimmers in one fluid from the poses of a group.

    Parameters
    ----------
    group
        The swimmers at the first time; forces and torques on them stay as they are in the scene.
    times
        Increasing times (m,) at which the path is kept.
    model
        ``"estimate"``: point forces, half a millisecond a step and pair; ``"bem"``: the solve.
    level
        Of the boundary elements that either is made of.
    max_step
        Longest time step; by default 1/16 of the fastest motor's period and 0.35 rad of turning.
    keep
        File in which the path is kept while it grows; one that a killed process left is gone on
        from, to the same numbers.
    progress
        Called with (times done, times in all).

    Returns
    -------
    xarray.Dataset
        ``position`` (time, swimmer, axis) of the bodies' centres, ``quaternion`` (time, swimmer,
        wxyz), ``phase`` (time, swimmer), ``expected_error`` (time): of the estimate, a share of
        the velocities; NaN by boundary elements, whose level has it.

    Raises
    ------
    SpecError
        If the times do not increase, swimmers come to touch, or `keep` holds another path.
    MicroswimError
        If they come so near to each other that the estimate may be off by more than a quarter.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> beside = ms.Member(swimmer=helix, position=(0, 6, 0))
    >>> pair = ms.Group((ms.Member(swimmer=helix), beside))
    >>> found = ms.group_path(pair, [0.0, 0.5], level="coarse")
    >>> bool(found.position[-1, 0, 0] < 0)
    True
    """
    t = np.atleast_1d(np.asarray(times, float))
    if t.ndim != 1 or (np.diff(t) <= 0).any():
        raise SpecError("times", times, "finite and increasing")
    blocks = group.prepared(level)
    asked = (group, t.tolist(), model, level, max_step)
    digest, place = sha256(repr(asked).encode()).hexdigest(), None if keep is None else Path(keep)
    kept, errors = ([_start(group)], []) if place is None else _begun(group, place, digest)
    for k in range(len(errors), t.size):
        pose = kept[k]
        found = _solved(group, pose, blocks, model)
        errors.append(float(getattr(found, "expected_error", np.nan)))
        if k + 1 < t.size:
            for h in _steps(t[k + 1] - t[k], found, max_step):
                pose = _step(group, pose, h, blocks, model)
            kept.append(pose)
        if place is not None:
            poses = dict(zip(_POSE, zip(*kept, strict=True), strict=True))
            keeping.keep(place, digest, errors=errors, **poses)
        if progress is not None:
            progress(k + 1, t.size)
    return _dataset(group, t, kept, np.array(errors), model)


_POSE = ("position", "rotation", "phase")


def _begun(group: Group, place: Path, digest: str) -> tuple[list[Pose], list[float]]:
    """Return the poses that a file holds of a path, and the errors at them; the first without."""
    if not place.exists():
        return [_start(group)], []
    found = keeping.kept(place, digest, (*_POSE, "errors"))
    return list(zip(*(found[name] for name in _POSE), strict=True)), found["errors"].tolist()


Pose = tuple[Array, Array, Array]  # positions (n, 3), rotations (n, 3, 3), phases (n,)


def _start(group: Group) -> Pose:
    x, phase = (
        np.array([getattr(m, name) for m in group.members]) for name in ("position", "phase")
    )
    return x, np.array([m.rotation for m in group.members]), phase


def _solved(group: Group, pose: Pose, blocks: Any, model: str) -> Any:
    """Return the solution at a pose."""
    x, Q, phase = pose
    directions, rolls = zip(*(direction_and_roll(q) for q in Q), strict=True)
    here = group.moved(positions=x, directions=directions, rolls=rolls, phases=phase)
    if model == "bem":
        return here.solve(blocks=blocks)
    found = here.estimate(blocks=blocks)
    if not found.expected_error <= WORST:
        raise MicroswimError(
            'model = "estimate": two swimmers are so near that velocities may be off by '
            f'{100.0 * found.expected_error:.0f} %; take model = "bem"'
        )
    return found


def _steps(time: float, found: Any, longest: float | None) -> Array:
    """Return equal time steps for a stretch of time."""
    if longest is None:
        turning = float(np.linalg.norm(found.velocity[:, 3:], axis=1).max())
        rate = float(np.abs(found.rates).max())
        shortest = max(rate * STEPS / (2.0 * np.pi), turning / TURN)
        longest = 1.0 / shortest if shortest > 0 else time
    return np.full(n := int(np.ceil(time / longest - 1e-9)), time / n)


def _step(group: Group, pose: Pose, h: float, blocks: Any, model: str) -> Pose:
    """Return the pose a time step later."""
    x, Q, phase = pose
    moves, turns = [], []
    for share in (0.0, 0.5, 0.5, 1.0):
        dx = share * h * moves[-1] if moves else np.zeros_like(x)
        u = share * h * turns[-1] if turns else np.zeros_like(x)
        now = Q @ Rotation.from_rotvec(u).as_matrix()
        found = _solved(
            group, (x + dx, now, phase + share * h * _rates(group, blocks)), blocks, model
        )
        moves.append(np.einsum("nij,nj->ni", now, found.velocity[:, :3]))
        du = np.zeros_like(x)
        for one, w, out in zip(u, found.velocity[:, 3:], du, strict=True):
            in_chart(one, w, out)
        turns.append(du)
    weight = h / 6.0 * np.array([1.0, 2.0, 2.0, 1.0])
    dx, u = (np.tensordot(weight, np.array(k), 1) for k in (moves, turns))
    later = phase + h * _rates(group, blocks)
    return x + dx, Q @ Rotation.from_rotvec(u).as_matrix(), later


def _rates(group: Group, blocks: Any) -> Array:
    return np.array([blocks.of(m).rate for m in group.members])


def _dataset(group: Group, t: Array, kept: list[Pose], errors: Array, model: str) -> xr.Dataset:
    x, Q, phase = (np.array(a) for a in zip(*kept, strict=True))
    q = Rotation.from_matrix(Q.reshape(-1, 3, 3)).as_quat(scalar_first=True)
    length, time = (unit(group.units, kind) for kind in ("length", "time"))
    n = len(group.members)
    told = {"units": length, "long_name": "body centres, scene"}
    data = {
        "position": (("time", "swimmer", "axis"), x, told),
        "quaternion": (("time", "swimmer", "wxyz"), q.reshape(t.size, n, 4), {"units": "1"}),
        "phase": (("time", "swimmer"), phase, {"units": "rad"}),
        "expected_error": ("time", errors, {"units": "1", "long_name": "share of the velocities"}),
    }
    coords = {"time": ("time", t, {"units": time}), "swimmer": np.arange(n),
              "axis": list("xyz"), "wxyz": list("wxyz")}  # fmt: skip
    return sealed(xr.Dataset(data, coords, {"model": model, "units": group.units}))
