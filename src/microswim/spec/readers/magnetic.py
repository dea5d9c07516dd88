"""Tables of magnetic fields: B on a grid, B in time, and the pose of a magnet in time.

Every column has its unit in the header, ``x (mm)``, ``Bx (mT)``, ``t (s)``; all come out in SI.
"""

from __future__ import annotations

import warnings

import numpy as np

from microswim.errors import SpecError
from microswim.gait.readable import percent
from microswim.numerics.array import Array
from microswim.spec.readers import measured
from microswim.spec.readers.measured import Table
from microswim.swimmer.magnetism.grid import LEAST, GridCoil

_PLACE = {"x": ("x",), "y": ("y",), "z": ("z",)}
_TIME = {"time": ("t", "time")}
_B = {name: (name, f"b_{name[1]}") for name in ("bx", "by", "bz")}
_MOMENT = {name: (name, f"m_{name[1]}") for name in ("mx", "my", "mz")}
_COIL = {"coil": ("coil", "magnet", "channel")}
#: Change (of B, rms) that makes a grid free of sources, above which it is said.
DOUBTFUL = 0.03
SAME = 1e-6  #: of the spacing: coordinates that are one


class GridWarning(UserWarning):
    """B on a grid has sources, which no magnetic field has."""


def read_grid(file: str) -> tuple[GridCoil, ...]:
    """Return the coils of a table of B on a grid: x, y, z, Bx, By, Bz, and coil where several are.

    The points may stand in any order; each coil has all points of a grid of planes.

    Raises
    ------
    SpecError
        One sentence: what in the file is missing or wrong.
    """
    table = measured.read(file, _PLACE | _B | _COIL, (*_PLACE, *_B), label="coil")
    places = _columns(table, tuple(_PLACE), "length")
    values = _columns(table, tuple(_B), "field")
    _check_whole(file, places, values)
    labels = np.array(table.labels or ["grid"] * len(places))
    names = list(dict.fromkeys(labels.tolist()))
    return tuple(
        _coil(file, name, places[labels == name], values[labels == name]) for name in names
    )


def _coil(file: str, name: str, places: Array, values: Array) -> GridCoil:
    axes, where = zip(*(_planes(c) for c in places.T))
    shape = tuple(len(axis) for axis in axes)
    if min(shape) < LEAST:
        raise SpecError(
            f"{file}: a grid of {shape[0]} x {shape[1]} x {shape[2]} points; each axis must have "
            f"{LEAST} or more"
        )
    flat = np.ravel_multi_index(where, shape)
    there = np.bincount(flat, minlength=int(np.prod(shape)))
    if len(places) != there.size or (there != 1).any():
        raise SpecError(
            f"{file}: B must be on a full grid, each point once; the planes make "
            f"{shape[0]} x {shape[1]} x {shape[2]} points, {int((there == 0).sum())} are missing "
            f"and {int((there > 1).sum())} stand twice"
        )
    whole = np.empty((there.size, 3))
    whole[flat] = values
    x, y, z = axes
    coil = GridCoil(name, x, y, z, whole.reshape(*shape, 3))
    if coil.mended > DOUBTFUL:
        warnings.warn(
            f"{file}: B has sources, and {percent(coil.mended)} of it was changed to take them "
            "away. Are columns, signs or units mixed up, or is the grid too coarse?",
            GridWarning,
            stacklevel=2,
        )
    return coil


def _planes(coordinates: Array) -> tuple[Array, Array]:
    """Coordinates of the planes of a grid, and the plane of each point."""
    order = np.argsort(coordinates, kind="stable")
    along = coordinates[order]
    step = np.diff(along)
    widest = step.max(initial=0.0)
    new = np.concatenate([[True], step > SAME * widest])
    plane = np.empty(len(along), int)
    plane[order] = np.cumsum(new) - 1
    return along[new], plane


def read_series(file: str) -> tuple[Array, Array]:
    """Return the times (n,) and fields (n, 3) of a table t, Bx, By, Bz.

    Raises
    ------
    SpecError
        One sentence.
    """
    table = measured.read(file, _TIME | _B, ("time", *_B))
    return _times(table), _columns(table, tuple(_B), "field")


def read_poses(file: str) -> tuple[Array, Array, Array | None]:
    """Return times (n,), places (n, 3) and moments (n, 3) of a magnet; None without mx, my, mz.

    Raises
    ------
    SpecError
        One sentence.
    """
    table = measured.read(file, _TIME | _PLACE | _MOMENT, ("time", *_PLACE))
    there = [name for name in _MOMENT if name in table.numbers]
    if there and len(there) < 3:
        raise SpecError(f"{file}: the moment is mx, my and mz; it has {', '.join(there)} alone")
    moments = _columns(table, tuple(_MOMENT), "moment") if there else None
    return _times(table), _columns(table, tuple(_PLACE), "length"), moments


def _times(table: Table) -> Array:
    """Increasing times, two at least."""
    times = _columns(table, ("time",), "time")[:, 0]
    if times.size < 2 or not (np.diff(times) > 0).all():
        raise SpecError(f"{table.path}: the times must increase from row to row, two rows at least")
    return times


def _columns(table: Table, names: tuple[str, ...], dimension: str) -> Array:
    example = {"length": "x (mm)", "field": "Bx (mT)", "time": "t (s)", "moment": "mx (A m^2)"}
    mend = f"write it into the header, as {example[dimension]}"
    made = [
        table.numbers[n] * measured.factor(table, n, dimension, "SI", mend) for n in names
    ]  # fmt: skip
    columns = np.stack(made, axis=-1)
    if not np.isfinite(columns).all():
        raise SpecError(f"{table.path}: a number is missing in the columns {', '.join(names)}")
    return columns


def _check_whole(file: str, places: Array, values: Array) -> None:
    if len(places) != len(values) or not values.any():
        raise SpecError(f"{file}: B is zero everywhere")
