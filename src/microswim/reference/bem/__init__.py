"""Boundary-element Stokes solver: the judge in free space and beside a wall.

`gait` gives the gait of a swimmer, `solve` the flow at one phase, `resistance` the matrix of any closed
surface. Depends on swimmer, bodies, tails, gait, errors; see docs/decisions/boundary-elements.md.
"""

from __future__ import annotations

from typing import Any

from .levels import LEVELS
from .solution import Solution, solve
from .surface import Surface, ellipsoid, torus
from .system import Layer, Quadrature, resistance
from .wall import Wall


def gait(swimmer: Any, **options: Any) -> Any:
    """Gait of a swimmer; see `microswim.reference.bem.phases.gait` for the options."""
    from .phases import gait as compute

    return compute(swimmer, **options)


__all__ = [
    "LEVELS", "Layer", "Quadrature", "Solution", "Surface", "Wall", "ellipsoid", "gait",
    "resistance", "solve", "torus",
]  # fmt: skip
