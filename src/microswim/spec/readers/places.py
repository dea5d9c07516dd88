"""Places of many alike swimmers of a scene: a table with one row for each.

Columns x, y, z, with a unit in the header where the specs have units; dx, dy, dz, the axis from the
body along the tail; phase (rad).
"""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers import measured

KNOWN = {name: (name,) for name in ("x", "y", "z", "dx", "dy", "dz", "phase")}
POSITION, DIRECTION = ("x", "y", "z"), ("dx", "dy", "dz")


def read_places(path: str | PathLike[str], units: str) -> list[dict[str, Any]]:
    """Return position, and direction and phase if they are there, of each swimmer of a table.

    Raises
    ------
    SpecError
        If the file is none, a cell is empty, a unit is missing, or a column is not known.
    """
    table = measured.read(path, KNOWN, POSITION)
    if table.left_out:
        raise SpecError(f"{path}: column {table.left_out[0]}: not known; it has {', '.join(KNOWN)}")
    turned = [name for name in DIRECTION if name in table.numbers]
    if turned and len(turned) < 3:
        raise SpecError(f"{path}: column {turned[0]}: give dx, dy and dz, or none of them")
    for name, values in table.numbers.items():
        if not np.isfinite(values).all():
            row = int(np.flatnonzero(~np.isfinite(values))[0])
            raise SpecError(f"{path}: {table.titles[name]}: no number in row {row + 1}")
    mend = "write it in the header, as in x (um)"
    made: dict[str, Any] = {"position": _together(table, POSITION, "length", units, mend)}
    if turned:
        made["direction"] = _together(table, DIRECTION, None, units, mend)
    if "phase" in table.numbers:
        made["phase"] = _together(table, ("phase",), "angle", units, mend)[:, 0]
    return [dict(zip(made, row, strict=True)) for row in zip(*(x.tolist() for x in made.values()))]


def _together(
    table: measured.Table, names: tuple[str, ...], kind: str | None, units: str, mend: str
) -> np.ndarray:
    """Return some columns side by side, in the units of the specs."""
    scale = [measured.factor(table, n, kind, units, mend) if kind else 1.0 for n in names]
    return np.stack([table.numbers[n] * s for n, s in zip(names, scale)], axis=-1)
