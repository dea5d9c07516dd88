"""A swimmer as plain data: the tables of a spec file, as numbers, words and lists."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

from microswim import __version__
from microswim.gait import doors
from microswim.gait.units import unit
from microswim.numerics.plain import plain
from microswim.spec.tables import FIELDS, TAGS
from microswim.spec.toml import to_toml
from microswim.swimmer.drag.coefficients import Unchosen
from microswim.swimmer.parts import without_number
from microswim.swimmer.swimmer import Swimmer


def describe(swimmer: Swimmer) -> dict[str, Any]:
    """Return the swimmer as the tables of a spec file, plain numbers and strings only."""
    chosen = not isinstance(swimmer.coefficients, Unchosen)  # else the file shall choose no law
    tags = TAGS | ({"coefficients": "law"} if chosen else {})
    tables: dict[str, Any] = {}
    for part in swimmer.parts:
        owner = getattr(swimmer, part)
        each = [_table(one, tags.get(part)) for one in getattr(owner, "each", (owner,))]
        tables[part] = each if len(each) > 1 else each[0]
    return tables | {"units": swimmer.units}


def _table(owner: Any, tag: str | None) -> dict[str, Any]:
    """What a part holds; the tag is the field that names its kind."""
    table = {} if tag is None else {tag: getattr(owner, tag)}
    for f in fields(owner):
        value = getattr(owner, f.name)
        if value is not None:
            table[f.name] = _name_of(value) if callable(value) else value
    return table


def to_tables(swimmer: Swimmer) -> dict[str, Any]:
    """Return the tables of a spec file that reads back as this swimmer, quantities with units.

    Examples
    --------
    >>> import microswim as ms
    >>> from microswim.spec.describe import to_tables
    >>> to_tables(ms.Swimmer.preset("goto/C"))["tail"]["frequency"]
    '73.95 Hz'
    """
    tables = describe(swimmer)
    units = tables.pop("units")
    law = swimmer.coefficients
    if isinstance(law, Unchosen) and law.is_usual:
        del tables["coefficients"]
    written: dict[str, Any] = {
        part: [_with_units(part, one, units) for one in table]
        if isinstance(table, list)
        else _with_units(part, table, units)
        for part, table in tables.items()
    }
    if swimmer.region is not None:
        written["region"] = {"data": doors.go(doors.PACK_REGION, swimmer.region)}
    if swimmer.calibration is not None:
        written["calibration"] = swimmer.calibration.as_tables()
    return written


def _with_units(part: str, table: dict[str, Any], units: str) -> dict[str, Any]:
    return {name: _written(unit_of(f"{part}.{name}", units), v) for name, v in table.items()}


def to_text(swimmer: Swimmer) -> str:
    """Return the text of a spec file that reads back as this swimmer, see `Swimmer.to_toml`."""
    units = "SI units" if swimmer.units == "SI" else "no units"
    return to_toml(to_tables(swimmer), f"A swimmer in {units}, by microswim {__version__}")


def _written(unit: str, value: Any) -> Any:
    value = plain(value, nan=True)
    if isinstance(value, list):
        unit = "" if unit == "rad" else unit  # a direction as a vector
        return [_written(unit, v) for v in value]
    return f"{value!r} {unit}" if unit and isinstance(value, (int, float)) else value


def unit_of(name: str, units: str) -> str:
    """Return the SI unit of a field; empty for a bare number and without units.

    Examples
    --------
    >>> from microswim.spec.describe import unit_of
    >>> unit_of("body.semi_axes[0]", "SI"), unit_of("tail.waves", "SI")
    ('m', '')
    """
    field = FIELDS.get(without_number(name).partition("[")[0])
    if units != "SI" or field is None or field.measures is None:
        return ""
    return unit(units, field.measures)


def _name_of(function: Any) -> str:
    return f"{function.__module__}:{getattr(function, '__qualname__', type(function).__name__)}"


def spec_json(swimmer: Swimmer) -> str:
    """Return `describe` as canonical JSON, for provenance and comparison."""
    return json.dumps(plain(describe(swimmer), nan=True), sort_keys=True)
