"""Identify a swimmer from its track [Tabak Sections 4.1, 5]: wave shape and rate by least squares.

The frequency comes from the track's spectrum, first guesses from a grid of designs, then amplitude,
number of waves, frequency (and what else is asked for) are fitted together with the unknown initial
pose and phase.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from microswim import checks
from microswim.calibration.calibrate import lift
from microswim.calibration.identifiability import determined
from microswim.calibration.unknowns import resolve
from microswim.errors import MicroswimError
from microswim.numerics.compiled import settled
from microswim.studies.identification.first_guesses import (
    AMPLITUDE,
    WAVES,
    first_guesses,
    initial_poses,
)
from microswim.studies.identification.honesty import (
    check_shown,
    covariance_of_model,
    left_over,
    model_errors,
)
from microswim.studies.identification.problem import FREQUENCY, PathProblem
from microswim.studies.identification.result import Identification, distinct_from, remarks
from microswim.studies.identification.track import Track
from microswim.swimmer.swimmer import Swimmer

SHAPE = (AMPLITUDE, WAVES, FREQUENCY)
LEAST = 1e-3  #: of the spec's own value, where what is unknown is a positive number


@checks.given(
    swimmer=checks.swimmer,
    track=partial(checks.instance, kind="Track"),
    unknowns=checks.words,
    sigma=checks.above_zero("length"),
    sigma_attitude=checks.above_zero("angle (rad)"),
    start=checks.mapping,
    starts=checks.at_least(1),
    model_error=checks.truth,
    progress=checks.function,
)
@settled(True)  # thousands of gaits, one by one
def identify_swimmer(
    swimmer: Swimmer,
    track: Track,
    unknowns: Iterable[str] = SHAPE,
    *,
    sigma: float | None = None,
    sigma_attitude: float | None = None,
    start: dict[str, float] | None = None,
    starts: int = 8,
    model_error: bool = True,
    progress: Callable[[int, int], None] | None = None,
) -> Identification:
    """Find wave shape and rate of a swimmer from its track.

    Parameters
    ----------
    swimmer
        What is known of it: body, filament, fluid; what is not unknown stays as it is.
    track
        Times and positions of the body's centre, 2-D (projection) or 3-D, noisy.
    unknowns
        Dotted numbers of the spec, or interaction coefficients such as ``"translation.s"``;
        amplitude, number of waves and frequency by default.
    sigma
        Standard deviation of the noise of each coordinate; estimated from the fit by default.
    sigma_attitude
        Of the attitude (rad), if the track has one; 0.02 by default.
    start
        First guess by name; a grid of designs is searched if there is none.
    starts
        Number of first guesses out of the grid that are followed.
    model_error
        Whether the intervals hold the error to expect of the model as well. Without it they
        are right only for a track that the model itself has made.
    progress
        Called with the number of fits done and in all.

    Returns
    -------
    Identification
        By the swimmer's own model: calibrated, the atlas, or resistive force theory.

    Raises
    ------
    SpecError
        If an unknown does not exist, the track is too short or an option makes no sense.
    MicroswimError
        If the track shows no wobble, its frames are too slow for the beat, or no fit converges.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> t = np.linspace(0, 12, 240)
    >>> track = ms.Track(time=t, position=ms.trajectory(swimmer.gait(), t).position.values)
    >>> guess = {"tail.amplitude": 0.11, "tail.waves": 2.9, "tail.frequency": 1.0}
    >>> found = ms.identify_swimmer(swimmer, track, start=guess, model_error=False)
    >>> [round(float(v), 3) for v in found.values]
    [0.1, 3.0, 1.0]
    """
    for name, value in (("sigma", sigma), ("sigma_attitude", sigma_attitude)):
        if value is not None:
            checks.positive(name, value)
    checks.truth("model_error", model_error)
    checks.count("starts", starts)
    names = tuple(unknowns)
    if WAVES in names and WAVES not in swimmer.numbers and "tail.wavelength" in swimmer.numbers:
        swimmer = swimmer.with_({WAVES: float(swimmer.tail.number_of_waves)})
    chosen = resolve(swimmer, names)
    problem = PathProblem(swimmer, track, chosen, sigma_attitude or 0.02, sigma)
    check_shown(problem, SHAPE)
    guesses = [start] if start is not None else first_guesses(problem, starts)
    fits = []
    for i, guess in enumerate(guesses):
        fits += fit(problem, guess, motor=start is not None)
        if progress is not None:
            progress(i + 1, len(guesses))
    if not fits:
        raise MicroswimError("no first guess led to a path like the track; give start values")
    return outcome(problem, sorted(fits, key=lambda done: done.cost), model_error)


def fit(problem: PathProblem, guess: dict[str, float], motor: bool = False) -> list[Any]:
    """Return the least squares from a guess, with a few initial phases; empty if none works.

    `motor`: the guess holds the motor's frequency, not that of the wobble.
    """
    own = problem.swimmer.numbers
    first = np.array([guess.get(u.name, u.value(own)) for u in problem.unknowns], dtype=float)
    if problem.wobbles and motor:
        i = problem.names.index(FREQUENCY)
        first[i] *= problem.wobble_ratio(first)
    low = _lowest(problem, own)
    bounds = (np.concatenate([low, np.full(1 + problem.pose_size(), -np.inf)]), np.inf)
    best = []
    for z in initial_poses(problem, np.maximum(first, 1.01 * low), count=1 if motor else 2):
        try:
            slope: dict[str, Any] = {"jac": problem.jacobian, "bounds": bounds}
            with np.errstate(invalid="ignore"):  # of a law far out, on the way
                done = least_squares(
                    problem.residuals, z, x_scale=_sizes(problem, z), max_nfev=40, xtol=1e-9,
                    ftol=1e-9, **slope,
                )  # fmt: skip
        except (MicroswimError, np.linalg.LinAlgError, ValueError):
            continue
        best.append(done)
    return [min(best, key=lambda done: done.cost)] if best else []


def _lowest(problem: PathProblem, own: dict[str, float]) -> np.ndarray:
    """Lower bounds: what is positive stays so; a rate and a coupling may have either sign."""
    free = (FREQUENCY, "coupling")
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


def outcome(problem: PathProblem, fits: list[Any], model_error: bool) -> Identification:
    """Return everything there is to say about the best fit."""
    best = fits[0]
    n, m = len(problem.unknowns), best.fun.size
    degrees = m - best.x.size
    spread = np.sqrt(2.0 * best.cost / max(degrees, 1)) if problem.sigma is None else 1.0
    J = problem.jacobian(best.x) / spread
    nuisance = np.linalg.qr(J[:, n:])[0]
    own = (J[:, :n] - nuisance @ (nuisance.T @ J[:, :n])) @ problem.slope(best.x)
    values = problem.physical(best.x)
    directions, covariance = determined(own, values, problem.names)
    covariance = _without_vague(covariance, problem.typical)
    others = [f for f in fits[1:] if 2.0 * (f.cost - best.cost) < 9.0 * spread**2]
    distinct = distinct_from(values, [problem.physical(f.x) for f in others], covariance)
    path = problem.place(problem.body_path(best.x[:n], best.x[n])[0], best.x[n + 1 :])
    misfit = None if problem.sigma is None else 2.0 * best.cost / degrees
    said = remarks(problem.names, directions, covariance, distinct, misfit)
    withheld = left_over(problem, path) or branches(problem, distinct)
    if model_error and not withheld:
        covariance, more = _with_model(problem, best.x, own, nuisance, spread, covariance)
        said += more
    blind = ~np.isfinite(np.diag(covariance))
    values = np.where(blind, [u.value(problem.swimmer.numbers) for u in problem.unknowns], values)
    found = lift(problem.swimmer, problem.unknowns, [float(v) for v in values]).with_({})
    return Identification(
        swimmer=found,
        names=problem.names,
        values=values,
        covariance=covariance,
        residual=float(np.sqrt(np.mean((path - problem.track.position) ** 2))),
        degrees=degrees,
        directions=directions,
        warnings=said if not withheld else (*said, withheld),
        path=path,
        alternatives=tuple(sorted(distinct, key=partial(_away, problem))),
        withheld=withheld,
        model=problem.own_model,
    )


def _without_vague(covariance: np.ndarray, typical: np.ndarray) -> np.ndarray:
    """Infinite where a value is known to no better than a hundred times its size."""
    vague = np.diag(covariance) > (100.0 * typical) ** 2
    out = covariance.copy()
    out[vague, :] = out[:, vague] = 0.0
    out[vague, vague] = np.inf
    return out


def _away(problem: PathProblem, values: np.ndarray) -> float:
    """How far a design lies from the spec's own, in logarithms where both are positive."""
    share = values / [u.value(problem.swimmer.numbers) or 1.0 for u in problem.unknowns]
    return float(np.sum(np.log(np.maximum(share, 1e-9)) ** 2))


