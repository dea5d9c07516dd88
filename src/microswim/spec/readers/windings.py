"""Round coils by their measures: a TOML file of ``[[coil]]`` tables.

Each has ``position`` and ``axis``, ``diameter`` (mean of the winding), ``turns``, and may have
``length`` and ``thickness`` of the winding and a ``name``; lengths with their units.
"""

from __future__ import annotations

from typing import Any

from microswim.errors import SpecError
from microswim.spec.readers.text import read_text, toml
from microswim.spec.values import in_unit
from microswim.swimmer.magnetism.winding import Winding

NEEDED, KNOWN = ("position", "axis", "diameter", "turns"), ("length", "thickness", "name")
MOST = 64  #: coils


def read_windings(file: str) -> tuple[Winding, ...]:
    """Return the coils of a file.

    Raises
    ------
    SpecError
        One sentence: what in the file is missing or wrong.
    """
    tables = toml(read_text(file), file).get("coil")
    if not isinstance(tables, list) or not 1 <= len(tables) <= MOST:
        raise SpecError(f"{file}: needs 1 to {MOST} tables [[coil]]")
    return tuple(_winding(f"{file}: coil[{i}]", table, i) for i, table in enumerate(tables))


def _winding(who: str, table: Any, number: int) -> Winding:
    if not isinstance(table, dict):
        raise SpecError(f"{who}: must be a table [[coil]]")
    for name in NEEDED:
        if name not in table:
            raise SpecError(f"{who}.{name}: missing")
    for name in table:
        if name not in NEEDED + KNOWN:
            raise SpecError(f"{who}.{name}: unknown; known are {', '.join(NEEDED + KNOWN)}")
    diameter = _size(who, table, "diameter", "m")
    thickness = _size(who, table, "thickness", "m") if "thickness" in table else 0.0
    if not diameter > thickness:
        raise SpecError(f"{who}.thickness: must be below the mean diameter of the winding")
    axis = _vector(who, table, "axis", "")
    if not any(axis):
        raise SpecError(f"{who}.axis: must be a vector other than zero")
    return Winding(
        name=str(table.get("name", f"coil_{number + 1}")),
        position=_vector(who, table, "position", "m"),
        axis=axis,
        diameter=diameter,
        length=_size(who, table, "length", "m") if "length" in table else 0.0,
        thickness=thickness,
        turns=_size(who, table, "turns", ""),
    )


def _vector(who: str, table: dict[str, Any], name: str, unit: str) -> tuple[float, float, float]:
    given = table[name]
    if not isinstance(given, list) or len(given) != 3:
        raise SpecError(f"{who}.{name}: must be three numbers [x, y, z]")
    x, y, z = (in_unit(f"{who}.{name}", str(one), unit, "SI") for one in given)
    return x, y, z


def _size(who: str, table: dict[str, Any], name: str, unit: str) -> float:
    size = in_unit(f"{who}.{name}", str(table[name]), unit, "SI")
    if not 0.0 < size < 1e9:
        raise SpecError(f"{who}.{name}: must be positive")
    return size
