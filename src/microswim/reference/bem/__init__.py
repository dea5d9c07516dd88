"""Boundary-element Stokes solver: the judge in free space and beside a wall.

The wall is a swimmer's `wall`, by the image tensor of Blake, J. R. (1971) Proc. Camb. Phil. Soc.
70, 303-310. `gait` gives the gait of a swimmer, `solve` the flow at one phase, `resistance` the
matrix of any closed surface.
"""

from __future__ import annotations

from typing import Any

from .levels import LEVELS, Level, get_level
from .solution import Solution, solve
from .surface import Surface, ellipsoid, torus
from .system import Layer, Quadrature, resistance


def gait(swimmer: Any, **options: Any) -> Any:
    """Gait of a swimmer; see `microswim.reference.bem.phases.gait` for the options."""
    from .phases import gait as compute

    return compute(swimmer, **options)


def body_resistance(body: Any, viscosity: float, level: str = "standard") -> Any:
    """Resistance (6, 6) of a body alone about its centre, with a level's order and quadrature.

    A check against the exact `body.resistance(viscosity)`.
    """
    chosen = get_level(level)
    r = chosen.resolution
    return resistance(ellipsoid(body.semi_axes3, r.body + 1, r.order), viscosity, rule=chosen.rule)


__all__ = [
    "LEVELS", "Layer", "Level", "Quadrature", "Solution", "Surface",
    "body_resistance", "ellipsoid", "gait", "get_level",
    "resistance", "solve", "torus",
]  # fmt: skip
