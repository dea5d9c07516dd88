"""Limits with units, ``mean_torque <= 2 nN m``: the text of constraints in SI numbers.

A side that is a quantity is read as the file reads the field, or the merit, that it is compared
with; against an expression it becomes its SI number.
"""

from __future__ import annotations

import math
import re
from typing import Any

from microswim.errors import SpecError
from microswim.gait.quantities import NUMBERS, OLD, QUANTITIES
from microswim.gait.units import unit
from microswim.spec.tables import FIELDS
from microswim.spec.units import NUMBER, has_unit, parse, to_si
from microswim.swimmer.swimmer import Swimmer

#: SI units of the merits that have one, by their names of today and of before.
MEASURED_IN = {
    name: unit("SI", QUANTITIES[name].dimension)
    for name in NUMBERS
    if QUANTITIES[name].dimension != "number"
} | {"arc_length": "m", "tail_length": "m"}
MEASURED_IN |= {old: MEASURED_IN[new] for old, new in OLD.items()}
_SIGNS = re.compile(r"(<=|>=|<|>)")
_APART = re.compile(r",(?![^(]*\))")  # commas between constraints, not those of min(a, b)


def in_si(text: str, swimmer: Swimmer, bare: bool = True) -> str:
    """Return constraints with their quantities as numbers in SI.

    Parameters
    ----------
    text
        As `microswim.studies.optimisation.expressions.constraints` takes it, with quantities.
    swimmer
        Whose units hold.
    bare
        Whether a bare number may limit what has a unit (Python: SI); the command line says no.

    Raises
    ------
    SpecError
        If a unit does not fit, or one is missing, or the swimmer has no units.

    Examples
    --------
    >>> import microswim as ms
    >>> in_si("mean_torque <= 2 nN um, efficiency >= 0.01", ms.Swimmer.preset("goto/C"))
    'mean_torque<=2e-15, efficiency>=0.01'
    """
    pieces = [_SIGNS.split(part) for part in _APART.split(text)] if text.strip() else []
    return ", ".join("".join(_piece(p, swimmer, bare)) for p in pieces)


def _piece(sides: list[str], swimmer: Swimmer, bare: bool) -> list[str]:
    sides = [side.strip() for side in sides]
    unit = next((u for u in map(_unit_of, sides[::2]) if u), None)
    return [
        side if i % 2 else _side(side, unit, swimmer, bare, " ".join(sides))
        for i, side in enumerate(sides)
    ]


def _unit_of(side: str) -> str | None:
    """SI unit of a name, or None for what is none or has none."""
    field = FIELDS.get(side.partition("[")[0])
    if field is not None and field.dimension is not None:
        return field.dimension.si
    return MEASURED_IN.get(side)


def _side(side: str, unit: str | None, swimmer: Swimmer, bare: bool, whole: str) -> str:
    if not has_unit(side) or side.endswith(")") or re.match(rf"{NUMBER}\s*[*/+-]", side):
        number = re.fullmatch(NUMBER, side)
        if (
            number
            and 0 < abs(float(side)) < math.inf
            and unit
            and not bare
            and swimmer.units == "SI"
        ):
            raise SpecError(f'"{whole}": {side} must have a unit, as in "{side} {unit}"')
        return side
    if swimmer.units != "SI":
        raise SpecError(f'"{whole}": {side} must be a bare number; the spec has no units')
    try:
        return repr(to_si(side, unit) if unit else _base(side))
    except ValueError as error:
        raise SpecError(f'"{whole}": {side} {error}') from None


def _base(side: str) -> float:
    found: Any = parse(side).to_base_units()
    mass = found.dimensionality.get("[mass]", 0)  # the list counts in grams
    return float(found.magnitude) * 10.0 ** (-3.0 * float(mass))
