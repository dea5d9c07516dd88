"""What the tracks of many cells hold, worked out side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from microswim import checks
from microswim.jobs.processes import answers_by_name, counted
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.without_model import TrackNumbers, describe_track

FEWEST = 100_000  #: positions in all for which other processes are started: some two seconds


@checks.given(
    tracks=partial(checks.mapping, allowed="tracks by name, {...}"), progress=checks.function
)
def describe_tracks(
    tracks: Mapping[str, Track],
    *,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, TrackNumbers]:
    """Return what each of many tracks holds without a model, on all cores.

    Parameters
    ----------
    tracks
        By name, such as `read_tracks` returns.
    workers
        Processes: all cores by default, 0 for this one alone. Fewer than 100,000 positions in all
        are worked out here.
    progress
        Called with the number of tracks done and in all.

    Returns
    -------
    dict
        What `describe_track` returns, by name.

    Raises
    ------
    MachineError
        If worker processes cannot start or die.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> t = np.linspace(0, 4, 100)
    >>> noise = 0.05 * np.random.default_rng(3).normal(size=(100, 2))
    >>> there = ms.Track(time=t, position=np.stack([3 * t, 0 * t], -1) + noise)
    >>> found = ms.describe_tracks({"still": ms.Track(time=t, position=noise), "there": there})
    >>> {name: cell.numbers["speed"] is not None for name, cell in found.items()}
    {'still': False, 'there': True}
    """
    many = counted(workers)
    for name, track in tracks.items():
        checks.instance(f"tracks {name}", track, "Track")
    jobs = {f"track {name}": (track, name) for name, track in tracks.items()}
    long = sum(track.time.size for track in tracks.values()) >= FEWEST and len(jobs) > 1
    found = answers_by_name(describe_track, jobs, many if long else 0, progress)
    return dict(zip(tracks, found.values(), strict=True))
