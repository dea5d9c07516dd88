"""The designs that a track leaves: each fits as well as the best, and has an interval of its own.

A helical path has three numbers, pitch, radius and rate, and several helices share them; a planar
beat of another number of waves may draw the same path. Which of them made the track no fit can
tell, so they are all listed, those first that lie nearest to what the spec says is known.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import stdtrit

from microswim.calibration.identifiability import Direction, determined
from microswim.numerics.array import read_only
from microswim.studies.identification.fitting.descent import lowest
from microswim.studies.identification.fitting.first_guesses import Grid
from microswim.studies.identification.fitting.honesty import covariance_of_model
from microswim.studies.identification.fitting.problem import PathProblem
from microswim.studies.identification.fitting.profile import stretches
from microswim.studies.identification.fitting.within_errors import reach

AS_WELL = 9.0  #: chi-squared that a design may lie behind the best
VAGUE = 100.0  #: times its own size, beyond which a value is not known at all


@dataclass(frozen=True, eq=False, kw_only=True)
@read_only
class Branch:
    """A design that fits the track as well as any other.

    Parameters
    ----------
    values
        Of the unknowns.
    covariance
        Of the values; infinite along what the track does not determine.
    degrees
        Degrees of freedom left, for the intervals.
    behind
        Chi-squared by which it lies behind the best of all.
    directions
        Combinations of the unknowns, best determined first.
    parameters
        Of the fit: the values, with the frequency of the wobble, then phase and pose.
    errors
        Relative errors of the model's velocities that are in the covariance, None if none are.
    by_model
        Standard uncertainty by those over that by noise, of the value that has most of it.
    stretch
        How much further than the curvature says each interval reaches down and up, (n, 2).
    """

    values: np.ndarray
    covariance: np.ndarray
    degrees: int
    behind: float
    directions: tuple[Direction, ...]
    parameters: np.ndarray
    errors: np.ndarray | None = None
    by_model: float = 0.0
    stretch: np.ndarray | None = None

    @property
    def uncertainty(self) -> np.ndarray:
        """Standard uncertainty of each value; infinite where the track does not tell."""
        return np.sqrt(np.diag(self.covariance))

    def interval(self, level: float = 0.95) -> np.ndarray:
        """Return the confidence interval of each value, if this design it is, shape (n, 2)."""
        half = stdtrit(max(self.degrees, 1), 0.5 + level / 2.0) * self.uncertainty
        reach = np.outer(half, [-1.0, 1.0])
        if self.stretch is not None:
            reach = np.where(np.isfinite(reach), reach * self.stretch, reach)
        return self.values[:, None] + reach


def branch_of(
    problem: PathProblem, done: Any, spread: float, behind: float, errors: np.ndarray | None,
    tried: bool = True, grid: Grid | None = None,
) -> Branch:  # fmt: skip
    """Return the design of a fit, with what noise and the model's errors leave open.

    Parameters
    ----------
    problem
        Whose residuals were made small.
    done
        What least squares found.
    spread
        Size of the noise in units of the residuals.
    behind
        As of `Branch`.
    errors
        Relative errors to expect of the model's six velocities, None to leave them out.
    tried
        Whether the ends of the intervals are tried, see `profile`.
    grid
        Of designs, of which the errors may not tell some apart.
    """
    n = len(problem.unknowns)
    J = problem.jacobian(done.x) / spread
    nuisance = np.linalg.qr(J[:, n:])[0]
    own = (J[:, :n] - nuisance @ (nuisance.T @ J[:, :n])) @ problem.slope(done.x)
    values, typical = problem.physical(done.x), problem.typical
    directions, covariance = determined(own * typical, values / typical, problem.names)
    covariance = _without_vague(covariance)
    noise = np.sqrt(np.diag(covariance)) * typical
    stretch = np.ones((n, 2))
    if tried:
        stretch = stretches(problem, done, values, noise, spread)
    by_model = 0.0
    if errors is not None and np.isfinite(covariance).all():
        more = covariance_of_model(problem, done.x, own, nuisance, spread, errors)
        more = more / np.outer(typical, typical)
        by_model = float(np.sqrt(np.max(np.diag(more) / np.diag(covariance))))
        covariance = covariance + more
        whole = np.sqrt(np.diag(covariance))[:, None] * typical[:, None]
        rest = np.sqrt(np.diag(more))[:, None] * typical[:, None]
        stretch = np.hypot(stretch * noise[:, None], rest) / whole
        degrees = max(done.fun.size - done.x.size, 1)
        half = stdtrit(degrees, 0.975) * whole[:, 0]
        for name, ends in reach(problem, grid, done, spread, errors).items():
            i = problem.names.index(name)
            out = np.abs(np.array(ends) - values[i]) / max(half[i], 1e-300)
            stretch[i] = np.maximum(stretch[i], out)
        room = values - lowest(problem)  # below that no value is tried: what is positive stays so
        stretch[:, 0] = np.minimum(stretch[:, 0], room / np.maximum(half, 1e-300))
    return Branch(
        values=values,
        covariance=covariance * np.outer(typical, typical),
        degrees=done.fun.size - done.x.size,
        behind=behind,
        directions=directions,
        parameters=done.x,
        errors=errors,
        by_model=by_model,
        stretch=stretch,
    )


def _without_vague(covariance: np.ndarray) -> np.ndarray:
    """Infinite where a value is known to no better than a hundred times its size."""
    vague = np.diag(covariance) > VAGUE**2
    out = covariance.copy()
    out[vague, :] = out[:, vague] = 0.0
    out[vague, vague] = np.inf
    return out


def holds(branch: Branch, values: np.ndarray) -> bool:
    """Return whether a design lies in the intervals of a branch."""
    low, high = branch.interval().T
    near = 1e-6 * np.abs(branch.values)
    return bool(((low - near <= values) & (values <= high + near)).all())


def ranked(problem: PathProblem, branches: list[Branch]) -> tuple[Branch, ...]:
    """Return the branches, those nearest to the spec's own values first: in logarithms."""
    own = problem.swimmer.numbers
    spec = np.array([u.value(own) for u in problem.unknowns])
    scale = np.where(spec != 0, spec, problem.typical)

    def away(branch: Branch) -> float:
        share = branch.values / scale
        logs = np.log(np.maximum(np.abs(share), 1e-9))
        return float(np.sum(np.where(spec != 0, np.where(share > 0, logs, 10.0), share) ** 2))

    return tuple(sorted(branches, key=away))
