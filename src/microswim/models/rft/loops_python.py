"""A few designs: the kernels run as Python, all designs side by side.

The same sums with the same quadrature as loops_compiled, which is faster once it is loaded.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.models.rft.batch_numbers import half_beats as half_beats
from microswim.models.rft.helix import helix_tail
from microswim.models.rft.plane_wave import side_by_side
from microswim.numerics.quadrature import gauss
from microswim.numerics.solve6 import solve


def solve_helices(
    arc: bool, p: np.ndarray, drag: np.ndarray, free: np.ndarray, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what `loops_compiled.solve_helices` does."""
    V, power = np.full((len(p), 6), np.nan), np.full(len(p), np.nan)
    for count in np.unique(counts[counts >= 0]):
        group = counts == count
        R, F, G = helix_tail.written(arc, p[group].T, 0.0, gauss(count))
        V[group], power[group] = _solved(R, F, G, drag[group], free)
    return V, power


def solve_waves(
    arc: bool,
    p: np.ndarray,
    drag: np.ndarray,
    phases: np.ndarray,
    free: np.ndarray,
    ramp_rule: Any,
    rule: Any,
) -> tuple[np.ndarray, np.ndarray]:
    """Return what `loops_compiled.solve_waves` does."""
    sums = side_by_side(arc, p.T, phases, ramp_rule, rule)
    solved = [_solved(R, F, G, drag, free) for R, F, G in zip(*sums)]
    V, power = (np.stack(part, axis=1) for part in zip(*solved))
    return V, power


def _solved(
    R: np.ndarray, F: np.ndarray, G: np.ndarray, drag: np.ndarray, free: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Twists (n, 6) and tail powers (n,) from R (6, 6, n), F (6, n), G (n,) of the tails and the
    drag (n, 6) of the bodies.
    """
    V = -F
    R[range(6), range(6)] += drag.T
    solve.written(R, V, free)
    return V.T, G + np.sum(F * V, axis=0)
