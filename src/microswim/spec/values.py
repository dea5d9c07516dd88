"""One value of one field: text of the command line, or what Python was given.

The rule of the file holds here too: a swimmer in SI takes quantities with units, one without units
takes bare numbers, angles either; a truth is true or false, a word one of its choices. What is not
a field is left as it is, for those who know the names to refuse.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from microswim import checks
from microswim.errors import SpecError, nearest
from microswim.spec.fields import Field
from microswim.spec.tables import FIELDS
from microswim.spec.units import NUMBER, has_unit, to_si
from microswim.swimmer.parts import without_number

_TRUTHS = {"true": True, "false": False}


def from_text(name: str, text: str, units: str, said: str = "") -> Any:
    """Return the value that the text of an option means for a field.

    Parameters
    ----------
    name
        Dotted name, ``tail.length`` or ``interaction.translation[0]``.
    text
        As it was written.
    units
        Of the swimmer: ``"SI"`` or ``"dimensionless"``.
    said
        What an error calls it; by default the name.

    Raises
    ------
    SpecError
        If the field cannot have this value.

    Examples
    --------
    >>> from_text("tail.length", "2 mm", "SI"), from_text("coefficients.spin", "true", "SI")
    (0.002, True)
    """
    text, field, said = text.strip(), _field(name), said or name
    bare = float(text) if re.fullmatch(NUMBER, text) else None
    match field:
        case None:
            return text if bare is None else _finite(said, bare)
        case Field(kind="quantity"):
            return _quantity(field, text if bare is None else bare, units, said)
        case Field(kind="number") if bare is None:
            raise SpecError(said, text, "a bare number")
        case Field(kind="number") if bare is not None:
            return _finite(said, bare)
        case Field(kind="truth"):
            return from_python(name, _TRUTHS.get(text, text), units, said)
    return from_python(name, text, units, said)


def in_unit(said: str, text: str, unit: str, units: str) -> float:
    """Return the number that the text of an option means for what is measured in a unit.

    Parameters
    ----------
    said
        What an error calls it.
    text
        As it was written.
    unit
        SI unit; empty or ``"1"`` for what has none.
    units
        Of the swimmer: ``"SI"`` or ``"dimensionless"``.

    Raises
    ------
    SpecError
        If a unit is missing, does not fit, or is one too many.

    Examples
    --------
    >>> in_unit("--sigma", "20 nm", "m", "SI"), in_unit("--sigma", "0.01", "m", "dimensionless")
    (2e-08, 0.01)
    """
    text = text.strip()
    if re.fullmatch(NUMBER, text):
        value = _finite(said, float(text))
        if units == "SI" and value and unit not in ("", "1"):
            raise SpecError(
                f'{said} = {text}: must have a unit, as in "{text} {unit}"; the spec has units'
            )
        return value
    if unit in ("", "1") or units != "SI":
        why = "the spec has no units" if units != "SI" and has_unit(text) else None
        raise SpecError(said, text, "a bare number", why)
    try:
        return to_si(text, unit)
    except ValueError as error:
        raise SpecError(f"{said} = {text!r}: {error}") from None


def from_python(name: str, value: Any, units: str, said: str = "") -> Any:
    """Return the value of a field as a swimmer has it; a text with a unit becomes its number.

    Numbers stand as they are: in Python they are SI, or of a swimmer without units.

    Raises
    ------
    SpecError
        If the field cannot have this value.

    Examples
    --------
    >>> from_python("tail.length", "2 mm", "SI"), from_python("tail.length", 0.002, "SI")
    (0.002, 0.002)
    """
    field, said = _field(name), said or name
    if (
        field is not None
        and field.kind == "truth"
        and type(value).__name__ not in ("bool", "bool_")
    ):
        raise SpecError(said, value, "true or false")
    if field is None or not isinstance(value, str):
        return value
    if field.kind == "quantity":
        return _quantity(field, value, units, said)
    if field.kind == "number":
        raise SpecError(said, value, "a bare number")
    if field.choices and value not in field.choices:
        allowed = "one of " + ", ".join(f'"{c}"' for c in field.choices)
        close = nearest(value, field.choices)
        raise SpecError(said, value, allowed, close if close.startswith("did") else None)
    return value


def all_from_python(over: Any, units: str) -> Any:
    """Return what varies with every value read by `from_python`; arrays of numbers as they are.

    Parameters
    ----------
    over
        Dotted name to a list, pair or array of values, or a list of such designs.
    units
        Of the swimmer.

    Raises
    ------
    SpecError
        If a field cannot have one of the values.
    """
    if isinstance(over, Mapping):
        return {name: _each(str(name), values, units) for name, values in over.items()}
    if isinstance(over, (list, tuple)) and all(isinstance(row, Mapping) for row in over):
        return [{k: from_python(k, v, units, f"over {k}") for k, v in row.items()} for row in over]
    return over


def _each(name: str, values: Any, units: str) -> Any:
    if getattr(getattr(values, "dtype", None), "kind", "") in ("U", "S", "O"):
        values = values.tolist()
    if not isinstance(values, (list, tuple)):
        return values
    return type(values)([from_python(name, v, units, f"over {name}") for v in values])


def _field(name: str) -> Field | None:
    return FIELDS.get(without_number(name).partition("[")[0])


def _finite(said: str, value: float) -> float:
    checks.number(said, value, "a finite number")
    return value


def _quantity(field: Field, value: Any, units: str, said: str) -> float:
    dimension = field.dimension
    assert dimension is not None
    free = field.measures == "angle"  # bare radians or with a unit, in any file
    if not isinstance(value, str):
        if units == "SI" and value != 0 and not free:
            raise SpecError(
                f'{said} = {value!r}: must have a unit, as in "{dimension.example}"; '
                "the spec has units"
            )
        return _finite(said, value)
    if units != "SI" and not free:
        allowed = "a bare number" if has_unit(value) else "a number"
        raise SpecError(said, value, allowed, "the spec has no units" if has_unit(value) else None)
    try:
        number = to_si(value, dimension.si)
    except ValueError as error:
        raise SpecError(f"{said} = {value!r}: {error}{_hint(field, value)}") from None
    refused = dimension.refused(number)
    if refused:
        raise SpecError(f"{said} = {value!r}: {refused}")
    return number


def _hint(field: Field, value: str) -> str:
    if field.measures == "viscosity" and re.search(r"St\b", value):
        return "; a kinematic viscosity times the density is the viscosity"
    return ""
