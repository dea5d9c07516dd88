"""``--over``: what varies and how far, as text; quantities carry units: ``1mm:3mm:5``."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from microswim.errors import SpecError

UNITS = {
    "fluid.viscosity": "Pa s",
    "fluid.density": "kg/m^3",
    "tail.length": "m",
    "tail.amplitude": "m",
    "tail.wavelength": "m",
    "tail.radius": "m",
    "tail.frequency": "Hz",
    "body.radius": "m",
    "body.semi_axes": "m",
    "coefficients.normal": "Pa s",
    "coefficients.tangential": "Pa s",
}
MEND = "for example tail.amplitude=0.01:0.5:50,tail.waves=1,2,3"


def split(texts: tuple[str, ...], option: str = "--over") -> dict[str, str]:
    """Dotted name to the text of its values.

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


def axes(texts: tuple[str, ...]) -> dict[str, Any]:
    """Axes of a grid: every name with its values.

    Raises
    ------
    SpecError
        If a range does not say how many values.
    """
    return {name: _axis(name, text) for name, text in split(texts).items()}


def bounds(texts: tuple[str, ...]) -> dict[str, Any]:
    """What a design may vary: a pair of bounds, or a list of choices.

    Raises
    ------
    SpecError
        If a range is no range.
    """
    return {name: _bounds(name, text) for name, text in split(texts).items()}


def spreads(texts: tuple[str, ...]) -> dict[str, Any]:
    """Uncertain numbers: ``5%`` as it stands, ``LOW:HIGH`` as a pair.

    Raises
    ------
    SpecError
        If a range is no range.
    """
    pieces = split(texts, "--uncertain").items()
    return {k: text if text.endswith("%") else _bounds(k, text) for k, text in pieces}


def _axis(name: str, text: str) -> Any:
    if ":" not in text:
        return [value(name, part) for part in text.split(",")]
    first, last, *rest = text.split(":")
    if not rest or not rest[0].strip().isdigit() or rest[1:] not in ([], ["log"]):
        allowed = "FIRST:LAST:COUNT, FIRST:LAST:COUNT:log or a list"
        raise SpecError(f"--over {name}", text, allowed, MEND)
    a, b, n = value(name, first), value(name, last), int(rest[0])
    if isinstance(a, str) or isinstance(b, str) or n < 1 or (rest[1:] and not (a > 0 and b > 0)):
        raise SpecError(f"--over {name}", text, "a range of numbers with at least one value")
    return (np.geomspace if rest[1:] else np.linspace)(a, b, n)


def _bounds(name: str, text: str) -> Any:
    if ":" not in text:
        return [value(name, part) for part in text.split(",")]
    ends = [value(name, part) for part in text.split(":")]
    if len(ends) != 2 or isinstance(ends[0], str) or isinstance(ends[1], str):
        raise SpecError(f"--over {name}", text, "LOW:HIGH, or a list of choices", MEND)
    return tuple(ends)


def value(name: str, text: str) -> Any:
    """A number, a quantity in SI, or a word.

    Raises
    ------
    SpecError
        If a quantity does not have the unit of its field.
    """
    text = text.strip()
    try:
        return float(text)
    except ValueError:
        pass
    unit = UNITS.get(name.partition("[")[0])
    if unit is None or not text[:1].isdigit():
        return text
    from microswim.spec.units import to_si

    try:
        return to_si(text, unit)
    except ValueError as error:
        raise SpecError(f"--over {name} = {text!r}: {error}") from None
