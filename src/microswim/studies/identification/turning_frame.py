"""Local fits of a path that winds: parabolas in a frame that turns along.

Where a path turns by more than a fifth of a radian within five averages a parabola cuts its loops.
In a plane, with positions as complex numbers, ``a + b t + (c + d t) exp(i w t)`` is a circle whose
rate and radius shift slowly around a centre that moves. What averaging over a beat takes off a
circle is put back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FINER = 8  #: rates per natural one, ``2 pi / duration``
FASTEST = 0.9 * np.pi  #: rad from one average to the next, beyond which nobody knows the side
LEAST = 0.2  #: rad within five averages, below which a parabola does: to .15 % of the speed


def rate_of_winding(step: float, mean: np.ndarray, least: float = LEAST) -> float:
    """Return the rate at which a path winds (rad per time, to the left positive), 0 for none.

    The strongest line of the velocities from average to average.

    Parameters
    ----------
    step
        Time between averages.
    mean
        Averages in a plane, shape (m, 2).
    least
        Turn within five averages (rad) that is asked for.
    """
    v = np.diff(mean[:, 0] + 1j * mean[:, 1])
    size = FINER * len(v)
    rate = 2.0 * np.pi * np.fft.fftfreq(size, step)
    power = np.abs(np.fft.fft(v - v.mean(), size))
    power[np.abs(rate) * step > FASTEST] = 0.0
    i = int(np.argmax(power))
    return float(rate[i]) if abs(rate[i]) * 4.0 * step > least else 0.0


@dataclass(frozen=True)
class Averaging:
    """How averages were taken.

    Parameters
    ----------
    width
        Time over which, 0 for samples as they are.
    frame
        Time between samples, joined by straight lines.
    """

    width: float = 0.0
    frame: float = 0.0

    def held(self, rate: float) -> float:
        """Return the share of a circle run at a rate that is left."""
        if self.width == 0.0:
            return 1.0
        turn = rate / (2.0 * np.pi)
        return float(np.sinc(turn * self.width) * np.sinc(turn * self.frame) ** 2)


@dataclass(frozen=True, eq=False)
class LocalFit:
    """Positions and velocities of a path by local fits.

    Parameters
    ----------
    position, velocity
        Of the path, shape (m, 2).
    off
        Averages less the fit, of those with a whole window around them.
    hat
        Share of an average in its own fit.
    spread
        Root of the sum of squared weights of a velocity.
    """

    position: np.ndarray
    velocity: np.ndarray
    off: np.ndarray
    hat: float
    spread: float


def local_fit(
    step: float, mean: np.ndarray, window: int, rate: float, averaging: Averaging
) -> LocalFit:
    """Return the path by local fits in a frame that turns at a rate.

    Parameters
    ----------
    step
        Time between averages.
    mean
        Averages in a plane, shape (m, 2).
    window
        An odd number of averages, at least 5.
    rate
        At which the frame turns, not 0.
    averaging
        How the averages were taken.
    """
    z, half = mean[:, 0] + 1j * mean[:, 1], window // 2
    t = step * np.arange(-half, half + 1)
    turned = np.exp(1j * rate * t)
    held, few = averaging.held(rate), 1e-4 * abs(rate)
    lost = -1j * (averaging.held(rate + few) - averaging.held(rate - few)) / (2.0 * few)
    one, none = np.ones_like(turned), np.zeros_like(turned)
    seen = np.stack([one, t + none, held * turned, (held * t + lost) * turned], axis=1)
    true = np.stack([one, t + none, turned, t * turned], axis=1)
    speed = np.stack([none, one, 1j * rate * turned, (1.0 + 1j * rate * t) * turned], axis=1)
    coefficients = np.linalg.pinv(seen)
    x, v, kept = (_swept(rows @ coefficients, z) for rows in (true, speed, seen))
    inner = slice(half, len(z) - half)
    return LocalFit(
        position=_plane(x),
        velocity=_plane(v),
        off=_plane((z - kept)[inner]),
        hat=float((seen @ coefficients)[half, half].real),
        spread=float(np.linalg.norm((speed @ coefficients)[half])),
    )


def _swept(weights: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Values of the local fits: at the middle of each window; at the ends by the outermost one."""
    window = len(weights)
    half = window // 2
    middle = np.convolve(z, weights[half][::-1], mode="valid")
    return np.concatenate([
        weights[:half] @ z[:window], middle, weights[half + 1 :] @ z[-window:]
    ])  # fmt: skip


def _plane(z: np.ndarray) -> np.ndarray:
    return np.stack([np.real(z), np.imag(z)], axis=-1)
