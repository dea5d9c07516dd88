"""Tables of which a spec may hold several, ``[[tail]]``: split, set one by one or all alike."""

from __future__ import annotations

from typing import Any

from microswim.errors import SpecError
from microswim.swimmer.parts import ONE_OF_SEVERAL


def several(table: Any) -> list[dict[str, Any]]:
    """Return the tables that stand under one name: several, the one, or none.

    Examples
    --------
    >>> several([{"kind": "helix"}, {"kind": "helix"}])[1], several({"kind": "none"}), several(None)
    ({'kind': 'helix'}, [{'kind': 'none'}], [])
    """
    each = table if isinstance(table, list) else [table]
    return [one for one in each if isinstance(one, dict)]


def apart(tables: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return a spec for each tail, by its name: ``tail``, or ``tail[0]``, ``tail[1]``, ...

    Raises
    ------
    SpecError
        If there is an empty list of tails.
    """
    tails = tables.get("tail")
    if not isinstance(tails, list):
        return {"tail": tables}
    if not tails:
        raise SpecError('tail: an empty list; leave it out for kind = "none", or add a table')
    if len(tails) == 1:
        return {"tail": tables | {"tail": tails[0]}}
    return {f"tail[{n}]": tables | {"tail": one} for n, one in enumerate(tails)}


def to_set(tables: dict[str, Any], part: str, path: str, value: Any) -> list[dict[str, Any]]:
    """Return the tables in which a field is set: that of its part, of all alike, or one of several.

    Raises
    ------
    SpecError
        If there is no such table.
    """
    one = ONE_OF_SEVERAL.match(part)
    if one is None and "[" in part:
        raise SpecError(
            path, value, "a field as in tail.amplitude, or tail[0].amplitude of several"
        )
    name = part if one is None else one[1]
    table = tables.setdefault(name, {})
    each = several(table)
    if not each:
        raise SpecError(name, table, "a table")
    if one is None:
        return each
    if int(one[2]) >= len(each):
        raise SpecError(path, value, f"of a table that the spec holds: [0] to [{len(each) - 1}]")
    return [each[int(one[2])]]
