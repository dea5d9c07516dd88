"""Mean squared displacement of a track, and how long its heading persists."""

from __future__ import annotations

import numpy as np

from microswim.studies.identification.average_path import AveragePath, Estimate, mean_error

LAGS = 24
FEWEST_HEADINGS = 12


def mean_squared_displacement(t: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return lags and ``<|x(t + lag) - x(t)|^2>`` with its interval, shapes (k,) and (k, 3).

    Lags are whole frames up to a quarter of the track, some two dozen; frames that are missing are
    left out. The interval is that of batches twice as long as the lag, infinite below three.
    """
    frame = float(np.median(np.diff(t)))
    at = np.round((t - t[0]) / frame).astype(np.int64)
    at, first = np.unique(at, return_index=True)
    grid = np.full((int(at[-1]) + 1, x.shape[1]), np.nan)
    grid[at] = x[first]
    most = max(len(grid) // 4, 1)
    lags = np.unique(np.round(np.geomspace(1, most, LAGS)).astype(int))
    rows = []
    for lag in lags:
        moved = ((grid[lag:] - grid[:-lag]) ** 2).sum(axis=1)
        moved = moved[np.isfinite(moved)]
        if moved.size == 0:
            rows.append((np.nan, -np.inf, np.inf))
            continue
        half = mean_error(moved, 2 * lag) if moved.size >= 6 * lag else np.inf
        rows.append((moved.mean(), max(moved.mean() - half, 0.0), moved.mean() + half))
    return lags * frame, np.array(rows)


def turning_rate(path: AveragePath) -> Estimate:
    """Return the mean rate of turning of the heading: with its sign in 2-D (to the left), without
    in 3-D.
    """
    v, step = path.independent, path.spacing
    size = np.linalg.norm(v, axis=1)
    if v.shape[1] == 2:
        rate = np.diff(path.among(path.heading)) / step
        noise = path.noise / float(size.mean())
        least = 2.0 * np.sqrt(2.0) * noise / (step * rate.size)
        return Estimate.around(float(rate.mean()), float(np.hypot(mean_error(rate, 1), least)))
    u = v / size[:, None]
    between = np.arccos(np.clip((u[1:] * u[:-1]).sum(axis=1), -1.0, 1.0)) ** 2
    noise2 = 4.0 * (path.noise / float(size.mean())) ** 2
    half = mean_error(between, 1)
    ends = np.maximum(np.array([between.mean(), between.mean() - half, between.mean() + half]), 0)
    value, low, high = np.sqrt(np.maximum(ends - noise2, 0.0)) / step
    return Estimate(float(value), float(low), float(high))


def persistence_time(path: AveragePath) -> Estimate | None:
    """Return the time over which the heading is forgotten: ``|<u(0) u(t)>| = exp(-t / tau)``.

    A steady turn of a path in a plane is no forgetting (headings as complex numbers). None for a
    path too short; infinite, with its lower end, for one that does not forget within the track.
    """
    v = path.independent
    if len(v) < FEWEST_HEADINGS:
        return None
    size = np.linalg.norm(v, axis=1)
    u = v / size[:, None]
    value = _forgotten(u, path.spacing)
    parts = [_forgotten(np.delete(u, block, axis=0), path.spacing)
             for block in np.array_split(np.arange(len(u)), 8)]  # fmt: skip
    rates = 1.0 / np.array(parts)
    k = len(rates)
    half = 2.3 * np.sqrt((k - 1) / k * np.sum((rates - rates.mean()) ** 2))  # jackknife, t(7)
    rate = 1.0 / value
    floor = 1.0 / (len(u) * path.spacing)  # what so long a track could hide
    low, high = max(rate - half, 0.0), max(rate + half, floor)
    return Estimate(value, float(1.0 / high), float(1.0 / low) if low > 0 else np.inf)


def _forgotten(u: np.ndarray, step: float) -> float:
    """Time constant from the correlations of the first lags, weighted by their number."""
    most = max(len(u) // 4, 1)
    c = []
    for lag in range(1, most + 1):
        if u.shape[1] == 2:
            z = u[:, 0] + 1j * u[:, 1]
            c.append(float(abs(np.mean(z[lag:] * z[:-lag].conj()))))
        else:
            c.append(float(np.mean((u[lag:] * u[:-lag]).sum(axis=1))))
        if c[-1] < 0.4:
            break
    lags = np.arange(1, len(c) + 1) * step
    fall = -np.log(np.clip(c, 0.05, 1.0))
    rate = float(lags @ fall / (lags @ lags))
    return np.inf if rate <= 0 else 1.0 / rate
