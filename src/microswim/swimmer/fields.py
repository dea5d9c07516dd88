"""Dotted names of the numbers that a frozen dataclass holds: ``.amplitude``, ``.rotation[1]``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError, nearest
from microswim.swimmer.parts import part_of, replaced, with_part, without_number

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer

#: Fields that say the same in two ways: one of the two is given, and setting one clears the other.
ALTERNATIVES = {"tail.waves": "tail.wavelength", "tail.wavelength": "tail.waves"}


def numbers_of(owner: Any, prefix: str = ".") -> list[tuple[str, float]]:
    """Return the name and value of every number, entries of nested tuples included.

    Those of several tails are ``[0].amplitude``, ``[1].amplitude``, ...
    """
    each = getattr(owner, "each", (owner,))
    if len(each) > 1:
        return [e for n, one in enumerate(each) for e in numbers_of(one, f"[{n}].")]
    found: list[tuple[str, float]] = []
    for f in fields(owner):
        found += _entries(f"{prefix}{f.name}", getattr(owner, f.name))
    return found


def _entries(path: str, value: Any) -> list[tuple[str, float]]:
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return []
    if isinstance(value, tuple):
        return [e for i, v in enumerate(value) for e in _entries(f"{path}[{i}]", v)]
    return [] if callable(value) else [(path, value)]


def set_item(values: tuple, index: list[int], value: Any) -> tuple:
    """Return a copy of nested tuples with one entry replaced."""
    head, *rest = index
    new = set_item(values[head], rest, value) if rest else value
    return (*values[:head], new, *values[head + 1 :])


def lifted(swimmer: Swimmer, values: Mapping[str, Any]) -> Swimmer:
    """Return a copy with numbers replaced *unchecked*: complex numbers, or arrays of designs.

    The formulas of the package accept both, so that one set of them serves a gait, its derivatives
    by the complex step and a batch. Such a swimmer stays within the package.

    Raises
    ------
    SpecError
        If a name is no number of this swimmer.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> lifted(helix, {"tail.amplitude": 0.1 + 1e-30j}).tail.amplitude
    (0.1+1e-30j)
    """
    numbers = swimmer.numbers if values else {}
    for path, value in values.items():
        if path not in numbers:
            given = value if np.ndim(value) == 0 else "many values"
            raise SpecError(path, given, "a number of this swimmer", nearest(path, numbers))
        part, name = path.split(".", 1)
        name, *index = name.replace("]", "").split("[")
        owner = part_of(swimmer, part)
        if index:
            value = set_item(getattr(owner, name), [int(i) for i in index], value)
        for whole, new in with_part(swimmer, part, replaced(owner, name, value)).items():
            swimmer = replaced(swimmer, whole, new)
    return swimmer


def without_other_names(given: Iterable[str]) -> set[str]:
    """Return the fields that say in another way what `given` says already, and must be cleared."""
    given, cleared = set(given), set()
    for name in given:
        plain = without_number(name)
        other = ALTERNATIVES.get(plain)
        if plain.partition("[")[0] == "tail.section":
            other = "tail.radius"  # the section says it
        if other is not None:
            cleared.add(name.partition(".")[0] + "." + other.partition(".")[2])
    return cleared - given


def both_of_the_wave(tail: Any) -> dict[str, Any]:
    """Return the number of waves and the wavelength of a tail that has them, by dotted name."""
    waves = tail.number_of_waves
    return {"tail.waves": waves, "tail.wavelength": tail.apparent_length / waves}


def in_terms_of(swimmer: Any, names: Iterable[str]) -> Any:
    """Return the same swimmer in the words of `names`: its wave by the one of `waves` and
    `wavelength` that is among them, the direction of its magnet by an angle.
    """
    for name in names:
        if name in swimmer.numbers:
            continue
        if name in ALTERNATIVES:
            swimmer = swimmer.with_({name: float(both_of_the_wave(swimmer.tail)[name])})
        elif name == "magnet.direction" and getattr(swimmer.magnet, "direction", None) is not None:
            s, q, r = swimmer.magnet.direction
            angles = {name: np.arctan2(np.hypot(q, r), s), "magnet.azimuth": np.arctan2(r, q)}
            swimmer = swimmer.with_({k: float(v) for k, v in angles.items()})
    return swimmer
