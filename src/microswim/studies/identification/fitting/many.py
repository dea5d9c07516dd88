"""The swimmers of many tracks: the grid of designs worked out once, the fits side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.jobs.processes import answers_by_name, counted
from microswim.numerics.compiling.compiled import settled
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.fitting.first_guesses import Grid
from microswim.studies.identification.fitting.fit import SHAPE, asked, identified
from microswim.studies.identification.result import Identification
from microswim.swimmer.swimmer import Swimmer

FEWEST = 4  #: tracks for which other processes are started


@checks.given(
    swimmer=checks.swimmer,
    tracks=partial(checks.mapping, allowed="tracks by name, {...}"),
    unknowns=checks.words,
    sigma=checks.above_zero("length"),
    sigma_attitude=checks.above_zero("angle (rad)"),
    start=checks.mapping,
    starts=checks.at_least(1),
    model_error=checks.truth,
    progress=checks.function,
)
def identify_swimmers(
    swimmer: Swimmer,
    tracks: Mapping[str, Track],
    unknowns: Iterable[str] = SHAPE,
    *,
    sigma: float | None = None,
    sigma_attitude: float | None = None,
    start: dict[str, float] | None = None,
    starts: int = 8,
    model_error: bool = True,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Identification | MicroswimError]:
    """Find the swimmer of each of many tracks, on all cores.

    Parameters
    ----------
    swimmer
        What is known of all of them.
    tracks
        By name, such as `read_tracks` returns.
    unknowns, sigma, sigma_attitude, start, starts, model_error
        As for `identify_swimmer`.
    workers
        Processes: all cores by default, 0 for this one alone. Fewer than four tracks are fitted
        here.
    progress
        Called with the number of tracks done and in all.

    Returns
    -------
    dict
        What `identify_swimmer` returns, or the error that it raises of a track, by name.

    Raises
    ------
    SpecError
        If an unknown does not exist or an option makes no sense.
    MachineError
        If worker processes cannot start or die.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> t = np.linspace(0, 6, 90)
    >>> track = ms.Track(time=t, position=ms.trajectory(swimmer.gait(), t).position.values)
    >>> found = ms.identify_swimmers(swimmer, {"one": track}, ["tail.amplitude"], start={})
    >>> round(float(found["one"].values[0]), 6)
    0.1
    """
    many = counted(workers)
    for name, track in tracks.items():
        checks.instance(f"tracks {name}", track, "Track")
    swimmer, names = asked(swimmer, unknowns)
    grid = None if start is not None else Grid.of(swimmer, names)
    how = {"sigma": sigma, "sigma_attitude": sigma_attitude, "start": start, "starts": starts}
    call = partial(_one, swimmer, names, grid, how | {"model_error": model_error})
    jobs = {f"track {name}": (track,) for name, track in tracks.items()}
    found = answers_by_name(call, jobs, many if len(jobs) >= FEWEST else 0, progress)
    return dict(zip(tracks, found.values(), strict=True))


@settled(True)  # thousands of gaits, one by one
def _one(
    swimmer: Swimmer, names: tuple[str, ...], grid: Grid | None, options: dict[str, Any],
    track: Track,
) -> Identification | MicroswimError:  # fmt: skip
    try:
        return identified(swimmer, track, names, grid, **options)
    except MicroswimError as error:
        if isinstance(error, SpecError) and not str(error.field).startswith("track"):
            raise
        return error
