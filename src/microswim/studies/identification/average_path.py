"""The path without its wobble, and the speed along it, as far as noise lets it be seen.

Positions are averaged over whole periods of the wobble (over nothing where there is none), then
smoothed by local parabolas [Savitzky and Golay 1964], in a frame that turns along where the path
winds; cross-validation, one left out, chooses window and turning. The velocity's own noise follows
from the residuals and is taken off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import chdtri, stdtrit

from microswim.studies.identification import parabolas
from microswim.studies.identification.turning_frame import Averaging, local_fit, rate_of_winding

MOST = 20_000  #: averages of which a path is made
TURNS = 0.8  #: of the error of a parabola, that a turning one must foretell better
WINDOWS = (5, 7, 11, 15, 23, 31, 47, 63, 95, 127, 191, 255, 511, 1023)


ROUNDING = 1e-13  #: of a position, below which it does not move


AS_IT_IS = Averaging()


@dataclass(frozen=True)
class Estimate:
    """A number and its 95 % interval, infinite where it is not known.

    Parameters
    ----------
    value, low, high
        In the units of the track.
    """

    value: float
    low: float
    high: float

    @classmethod
    def around(cls, value: float, half: float) -> Estimate:
        """Return an interval that reaches equally far up and down."""
        return cls(float(value), float(value - half), float(value + half))


@dataclass(frozen=True, eq=False)
class AveragePath:
    """The path without its wobble.

    Parameters
    ----------
    time, mean
        Averages over periods of the wobble, shapes (m,), (m, d).
    position, velocity
        Of the smoothed averages, (m, d).
    noise
        Standard deviation of a coordinate of the velocity.
    window
        Averages in a local parabola: that far apart velocities are independent.
    swims
        Whether the velocities are above their noise (one chance in a thousand).
    winding
        Rate at which the frame of the local parabolas turns.
    averaging
        How the averages were taken.
    """

    time: np.ndarray
    mean: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    noise: float
    window: int
    swims: bool
    winding: float = 0.0
    averaging: Averaging = AS_IT_IS

    @property
    def independent(self) -> np.ndarray:
        """Velocities one window apart, at least two of them."""
        return self.among(self.velocity)

    def among(self, values: np.ndarray) -> np.ndarray:
        """Return those values of the averages that are one window apart."""
        m = len(values)
        step = min(self.window, m - 1)
        return values[(m - 1) % step // 2 :: step]

    @property
    def spacing(self) -> float:
        """Time between two independent velocities."""
        m = len(self.time)
        return float(min(self.window, m - 1) * (self.time[1] - self.time[0]))

    @property
    def heading(self) -> np.ndarray:
        """Angle of the velocity to x, in a plane."""
        return np.unwrap(np.arctan2(self.velocity[:, 1], self.velocity[:, 0]))

    @property
    def turned(self) -> float:
        """Range of the heading (rad)."""
        return float(np.ptp(self.heading))

    def frames(self) -> list[np.ndarray]:
        """Return the angles of axes that turn with the path: with its heading, at a steady rate."""
        rate = rate_of_winding(float(self.time[1] - self.time[0]), self.mean, least=0.0)
        return [self.heading, *([rate * (self.time - self.time[0])] if rate else [])]

    def seen_from(
        self, t: np.ndarray, x: np.ndarray, turn: np.ndarray, off: bool = False
    ) -> np.ndarray:
        """Return positions off the path (or what is off it already) in axes that turn; in a plane.

        Parameters
        ----------
        t, x
            Times and positions.
        turn
            Angles of the axes, at the times of the averages.
        off
            Whether the path is taken off already.
        """
        if not off:
            x = x - CubicSpline(self.time, self.position)(np.clip(t, *self.time[[0, -1]]))
        turned = np.exp(-1j * np.interp(t, self.time, turn)) * (x[:, 0] + 1j * x[:, 1])
        return np.stack([turned.real, turned.imag], axis=-1)

    def narrower(self) -> AveragePath | None:
        """Return the same path with a window that leaves five independent velocities, or None."""
        fits = [w for w in WINDOWS if w <= min(self.window, len(self.mean) // 5)]
        if not fits:
            return None
        return self if fits[-1] == self.window else self._through(fits[-1])

    def _through(self, window: int) -> AveragePath:
        return smoothed(self.time, self.mean, window, self.winding, self.averaging)

    def speed(self) -> Estimate:
        """Return the mean speed along the path, its noise taken off.

        A window w cuts corners as ``w^2``: what half of it says extrapolates to none [Richardson],
        and how far that goes is in the interval.
        """
        size = np.linalg.norm(self.velocity, axis=1)
        value, noise = self._speed(), self.noise
        halves = [w for w in WINDOWS if 2 * w <= self.window + 3]
        if halves:
            half = self._through(halves[-1])
            value += (half._speed() - value) / (1.0 - (halves[-1] / self.window) ** 2)
            noise = half.noise
        few = 2.0 * noise / np.sqrt(max(size.size / self.window, 1.0))
        cut = value - self._speed()
        error = np.linalg.norm([mean_error(size, 2 * self.window), few, cut])
        return Estimate.around(value, float(error))

    def _speed(self) -> float:
        """Noise taken off: ``E|v + e| = v + (d - 1) s^2 / (2 v)`` for small e."""
        raw = float(np.linalg.norm(self.velocity, axis=1).mean())
        return float(np.sqrt(max(raw**2 - (self.velocity.shape[1] - 1) * self.noise**2, 0.0)))


def mean_error(values: np.ndarray, apart: int) -> float:
    """Return half the 95 % interval of a mean of correlated values, by batches [Law and Carson
    1979].

    Parameters
    ----------
    values
        In the order of time, shape (n,).
    apart
        So far apart they are independent. Less than three batches of that length: two are made.
    """
    count = int(np.clip(values.size // max(apart, 1), 3, 30))
    if values.size < 3:
        return 0.0
    ends = values.size * np.arange(count + 1) // count
    means = np.add.reduceat(values, ends[:-1]) / np.diff(ends)
    return float(_quantile(count - 1) * means.std(ddof=1) / np.sqrt(count))


@cache
def _quantile(freedom: int) -> float:
    """Student's t, 97.5 %."""
    return float(stdtrit(freedom, 0.975))


