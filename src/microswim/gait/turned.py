"""Whether a gait at any phase is the gait at phase 0, turned about s.

So it is for a rigid helix on a body of revolution, free alike in q and r:
``R(phi) = Q R(0) Q'``, ``F_p(phi) = Q F_p(0)`` with Q the rotation by ``sign * phi`` about s, and
so ``V(phi) = Q V(0)``: one phase tells all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.numerics.series.fourier import rotate

if TYPE_CHECKING:
    from microswim.gait.gait import Gait

ROUNDING = 1e-13


def sense(gait: Gait) -> float:
    """Return the sign of the rotation; 0.0 of any other gait.

    The imaginary parts of a complex step are held to the same, or a derivative would be lost.
    """
    R, F, free = gait.resistance_series, gait.propulsion_series, gait.free
    terms = len(R), len(F), len(gait.activity_series)
    if terms != (5, 3, 1) or free[1] != free[2] or free[4] != free[5]:
        return 0.0
    R0, F0 = R[0] + R[1] + R[3], F[0] + F[1]
    for sign in (1.0, -1.0):
        if _same(rotate(R0, sign), R) and _same(rotate(F0, sign), F):
            return sign
    return 0.0


def _same(x: Any, y: Any) -> bool:
    parts = ((x.real, y.real), (x.imag, y.imag)) if np.iscomplexobj(x) else ((x, y),)
    return all(np.abs(a - b).max() <= ROUNDING * np.abs(b).max() for a, b in parts)
