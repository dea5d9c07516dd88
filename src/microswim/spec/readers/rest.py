"""The shape of an elastic filament at rest, as a table of points in the order along it.

Columns s, q, r or x, y, z from the joint on, of any unit: the curve is drawn to the tail's length.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers import measured

KNOWN = {"x": ("x", "s"), "y": ("y", "q"), "z": ("z", "r")}


def with_points(table: dict[str, Any]) -> dict[str, Any]:
    """Return what `ElasticTail` takes: points in place of the file that the spec names.

    Raises
    ------
    SpecError
        If both are there, or the file is no such table.
    """
    if "file" not in table:
        return table
    if "rest" in table:
        raise SpecError("tail.file, tail.rest: give one of the two")
    path = table.pop("file")
    found = measured.read(path, KNOWN, tuple(KNOWN))
    points = np.stack([found.numbers[name] for name in KNOWN], axis=1)
    if not np.isfinite(points).all():
        raise SpecError(f"{path}: a cell is empty; a shape at rest has three numbers in each row")
    return {**table, "rest": tuple(map(tuple, points.tolist()))}
