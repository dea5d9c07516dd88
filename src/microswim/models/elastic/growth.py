"""Whether a tail settles to its beat: what becomes of a small disturbance in a period.

Linearised about the beat, with the body's free velocities eliminated, a disturbance follows
``dz/dphi = A(phi) z``. Radau's method of order five carries n of them over a period; the largest
multiplier in magnitude is the growth. Where half a period on the tail is its mirror image A repeats
there, and the square of half a period's is taken.
"""

from __future__ import annotations

import numpy as np

from microswim.models.elastic.beat import Beat
from microswim.numerics.series.fourier import evaluate, series_of

ROOT = np.sqrt(6.0)
STEPS = 16  #: a period, at least
#: Radau IIA of three stages, whose last is the end of the step.
TIMES = np.array([(4.0 - ROOT) / 10.0, (4.0 + ROOT) / 10.0, 1.0])
STAGES = np.array([
    [(88.0 - 7.0 * ROOT) / 360.0, (296.0 - 169.0 * ROOT) / 1800.0, (-2.0 + 3.0 * ROOT) / 225.0],
    [(296.0 + 169.0 * ROOT) / 1800.0, (88.0 + 7.0 * ROOT) / 360.0, (-2.0 - 3.0 * ROOT) / 225.0],
    [(16.0 - ROOT) / 36.0, (16.0 + ROOT) / 36.0, 1.0 / 9.0],
])  # fmt: skip
#: What the multiplier of a disturbance that neither grows nor dies may differ from 1.
NEUTRAL = 1e-6


def growth(beat: Beat) -> float:
    """Return the factor by which the slowest disturbance grows in a period."""
    return abs(multiplier(beat))


def multiplier(beat: Beat) -> complex:
    """Return the same with its sense: below zero it changes its side in each period, complex it
    turns.
    """
    if not np.real(beat.problem.drag.normal) > 0.0:
        return 0.0
    return slowest(_rates(beat), 2 if beat.problem.mirrors else 1)


def slowest(A: np.ndarray, times: int) -> complex:
    """Return the same by the rates A at equal phases, (T, n, n), which repeat so often a period."""
    carried = np.eye(A.shape[-1])
    for step in _steps(A, times):
        carried = step @ carried
    factors = np.linalg.eigvals(carried)
    return complex(factors[np.abs(factors).argmax()] ** times)


def _rates(beat: Beat) -> np.ndarray:
    """``A = -M^-1 G`` at the phases of the beat, the rows of the coordinates, (T, n, n)."""
    at, f = beat.balance, beat.velocity.shape[1]
    return -np.linalg.solve(np.real(at.resistance), np.real(at.stiffness))[:, f:]


def _steps(A: np.ndarray, times: int) -> np.ndarray:
    """Matrices that carry a disturbance over equal steps, of an A so many times in a period."""
    T, n = max(len(A), STEPS // times), A.shape[-1]
    h = 2.0 * np.pi / (times * T)
    when = h * (np.arange(T)[:, None] + TIMES)
    at_stages = evaluate(series_of(A), times * when)
    system = np.eye(3 * n) - h * np.einsum("ij,tjab->tiajb", STAGES, at_stages).reshape(
        T, 3 * n, 3 * n
    )
    ones = np.broadcast_to(np.tile(np.eye(n), (3, 1)), (T, 3 * n, n))
    return np.linalg.solve(system, ones)[:, -n:]
