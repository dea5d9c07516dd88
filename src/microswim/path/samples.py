"""At which times a path is kept."""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array

MOST_SAMPLES, A_PERIOD = 4000, 16


def sampled(period: float, time: float, samples: int | None) -> Array:
    """Return the times at which a path is kept."""
    if samples is not None:
        return np.linspace(0.0, time, int(samples))
    turns = time / period
    if not turns > 0 or A_PERIOD * turns <= MOST_SAMPLES:
        count = int(np.clip(np.ceil(A_PERIOD * turns), 200, MOST_SAMPLES)) if turns else 1000
        return np.linspace(0.0, time, count + 1)
    every = period * np.ceil(2.0 * turns / MOST_SAMPLES)
    inside = np.arange(0.0, time * (1.0 - 1e-12), every)
    return np.append(inside, time)
