"""Least squares of a track from one guess on, all unknowns free or one of them held."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from microswim.errors import MicroswimError
from microswim.studies.identification.fitting.first_guesses import (
    WAVES,
    curvature_guess,
    initial_poses,
)
from microswim.studies.identification.fitting.problem import CURVATURE, FREQUENCY, PathProblem

LEAST = 1e-3  #: of the spec's own value, where what is unknown is a positive number
ALIKE = 1e-3  #: of its values, within which a fit is another once more
MOST = 24  #: different fits that are followed


def least(
    problem: PathProblem, z: np.ndarray, pinned: tuple[int, float, float] | None = None
) -> Any:
    """Return what least squares finds from z on, None if they fail.

    Parameters
    ----------
    problem
        Whose residuals are made small.
    z
        Values, phase and pose to start from.
    pinned
        Number of an unknown, the value at which it is held, and how exactly.
    """
    low = lowest(problem)
    floor = np.concatenate([low, np.full(1 + problem.pose_size(), -np.inf)])
    residuals, jacobian = problem.residuals, problem.jacobian
    if pinned is not None:
        residuals, jacobian = _pinned(problem, *pinned)
    slope: dict[str, Any] = {"jac": jacobian, "bounds": (floor, np.inf)}
    try:
        with np.errstate(invalid="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a law far out, on the way
            return least_squares(
                residuals, z, x_scale=_sizes(problem, z), max_nfev=40, xtol=1e-9,
                ftol=1e-9, **slope,
            )  # fmt: skip
    except (MicroswimError, np.linalg.LinAlgError, ValueError):
        return None


def apart(problem: PathProblem, fits: list[Any]) -> list[Any]:
    """Return the fits of different designs, the best of each; fits are sorted by their cost."""
    n, found = len(problem.unknowns), []
    for done in fits:
        if not any(np.allclose(done.x[:n], other.x[:n], rtol=ALIKE, atol=0.0) for other in found):
            found.append(done)
    return found[:MOST]


def lowest(problem: PathProblem) -> np.ndarray:
    """Return the lower bounds of the unknowns: what is positive stays so, a rate is free."""
    free, own = (FREQUENCY, CURVATURE, "coupling"), problem.swimmer.numbers
    lowest = [
        0.3 if u.name == WAVES
        else -np.inf if u.name.startswith(free) or u.value(own) <= 0
        else LEAST * u.value(own)
        for u in problem.unknowns
    ]  # fmt: skip
    return np.array(lowest)


def _sizes(problem: PathProblem, z: np.ndarray) -> np.ndarray:
    """Typical steps: a tenth of a value; of the frequency a fraction of a cycle."""
    n = len(problem.unknowns)
    own = 0.1 * np.maximum(np.abs(z[:n]), 1e-2 * problem.typical)
    sizes = np.concatenate([own, np.ones(len(z))])
    sizes = sizes[: len(z)]
    for i, name in enumerate(problem.names):
        if name == FREQUENCY:
            sizes[i] = 0.2 / problem.track.duration
    d = problem.track.dimensions
    sizes[-d:] = np.maximum(np.ptp(problem.track.position, axis=0) * 0.1, 1e-9)
    return sizes


def _pinned(problem: PathProblem, i: int, value: float, exactly: float) -> Any:
    """Residuals and their derivatives with one more, which holds an unknown at a value."""

    def residuals(z: np.ndarray) -> np.ndarray:
        off = (problem.physical(z)[i] - value) / exactly
        return np.append(problem.residuals(z), off)

    def jacobian(z: np.ndarray) -> np.ndarray:
        row = np.zeros(len(z))
        row[: len(problem.unknowns)] = np.linalg.inv(problem.slope(z))[i] / exactly
        return np.vstack([problem.jacobian(z), row])

    return residuals, jacobian


def fit(
    problem: PathProblem, guess: dict[str, float], motor: bool = False, phases: int = 2
) -> list[Any]:
    """Return the least squares from a guess, with a few initial phases; empty if none works.

    `motor`: the guess holds the motor's frequency, not that of the wobble.
    """
    own = problem.swimmer.numbers
    first = np.array([guess.get(u.name, u.value(own)) for u in problem.unknowns], dtype=float)
    if problem.wobbles and motor:
        i = problem.names.index(FREQUENCY)
        first[i] *= problem.wobble_ratio(first)
    if CURVATURE in problem.names and CURVATURE not in guess:
        first[problem.names.index(CURVATURE)] = curvature_guess(problem, first)
    low, best = lowest(problem), []
    try:
        poses = initial_poses(problem, np.maximum(first, 1.01 * low), count=phases)
    except (MicroswimError, np.linalg.LinAlgError, ValueError):  # a design that no law knows
        return []
    for z in poses:
        best.append(least(problem, z))
    best = [done for done in best if done is not None]
    return [min(best, key=cost)] if best else []


def cost(done: Any) -> float:
    """Return the cost of what least squares found."""
    return float(done.cost)
