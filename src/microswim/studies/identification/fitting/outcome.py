"""What fits say together: the designs that the track leaves open, with the error of the model.

Of two fits the one that lies closer need not be the true one where the model itself is off: each is
given the velocities that its errors allow before they are compared, see `unexplained`.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from microswim.calibration.calibrate import lift
from microswim.errors import MicroswimError
from microswim.gait.readable import percent, significant
from microswim.studies.identification.fitting.branches import (
    AS_WELL,
    Branch,
    branch_of,
    holds,
    ranked,
)
from microswim.studies.identification.fitting.descent import apart, cost, fit
from microswim.studies.identification.fitting.first_guesses import Grid
from microswim.studies.identification.fitting.honesty import left_over, model_errors, unexplained
from microswim.studies.identification.fitting.problem import CURVATURE, PathProblem
from microswim.studies.identification.fitting.within_errors import both, inside, shape_of, starts
from microswim.studies.identification.result import Identification, remarks
from microswim.swimmer.swimmer import Swimmer

ROUNDS = 3  #: of looking for designs within the errors of the best, while there are better ones
ALIKE = 0.5  #: chi-squared by which a fit is no better than another
WAY_BACK = (0.0, 0.25, 0.5, 0.75, 1.0)  #: shares of the way from a fit to the spec


def _swimmer_of(problem: PathProblem, values: np.ndarray) -> Swimmer:
    return lift(problem.swimmer, problem.unknowns, [float(v) for v in values]).with_({})


def _errors(problem: PathProblem, done: Any) -> np.ndarray | None:
    """Relative errors to expect of the model at the design of a fit, or where nobody measured them
    there, at the first on the way to the spec's own: what is off may have led beyond what is known.
    """
    values = problem.physical(done.x)
    spec = np.array([u.value(problem.swimmer.numbers) for u in problem.unknowns])
    back = np.where([name == CURVATURE for name in problem.names], 0.0, spec - values)
    for share in WAY_BACK:
        found = _errors_at(problem, values + share * back)
        if found is not None:
            return found
    return None


def _errors_at(problem: PathProblem, values: np.ndarray) -> np.ndarray | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of laws beyond their range: that is in the errors
        try:
            return model_errors(_swimmer_of(problem, values).gait("auto"))
        except MicroswimError:
            return None


def _about_model(problem: PathProblem, branch: Branch) -> tuple[str, ...]:
    """What the model's own error does to the interval of a branch, where it matters."""
    if branch.errors is None:
        return (
            f"the error of model {problem.own_model} is not known for this swimmer: the intervals "
            "hold for noise alone",
        )
    if branch.by_model < 1.0:
        return ()
    return (
        f"the error of model {problem.own_model} (up to {percent(branch.errors.max())} of a "
        f"velocity) is {significant(branch.by_model, 2)} times the noise in these intervals; a "
        "calibration narrows them",
    )


@dataclass(frozen=True, eq=False)
class _Compared:
    """A fit, the errors of the model there, and what both leave: chi-squared and residuals."""

    done: Any
    errors: np.ndarray | None
    chi_squared: float
    residuals: np.ndarray


def _compared(
    problem: PathProblem, fits: list[Any], spread: float, model_error: bool
) -> list[_Compared]:
    """Fits, the one that explains the track best first; the model's error allowed for."""
    found: list[_Compared] = []
    for done in apart(problem, fits) if model_error else fits:
        errors = _errors(problem, done) if model_error else None
        found.append(_Compared(done, errors, *unexplained(problem, done, spread, errors)))
    return sorted(found, key=attrgetter("chi_squared"))


def _with_those_within_errors(
    problem: PathProblem, grid: Grid | None, compared: list[_Compared], spread: float
) -> list[_Compared]:
    """Fits and those of the designs that the errors of the model leave, seen from the best; seen
    anew where a better one is found.
    """
    if grid is None or not both(problem):
        return compared
    tried = [shape_of(problem, one.done) for one in compared]
    for _ in range(ROUNDS):
        best = compared[0]
        if best.errors is None:
            break
        guesses = starts(problem, grid, best.done, spread, best.errors, tried)
        more = [done for guess in guesses for done in fit(problem, guess, phases=1)]
        more = [done for done in more if inside(grid, shape_of(problem, done))]
        if not more:
            break
        fits = sorted([*(one.done for one in compared), *more], key=cost)
        compared = _compared(problem, fits, spread, True)
        if compared[0].chi_squared > best.chi_squared - ALIKE:
            break
    return compared


def _branches(
    problem: PathProblem, compared: list[_Compared], spread: float, grid: Grid | None
) -> list[Branch]:
    """The designs that explain the track as well as the best, each once."""
    found: list[Branch] = []
    for one in compared:
        behind, values = one.chi_squared - compared[0].chi_squared, problem.physical(one.done.x)
        if behind > AS_WELL or any(holds(branch, values) for branch in found):
            continue
        found.append(branch_of(problem, one.done, spread, behind, one.errors, grid=grid))
    return found


def outcome(
    problem: PathProblem, fits: list[Any], model_error: bool, grid: Grid | None = None
) -> Identification:
    """Return everything there is to say about the fits, the best of them first."""
    best = fits[0]
    degrees = best.fun.size - best.x.size
    spread = np.sqrt(2.0 * best.cost / max(degrees, 1)) if problem.sigma is None else 1.0
    spread = max(float(spread), 1e-300)
    compared = _compared(problem, fits, spread, model_error)
    if model_error:
        compared = _with_those_within_errors(problem, grid, compared, spread)
    withheld = left_over(problem, compared[0].residuals)
    branches = (branch_of(problem, best, spread, 0.0, None, tried=False),)
    if not withheld:
        branches = ranked(problem, _branches(problem, compared, spread, grid))
    first = branches[0]
    path = problem.path(first.parameters)
    misfit = None if problem.sigma is None else 2.0 * best.cost / degrees
    said = remarks(problem.names, first.directions, first.covariance, len(branches) - 1, misfit)
    if model_error and not withheld:
        said += _about_model(problem, first)
    several = "several designs fit alike: each has its interval, the track does not tell which"
    blind = ~np.isfinite(np.diag(first.covariance))
    own = [u.value(problem.swimmer.numbers) for u in problem.unknowns]
    values = np.where(blind, own, first.values)
    why = withheld or (several if len(branches) > 1 else "")
    return Identification(
        swimmer=_swimmer_of(problem, values),
        names=problem.names,
        values=values,
        covariance=first.covariance,
        residual=float(np.sqrt(np.mean((path - problem.track.position) ** 2))),
        degrees=degrees,
        directions=first.directions,
        warnings=said if not why else (*said, why),
        path=path,
        branches=() if withheld else branches,
        alternatives=tuple(branch.values for branch in branches[1:]),
        withheld=why,
        model=problem.own_model,
    )
