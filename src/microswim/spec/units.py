"""Quantities such as ``"1.37 um"`` into SI numbers: the door where units come in.

pint says what a unit means. What may be written is narrower than what pint would evaluate: a
number, then units with powers of one digit, so that no text of a spec file can keep the machine
busy (``"9**9**9**9 m"``).
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?)\s*(.*?)\s*")
_POWER = r"(?:\*\*|\^)\s*-?\d(?!\s*(?:\*\*|\^|\d|\.))"
_UNIT = re.compile(rf"(?:1\s*(?=/))?(?:[^\W\d]|[°% */()·]|{_POWER})*")
#: What most specs hold, so that they need not wait for pint; a test holds it to what pint says.
_COMMON = {
    "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9},
    "Hz": {"Hz": 1.0, "kHz": 1e3},
    "Pa s": {"Pa s": 1.0, "mPa s": 1e-3},
    "kg/m^3": {"kg/m^3": 1.0},
}
_ANGLES = {"radian", "degree", "turn", "revolution", "revolutions_per_minute"}


@cache
def _registry() -> pint.UnitRegistry:
    import pint  # takes a good part of a second

    return pint.UnitRegistry(autoconvert_to_preferred=False)


def to_si(value: Any, unit: str) -> float:
    """Number in the SI unit of a quantity such as ``"1.37 um"``.

    For frequencies, angles count as cycles: ``"60 rpm"`` is 1 Hz.

    Raises
    ------
    ValueError
        If the text is no quantity or its dimension is not that of `unit`.

    Examples
    --------
    >>> from microswim.spec.units import to_si
    >>> to_si("60 rpm", "Hz"), to_si("1 mPa s", "Pa s")
    (1.0, 0.001)
    """
    match = _QUANTITY.fullmatch(str(value))
    if match is None or len(str(value)) > 80 or not _UNIT.fullmatch(match[2]):
        raise ValueError(f'must be a quantity such as "1 {unit}"')
    number, text = match.groups()
    if text in _COMMON.get(unit, ()):
        return float(number) * _COMMON[unit][text]
    text = f"1{text}" if text.startswith("/") else text.replace("·", "*")
    try:
        quantity = _registry().Quantity(float(number), text)
    except Exception as error:  # pint's parser raises its tokenizer's errors for garbage
        raise ValueError(f'must be a quantity such as "1 {unit}"') from error
    if quantity.unitless and unit:
        raise ValueError(f'must have a unit, as in "1 {unit}"')
    cyclic = unit == "Hz" and any(str(u) in _ANGLES for u in quantity.units._units)
    try:
        return float(quantity.to("turn/s" if cyclic else unit).magnitude)
    except Exception as error:  # of another dimension, or beyond the range of numbers
        raise ValueError(f"must have the dimension of {unit}") from error
