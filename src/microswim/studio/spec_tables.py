"""Spec tables as the page holds them: checked, complete, in one unit per dimension.

What arrives from a browser is data: a spec that names code (``kind = "custom"``) is refused before
anything is imported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from microswim.errors import SpecError
from microswim.numerics.plain import plain
from microswim.spec.describe import describe
from microswim.spec.file import from_dict
from microswim.spec.readers.text import toml
from microswim.spec.tables import FIELDS
from microswim.spec.units import DIMENSIONS, SIZES
from microswim.studio.brought import surfaces as dropped
from microswim.swimmer.swimmer import Swimmer

LARGEST_SPEC = 256 * 1024  #: bytes; a region calibration is the most of it
MOST_WAVES = 60.0


def parse(text: str) -> dict[str, Any]:
    """Return tables of an uploaded spec file.

    Raises
    ------
    SpecError
        If it is too long or not TOML.
    """
    if len(text) > LARGEST_SPEC:
        raise SpecError(f"the file has {len(text)} characters; a spec has at most {LARGEST_SPEC}")
    return toml(text, "the file")


def swimmer_of(tables: Any) -> Swimmer:
    """Return the swimmer of tables that came from outside.

    Raises
    ------
    SpecError
        As `microswim.spec.file.from_dict`; also for a tail given by code and for absurd sizes.
    """
    if not isinstance(tables, dict):
        raise SpecError("the spec must be an object of tables, [fluid], [body], [tail], ...")
    tails = tables.get("tail")
    for tail in tails if isinstance(tails, list) else [tails]:
        if not isinstance(tail, dict) or tail.get("kind") != "custom":
            continue
        raise SpecError(
            "tail.kind",
            "custom",
            '"helix" or "plane_wave" here',
            "the studio runs no code from a spec",
        )
    swimmer = from_dict(dropped.located(tables))
    waves = float(swimmer.tail.number_of_waves)
    if not waves <= MOST_WAVES:
        raise SpecError("tail.waves", f"{waves:.6g}", f"at most {MOST_WAVES:g} in the studio")
    return swimmer


def canonical(swimmer: Swimmer) -> dict[str, Any]:
    """Return every field of a swimmer as spec tables, quantities in units that suit its size."""
    units = units_of(swimmer)
    tables = dropped.named(plain(describe(swimmer)))
    del tables["units"]
    if not any(map(any, swimmer.interaction.coupling)):
        del tables["interaction"]["coupling"]
    if swimmer.region is not None:  # it takes their place
        del tables["coefficients"], tables["interaction"]
    made = swimmer.calibration
    return {
        part: _each(
            table,
            lambda one, part=part: {k: _quantity(f"{part}.{k}", v, units) for k, v in one.items()},
        )
        for part, table in tables.items()
    } | ({} if made is None else {"calibration": made.as_tables()})


def _each(table: Any, change: Callable[[Any], Any]) -> Any:
    """A table changed, or each of several."""
    return [change(one) for one in table] if isinstance(table, list) else change(table)


def units_of(swimmer: Swimmer) -> dict[str, tuple[str, float]]:
    """Return the unit and its size in SI by dimension; empty for a dimensionless swimmer."""
    if swimmer.units != "SI":
        return {}
    size = float(swimmer.tail.apparent_length) or 2.0 * max(map(float, swimmer.body.semi_axes3))
    viscosity = float(swimmer.fluid.viscosity)
    suits = {
        "length": "um" if size < 1e-3 else "mm" if size < 1.0 else "m",
        "viscosity": "mPa s" if viscosity < 0.1 else "Pa s",
        "field": "mT",
    }
    si = {kind: (dimension.si, 1.0) for kind, dimension in DIMENSIONS.items()}
    return si | {kind: (unit, SIZES[DIMENSIONS[kind].si][unit]) for kind, unit in suits.items()}


def _quantity(name: str, value: Any, units: dict[str, tuple[str, float]]) -> Any:
    """A number with its unit, as the spec file has it."""
    measures = FIELDS[name].measures
    if measures and isinstance(value, list) and measures != "angle":
        return [_quantity(name, v, units) for v in value]
    number: Any = value
    if measures == "angle" and not isinstance(value, list):
        return f"{float(f'{math.degrees(number):.12g}')!r} deg"
    if measures in (None, "angle") or not units:
        return value
    unit, size = units[measures]
    return f"{float(f'{number / size:.12g}')!r} {unit}"
