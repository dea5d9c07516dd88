"""The wobble of a track and the path without it, each found beside the other."""

from __future__ import annotations

import numpy as np

from microswim.studies.identification.average_path import AveragePath, average_path
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.spectrum import Line, line

STRAIGHT = 0.3  #: rad, a turn that does not split the line of a wobble
ROUNDS = 3  #: of path and wobble, each without the other
ROUND = 0.5  #: ratio of the axes of an ellipse, above which a wobble may be a circle that is run


def wobble_and_path(track: Track) -> tuple[Line, AveragePath]:
    """Return the wobble, and the path without it; a circle that the path itself runs is no wobble.

    Such a circle is a line of the spectrum too: both coordinates swing alike, a quarter of a turn
    apart, and without it next to nothing is left of the path. In a plane the wobble is looked for
    once more in axes that turn with the path, since turning splits its line in two, a circle each.

    Parameters
    ----------
    track
        Of one cell.
    """
    t, x = track.time, track.position
    seen = line(t, x)
    path = average_path(t, x, 1.0 / seen.frequency if seen.stands_out else None)
    if not seen.stands_out or x.shape[1] != 2:
        return seen, path
    moved = float(np.linalg.norm(path.velocity, axis=1).mean())
    if is_round(seen) and moved < 0.3 * 2.0 * np.pi * seen.frequency * seen.amplitude:
        beat = _half_of_a_beat(t, x, seen, path)
        if beat is not None:
            return beat
        other = line(t, x, above=2.5 * seen.frequency)
        seen, path = other, average_path(t, x, 1.0 / other.frequency if other.stands_out else None)
    return _in_turning_axes(t, x, seen, path) if _turns(seen, path) else (seen, path)


def _turns(seen: Line, path: AveragePath) -> bool:
    """Whether there is a wobble on a path whose heading shows and turns."""
    shows = seen.stands_out and path.swims and path.speed().value > 3.0 * path.noise
    return bool(shows and path.turned >= STRAIGHT)


def _half_of_a_beat(
    t: np.ndarray, x: np.ndarray, seen: Line, path: AveragePath
) -> tuple[Line, AveragePath] | None:
    """Wobble and path, where a circle is half of a beat to and fro in axes that turn; or None."""
    if not _turns(seen, path):
        return None
    found, without = _in_turning_axes(t, x, seen, path)
    return None if is_round(found) or not found.stands_out else (found, without)


def is_round(seen: Line) -> bool:
    """Return whether both coordinates swing alike, a quarter of a turn apart."""
    major, minor = np.linalg.svd(seen.wave, compute_uv=False)
    return bool(minor > ROUND * major)


def _in_turning_axes(
    t: np.ndarray, x: np.ndarray, seen: Line, path: AveragePath
) -> tuple[Line, AveragePath]:
    """Wobble in the axes in which its line is highest; and the path of what it leaves."""
    found, above = seen, 0.5 * seen.frequency
    for _ in range(ROUNDS):
        tried = [(line(t, path.seen_from(t, x, turn), above), turn) for turn in path.frames()]
        again, turn = max(tried, key=lambda pair: pair[0].stands_out * pair[0].amplitude)
        if not again.stands_out:
            break
        straight = x - path.seen_from(t, again.wave, -turn, off=True)
        found, path = again, average_path(t, straight, 1.0 / again.frequency)
    return found, path
