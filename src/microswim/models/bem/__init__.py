"""Boundary-element Stokes solver: the judge in free space, beside a wall and in a tube.

The wall is a swimmer's `wall`, by the image tensor of Blake, J. R. (1971) Proc. Camb. Phil. Soc.
70, 303-310. `gait.gait` gives the gait of a swimmer, `solve` the flow at one phase and `resistance`
the matrix of any closed surface.
"""

from __future__ import annotations

from typing import Any

from microswim.models.bem.levels import LEVELS, Level, get_level
from microswim.models.bem.patches.surface import Surface, ellipsoid, sampled, still, torus
from microswim.models.bem.solution import Solution, solve
from microswim.models.bem.system import Layer, Quadrature, resistance
from microswim.swimmer.geometry.body import Body


def body_resistance(body: Body, viscosity: float, level: str = "standard") -> Any:
    """Return the resistance (6, 6) of a body alone about its centre, with a level's order and
    quadrature.

    A check against the exact `body.resistance(viscosity)`.
    """
    chosen = get_level(level)
    r = chosen.resolution
    surface = still(sampled(body.facets(r.body + 1)) - body.centre, r.order)
    return resistance(surface, viscosity, rule=chosen.rule)


__all__ = [
    "LEVELS", "Layer", "Level", "Quadrature", "Solution", "Surface",
    "body_resistance", "ellipsoid", "get_level",
    "resistance", "solve", "torus",
]  # fmt: skip
