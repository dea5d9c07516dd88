"""The spectrum of a track in ``n log n`` steps: frames that are missing, times that are uneven.

Where all times lie on a grid of frames, with gaps, the least-squares power of a sine [Lomb 1976,
Scargle 1982] follows from fast Fourier transforms of the track and of its window [Press and Rybicki
1989]. Uneven times are taken onto such a grid by linear interpolation where the track is long, and
fitted frequency by frequency where it is short.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import fft
from scipy.optimize import minimize_scalar
from scipy.special import digamma, gammaincc, gammaincinv

FINER = 10  #: frequencies per natural one, 1 / duration
SHORT = 1500  #: samples that are fitted one by one
ON_GRID = 0.02  #: of a frame, that a time may be off the grid


def power(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies and the share of the variance that a sine of each explains.

    Parameters
    ----------
    t
        Times, increasing, shape (n,).
    y
        What is left of the positions, shape (n, d).

    Returns
    -------
    tuple
        From two cycles in the track to half the frame rate, a tenth of a cycle apart.
    """
    frame = float(np.median(np.diff(t)))
    steps = (t - t[0]) / frame
    even = bool((np.abs(steps - np.round(steps)) < ON_GRID).all())
    size = int(fft.next_fast_len(FINER * (round(steps[-1]) + 1), real=True) or 0)
    k = np.arange(int(np.ceil(2.0 * size / steps[-1])), size // 2)
    f = k / (size * frame)
    total = max(float(np.sum((y - y.mean(axis=0)) ** 2)), 1e-300)
    if not even and t.size <= SHORT:
        return f, _one_by_one(t - t.mean(), y, f) / total
    if not even:
        grid = np.arange(int(steps[-1]) + 1)
        y = np.stack([np.interp(grid, steps, column) for column in y.T], axis=-1)
        steps = grid
    return f, _by_transforms(np.round(steps).astype(np.int64), y, k, size) / total


def _one_by_one(t: np.ndarray, y: np.ndarray, f: np.ndarray) -> np.ndarray:
    out = np.zeros(f.size)
    for i, frequency in enumerate(f):
        c, s = np.cos(2 * np.pi * frequency * t), np.sin(2 * np.pi * frequency * t)
        basis = np.stack([c, s, np.ones_like(t)], axis=-1)
        fit = basis @ np.linalg.lstsq(basis, y, rcond=None)[0]
        out[i] = np.sum((fit - fit.mean(axis=0)) ** 2)
    return out


def _by_transforms(frames: np.ndarray, y: np.ndarray, k: np.ndarray, size: int) -> np.ndarray:
    """Power at the frequencies ``k / size`` per frame: normal equations of cos and sin.

    With ``Y = sum y exp(-i w t)`` and ``W = sum exp(-2 i w t)`` the sums over cos^2, sin^2 and
    cos sin are ``(n + Re W) / 2, (n - Re W) / 2, -Im W / 2``.
    """
    n = frames.size
    y = y - y.mean(axis=0)
    held = np.zeros(int(frames[-1]) + 1)
    held[frames] = 1.0
    window: Any = _at(_rfft(held, size), 2 * k, size)
    cc, ss, cs = (n + window.real) / 2.0, (n - window.real) / 2.0, -window.imag / 2.0
    out = np.zeros(k.size)
    for column in y.T:
        held[frames] = column
        Y = _rfft(held, size)[k]
        c, s = Y.real, -Y.imag
        out += (ss * c**2 - 2.0 * cs * c * s + cc * s**2) / np.maximum(cc * ss - cs**2, 1e-12 * n)
    return out


def _rfft(values: np.ndarray, size: int) -> Any:
    transform: Any = fft.rfft
    return transform(values, size)


def _at(transform: np.ndarray, k: np.ndarray, size: int) -> np.ndarray:
    """Transform at indices beyond one half, where it mirrors."""
    mirrored = k > size // 2
    found = transform[np.where(mirrored, size - k, k)]
    return np.where(mirrored, found.conj(), found)


@dataclass(frozen=True, eq=False)
class Line:
    """The line of a spectrum that stands highest above its surroundings.

    Parameters
    ----------
    frequency, amplitude
        Of the wobble: cycles per time, and half of peak to peak, over all coordinates.
    frequency_error, amplitude_error
        Standard uncertainties.
    chance
        Probability that noise alone has a line so high anywhere in the spectrum.
    noise
        Standard deviation of a coordinate's noise from the upper third of the spectrum.
    hidden
        Amplitude of a wobble that noise could hide.
    wave
        Its values, (n, d).
    """

    frequency: float
    amplitude: float
    frequency_error: float
    amplitude_error: float
    chance: float
    noise: float
    hidden: float
    wave: np.ndarray

    @property
    def stands_out(self) -> bool:
        """Whether the line is above the noise beyond doubt: less than one chance in a thousand.

        The surroundings are themselves known to a tenth only, so a tenth of that is asked for.
        """
        return self.chance < 1e-4


def line(t: np.ndarray, x: np.ndarray, above: float = 0.0) -> Line:
    """Return the line that stands highest above the spectrum around it, of five beats at least.

    A polynomial takes off what is slower. The surroundings are straight lines in the logarithms of
    frequency and power, fitted robustly: a path that turns has a red spectrum; a taper keeps it
    from leaking up. Around them the power of d coordinates is Gamma(d) distributed where there is
    no line [Scargle 1982]. Uncertainties are those of a sine in noise: ``var A = 2 s^2 / n``,
    ``var f = 6 s^2 / (n (pi T A)^2)`` [Rife and Boorstyn 1974].

    Parameters
    ----------
    t, x
        Times and positions, (n,) and (n, d).
    above
        Frequency below which nothing is looked for.
    """
    n, d = x.shape
    slow = _slow(t, min(DEGREE, n // 8))
    y = x - slow @ np.linalg.lstsq(slow, x, rcond=None)[0]
    above = max(above, BEATS / float(t[-1] - t[0]))
    taper = np.sin(np.pi * (t - t[0]) / (t[-1] - t[0]))[:, None] ** 2
    f, P = _unscaled(t, y * taper * np.sqrt(n / np.sum(taper**2)))
    usable = f > above
    if usable.sum() < 3 * FINER:
        none = float("nan")
        return Line(none, none, none, none, 1.0, _noise(y), none, y * 0.0)
    f, P = f[usable], P[usable]
    around = _surroundings(f, P, d)
    i = int(np.argmax(P / around))
    alone = min(float(gammaincc(d, d * P[i] / around[i])), 1.0 - 1e-12)
    chance = float(-np.expm1(3.0 * f.size / FINER * np.log1p(-alone)))
    if np.ptp(y, axis=0).max() <= ROUNDING * np.abs(x).max():
        chance = 1.0
    s2 = around[i] / (2.0 * d)
    top = np.median(P[2 * f.size // 3 :: FINER]) / (2.0 * gammaincinv(d, 0.5))
    frequency, wave = _sine(t, x, float(f[i]), slow)
    A = float(np.sqrt(2.0 * np.mean(np.sum(wave**2, axis=1))))
    T = float(t[-1] - t[0])
    return Line(
        frequency=frequency,
        amplitude=A,
        frequency_error=float(np.sqrt(6.0 * s2 / n) / (np.pi * T * max(A, 1e-300))),
        amplitude_error=float(np.sqrt(2.0 * s2 / n)),
        chance=chance,
        noise=min(float(np.sqrt(top)), _noise(y)),
        hidden=float(np.sqrt(2.0 * np.max(around[f > f[-1] / 50.0]) * HIDES / n)),
        wave=wave,
    )


def _slow(t: np.ndarray, degree: int) -> np.ndarray:
    return np.polynomial.legendre.legvander(2.0 * (t - t[0]) / (t[-1] - t[0]) - 1.0, degree)


def _unscaled(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    f, share = power(t, y)
    return f, share * float(np.sum((y - y.mean(axis=0)) ** 2))


def _noise(y: np.ndarray) -> float:
    """Noise by third differences, into which a path that turns does not leak."""
    return float(np.sqrt(np.mean(np.diff(y, 3, axis=0) ** 2) / 20.0)) if len(y) > 8 else 0.0


def _sine(t: np.ndarray, x: np.ndarray, near: float, slow: np.ndarray) -> tuple[float, np.ndarray]:
    """Frequency and values of the best sine near one, by least squares beside the slow path."""
    step = 0.5 / (t[-1] - t[0])
    Q = np.linalg.qr(slow)[0]
    x = x - Q @ (Q.T @ x)

    def sine(f: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        angle = 2.0 * np.pi * f * t
        basis = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        slowly, seen = Q.T @ basis, basis.T @ x
        return basis, np.linalg.solve(basis.T @ basis - slowly.T @ slowly, seen), seen

    def held(f: float) -> float:
        _, c, seen = sine(f)
        return -float(np.sum(c * seen))

    found: Any = minimize_scalar(
        held,
        bounds=(near - step, near + step), method="bounded", options={"xatol": 1e-4 * step},
    )  # fmt: skip
    basis, c, _ = sine(float(found.x))
    return float(found.x), basis @ c


NEAR = 12  #: natural frequencies to either side that are the surroundings
BEATS = 5.0  #: in a track, at the least
DEGREE = 10  #: of the polynomial that takes off what is slower
ROUNDING = 1e-10
HIDES = 10.0  #: times the power around it, below which a line is not told from chance


def _surroundings(f: np.ndarray, P: np.ndarray, d: int) -> np.ndarray:
    """Mean power around each frequency: robust straight lines through the logarithms nearby."""
    x, z = np.log(f[::FINER]), np.log(np.maximum(P[::FINER], 1e-300)) - digamma(d) + np.log(d)
    count = x.size
    knots = np.unique(np.round(np.geomspace(1, count, 40)).astype(int)) - 1
    level = []
    for k in knots:
        half = max(NEAR, k // 3)
        low = int(np.clip(k - half, 0, max(count - 2 * half - 1, 0)))
        some = slice(low, low + 2 * half + 1, max(half // 200, 1))
        level.append(_line_at(x[some] - x[k], z[some]))
    return np.exp(np.clip(np.interp(np.log(f), x[knots], level), -690.0, 690.0))


def _line_at(x: np.ndarray, z: np.ndarray) -> float:
    """Value at zero of a straight line that points far above it do not pull up."""
    level, weight = 0.0, np.ones(z.size)
    for _ in range(12):
        total = float(weight.sum())
        x0, z0 = float(weight @ x) / total, float(weight @ z) / total
        beside = weight * (x - x0)
        slope = float(beside @ z) / max(float(beside @ x), 1e-300)
        level = z0 - slope * x0
        weight = 1.0 / np.maximum(z - level - slope * x, 1.0) ** 2
    return level
