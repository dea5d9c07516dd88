"""Loops that a path in a plane runs: their radius, and how fast their centre moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import stdtrit

from microswim.studies.identification.average_path import AveragePath, Estimate
from microswim.studies.identification.turning_frame import rate_of_winding

FEWEST = 1.5  #: loops
FEWEST_AVERAGES = 8
SURELY = 1.9  #: half intervals that a centre at rest moves by chance, once in a thousand
STEADY = 0.7  #: of the square of the steps about their mean that one circle holds


@dataclass(frozen=True)
class Loops:
    """Loops at a steady rate around a centre that moves.

    Parameters
    ----------
    rate
        At which they are run (rad per time), to the left positive.
    radius
        Of the circle.
    drift
        Speed of its centre.
    """

    rate: float
    radius: Estimate
    drift: Estimate

    @property
    def drifts(self) -> bool:
        """Whether the centre moves."""
        return self.drift.low > 0


def loops_of(path: AveragePath) -> Loops | None:
    """Return the loops of a path in a plane, None if it runs no circle at a steady rate.

    Averages are ``c + d t + R exp(i w t)`` by least squares. What is left remembers itself: so
    many fewer averages are independent.

    Parameters
    ----------
    path
        Without the wobble.
    """
    if path.mean.shape[1] != 2 or not path.swims or len(path.mean) < FEWEST_AVERAGES:
        return None
    t = path.time - path.time.mean()
    z = path.mean[:, 0] + 1j * path.mean[:, 1]
    rate = rate_of_winding(float(t[1] - t[0]), path.mean, least=0.0)
    if abs(rate) * np.ptp(t) < 2.0 * np.pi * FEWEST:
        return None
    rate = _rate_near(t, z, rate)
    c, left, errors = _circle(t, z, rate)
    v = np.diff(left)
    swung = np.diff(c[2] * np.exp(1j * rate * t))
    if np.sum(np.abs(v) ** 2) > (1.0 - STEADY) * np.sum(np.abs(v + swung) ** 2):
        return None
    seen = path.averaging.held(rate)
    radius, drift = (float(abs(one)) for one in (c[2] / seen, c[1]))
    wide, half = float(errors[2]) / seen, float(errors[1])
    if wide > radius:
        return None
    low = drift - half if drift > SURELY * half else 0.0
    return Loops(rate, Estimate.around(radius, wide), Estimate(drift, low, drift + half))


def _rate_near(t: np.ndarray, z: np.ndarray, rate: float) -> float:
    """Rate of the best circle within half a loop in the track; t has mean 0."""
    straight = np.stack([np.ones_like(t), t], axis=1)
    straight /= np.linalg.norm(straight, axis=0)
    z = z - straight @ (straight.T @ z)

    def held(w: float) -> float:
        swing = np.exp(1j * w * t)
        own = len(t) - float(np.sum(np.abs(straight.T @ swing) ** 2))
        return -float(abs(np.vdot(swing, z)) ** 2) / own

    half = np.pi / float(np.ptp(t))
    off: Any = minimize_scalar(
        held, method="bounded", bounds=(rate - half, rate + half), options={"xatol": 1e-7 * half}
    )
    return float(off.x)


def _circle(t: np.ndarray, z: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients of the centre, its velocity and the circle; what is left; half intervals."""
    basis = np.stack([np.ones_like(t), t, np.exp(1j * rate * t)], axis=1)
    c = np.linalg.lstsq(basis, z, rcond=None)[0]
    left = z - basis @ c
    total = max(float(np.sum(np.abs(left) ** 2)), 1e-300)
    memory = float(np.clip(np.sum(left[1:] * left[:-1].conj()).real / total, 0.0, 1.0))
    free = max(len(z) * (1.0 - memory) / (1.0 + memory) - 3.0, 1.0)
    share = np.sqrt(np.diag(np.linalg.inv(np.real(basis.conj().T @ basis))) * len(z) / (free + 3.0))
    deviation = np.sqrt(total / (2.0 * len(z)) * (free + 3.0) / free)
    return c, left, stdtrit(free, 0.975) * deviation * share
