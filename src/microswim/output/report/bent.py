"""Rows of a run whose path is bent: speed along it, its curvature, and how the flagellum's differs.

A beat that is bent in the mean draws a circle. Its curvature over that of the flagellum is about
two for sperm [Friedrich et al. 2010], and depends on the ratio of drag across to drag along.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from microswim.gait.readable import with_error

BENT = 1.05  #: speed along the path over swimming speed from which on both are told
UNKNOWN = "; how wrong is not known, --model bem tells"


def rows(
    numbers: dict[str, Any], row: Callable[..., tuple[str, str, str]], off: dict[str, Any]
) -> list[tuple[str, str, str]]:
    """Return the rows, none where the path is straight.

    Parameters
    ----------
    numbers
        Of the run.
    row
        Row of a quantity: its name, what is told of it, the velocity whose error it has.
    off
        Errors to expect, ``path_curvature`` among them for a flagellum that is bent.
    """
    if not (numbers["path_speed"] or 0.0) > BENT * (numbers["swimming_speed"] or 0.0):
        return []
    found = [
        row("path_speed", "the path is bent: forward and round"),
        row("path_curvature", "of the circle or helix", "path_curvature"),
    ]
    if numbers.get("curvature_ratio") is not None:
        error = off.get("path_curvature")
        ratio = with_error(numbers["curvature_ratio"], error, "1")
        told = "of the path over the flagellum's mean" + ("" if error else UNKNOWN)
        found.append(("curvature ratio", ratio, told))
    return found
