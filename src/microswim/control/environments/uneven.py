"""A field that is not the same everywhere: a gradient about the origin, of its own each episode.

    B(x) = B + J x      J = g (3 a a' - 1) / 2

a: a random direction, g: the largest slope, as on the axis of a magnet far away.
"""

from __future__ import annotations

from typing import Any

from microswim.control.environments.random_streams import direction
from microswim.numerics.compiling.compiled import njit


@njit(cache=True)
def draw(J: Any, slope: float, keys: Any, i: int) -> None:
    """Write a gradient (9,) of the given largest slope, symmetric and free of trace."""
    a = direction(keys, i)
    for m in range(3):
        for n in range(3):
            J[3 * m + n] = 1.5 * slope * a[m] * a[n] - (0.5 * slope if m == n else 0.0)
