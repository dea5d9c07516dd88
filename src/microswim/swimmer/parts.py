"""The parts of a swimmer by name: ``body``, ``tail``, and of several tails ``tail[1]``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from microswim.errors import SpecError

#: One of several tables of a name.
ONE_OF_SEVERAL = re.compile(r"^(\w+)\[(\d+)\]$")


def without_number(path: str) -> str:
    """Return the dotted name of a field, without the number of its table.

    Examples
    --------
    >>> without_number("tail[1].section[0]")
    'tail.section[0]'
    """
    part, dot, name = path.partition(".")
    return part.partition("[")[0] + dot + name if dot else path


def replaced(owner: Any, name: str, value: Any) -> Any:
    """Return a copy of a frozen dataclass with one field replaced, without its checks."""
    copy = object.__new__(type(owner))
    for f in fields(owner):
        object.__setattr__(copy, f.name, getattr(owner, f.name))
    object.__setattr__(copy, name, value)
    return copy


def part_of(swimmer: Any, part: str) -> Any:
    """Return the part of a swimmer, or one of several; None if it has none.

    Examples
    --------
    >>> import microswim as ms
    >>> part_of(ms.Swimmer.preset("tabak/helix"), "tail[0]").kind
    'helix'
    """
    one = ONE_OF_SEVERAL.match(part)
    if one is None:
        return getattr(swimmer, part, None)
    each, n = getattr(getattr(swimmer, one[1], None), "each", ()), int(one[2])
    return each[n] if n < len(each) else None


def with_part(swimmer: Any, part: str, new: Any) -> dict[str, Any]:
    """Return the part of a swimmer that changes where `part_of` becomes `new`, by its name."""
    one = ONE_OF_SEVERAL.match(part)
    if one is None:
        return {part: new}
    whole, n = getattr(swimmer, one[1]), int(one[2])
    if len(whole.each) == 1:
        return {one[1]: new}
    each = (*whole.each[:n], new, *whole.each[n + 1 :])
    return {one[1]: replaced(whole, f"{one[1]}s", each)}


def spread(swimmer: Any, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return changes where a field of several tails, ``tail.radius``, is that of each of them."""
    many = len(swimmer.tail.each)
    out: dict[str, Any] = {}
    for path, value in changes.items():
        part, _, name = path.partition(".")
        all_of = part == "tail" and many > 1
        names = [f"tail[{n}].{name}" for n in range(many)] if all_of else [path]
        out |= dict.fromkeys(names, value)
    return out


def changed(swimmer: Any, changes: Mapping[str, Mapping[str, Any]]) -> Any:
    """Return a checked copy of a swimmer with fields of its parts replaced.

    Raises
    ------
    SpecError
        If a value is out of range, with the number of the tail among several.
    """
    parts: dict[str, Any] = {}
    tails = list(swimmer.tail.each)
    for part, new in changes.items():
        one = ONE_OF_SEVERAL.match(part)
        owner = part_of(swimmer, part)
        made = numbered(part, replace, owner, **_chosen_anew(owner, new))
        if one is None:
            parts[part] = made
        else:
            tails[int(one[2])] = made
            parts[one[1]] = tails
    return replace(swimmer, **parts)


def _chosen_anew(owner: Any, new: Mapping[str, Any]) -> dict[str, Any]:
    """Changes, with what is chosen anew where another field comes or goes: sections of a bent
    tail.
    """
    chosen = {
        other: None
        for name, other in getattr(owner, "chosen_by", {}).items()
        if name in new and (new[name] is None) != (getattr(owner, name) is None)
    }
    return chosen | dict(new)


def numbered(part: str, make: Any, *args: Any, **fields: Any) -> Any:
    """Return ``make(*args, **fields)``; what it refuses of ``tail`` is said of ``tail[1]``."""
    try:
        return make(*args, **fields)
    except SpecError as error:
        plain = part.partition("[")[0]
        if part == plain:
            raise
        said = re.sub(rf"\b{plain}(?=[.:])", part, error.field)
        raise SpecError(said, error.value, error.allowed, error.mend) from None
