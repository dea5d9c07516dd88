"""Scrambled Sobol points: the same ones for a seed, today and in a campaign that goes on later."""

from __future__ import annotations

from typing import Any

import numpy as np


def points(count: int, dimensions: int, seed: int) -> np.ndarray:
    """Return `count` points (count, dimensions) of the unit cube.

    SciPy's old argument ``seed``: the new one, ``rng``, scrambles otherwise, and solves that are
    kept would no longer be those of the points.
    """
    from scipy.stats import qmc

    old: dict[str, Any] = {"seed": seed}
    return qmc.Sobol(dimensions, **old).random(count)
