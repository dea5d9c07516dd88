"""Identify a swimmer from its track [Tabak Sections 4.1, 5]: wave shape and rate by least squares.

The frequency comes from the track's spectrum, first guesses from a grid of designs, then amplitude,
number of waves, frequency (and what else is asked for) are fitted together with the unknown initial
pose and phase.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from microswim import checks
from microswim.calibration.unknowns import resolve
from microswim.errors import MicroswimError
from microswim.numerics.compiling.compiled import settled
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.fitting.descent import apart, cost, fit, least
from microswim.studies.identification.fitting.first_guesses import (
    AMPLITUDE,
    WAVES,
    Designs,
    Grid,
    first_guesses,
)
from microswim.studies.identification.fitting.honesty import check_shown, left_over
from microswim.studies.identification.fitting.outcome import outcome
from microswim.studies.identification.fitting.problem import CURVATURE, FREQUENCY, PathProblem
from microswim.studies.identification.result import Identification
from microswim.swimmer.swimmer import Swimmer

SHAPE = (AMPLITUDE, WAVES, FREQUENCY)
ATTITUDE = 0.02  #: rad, noise of an attitude that nobody tells
ROUNDS = 4  #: of looking beside the best fit, while there are better ones
FAR = 30.0  #: times the cost of the best, beyond which a fit is not followed


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
    swimmer, names = asked(swimmer, unknowns)
    grid = None if start is not None else Grid.of(swimmer, names)
    how = {"sigma": sigma, "sigma_attitude": sigma_attitude, "start": start, "starts": starts}
    return identified(
        swimmer, track, names, grid, model_error=model_error, progress=progress, **how
    )


def asked(swimmer: Swimmer, unknowns: Iterable[str]) -> tuple[Swimmer, tuple[str, ...]]:
    """Return the swimmer with its wave said as the unknowns ask for it, and their names.

    Raises
    ------
    SpecError
        If an unknown does not exist.
    """
    names = tuple(unknowns)
    if WAVES in names and WAVES not in swimmer.numbers and "tail.wavelength" in swimmer.numbers:
        swimmer = swimmer.with_({WAVES: float(swimmer.tail.number_of_waves)})
    if (
        CURVATURE in names
        and CURVATURE not in swimmer.numbers
        and hasattr(swimmer.tail, "mean_curvature")
    ):
        swimmer = swimmer.with_({CURVATURE: 0.0})
    resolve(swimmer, names)
    return swimmer, names


def identified(
    swimmer: Swimmer,
    track: Track,
    names: tuple[str, ...],
    grid: Grid | None,
    *,
    sigma: float | None = None,
    sigma_attitude: float | None = None,
    start: dict[str, float] | None = None,
    starts: int = 8,
    model_error: bool = True,
    progress: Callable[[int, int], None] | None = None,
) -> Identification:
    """Return what `identify_swimmer` does, the grid of designs given: it is that of all tracks."""
    chosen = resolve(swimmer, names)
    problem = PathProblem(swimmer, track, chosen, sigma_attitude or ATTITUDE, sigma)
    check_shown(problem, SHAPE)
    designs = None if grid is None else Designs(problem, grid)
    fits = _followed(problem, designs, start, starts, progress)
    if not fits:
        raise MicroswimError(
            "no first guess led to a path like the track: no design of this spec that was tried "
            "swims and wobbles as the track does, or has a gait at all; give start values, or "
            "another spec"
        )
    fits.sort(key=cost)
    if problem.weighs:
        problem, fits = weighed_anew(problem, fits, sigma, sigma_attitude, model_error)
    return outcome(problem, fits, model_error, grid)


def _followed(
    problem: PathProblem, designs: Designs | None, start: dict[str, float] | None, starts: int,
    progress: Callable[[int, int], None] | None,
) -> list[Any]:  # fmt: skip
    """Fits from the start, or from a grid of designs until one holds, then from those beside it."""
    if start is not None:
        return fit(problem, start, motor=True, phases=1)
    guesses, fits = first_guesses(problem, designs, starts), []
    for i, guess in enumerate(guesses):
        fits += fit(problem, guess)
        if progress is not None:
            progress(i + 1, len(guesses))
        if fits and not left_over(problem, min(fits, key=cost).fun):
            break
    if designs is None or not fits:
        return fits
    n = len(problem.unknowns)
    for _ in range(ROUNDS):
        best = min(fits, key=cost)
        found = dict(zip(problem.names, map(float, best.x[:n])))
        found.setdefault(FREQUENCY, problem.swimmer.tail.frequency)
        for guess in designs.beside(found):
            fits += fit(problem, guess, phases=1)
        if _alike(best, min(fits, key=cost)):
            break
    return fits


def _alike(one: Any, better: Any) -> bool:
    """Whether a fit that is better is so by chance: what the first was like, it is like."""
    return one.cost - better.cost < better.cost / better.fun.size


def weighed_anew(
    problem: PathProblem, fits: list[Any], sigma: float | None, sigma_attitude: float | None,
    model_error: bool,
) -> tuple[PathProblem, list[Any]]:  # fmt: skip
    """Return the problem with the noise that the best fit leaves, and its fits.

    Positions and attitudes have noises of their own; what is not given is what was left over. Fits
    that are far off are followed where the model itself may be off.
    """
    left, count = fits[0].fun, problem.track.position.size
    free = np.sqrt(left.size / max(left.size - fits[0].x.size, 1))
    size = [float(np.sqrt(np.mean(part**2))) * free for part in (left[:count], left[count:])]
    noise = problem.scale * size[0] if sigma is None else sigma
    turn = problem.sigma_attitude * size[1] if sigma_attitude is None else sigma_attitude
    if not (noise > 0 and turn > 0):
        return problem, fits
    known = replace(problem, sigma=noise, sigma_attitude=turn)
    near = [done for done in fits if done.cost < FAR * fits[0].cost]
    again = [least(known, done.x) for done in (apart(known, fits) if model_error else near)]
    return known, sorted((done for done in again if done), key=cost)
