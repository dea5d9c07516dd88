"""Parabolas run along a path: each fits the averages of a window around its own by least squares
[Savitzky and Golay 1964]; those of the first and the last window serve to the ends.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.ndimage import correlate1d


@cache
def weights(window: int) -> np.ndarray:
    """Return the weights of the averages in a parabola's three coefficients, shape (3, window).

    Parameters
    ----------
    window
        An odd number of averages, at least 3.
    """
    return np.linalg.pinv(_powers(window))


def middle(x: np.ndarray, window: int) -> np.ndarray:
    """Return each parabola's value at its own average; beyond its ends the path stands still.

    Parameters
    ----------
    x
        Averages, evenly spaced, shape (m, d).
    window
        An odd number of them.
    """
    return correlate1d(x, weights(window)[0], axis=0, mode="nearest")


def positions_and_velocities(
    x: np.ndarray, window: int, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return values and slopes of the parabolas along the path, each shape (m, d).

    Parameters
    ----------
    x
        Averages, evenly spaced, shape (m, d), at least a window of them.
    window
        An odd number of them.
    step
        Time from one to the next.
    """
    half, w, powers = window // 2, weights(window), _powers(window)
    slopes = np.stack([np.zeros(window), powers[:, 0], 2.0 * powers[:, 1]], axis=1)
    found = []
    first, last = w @ x[:window], w @ x[-window:]
    for weight, row in ((w[0], powers), (w[1], slopes)):
        along = correlate1d(x, weight, axis=0, mode="nearest")
        along[:half] = row[:half] @ first
        along[-half:] = row[-half:] @ last
        found.append(along)
    return found[0], found[1] / step


def _powers(window: int) -> np.ndarray:
    k = np.arange(window) - window // 2
    return np.stack([np.ones(window), k, k**2], axis=1)