def average_path(t: np.ndarray, x: np.ndarray, period: float | None) -> AveragePath:
    """Return the path without its wobble.

    Parameters
    ----------
    t, x
        Times, increasing, and positions, (n,) and (n, d).
    period
        Of the wobble, None if it has none.
    """
    time, mean, averaging = _averages(t, x, period)
    window, winding = _window(time, mean, averaging)
    if window is None:
        return _straight(time, mean)
    return smoothed(time, mean, window, winding, averaging)


def _straight(time: np.ndarray, mean: np.ndarray) -> AveragePath:
    """A straight line through averages too few for a window."""
    m, d = mean.shape
    centred = time - time.mean()
    v = centred @ mean / (centred @ centred)
    line = mean.mean(axis=0) + centred[:, None] * v
    s2 = float(((mean - line) ** 2).sum() / max(d * (m - 2), 1))
    least = ROUNDING * float(np.abs(mean).max())
    noise = max(float(np.sqrt(s2)), least) / float(np.sqrt(centred @ centred))
    swims = bool(v @ v > noise**2 * chdtri(d, 0.001))
    return AveragePath(time, mean, line, np.tile(v, (m, 1)), noise, m, swims)


def smoothed(
    time: np.ndarray, mean: np.ndarray, window: int, winding: float, averaging: Averaging
) -> AveragePath:
    """Return the path smoothed by parabolas over a window.

    Parameters
    ----------
    time, mean
        Averages, evenly spaced.
    window
        An odd number of them, at least 5.
    winding
        Rate at which the frame of the parabolas turns; 0 in space.
    averaging
        How the averages were taken.
    """
    dt, m = float(time[1] - time[0]), len(mean)
    if winding:
        fit = local_fit(dt, mean, window, winding, averaging)
        smooth, v, off, h, spread = fit.position, fit.velocity, fit.off, fit.hat, fit.spread
    else:
        smooth, v = parabolas.positions_and_velocities(mean, window, dt)
        off, h = (mean - smooth)[window // 2 : m - window // 2], _own(window)
        spread = float(np.sqrt(np.sum(parabolas.weights(window)[1] ** 2))) / dt
    s2 = float(np.mean(off**2) / (1.0 - h))
    noise = max(float(np.sqrt(s2)), ROUNDING * float(np.abs(mean).max())) * spread
    some = v[window // 2 : m - window // 2][::window]
    total = float((some**2).sum())
    swims = total > noise**2 * chdtri(some.size, 0.001) and total > 0
    return AveragePath(time, mean, smooth, v, noise, window, bool(swims), winding, averaging)


def _own(window: int) -> float:
    """Share of an average in its own parabola."""
    return float(parabolas.weights(window)[0, window // 2])


def _averages(
    t: np.ndarray, x: np.ndarray, period: float | None
) -> tuple[np.ndarray, np.ndarray, Averaging]:
    """Means of the path (straight between samples) over whole periods, evenly spaced, and how
    they were taken.
    """
    frame = float(np.median(np.diff(t)))
    T = t[-1] - t[0]
    step = max(period or frame, T / MOST)
    if period is not None:
        step = period * np.ceil(step / period - 1e-9)
    count = max(int((T + (0.0 if period else frame)) / step + 1e-6), 2)
    if period is None and step == frame:
        grid = t[0] + frame * np.arange(count)
        return grid, np.stack([np.interp(grid, t, column) for column in x.T], axis=-1), Averaging()
    step = min(step, T / count)
    ends = t[0] + step * np.arange(count + 1)
    area = np.concatenate(
        [np.zeros((1, x.shape[1])), np.cumsum(np.diff(t)[:, None] * (x[1:] + x[:-1]) / 2.0, axis=0)]
    )
    i = np.clip(np.searchsorted(t, ends, side="right") - 1, 0, t.size - 2)
    part = (ends - t[i])[:, None]
    slope = (x[i + 1] - x[i]) / (t[i + 1] - t[i])[:, None]
    whole = area[i] + part * x[i] + part**2 * slope / 2.0
    taken = Averaging(float(step), frame)
    return (ends[1:] + ends[:-1]) / 2.0, np.diff(whole, axis=0) / step, taken


def _window(time: np.ndarray, x: np.ndarray, averaging: Averaging) -> tuple[int | None, float]:
    """Window and turning whose local fit foretells an average left out best: ``r / (1 - h)`` its
    error. The widest of those that do alike; turning only where it foretells better.
    """
    fits = [w for w in WINDOWS if w <= 0.6 * len(x)]
    if not fits:
        return None, 0.0
    edge, step = fits[-1] // 2, float(time[1] - time[0])
    inner = slice(edge, len(x) - edge)

    def chosen(errors: list[float]) -> tuple[int, float]:
        best = min(errors)
        return max(w for w, e in zip(fits, errors) if e <= 1.02 * best), best

    errors = [float(np.mean((x - parabolas.middle(x, w))[inner] ** 2))
              / (1.0 - _own(w)) ** 2 for w in fits]  # fmt: skip
    window, straight = chosen(errors)
    winding = rate_of_winding(step, x) if x.shape[1] == 2 else 0.0
    if winding == 0.0:
        return window, 0.0
    turned = [local_fit(step, x, w, winding, averaging) for w in fits]
    trims = [edge - w // 2 for w in fits]
    errors = [float(np.mean(f.off[k : len(f.off) - k] ** 2)) / (1.0 - f.hat) ** 2
              for f, k in zip(turned, trims)]  # fmt: skip
    wound, turning = chosen(errors)
    return (wound, winding) if turning < TURNS * straight else (window, 0.0)
