"""Local resistance of a filament of elliptic section, a ribbon.

To the order of slender-body theory a section counts through the flow of a line of forces spread
over it [Batchelor 1970, J. Fluid Mech. 44, 419]. Those on an ellipse that moves are even in its
eccentric angle eta, and at the middle of the section

    u_i = F_i / (4 pi mu) [ln R - <ln |y|> + <y_i^2/|y|^2>],   y = (a cos eta, b sin eta),

with ``<ln |y|> = ln((a + b)/2)`` and ``<y_1^2/|y|^2> = a/(a + b)``. A circle has 1/2 for the
latter: the ribbon moves along the half axis a as a round filament of the radius

    r_a = (a + b)/2 exp(1/2 - a/(a + b)),

and along itself as one of the radius ``(a + b)/2``, whatever the law. A pair of constants knows no
radius, and is the same in both directions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.swimmer.drag.coefficients import Coefficients
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.parts import replaced


def round_radii(tail: Tail) -> tuple[Any, Any, Any]:
    """Return radii of round filaments that drag alike along tail, normal and binormal."""
    a, b = tail.half_axes
    mean = 0.5 * (a + b)
    return mean, mean * np.exp(0.5 - 0.5 * a / mean), mean * np.exp(0.5 - 0.5 * b / mean)


def local(
    law: Coefficients, tail: Tail, viscosity: Any, narrowing: Any = 1.0
) -> tuple[Any, Any, Any, Any]:
    """Return ``(c_t, c_n, c_b, c_r)``: along the tail, its normal, its binormal, and of spin.

    Where the half axes are those at the root times `narrowing`: local laws know the section there.
    """
    radii = (narrowing * r for r in round_radii(tail))
    along, normal, binormal = (replaced(tail, "radius", r) for r in radii)
    c_t, _ = law.pair(along, viscosity)
    _, c_n = law.pair(normal, viscosity)
    _, c_b = law.pair(binormal, viscosity)
    return c_t, c_n, c_b, narrowing**2 * law.local(tail, viscosity)[2]
