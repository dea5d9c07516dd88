"""How far a value reaches until the fit gets worse: intervals by the profile of chi-squared.

Where two designs that fit alike lie close together the misfit is no parabola between them, and an
interval from its curvature alone is too short. So each end of it is tried: with the value held
there and all else fitted anew, chi-squared must have risen by ``t^2`` [Venzon and Moolgavkar 1988].
If the value known worst passes, the curvature is believed for all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import stdtrit

from microswim.studies.identification.fitting.descent import least
from microswim.studies.identification.fitting.problem import PathProblem

LEVEL = 0.95
TOLERANCE = 0.3  #: of the rise of chi-squared, within which a parabola is one
PIN = 3e-3  #: of the way out, to which a value is held
WIDER = 1.5
MOST = 8  #: tries for one end


def stretches(
    problem: PathProblem, done: Any, values: np.ndarray, uncertainty: np.ndarray, spread: float
) -> np.ndarray:
    """Return by how much each end lies further out than the curvature says, shape (n, 2).

    Parameters
    ----------
    problem, done
        Residuals, and where least squares found them smallest.
    values, uncertainty
        Of the unknowns there, by the curvature.
    spread
        Size of the noise in units of the residuals.
    """
    found = np.ones((values.size, 2))
    if not np.isfinite(uncertainty).all() or not (uncertainty > 0).all():
        return found
    t = float(stdtrit(max(done.fun.size - done.x.size, 1), 0.5 + LEVEL / 2.0))
    ways = _ways(problem, done)

    def end(i: int, sense: float) -> _End:
        step = sense * t * uncertainty[i]
        return _End(problem, done, i, float(values[i]), step, ways[:, i], t * spread)

    worst = int(np.argmax(uncertainty / problem.typical))
    if all(abs(end(worst, sense).risen(1.0) - 1.0) < TOLERANCE for sense in (-1.0, 1.0)):
        return found
    for i in range(values.size):
        found[i] = [end(i, sense).reached() for sense in (-1.0, 1.0)]
    return found


def _ways(problem: PathProblem, done: Any) -> np.ndarray:
    """Change of all parameters with each value, all else fitted: ``C g / g'C g``, g its slope."""
    n = len(problem.unknowns)
    J = problem.jacobian(done.x)
    size = np.maximum(np.linalg.norm(J, axis=0), 1e-300)  # units apart, before rounding cuts
    C = np.linalg.pinv((J / size).T @ (J / size), rcond=1e-14, hermitian=True)
    C = C / np.outer(size, size)
    g = np.zeros((len(done.x), n))
    g[:n] = np.linalg.inv(problem.slope(done.x)).T
    return (C @ g) / np.sum(g * (C @ g), axis=0)


@dataclass(eq=False)
class _End:
    """One end of the interval of one value, a step away by the curvature."""

    problem: PathProblem
    done: Any
    i: int
    value: float
    step: float
    way: np.ndarray
    size: float

    def risen(self, share: float) -> float:
        """Return chi-squared risen above that of the fit, over ``t^2``, a share of the way out."""
        moved = share * self.step
        held = (self.i, self.value + moved, PIN * abs(self.step))
        found = least(self.problem, self.done.x + moved * self.way, held)
        return np.inf if found is None else 2.0 * (found.cost - self.done.cost) / self.size**2

    def reached(self) -> float:
        """Return the share of the way at which chi-squared has risen by ``t^2``; one where no fit
        works there, which tells nothing.
        """
        inside, outside, share = 0.0, 0.0, 1.0
        for _ in range(MOST):
            risen = self.risen(share)
            if not np.isfinite(risen):
                return max(inside, 1.0)
            if abs(risen - 1.0) < TOLERANCE / 3.0:
                return share
            if risen > 1.0:
                outside = share
            else:
                inside = share
            share = (inside + outside) / 2.0 if outside else WIDER * share
        return outside or share
