"""Paths of several swimmers in one fluid: their poses and phases in time.

    x' = Q u,   Q' = Q [w],   phase' = rate,   (u, w) by a model of `of_all`, t too in a field

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
from microswim.errors import SpecError
from microswim.gait.units import unit
from microswim.numerics.array import Array, sealed
from microswim.path import keeping
from microswim.path.march import in_chart
from microswim.path.of_all import OfAll, Pose, model_of
from microswim.swimmer.group import LEVELS, Group


@checks.given(
    group=lambda name, value: checks.instance(name, value, "Group"),
    times=checks.series,
    model=checks.one_of("estimate", "bem", "far"),
    level=LEVELS,
    max_step=checks.above_zero("time"),
    keep=checks.place,
    progress=checks.function,
)
def group_path(
    group: Group,
    times: Any,
    *,
    model: Literal["estimate", "bem", "far"] = "estimate",
    level: Literal["coarse", "standard", "fine"] = "standard",
    max_step: float | None = None,
    keep: str | PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Follow several swimmers in one fluid from the poses of a group.

    Parameters
    ----------
    group
        The swimmers at the first time; forces and torques on them stay as they are in the scene,
        its field acts on their magnets, and these on each other.
    times
        Increasing times (m,) at which the path is kept.
    model
        ``"estimate"``: point forces, half a millisecond a step and pair; ``"bem"``: the solve;
        ``"far"``: thousands of swimmers, each the averages over its period of its force dipole
        and quadrupole and of its answer to a flow, motors out of step, beyond some 1.5 lengths.
    level
        Of the boundary elements that either is made of.
    max_step
        Longest time step; by default 0.35 rad of turning and 1/16 of the fastest motor's period;
        from afar in place of the period a tenth of the smallest distance.
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
        the velocities (from afar that of the last term kept, which 95 of 100 swimmers are within,
        of few all); NaN by boundary elements, whose level has it.

    Raises
    ------
    SpecError
        If the times do not increase, swimmers come to touch, or `keep` holds another path.
    MicroswimError
        If they come so near to each other that the estimate may be off by more than a quarter;
        from afar if half of them do.

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
    answer = model_of(group, model, level)
    asked = (group, t.tolist(), model, level, max_step)
    digest, place = sha256(repr(asked).encode()).hexdigest(), None if keep is None else Path(keep)
    kept, errors = ([], []) if place is None else _begun(place, digest)
    kept = kept or [answer.begun(_start(group))]
    for k in range(len(errors), t.size):
        pose = kept[k]
        V, error, longest = answer.at(pose, now := t[k])
        errors.append(error)
        if k + 1 < t.size:
            longest = longest if max_step is None else max_step
            for h in _steps(t[k + 1] - t[k], longest):
                pose = _step(answer, pose, now, h, V)
                V, now = None, now + h
            kept.append(pose)
        if place is not None:
            poses = dict(zip(_POSE, zip(*kept, strict=True), strict=True))
            keeping.keep(place, digest, errors=errors, **poses)
        if progress is not None:
            progress(k + 1, t.size)
    return _dataset(group, t, kept, np.array(errors), model)


_POSE = ("position", "rotation", "phase")


def _begun(place: Path, digest: str) -> tuple[list[Pose], list[float]]:
    """Return the poses that a file holds of a path, and the errors at them; none without it."""
    if not place.exists():
        return [], []
    found = keeping.kept(place, digest, (*_POSE, "errors"))
    return list(zip(*(found[name] for name in _POSE), strict=True)), found["errors"].tolist()


def _start(group: Group) -> Pose:
    x, phase = (
        np.array([getattr(m, name) for m in group.members]) for name in ("position", "phase")
    )
    return x, np.array([m.rotation for m in group.members]), phase


def _steps(time: float, longest: float) -> Array:
    """Return equal time steps for a stretch of time."""
    return np.full(n := max(1, int(np.ceil(time / longest - 1e-9))), time / n)


def _step(answer: OfAll, pose: Pose, t: float, h: float, first: Array | None) -> Pose:
    """Return the pose a time step later; `first` are the velocities at t, where they are known."""
    x, Q, phase = pose
    moves, turns = [], []
    for share in (0.0, 0.5, 0.5, 1.0):
        dx = share * h * moves[-1] if moves else np.zeros_like(x)
        u = share * h * turns[-1] if turns else np.zeros_like(x)
        now = Q @ Rotation.from_rotvec(u).as_matrix()
        if first is None or moves:
            there = x + dx, now, phase + share * h * answer.rates
            V, *_ = answer.at(there, t + share * h)
        else:
            V = first
        moves.append(np.einsum("nij,nj->ni", now, V[:, :3]))
        du = np.zeros_like(x)
        for one, w, out in zip(u, V[:, 3:], du, strict=True):
            in_chart(one, w, out)
        turns.append(du)
    weight = h / 6.0 * np.array([1.0, 2.0, 2.0, 1.0])
    dx, u = (np.tensordot(weight, np.array(k), 1) for k in (moves, turns))
    return x + dx, Q @ Rotation.from_rotvec(u).as_matrix(), phase + h * answer.rates


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
