"""Limits with units, ``mean_torque <= 2 nN m``: the text of constraints in SI numbers.

A side that is a quantity is read as the file reads the field, or the merit, that it is compared
with; against an expression it becomes its SI number.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from microswim.errors import SpecError
from microswim.gait.quantities import NUMBERS, OLD, QUANTITIES
from microswim.gait.readable import significant, spec_value
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.units import unit
from microswim.spec.describe import unit_of
from microswim.spec.tables import FIELDS
from microswim.spec.units import NUMBER, has_unit, parse, to_si
from microswim.studies.optimisation.dimensions import Dimension, Mixed, of_expression, of_unit
from microswim.swimmer.parts import without_number
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

#: SI units of the merits that have one, by their names of today and of before.
MEASURED_IN = {
    name: unit("SI", (QUANTITIES | DRIVEN)[name].dimension)
    for name in (*NUMBERS, *DRIVEN)
    if (QUANTITIES | DRIVEN)[name].dimension != "number"
} | {"arc_length": "m", "tail_length": "m"}
MEASURED_IN |= {old: MEASURED_IN[new] for old, new in OLD.items()}
_SIGNS = re.compile(r"(<=|>=|<|>)")
_APART = re.compile(r",(?![^(]*\))")  # commas between constraints, not those of min(a, b)


def measured_in(name: str, units: str) -> str:
    """Return the unit of a quantity, a merit or a number of the spec; empty where none is known.

    Examples
    --------
    >>> measured_in("swimming_speed", "SI"), measured_in("tail.amplitude", "SI")
    ('m/s', 'm')
    """
    known = QUANTITIES | DRIVEN
    if name in known:
        return unit(units, known[name].dimension)
    if "." in name:
        return unit_of(name, units)
    return MEASURED_IN.get(name, "") if units == "SI" else ""


def for_people(name: str, value: float, units: str) -> str:
    """Return a number of the spec, a quantity or an expression with its unit; shares in per cent.

    Examples
    --------
    >>> for_people("efficiency", 0.003289, "SI"), for_people("mean_power", 6.866e-11, "SI")
    ('0.329 %', '68.66 pW')
    """
    if name == "efficiency":
        return f"{significant(100.0 * value, 3)} %"
    known = measured_in(name, units)
    return spec_value(value, known) if known else f"{value:.4g}"


def limit_said(text: str, units: str) -> str:
    """Return a constraint between a quantity and a number, the number with its unit.

    Examples
    --------
    >>> limit_said("mean_torque<=2e-09", "SI"), limit_said("mean_torque <= 300", "dimensionless")
    ('mean_torque <= 2.000 nN m', 'mean_torque <= 300.0')
    """
    found = re.fullmatch(rf"([\w.\[\]]+) ?(<=|>=|<|>) ?({NUMBER})", text)
    if found is None:
        return text
    name, sign, number = found.groups()
    return f"{name} {sign} {for_people(name, float(number), units)}"


def with_units(table: xr.Dataset, units: str) -> xr.Dataset:
    """Return a table of designs whose variables say their units."""
    for name, variable in table.variables.items():
        said = measured_in(str(name), units)
        if said and variable.dtype.kind == "f":
            variable.attrs["units"] = said
    return table


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
    if swimmer.units == "SI":
        _check_dimensions(sides, bare)
    unit = next((u for u in map(_unit_of, sides[::2]) if u), None)
    return [
        side if i % 2 else _side(side, unit, swimmer, bare, " ".join(sides))
        for i, side in enumerate(sides)
    ]


def _check_dimensions(sides: list[str], bare: bool) -> None:
    """Refuse a comparison of unlike things; a bare number passes where `bare` says so."""
    whole = " ".join(sides)
    try:
        found = [_dimension(side) for side in sides[::2]]
    except Mixed as error:
        raise SpecError(f'"{whole}": {error}') from None
    known = [d for d, side in zip(found, sides[::2]) if d is not None and not _is_bare(side)]
    if any(d != known[0] for d in known):
        raise SpecError(f'"{whole}": its sides must have the same dimension')
    if known and known[0] and not bare:
        for side in filter(_is_bare, sides[::2]):
            if (
                re.search("[1-9]", side)
                and _unit_of(sides[0]) is None
                and _unit_of(sides[-1]) is None
            ):
                raise SpecError(f'"{whole}": {side} must have a unit; what it limits has one')


def _is_bare(side: str) -> bool:
    """Whether a side is made of bare numbers alone."""
    return re.search("[A-Za-z_]", re.sub(NUMBER, "", side)) is None


def _dimension(side: str) -> Dimension | None:
    """Dimension of a side, None where it is not known or is said better elsewhere."""
    if not _is_quantity(side):
        return of_expression(side, _unit_of)
    try:
        return of_unit(re.sub(NUMBER, "", side, count=1).strip())
    except ValueError:
        return None


def _is_quantity(side: str) -> bool:
    """Whether a side is a number with its unit, ``2 nN m``."""
    sum_or_product = side.endswith(")") or re.match(rf"{NUMBER}\s*[*/+-]", side)
    return has_unit(side) and not sum_or_product


def _unit_of(side: str) -> str | None:
    """SI unit of a name, or None for what is none or has none."""
    field = FIELDS.get(without_number(side).partition("[")[0])
    if field is not None and field.dimension is not None:
        return field.dimension.si
    return MEASURED_IN.get(side)


def _side(side: str, unit: str | None, swimmer: Swimmer, bare: bool, whole: str) -> str:
    if not _is_quantity(side):
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
