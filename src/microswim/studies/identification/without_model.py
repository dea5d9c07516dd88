"""What a track holds without any model of the swimmer, and what it cannot hold.

The words of computer-assisted sperm analysis: curvilinear velocity (from frame to frame), straight
line velocity (from first to last), the speed along the averaged path, linearity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.studies.identification.average_path import AveragePath, Estimate, mean_error
from microswim.studies.identification.displacement import (
    mean_squared_displacement,
    persistence_time,
    turning_rate,
)
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.loops import Loops, loops_of
from microswim.studies.identification.spectrum import Line
from microswim.studies.identification.wobble import is_round, wobble_and_path

#: What is computed, and what it measures.
NUMBERS = {
    "speed": "speed",
    "curvilinear_velocity": "speed",
    "straight_line_velocity": "speed",
    "linearity": "number",
    "turning_rate": "rate",
    "loop_radius": "length",
    "drift": "speed",
    "persistence_time": "time",
    "effective_diffusion": "diffusion",
    "wobble_frequency": "frequency",
    "wobble_amplitude": "length",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class TrackNumbers:
    """What the track of one cell holds.

    Parameters
    ----------
    name
        As the file calls it.
    numbers
        Name to estimate, see `NUMBERS`; what the track does not hold is None.
    noise
        Standard deviation of the noise of a coordinate, from the top of the spectrum.
    lag, displacement
        Mean squared displacement with its interval, (k,) and (k, 3).
    path
        Positions without the wobble.
    notes
        What the track cannot hold, a sentence each.
    positions, duration, frame_rate
        Of the track.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> t = np.linspace(0, 8, 400)
    >>> x = np.stack([3 * t, 0.2 * np.sin(2 * np.pi * 4 * t)], -1)
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=x.shape)
    >>> cell = ms.describe_track(ms.Track(time=t, position=x + noise))
    >>> round(cell.numbers["speed"].value, 2), round(cell.numbers["wobble_frequency"].value, 2)
    (3.0, 4.0)
    """

    name: str
    numbers: dict[str, Estimate | None]
    noise: float
    lag: np.ndarray
    displacement: np.ndarray
    path: np.ndarray
    notes: tuple[str, ...]
    positions: int
    duration: float
    frame_rate: float

    def as_dict(self) -> dict[str, Any]:
        """Return what there is to store: values, 95 % intervals, what cannot be known."""
        found: dict[str, Any] = {"track": self.name, "positions": self.positions}
        found |= {"duration": self.duration, "frame_rate": self.frame_rate, "noise": self.noise}
        found |= {name: e and e.value for name, e in self.numbers.items()}
        found["interval_95"] = {n: e and [e.low, e.high] for n, e in self.numbers.items()}
        found["mean_squared_displacement"] = {
            "lag": self.lag, "value": self.displacement[:, 0], "low": self.displacement[:, 1],
            "high": self.displacement[:, 2],
        }  # fmt: skip
        found["notes"] = list(self.notes)
        return found


def describe_track(track: Track, name: str = "") -> TrackNumbers:
    """Return what a track holds without a model: speeds, turning, wobble, displacement.

    Parameters
    ----------
    track
        Positions of a cell, 2-D or 3-D.
    name
        What the cell is called.

    Returns
    -------
    TrackNumbers

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> t = np.linspace(0, 4, 100)
    >>> still = 0.05 * np.random.default_rng(3).normal(size=(100, 2))
    >>> found = ms.describe_track(ms.Track(time=t, position=still))
    >>> found.numbers["wobble_frequency"] is None, found.notes[0]
    (True, 'it does not swim: no speed stands above the noise')
    """
    t, x = track.time, track.position
    seen, path = wobble_and_path(track)
    lag, displacement = mean_squared_displacement(t, x)
    numbers = _velocities(t, x, path, seen) | _wobble(seen)
    numbers |= _turning(path, numbers, lag, displacement)
    loops = loops_of(path)
    if loops is not None:
        numbers |= {"loop_radius": loops.radius, "drift": loops.drift}
    rate = 1.0 / float(np.median(np.diff(t)))
    return TrackNumbers(
        name=name,
        numbers={key: numbers.get(key) for key in NUMBERS},
        noise=seen.noise,
        lag=lag,
        displacement=displacement,
        path=path.position,
        notes=(*_notes(t, x, path, seen, numbers), *_both_ways(x, seen, loops, numbers)),
        positions=t.size,
        duration=float(t[-1] - t[0]),
        frame_rate=rate,
    )


def _velocities(
    t: np.ndarray, x: np.ndarray, path: AveragePath, seen: Line
) -> dict[str, Estimate | None]:
    T, steps = float(t[-1] - t[0]), np.linalg.norm(np.diff(x, axis=0), axis=1)
    beat = 1 if not seen.stands_out else max(int(t.size / (seen.frequency * T)), 1)
    curvilinear = Estimate.around(
        steps.sum() / T, mean_error(steps / np.diff(t), max(2 * beat, 10))
    )
    straight = Estimate.around(
        float(np.linalg.norm(x[-1] - x[0])) / T, 1.96 * np.sqrt(2.0) * seen.noise / T
    )
    linearity = straight.value / curvilinear.value if curvilinear.value > 0 else np.nan
    parts = [(e.high - e.low) / 2.0 / e.value for e in (straight, curvilinear) if e.value > 0]
    return {
        "speed": path.speed() if path.swims else None,
        "curvilinear_velocity": curvilinear,
        "straight_line_velocity": straight,
        "linearity": Estimate.around(linearity, linearity * float(np.linalg.norm(parts)))
        if len(parts) == 2 else None,
    }  # fmt: skip


def _turning(
    path: AveragePath, numbers: dict[str, Any], lag: np.ndarray, displacement: np.ndarray
) -> dict[str, Estimate | None]:
    """Turning and persistence of the heading; what forgets it within a window has no speed."""
    v, narrow, d = numbers["speed"], path.narrower(), path.mean.shape[1]
    if v is None or narrow is None or v.value < 3.0 * narrow.noise:
        return {}
    tau = persistence_time(narrow)
    if tau is not None and tau.value < narrow.spacing:
        known = np.flatnonzero(np.isfinite(displacement).all(axis=1))
        spread = displacement[known[-1]] / (2.0 * d * lag[known[-1]])
        return {"speed": None, "effective_diffusion": Estimate(*map(float, spread))}
    found: dict[str, Estimate | None] = {"turning_rate": turning_rate(narrow)}
    if tau is None or not np.isfinite(tau.value) or tau.value > path.time[-1] - path.time[0]:
        return found
    D = [v.value**2 * tau.value / d, v.low**2 * tau.low / d, v.high**2 * tau.high / d]
    return found | {"persistence_time": tau, "effective_diffusion": Estimate(*D)}


def _wobble(seen: Line) -> dict[str, Estimate | None]:
    if not seen.stands_out:
        return {}
    return {
        "wobble_frequency": Estimate.around(seen.frequency, 1.96 * seen.frequency_error),
        "wobble_amplitude": Estimate.around(seen.amplitude, 1.96 * seen.amplitude_error),
    }


def _notes(
    t: np.ndarray, x: np.ndarray, path: AveragePath, seen: Line, numbers: dict[str, Any]
) -> tuple[str, ...]:
    """What the track cannot hold, and what noise does to the rest."""
    notes = []
    if not path.swims:
        notes.append("it does not swim: no speed stands above the noise")
    elif numbers["speed"] is None:
        notes.append("it diffuses: its heading is forgotten from one step that is seen to the next")
    elif "turning_rate" not in numbers:
        notes.append("its heading is lost in the noise, or the track is too short to see it turn")
    elif "persistence_time" not in numbers:
        notes.append("its heading persists for longer than the track, which tells no more of it")
    if not seen.stands_out:
        notes.append("no wobble stands above the noise: wave shape and rate are not in this track")
    moved = float(np.mean(np.sum(np.diff(x, axis=0) ** 2, axis=1)))
    share = 2.0 * x.shape[1] * seen.noise**2 / moved if moved > 0 else 0.0
    if share > 0.2:
        notes.append(
            f"noise makes {min(share, 1.0):.0%} of the squared steps from frame to frame: the "
            "curvilinear velocity is too large and the linearity too small"
        )
    frame = float(np.median(np.diff(t)))
    lost = 1.0 - t.size / ((t[-1] - t[0]) / frame + 1.0)
    if lost > 0.02:
        notes.append(f"{lost:.0%} of its frames are missing")
    return tuple(notes)


def _both_ways(
    x: np.ndarray, seen: Line, loops: Loops | None, numbers: dict[str, Any]
) -> list[str]:
    """What two coordinates do not tell of a circle: whether it is the path or the wobble."""
    if x.shape[1] != 2:
        return []
    said, speed = [], numbers["speed"]
    if loops is not None:
        moves = " whose centre moves at drift" if loops.drifts else ""
        swims = ", which swims in the image at drift," if loops.drifts else ""
        said.append(
            f"its path runs in loops{moves}, told as a cell that circles; in two coordinates a "
            f"helix seen along its axis{swims} looks the same"
        )
    if seen.stands_out and is_round(seen):
        around = 2.0 * np.pi * seen.frequency * seen.amplitude / np.sqrt(2.0)
        times = f", at {around / speed.value:.2g} times speed," if speed is not None else ""
        said.append(
            "its wobble is a circle, told as a helix seen along its axis; in two coordinates a "
            f"cell that swims in such circles{times} and drifts looks the same"
        )
    return said
