"""How corrections become those of a phase, and of the other hand: a plane wave's harmonics."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.calibration.region import positive_definite as blocks
from microswim.numerics.compiling.compiled import compiled

SAMPLES = 12  #: phases over a period of a plane wave
HALF = SAMPLES // 2
PHASES = tuple(np.pi * np.arange(HALF) / HALF)
LOGARITHMS = (0, 5)  #: corrections whose mean is fitted by its logarithm: thrust and power
#: Signs, for the other hand, of the body's axial drag, its coupling with the turn, its part of F_p.
OTHER_HAND = np.array([1.0, -1.0, 1.0])


@compiled()
def scales(R0: Any, F0: Any, G0: Any) -> Any:
    """Return scales of F_s, F_q, T_r and G of a plane wave, from samples over half a period."""
    out = np.empty((4, *G0.shape[1:]), dtype=R0.dtype)
    thrust, power, across, turn = 0 * G0[0], 0 * G0[0], 0 * G0[0], 0 * G0[0]
    for j in range(len(G0)):
        thrust += F0[j, 0] / len(G0)
        power += G0[j] / len(G0)
        across += R0[j, 1, 1] / len(G0)
        turn += R0[j, 5, 5] / len(G0)
    out[0], out[3] = thrust, power
    out[1], out[2] = np.sqrt(power * across), np.sqrt(power * turn)
    return out


@compiled()
def beat(y: Any, phase: float) -> Any:
    """Return corrections (16,) at a phase from the harmonics, packed as `region` fits them.

    Of the means of thrust F_s and power G over the base's the logarithms are fitted: the truth is
    up to ten times the base's thrust.
    """
    out = np.empty((16, *y.shape[1:]), dtype=y.dtype)
    c1, s1 = np.cos(phase), np.sin(phase)
    c2, s2, c3, s3 = np.cos(2 * phase), np.sin(2 * phase), np.cos(3 * phase), np.sin(3 * phase)
    for i in range(len(blocks.EVEN)):
        out[blocks.EVEN[i]] = y[i] + c2 * y[10 + 2 * i] - s2 * y[11 + 2 * i]
    for i in LOGARITHMS:
        out[blocks.EVEN[i]] += np.exp(y[i]) - 1.0 - y[i]
    for i in range(len(blocks.ODD)):
        first = c1 * y[30 + 2 * i] - s1 * y[31 + 2 * i]
        out[blocks.ODD[i]] = first + c3 * y[42 + 2 * i] - s3 * y[43 + 2 * i]
    return out


def finer(samples: np.ndarray, count: int) -> np.ndarray:
    """Return samples over the period at more phases, the Nyquist term left out."""
    hat = np.fft.rfft(samples, axis=1)[:, :HALF]
    return np.fft.irfft(hat, count, axis=1) * (count / samples.shape[1])
