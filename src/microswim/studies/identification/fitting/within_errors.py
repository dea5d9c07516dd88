"""Designs that the error of the model does not tell apart: an interval may reach over all of them.

Around a fit the errors of the velocities move the values in proportion; large errors do more. A
planar beat shows a speed, and how far it swings and turns. Every design of the grid that has these
three within the errors to expect may have made the track. Small errors leave those that hang
together with the design of the fit: between others the shape of the path decides. Large ones change
that shape as well, and then the interval reaches over all of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.ndimage import label

from microswim.studies.identification.fitting.first_guesses import AMPLITUDE, WAVES, Grid, shown
from microswim.studies.identification.fitting.problem import PathProblem

LARGE = 0.2  #: error of a velocity from which on the shape of a path tells no design from others
SHOWN = (0, 1, 5)  #: us, uq and or: whose errors stand for speed, swing and turn


def reach(
    problem: PathProblem, grid: Grid | None, values: np.ndarray, errors: np.ndarray
) -> dict[str, tuple[float, float]]:
    """Return how far down and up amplitude and number of waves reach, empty where it is not known.

    Parameters
    ----------
    problem
        Whose track it is: of a planar beat in the image.
    grid
        Of the designs; both amplitude and waves are unknown.
    values
        Of the unknowns of a fit.
    errors
        Relative errors to expect of the six velocities.
    """
    if grid is None or not problem.planar or not {AMPLITUDE, WAVES} <= set(problem.names):
        return {}
    here = dict(zip(problem.names, map(float, values)))
    one = {name: np.array([here[name]]) for name in (AMPLITUDE, WAVES)}
    own = shown(problem.swimmer, one)
    shape = grid.amplitude.size, grid.waves.size
    alike = np.ones(shape, dtype=bool)
    for wanted, found, k in zip(own, (grid.speed, grid.wobble, grid.turn), SHOWN):
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.abs(np.log(np.abs(found / wanted)))
        alike &= (off <= np.log1p(errors[k])).reshape(shape)
    i = int(np.argmin(np.abs(np.log(grid.amplitude / here[AMPLITUDE]))))
    j = int(np.argmin(np.abs(grid.waves - here[WAVES])))
    alike[i, j] = True
    if errors[list(SHOWN)].max() < LARGE:
        islands: Any = label(alike, structure=np.ones((3, 3)))
        alike = islands[0] == islands[0][i, j]
    rows, columns = np.nonzero(alike)
    return {AMPLITUDE: _ends(grid.amplitude, rows), WAVES: _ends(grid.waves, columns)}


def _ends(values: np.ndarray, of: np.ndarray) -> tuple[float, float]:
    """Values of the grid just beyond those that are alike."""
    low, high = max(int(of.min()) - 1, 0), min(int(of.max()) + 1, values.size - 1)
    return float(values[low]), float(values[high])
