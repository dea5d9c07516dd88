"""``--over``: what varies and how far, as text; quantities carry units: ``1mm:3mm:5``."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.spec.values import from_text

MOST_VALUES = 1_000_000  #: of one axis
MEND = "for example tail.amplitude=0.01:0.5:50,tail.waves=1,2,3"


def split(texts: tuple[str, ...], option: str = "--over") -> dict[str, str]:
    """Return the dotted name to the text of its values.

    Raises
    ------
    SpecError
        If a piece has no name, or a name comes twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        for piece in re.split(r",(?=\s*[A-Za-z_][\w.\[\]]*\s*=)", text):
            name, equals, values = piece.partition("=")
            name = name.strip()
            if not equals or not name or not values.strip():
                raise SpecError(option, text, "NAME=VALUES", MEND)
            if name in found:
                raise SpecError(option, text, f"each name once ({name} comes twice)")
            found[name] = values.strip()
    return found


def axes(texts: tuple[str, ...], units: str) -> dict[str, Any]:
    """Return the axes of a grid: every name with its values.

    Raises
    ------
    SpecError
        If a range does not say how many values, or a value is none of its field.
    """
    return {
        name: values_of(name, text, units, f"--over {name}") for name, text in split(texts).items()
    }


def bounds(texts: tuple[str, ...], units: str, option: str = "--over") -> dict[str, Any]:
    """Return what a design may vary: a pair of bounds, or a list of choices.

    Raises
    ------
    SpecError
        If a range is no range, or a value is none of its field.
    """
    return {k: _bounds(k, text, units, option) for k, text in split(texts, option).items()}


def spreads(texts: tuple[str, ...], units: str) -> dict[str, Any]:
    """Return uncertain numbers: ``5%`` as it stands, ``LOW:HIGH`` as a pair.

    Raises
    ------
    SpecError
        If a range is no range.
    """
    option = "--uncertain"
    pieces = split(texts, option).items()
    return {k: t if t.endswith("%") else _bounds(k, t, units, option) for k, t in pieces}


def values_of(name: str, text: str, units: str, said: str) -> Any:
    """Return the values of one field: FIRST:LAST:COUNT, FIRST:LAST:COUNT:log or a list.

    Parameters
    ----------
    name
        Dotted name of the field.
    text
        As it was written.
    units
        Of the swimmer.
    said
        What an error calls it.

    Raises
    ------
    SpecError
        If a range does not say how many values, or a value is none of its field.
    """
    if ":" not in text:
        return [from_text(name, part, units, said) for part in text.split(",")]
    first, last, *rest = text.split(":")
    count = rest[0].strip() if rest else ""
    if not re.fullmatch("[0-9]+", count) or rest[1:] not in ([], ["log"]):
        allowed = "FIRST:LAST:COUNT, FIRST:LAST:COUNT:log or a list"
        raise SpecError(said, text, allowed, MEND)
    if not 1 <= int(count[:12]) <= MOST_VALUES:
        raise SpecError(said, text, f"of 1 to {MOST_VALUES} values")
    a, b = (_number(name, end, units, said, text) for end in (first, last))
    if rest[1:] and not (a > 0 and b > 0):
        raise SpecError(said, text, "of positive ends for a logarithmic range")
    return (np.geomspace if rest[1:] else np.linspace)(a, b, int(count))


def _bounds(name: str, text: str, units: str, option: str) -> Any:
    said = f"{option} {name}"
    if ":" not in text:
        return [from_text(name, part, units, said) for part in text.split(",")]
    ends = text.split(":")
    if len(ends) != 2:
        raise SpecError(said, text, "LOW:HIGH, or a list of choices", MEND)
    return tuple(_number(name, end, units, said, text) for end in ends)


def _number(name: str, end: str, units: str, said: str, text: str) -> float:
    """Value of an end of a range."""
    value = from_text(name, end, units, said)
    if isinstance(value, (bool, str)):
        raise SpecError(said, text, "a range of numbers, or a list of words", MEND)
    return value
