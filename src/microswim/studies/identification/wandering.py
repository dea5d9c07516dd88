"""How cells wander: persistence and diffusion of one track or of many, and the third coordinate.

The velocity of a cell that forgets its heading has ``<v(0) v(t)> = v^2 exp(-t / tau)``. Each
coordinate has its share of it, so in a film of cells that head everywhere in space tau and
``D = v^2 tau / 3`` are those of space, and the speed is ``sqrt(3/2)`` times the root mean square
that is seen. A helix that is inclined to the image swings along its path too, by ``sin(theta)`` of
what it swings across it, a quarter of a turn apart: that tells theta, and its advance is
``1 / cos(theta)`` times the one seen [Gurarie et al. 2011]. A cell that does not
swim diffuses: ``D = <dx^2> / 2 dt + <dx dx'> / dt`` of neighbouring steps, in which the noise of
the positions cancels [Vestergaard et al. 2014].
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit

from microswim import checks
from microswim.errors import SpecError
from microswim.studies.identification.average_path import AveragePath, Estimate
from microswim.studies.identification.displacement import persistence_time
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.spectrum import Line, line
from microswim.studies.identification.wobble import wobble_and_path

#: What is computed, and what it measures.
WANDERING = {
    "persistence_time": "time",
    "effective_diffusion": "diffusion",
    "rotational_diffusion": "rate",
    "speed_in_space": "speed",
    "inclination": "angle",
    "diffusion": "diffusion",
}
FEWEST = 8  #: cells, or pieces of a track, from which an interval comes
FEWEST_POSITIONS = 24
BINS = 64  #: lags
DRAWS = 200
FORGOTTEN = 0.3  #: of the correlation, below which it is left out
QUARTER = 0.35  #: largest cosine of the phase between the swings of a helix


@checks.given(seed=checks.at_least(0))
def wandering(tracks: Sequence[Track], *, seed: int = 0) -> dict[str, Estimate | None]:
    """Return how the cells of some tracks wander, taken for cells of one kind.

    Parameters
    ----------
    tracks
        Of one cell, or of many that are alike.
    seed
        Of the draws of cells (of pieces of a single track) from which the intervals come.

    Returns
    -------
    dict
        ``persistence_time``, ``effective_diffusion``, ``rotational_diffusion``,
        ``speed_in_space``, ``inclination`` and ``diffusion``: estimates with their 95 % intervals,
        None for what the tracks do not tell. Two coordinates are taken for the projection of
        cells that head everywhere in space.

    Raises
    ------
    SpecError
        If `tracks` is no list of tracks.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> steps = np.random.default_rng(0).normal(size=(2000, 2))
    >>> still = ms.Track(time=np.arange(2000.0), position=np.cumsum(steps, axis=0))
    >>> found = ms.wandering([still])
    >>> round(found["diffusion"].value, 1), found["persistence_time"]
    (0.5, None)
    """
    tracks = [tracks] if isinstance(tracks, Track) else tracks
    if not isinstance(tracks, (list, tuple)) or not all(isinstance(t, Track) for t in tracks):
        raise SpecError("tracks", tracks, "a list of tracks, such as those of read_tracks")
    found: dict[str, Estimate | None] = dict.fromkeys(WANDERING)
    if not tracks:
        return found
    seen = [(track, *wobble_and_path(track)) for track in tracks]
    moving = [one for one in seen if _swims(one[2])]
    swims = [pair for pair in (_velocities(path) for _, _, path in moving) if pair is not None]
    if swims:
        found |= _persistence(swims, seed)
    if len(tracks) == 1 and tracks[0].dimensions == 2 and moving:
        found |= _inclined(*moving[0])
    if not moving:
        found["diffusion"] = _diffusion(tracks)
    return found


def _swims(path: AveragePath) -> bool:
    """Whether its heading lasts from one velocity that is seen to the next."""
    narrow = path.narrower()
    if not path.swims or narrow is None:
        return path.swims
    tau = persistence_time(narrow)
    return tau is None or tau.value > narrow.spacing


def _velocities(path: AveragePath) -> tuple[np.ndarray, float, float] | None:
    """Velocities that are independent, their spacing and the noise of a coordinate."""
    narrow = path.narrower()
    if narrow is None or len(narrow.independent) < 3:
        return None
    return narrow.independent, narrow.spacing, narrow.noise


def _sums(v: np.ndarray, step: float, noise: float, width: float) -> np.ndarray:
    """Sums of ``v(0) v(t)`` and numbers of pairs, by lag in steps of a width; (2, BINS).

    In a plane complex, ``conj z(0) z(t)``, so that a steady turn is told from forgetting. The
    first is at lag zero, its noise taken off.
    """
    out = np.zeros((2, BINS), dtype=complex)
    out[:, 0] = np.sum(v**2) - v.size * noise**2, len(v)
    flat = v.shape[1] == 2
    z = v[:, 0] + 1j * v[:, 1] if flat else v
    for lag in range(1, len(v)):
        k = round(lag * step / width)
        if k >= BINS:
            break
        pairs = z[lag:] * z[:-lag].conj()
        out[0, k] += pairs.sum()
        out[1, k] += len(v) - lag
    return out


def _fitted(sums: np.ndarray, width: float) -> tuple[float, float]:
    """Mean square of the velocity and rate of forgetting, by least squares in the correlations."""
    number = sums[1].real
    known = number > 0
    t, n = width * np.flatnonzero(known), number[known]
    c = np.abs(sums[0][known] / n)
    lost = np.flatnonzero(c < FORGOTTEN * c[0])
    upto = lost[0] if lost.size else len(c)
    t, n, c = t[:upto], n[:upto], c[:upto]
    if len(t) < 2 or c[0] <= 0:
        return max(float(c[0]), 0.0), 0.0

    def off(p: np.ndarray) -> np.ndarray:
        return np.sqrt(n) * (p[0] * np.exp(-p[1] * t) - c) / c[0]

    start = [float(c[0]), max(float(np.log(c[0] / c[-1]) / t[-1]), 1e-3 / t[-1])]
    done = least_squares(off, start, x_scale=start)
    return float(done.x[0]), float(max(done.x[1], 0.0))


def _persistence(swims: list[Any], seed: int) -> dict[str, Estimate | None]:
    """Persistence, diffusion and speed in space; intervals by drawing cells, or pieces, again."""
    d, width = swims[0][0].shape[1], float(np.median([step for _, step, _ in swims]))
    whole = np.array([_sums(v, step, noise, width) for v, step, noise in swims])
    parts, many = whole, len(swims) >= FEWEST
    if not many:
        parts = np.array([
            _sums(part, step, noise, width)
            for v, step, noise in swims
            for part in np.array_split(v, int(np.clip(len(v) // 6, 1, 16)))
        ])  # fmt: skip
    if len(parts) < FEWEST:
        return {}
    square, rate = _fitted(whole.sum(axis=0), width)
    random, count = np.random.default_rng(seed), len(parts)
    draws = [_fitted(parts[random.integers(count, size=count)].sum(axis=0), width)
             for _ in range(DRAWS)]  # fmt: skip
    longest = max(len(v) * step for v, step, _ in swims)
    floor = 0.1 / longest
    if rate <= floor:
        return {}
    logs = np.log(np.maximum(draws, 1e-300))
    few = stdtrit(count - 1, 0.975) / 1.96 * np.sqrt(count / (count - 1.0))
    share = np.exp(few * (logs - np.median(logs, axis=0)))
    squares, rates = square * share[:, 0], np.maximum(rate * share[:, 1], floor)

    def about(value: float, drawn: np.ndarray) -> Estimate:
        low, high = np.quantile(drawn, (0.025, 0.975))
        return Estimate(value, float(low), float(high))

    found: dict[str, Estimate | None] = {
        "persistence_time": about(1.0 / rate, 1.0 / rates),
        "effective_diffusion": about(square / rate / d, squares / rates / d),
        "rotational_diffusion": about(rate / 2.0, rates / 2.0),
    }
    if many or longest > 10.0 / rate:
        seen = 3.0 / d
        found["speed_in_space"] = about(float(np.sqrt(square * seen)), np.sqrt(squares * seen))
    return found


def _inclined(track: Track, seen: Line, path: AveragePath) -> dict[str, Estimate | None]:
    """Inclination of a helix to the image and its speed, from how it swings along and across."""
    if not seen.stands_out:
        return {}
    t, x = track.time, track.position
    inner = (t >= path.time[0]) & (t <= path.time[-1])
    t, off = t[inner], path.seen_from(t[inner], x[inner], path.heading)
    if t.size < FEWEST_POSITIONS:
        return {}
    angle = 2.0 * np.pi * seen.frequency * t
    basis = np.stack([np.cos(angle), np.sin(angle), np.ones_like(t)], axis=-1)
    c = np.linalg.lstsq(basis, off, rcond=None)[0]
    along, across = (complex(c[0, k], -c[1, k]) for k in (0, 1))
    error = float(np.sqrt(2.0 / t.size)) * line(t, off).noise
    share = abs(along) / max(abs(across), 1e-300)
    if share > 1.0 or abs(along) < 3.0 * error:
        return {}  # swims in the image, or too steeply out of it
    if abs((along * across.conjugate()).real) > QUARTER * abs(along) * abs(across):
        return {}  # no helix: its swings are a quarter of a turn apart
    half = 1.96 * error * np.hypot(1.0, share) / abs(across)
    ends = np.clip([share, share - half, share + half], 0.0, 1.0 - 1e-6)
    theta = np.arcsin(ends)
    speed = path.speed()
    v = np.array([speed.value, speed.low, speed.high]) / np.cos(theta)
    return {
        "inclination": Estimate(*map(float, theta)),
        "speed_in_space": Estimate(*map(float, v)),
    }


def _diffusion(tracks: Sequence[Track]) -> Estimate | None:
    """Coefficient of diffusion, from steps between neighbouring frames; all coordinates alike."""
    values, weights = [], []
    for track in tracks:
        t, x = track.time, track.position
        frame = float(np.median(np.diff(t)))
        whole = np.abs(np.diff(t) - frame) < 0.1 * frame
        both = whole[1:] & whole[:-1]
        dx = np.diff(x, axis=0)
        if both.sum() < FEWEST:
            continue
        one = dx[:-1][both] ** 2 / 2.0 + dx[:-1][both] * dx[1:][both]
        for piece in np.array_split(one / frame, 10):
            if piece.size:
                values += [float(column.mean()) for column in piece.T]
                weights += [len(piece)] * piece.shape[1]
    if len(values) < 3:
        return None
    mean = float(np.average(values, weights=weights))
    error = float(np.std(values, ddof=1) / np.sqrt(len(values)))
    return Estimate(mean, max(mean - 2.0 * error, 0.0), mean + 2.0 * error)
