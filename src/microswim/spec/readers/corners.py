"""Corners of a path in space: a table of x, y, z, each with its unit in the header."""

from __future__ import annotations

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.spec.readers import measured

_PLACE = {"x": ("x",), "y": ("y",), "z": ("z",)}


def read_corners(file: str, units: str) -> Array:
    """Return the corners (k, 3) of a path.

    Parameters
    ----------
    file
        The table.
    units
        Of the swimmer; without units the header has none.

    Raises
    ------
    SpecError
        One sentence: what in the file is missing or wrong.
    """
    table = measured.read(file, _PLACE, tuple(_PLACE))
    mend = "write it into the header, as x (mm)"
    columns = [table.numbers[n] * measured.factor(table, n, "length", units, mend) for n in _PLACE]
    corners = np.stack(columns, axis=-1)
    if not np.isfinite(corners).all() or len(corners) < 2:
        raise SpecError(f"{file}: a path has two corners or more, each of three numbers")
    return corners
