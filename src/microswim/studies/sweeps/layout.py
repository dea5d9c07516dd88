"""How a sweep lies on disk: the arrays of its Zarr group, built empty, mended where damaged."""

from __future__ import annotations

import glob
import json
import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.gait.quantities import QUANTITIES
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.units import unit
from microswim.spec.tables import FIELDS
from microswim.studies.sweeps.space import Space
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.parts import without_number
from microswim.swimmer.swimmer import Swimmer

VECTORS = ("mean_velocity", "velocity_amplitude")
NUMBERS = ("swimming_speed", "mean_power", "mean_torque", "efficiency", "expected_error")
WAITING, DONE, FAILED = 0, 1, 2
FORMAT = 3
MARKS = "checks/rows"  # in a group of its own, so that xarray does not show it

# A row holds every output, NaN where it is not known; a failed row says why.
LONG_NAMES = {
    **{name: QUANTITIES[name].meaning for name in (*VECTORS, *NUMBERS[:-1])},
    "expected_error": "expected relative error of u_s; NaN if not known",
    **{name: quantity.meaning for name, quantity in DRIVEN.items()},
    "status": "0 not solved yet, 1 solved, 2 failed",
    "reason": "why a design failed; empty if it did not",
}


def numbers_of(swimmer: Swimmer) -> tuple[str, ...]:
    """Return the numbers of a row: more of a robot with a magnet in a rotating field."""
    return (*NUMBERS, *DRIVEN) if drive_of(swimmer) is not None else NUMBERS


def said(name: str, units: str) -> dict[str, str]:
    """Return what a variable of a sweep says of itself: its unit, and of an output its meaning.

    Parameters
    ----------
    name
        An output, or the dotted name of a field that varies.
    units
        Of the swimmer.
    """
    if name in LONG_NAMES:
        plain = "number" if name in NUMBERS else ""
        known = QUANTITIES | DRIVEN
        kind = known[name].dimension if name in known else plain
        told = {"units": unit(units, kind), "long_name": LONG_NAMES[name]}
        return {k: v for k, v in told.items() if v}
    field = FIELDS.get(without_number(name).partition("[")[0])
    if field is None or field.kind not in ("quantity", "number"):
        return {}
    return {"units": unit(units, field.measures or "number"), "long_name": field.about.label}


def blank(rows: int, numbers: Iterable[str]) -> dict[str, np.ndarray]:
    """Return rows of these numbers that hold nothing yet."""
    out: dict[str, np.ndarray] = {name: np.full((rows, 6), np.nan) for name in VECTORS}
    out |= {name: np.full(rows, np.nan) for name in numbers}
    out["status"] = np.zeros(rows, dtype=np.int8)
    out["reason"] = np.full(rows, "", dtype=object)
    return out


def built(path: Path, space: Space, attributes: Mapping[str, Any]) -> Path:
    """Return an empty store beside its place; a former one of a killed process is removed."""
    import zarr

    for left in path.parent.glob(f"{glob.escape(path.name)}.*.new"):
        shutil.rmtree(left, ignore_errors=True)
    fresh = path.with_name(f"{path.name}.{os.getpid()}.new")
    try:
        group = zarr.create_group(fresh, zarr_format=2, attributes=dict(attributes))
        _add_arrays(group, space, attributes)
        zarr.consolidate_metadata(fresh)
    except BaseException:
        shutil.rmtree(fresh, ignore_errors=True)
        raise
    return fresh


def mend(path: Path, template: Path) -> None:
    """Put back the files of a store that do not depend on results, where they differ."""
    results = {template / name for name in (*LONG_NAMES, MARKS)}
    try:
        for file in template.rglob("*"):
            if file.is_dir() or (file.parent in results and not file.name.startswith(".z")):
                continue
            place = path / file.relative_to(template)
            if not place.is_file() or place.read_bytes() != file.read_bytes():
                place.parent.mkdir(parents=True, exist_ok=True)
                file.replace(place)
    finally:
        shutil.rmtree(template, ignore_errors=True)


def _add_arrays(group: Any, space: Space, attributes: Mapping[str, Any]) -> None:
    dims, shape, chunks, units = space.dims, space.shape, space.chunks, str(attributes["units"])
    for name in blank(0, json.loads(attributes["outputs"])):
        vector = name in VECTORS
        kind, fill = {"status": ("i1", None), "reason": (str, None)}.get(name, ("f8", np.nan))
        group.create_array(
            name,
            shape=(*shape, 6) if vector else shape,
            chunks=(*chunks, 6) if vector else chunks,
            dtype=kind,
            fill_value=fill,
            compressors=_codec(),
            attributes={
                **said(name, units),
                "_ARRAY_DIMENSIONS": [*dims, "component"] if vector else list(dims),
            },
        )
    group.create_array(
        MARKS, shape=shape, chunks=chunks, dtype="u8", fill_value=0, compressors=_codec()
    )
    # A fill value would make xarray read 0 and "" as missing; so every status is written.
    group["status"][...] = 0
    _add_coordinate(group, "component", ("component",), np.array(DEGREES_OF_FREEDOM), {})
    for name, values in zip(space.names, space.values):
        dims = (name,) if space.grid else ("design",)
        _add_coordinate(group, name, dims, values, said(name, units))
    group.attrs["coordinates"] = " ".join(space.names) if not space.grid else "component"


def _codec() -> Any:
    """Return the compressor of all arrays; with a checksum, so that damage is not read."""
    from numcodecs import Zstd

    return Zstd(level=1, checksum=True)


def _add_coordinate(
    group: Any, name: str, dims: tuple[str, ...], values: np.ndarray, told: dict[str, str]
) -> None:
    words = values.dtype.kind == "U"
    array = group.create_array(
        name,
        shape=values.shape,
        dtype=str if words else values.dtype,
        compressors=_codec(),
        attributes={"_ARRAY_DIMENSIONS": list(dims), **told},
    )
    array[...] = values.astype(object) if words else values
