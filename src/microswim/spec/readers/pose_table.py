"""A table of poses of several swimmers: a row for each swimmer that moves at each pose.

    pose, swimmer, x (um), y (um), z (um), dx, dy, dz, roll (deg), phase (deg)

What has no column stays as it is in the scene, and so does a swimmer without a row at a pose.
"""

from __future__ import annotations

from os import PathLike

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.spec.readers import measured
from microswim.swimmer.group import Group

_PLACE = {"x": ("x",), "y": ("y",), "z": ("z",)}
_DIRECTION = {name: (name, f"direction_{name[1]}") for name in ("dx", "dy", "dz")}
_ANGLES = {"roll": ("roll",), "phase": ("phase",)}
_NUMBERS = {"pose": ("pose",), "swimmer": ("swimmer",)}


def read_group_poses(path: str | PathLike[str], group: Group) -> dict[str, Array]:
    """Return positions (m, n, 3) and what else changes over the poses of a table, by name.

    Poses are in the order of their numbers.

    Raises
    ------
    SpecError
        One sentence: what in the file is missing or wrong.
    """
    known = _NUMBERS | _PLACE | _DIRECTION | _ANGLES
    table = measured.read(path, known, ("pose", "swimmer"))
    if table.left_out:
        raise SpecError(f"{path}: no such column: {table.left_out[0]}; known: {', '.join(known)}")
    pose, swimmer = (_whole(table, name) for name in _NUMBERS)
    n = len(group.members)
    if swimmer.min() < 0 or swimmer.max() >= n:
        wrong = swimmer.max() if swimmer.max() >= n else swimmer.min()
        raise SpecError(f"{path}: swimmer", wrong, f"0 to {n - 1}, a swimmer of the scene")
    poses, row = np.unique(pose, return_inverse=True)
    if len(np.unique(row * n + swimmer)) < len(row):
        raise SpecError(f"{path}: a swimmer stands twice at one pose; give it one row")
    found = {}
    for name, columns in (("position", _PLACE), ("direction", _DIRECTION)):
        if there := [c for c in columns if c in table.numbers]:
            if len(there) < 3:
                raise SpecError(f"{path}: {', '.join(there)} alone; give {', '.join(columns)}")
            values = np.stack([_values(table, c, group.units) for c in columns], axis=-1)
            found[f"{name}s"] = _at(group, name, len(poses), (row, swimmer), values)
    for name in _ANGLES:
        if name in table.numbers:
            values = _values(table, name, group.units)
            found[f"{name}s"] = _at(group, name, len(poses), (row, swimmer), values)
    start = np.array([m.position for m in group.members])
    found.setdefault("positions", np.tile(start, (len(poses), 1, 1)))
    return found


def _whole(table: measured.Table, name: str) -> np.ndarray:
    values = table.numbers[name]
    if not np.array_equal(values, np.round(values)):
        raise SpecError(f"{table.path}: {name}: must be whole numbers")
    return values.astype(int)


def _values(table: measured.Table, name: str, units: str) -> Array:
    """Return a column in SI or without units, angles in rad."""
    kind = "length" if name in _PLACE else "angle" if name in _ANGLES else ""
    values = table.numbers[name]
    if kind == "length" or (kind and table.units[name]):
        system = units if kind == "length" else "SI"
        mend = f"write it into the header, as {name} (um)"
        values = values * measured.factor(table, name, kind, system, mend)
    if not np.isfinite(values).all():
        raise SpecError(f"{table.path}: {name}: a number is missing")
    return values


def _at(group: Group, name: str, m: int, where: tuple, values: Array) -> Array:
    start = np.array([getattr(member, name) for member in group.members], float)
    out = np.tile(start, (m, *(1 for _ in start.shape)))
    out[where] = values
    return out
