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
from microswim.studies.identification.problem import FREQUENCY, PathProblem
from microswim.studies.identification.result import Identification, distinct_from, remarks
from microswim.studies.identification.track import Track
from microswim.swimmer.swimmer import Swimmer

SHAPE = (AMPLITUDE, WAVES, FREQUENCY)
LOW = {AMPLITUDE: 1e-9, WAVES: 0.3}


@checks.given(
    swimmer=checks.swimmer,
    track=partial(checks.instance, kind="Track"),
    unknowns=checks.words,
    sigma=checks.above_zero("length"),
    sigma_attitude=checks.above_zero("angle (rad)"),
    start=checks.mapping,
    starts=checks.at_least(1),
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
    progress
        Called with the number of fits done and in all.

    Returns
    -------
    Identification

    Raises
    ------
    SpecError
        If an unknown does not exist or the track is too short.
    MicroswimError
        If no fit converges.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> t = np.linspace(0, 12, 240)
    >>> track = ms.Track(time=t, position=ms.trajectory(swimmer.gait(), t).position.values)
    >>> guess = {"tail.amplitude": 0.11, "tail.waves": 2.9, "tail.frequency": 1.0}
    >>> found = ms.identify_swimmer(swimmer, track, start=guess)
    >>> [round(float(v), 3) for v in found.values]
    [0.1, 3.0, 1.0]
    """
    chosen = resolve(swimmer, unknowns)
    problem = PathProblem(swimmer, track, chosen, sigma_attitude or 0.02, sigma)
    guesses = [start] if start is not None else first_guesses(problem, starts)
    fits = []
    for i, guess in enumerate(guesses):
        fits += fit(problem, guess, motor=start is not None)
        if progress is not None:
            progress(i + 1, len(guesses))
    if not fits:
        raise MicroswimError("no first guess led to a path like the track; give start values")
    return outcome(problem, sorted(fits, key=lambda done: done.cost))


def fit(problem: PathProblem, guess: dict[str, float], motor: bool = False) -> list[Any]:
    """Least squares from a guess, with a few initial phases; empty if none works.

    `motor`: the guess holds the motor's frequency, not that of the wobble.
    """
    own = problem.swimmer.numbers
    first = np.array([guess.get(u.name, u.value(own)) for u in problem.unknowns], dtype=float)
    if problem.wobbles and motor:
        i = problem.names.index(FREQUENCY)
        first[i] *= problem.wobble_ratio(first)
    low = np.array([LOW.get(u.name, -np.inf) for u in problem.unknowns])
    bounds = (np.concatenate([low, np.full(1 + problem.pose_size(), -np.inf)]), np.inf)
    best = []
    for z in initial_poses(problem, np.maximum(first, 1.01 * low), count=1 if motor else 2):
        try:
            slope: dict[str, Any] = {"jac": problem.jacobian, "bounds": bounds}
            done = least_squares(
                problem.residuals, z, x_scale=_sizes(problem, z), max_nfev=40, xtol=1e-9, ftol=1e-9,
                **slope,
            )  # fmt: skip
        except (MicroswimError, np.linalg.LinAlgError, ValueError):
            continue
        best.append(done)
    return [min(best, key=lambda done: done.cost)] if best else []


def _sizes(problem: PathProblem, z: np.ndarray) -> np.ndarray:
    """Typical steps: a tenth of a value; of the frequency a fraction of a cycle."""
    sizes = np.concatenate(
        [0.1 * np.maximum(np.abs(z[: len(problem.unknowns)]), 1e-2), np.ones(len(z))]
    )
    sizes = sizes[: len(z)]
    for i, name in enumerate(problem.names):
        if name == FREQUENCY:
            sizes[i] = 0.2 / problem.track.duration
    d = problem.track.dimensions
    sizes[-d:] = np.maximum(np.ptp(problem.track.position, axis=0) * 0.1, 1e-9)
    return sizes


def outcome(problem: PathProblem, fits: list[Any]) -> Identification:
    """Everything there is to say about the best fit."""
    best = fits[0]
    n, m = len(problem.unknowns), best.fun.size
    degrees = m - best.x.size
    spread = np.sqrt(2.0 * best.cost / max(degrees, 1)) if problem.sigma is None else 1.0
    J = problem.jacobian(best.x) / spread
    nuisance = np.linalg.qr(J[:, n:])[0]
    own = (J[:, :n] - nuisance @ (nuisance.T @ J[:, :n])) @ problem.slope(best.x)
    values = problem.physical(best.x)
    directions, covariance = determined(own, values, problem.names)
    others = [f for f in fits[1:] if 2.0 * (f.cost - best.cost) < 9.0 * spread**2]
    distinct = distinct_from(values, [problem.physical(f.x) for f in others], covariance)
    path = problem.place(problem.body_path(best.x[:n], best.x[n])[0], best.x[n + 1 :])
    misfit = None if problem.sigma is None else 2.0 * best.cost / degrees
    found = lift(problem.swimmer, problem.unknowns, [float(v) for v in values]).with_({})
    residual = float(np.sqrt(np.mean((path - problem.track.position) ** 2)))
    return Identification(
        swimmer=found,
        names=problem.names,
        values=values,
        covariance=covariance,
        residual=residual,
        degrees=degrees,
        directions=directions,
        warnings=remarks(problem.names, directions, covariance, distinct, misfit),
        path=path,
        alternatives=distinct,
    )