def branches(problem: PathProblem, distinct: tuple[np.ndarray, ...]) -> str:
    """Return why one interval would be a choice among designs, or nothing."""
    if distinct:
        return "several designs fit alike: no interval is given for one of them alone"
    shape = set(problem.names) >= {AMPLITUDE, WAVES, FREQUENCY}
    if shape and problem.swimmer.tail.is_rigid and problem.track.quaternion is None:
        return (
            "a helical path has three numbers, which several helices share: without the attitude, "
            "or a known number of waves, no interval is given"
        )
    return ""


def _with_model(
    problem: PathProblem, z: np.ndarray, own: np.ndarray, nuisance: np.ndarray, spread: float,
    covariance: np.ndarray,
) -> tuple[np.ndarray, tuple[str, ...]]:  # fmt: skip
    """The covariance with what the model's own error adds, or a remark that it is not known."""
    errors = model_errors(problem.swimmer.gait("auto"))
    if errors is None:
        return covariance, (
            f"the error of model {problem.own_model} is not known for this swimmer: the intervals "
            "hold for noise alone",
        )
    if not np.isfinite(covariance).all():
        return covariance, ()
    added = covariance_of_model(problem, z, own, nuisance, spread, errors)
    largest = np.sqrt(np.max(np.diag(added) / np.diag(covariance)))
    if largest < 1.0:
        return covariance + added, ()
    return covariance + added, (
        f"the error of model {problem.own_model} (up to {errors.max():.2g} of a velocity) is "
        f"{largest:.2g} times the noise in these intervals; a calibration narrows them",
    )
