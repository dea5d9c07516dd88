"""Quantities in a sentence about a spec, in the units in which they were written.

The parts of a swimmer refuse what makes no sense in their own numbers. Who reads the sentence has
written ``"12 um"``, and a bound is of use in the same unit.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from microswim.errors import Writing
from microswim.gait.readable import prefixed
from microswim.spec.fields import Field
from microswim.spec.several import several
from microswim.spec.tables import FIELDS
from microswim.spec.units import DIMENSIONS, to_si, unit_written
from microswim.swimmer.parts import without_number


def in_units(units: str, what: str, value: float, tables: Any = None) -> str | None:
    """Return a number of a field, or of a dimension, with its unit; None for a bare number.

    Parameters
    ----------
    units
        ``"SI"`` or ``"dimensionless"``.
    what
        Dotted name of a field, or a key of `DIMENSIONS`.
    value
        In SI.
    tables
        Those of the spec: the unit written for the field, else the first for its dimension; by
        default the unit that reads well.

    Examples
    --------
    >>> in_units("SI", "tail.radius", 4.6842e-7), in_units("SI", "tail.waves", 2.0)
    ('468.42 nm', None)
    >>> in_units("SI", "length", 4.6842e-7, {"tail": {"radius": "10 um"}})
    '0.46842 um'
    """
    field = _field(what)
    dimension = DIMENSIONS.get((field.measures or "") if field else what)
    if dimension is None or (units != "SI" and dimension.name != "angle"):
        return None
    if not math.isfinite(value):
        return None
    unit = _unit_written(without_number(what).partition("[")[0], dimension.name, tables)
    if unit:
        return f"{value / to_si(f'1 {unit}', dimension.si):.12g} {unit}"
    if dimension.name == "angle":  # radians, as in Python
        return None
    factor, unit = prefixed(value, dimension.si)
    return f"{value * factor:.12g} {unit}"


def as_written(tables: Any) -> Writing | None:
    """Return how numbers are written in the units of the tables of a spec, if there are tables."""
    if not isinstance(tables, Mapping):
        return None

    def written(what: str, value: float) -> str | None:
        known = (True for name in DIMENSIONS if name != "angle" for _ in _written(tables, name))
        return in_units("SI" if any(known) else "none", what, value, tables)

    return written


def _field(what: str) -> Field | None:
    return FIELDS.get(without_number(what).partition("[")[0])


def _unit_written(path: str, dimension: str, tables: Any) -> str | None:
    """The unit in which a spec writes a field, or the first of what it measures."""
    written = dict(reversed(list(_written(tables, dimension))))
    unit = written.get(path) or next(reversed(written.values()), None)
    si = DIMENSIONS[dimension].si
    try:
        return unit if unit and to_si(f"0 {unit}", si) == 0.0 else None  # not degrees Celsius
    except ValueError:
        return None


def _written(tables: Any, dimension: str) -> Iterator[tuple[str, str]]:
    """Fields of a dimension and the unit that each is written in, as the spec has them."""
    if not isinstance(tables, Mapping):
        return
    for part, table in tables.items():
        for one in several(table):
            for name, value in one.items():
                field = FIELDS.get(f"{part}.{name}")
                while isinstance(value, list) and value:
                    value = value[0]
                if field is not None and field.measures == dimension and unit_written(value):
                    yield field.path, unit_written(value)
