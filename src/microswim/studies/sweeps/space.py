"""The designs of a sweep: a grid or a list, in blocks of consecutive rows.

A design has a row number, C order of the grid. The blocks are the chunks of the store: as many
whole trailing axes as fit, then a part of the next, so that a block is always a run of rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

from microswim.errors import SpecError

MOST_DESIGNS = 100_000_000  #: of a sweep: at a microsecond each, minutes; on disk, ten gigabytes


@dataclass(frozen=True, eq=False)
class Space:
    """Designs over dotted names.

    Parameters
    ----------
    names
        Dotted names of what varies.
    values
        One array a name: the axis of a grid, or the column of a list.
    grid
        Whether the designs are all combinations.
    block
        Most designs in a block.
    """

    names: tuple[str, ...]
    values: tuple[np.ndarray, ...]
    grid: bool
    block: int

    @classmethod
    def of(cls, over: Any, block: int) -> Space:
        """Return the space of a mapping of axes (grid), or of a sequence of mappings or a table
        (list).

        Raises
        ------
        SpecError
            If nothing varies, an axis is empty or values are not of one kind.
        """
        if isinstance(over, Mapping):
            names, columns, grid = tuple(over), tuple(over.values()), True
        elif hasattr(over, "columns"):  # a table with named columns, such as a pandas.DataFrame
            names = tuple(str(c) for c in over.columns)
            columns, grid = tuple(np.asarray(over[c]) for c in over.columns), False
        elif isinstance(over, Sequence) and over and isinstance(over[0], Mapping):
            names, grid = tuple(over[0]), False
            if any(set(row) != set(names) for row in over):
                raise SpecError("over: every design of a list must set the same fields")
            columns = tuple([row[name] for row in over] for name in names)
        else:
            raise SpecError("over", over, "a mapping of names to values or a list of such designs")
        if not names:
            raise SpecError("over", "{}", "at least one name with its values")
        made = cls(names, tuple(map(_axis, names, columns)), grid, block)
        if made.size > MOST_DESIGNS:
            raise SpecError("over", f"{made.size} designs", f"at most {MOST_DESIGNS} designs")
        return made

    @property
    def dims(self) -> tuple[str, ...]:
        """Dimensions of the result: the names, or ``design`` for a list."""
        return self.names if self.grid else ("design",)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the result."""
        return tuple(len(v) for v in self.values) if self.grid else (len(self.values[0]),)

    @property
    def size(self) -> int:
        """Number of designs."""
        return prod(self.shape)

    @cached_property
    def chunks(self) -> tuple[int, ...]:
        """Shape of a block."""
        room, out = self.block, []
        for n in reversed(self.shape):
            out.append(max(1, min(n, room)))
            room = room // n if room >= n else 0
        return tuple(reversed(out))

    def blocks(self) -> Iterator[tuple[tuple[slice, ...], int, int]]:
        """Yield every block: its place in the grid, first row and row after the last."""
        counts = [-(-n // c) for n, c in zip(self.shape, self.chunks)]
        start = 0
        for index in np.ndindex(*counts):
            place = tuple(
                slice(i * c, min((i + 1) * c, n)) for i, c, n in zip(index, self.chunks, self.shape)
            )
            stop = start + prod(s.stop - s.start for s in place)
            yield place, start, stop
            start = stop

    def columns(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """Return the value of every name at the rows."""
        if not self.grid:
            return {name: v[rows] for name, v in zip(self.names, self.values)}
        index = np.unravel_index(rows, self.shape)
        return {name: v[i] for name, v, i in zip(self.names, self.values, index)}


def _axis(name: str, values: Any) -> np.ndarray:
    array = np.asarray(values)
    if array.ndim != 1 or array.size == 0:
        raise SpecError(f"over {name}", values, "a list of at least one value")
    if array.dtype.kind in "US" or (
        array.dtype.kind == "O" and all(isinstance(v, str) for v in array)
    ):
        return np.array([str(v) for v in array])
    if array.dtype.kind == "b":
        return array
    try:
        return array.astype(np.float64)
    except (TypeError, ValueError):
        raise SpecError(f"over {name}", values, "all numbers or all words") from None
