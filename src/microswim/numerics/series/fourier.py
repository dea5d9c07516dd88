"""Real Fourier series in the phase, and how six-vectors and 6x6 matrices turn with it.

A *series* has the shape ``(1 + 2 H, ...)``: ``[mean, cos 1, sin 1, cos 2, sin 2, ...]``. All
functions accept complex numbers, so that complex-step derivatives run through them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

#: Signs that a six-vector ``[linear; angular]`` gets from a mirror image in q, in r, and from half
#: a turn about s, which is both.
MIRROR_Q = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
MIRROR_R = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
TURN_S = MIRROR_Q * MIRROR_R


def basis(phase: Any, terms: int) -> np.ndarray:
    """Return ``[1, cos, sin, cos 2, sin 2, ...]``, shape phase.shape + (terms,)."""
    phase = np.asarray(phase)
    h = (np.arange(terms) + 1) // 2
    arg = phase[..., None] * h
    out = np.cos(arg)
    out[..., 2::2] = np.sin(arg[..., 2::2])
    return out


def evaluate(series: np.ndarray, phase: Any) -> np.ndarray:
    """Return the value of a series at the phases, shape phase.shape + series.shape[1:]."""
    rows = basis(phase, len(series))
    return (rows @ series.reshape(len(series), -1)).reshape(rows.shape[:-1] + series.shape[1:])


def series_of(samples: np.ndarray, harmonics: int | None = None) -> np.ndarray:
    """Return series through n uniform samples over the period (the Nyquist term is left out)."""
    n = len(samples)
    H = (n - 1) // 2 if harmonics is None else harmonics
    if np.iscomplexobj(samples):  # apart, or rounding of the real part drowns a complex step
        return series_of(np.real(samples), H) + 1j * series_of(np.imag(samples), H)
    hat = np.fft.rfft(samples, axis=0)[: H + 1] * (2.0 / n)
    out = np.empty((1 + 2 * H, *samples.shape[1:]))
    out[0], out[1::2], out[2::2] = hat[0].real / 2.0, hat[1:].real, -hat[1:].imag
    return out


def trimmed(series: np.ndarray, floor: float = 1e-13) -> np.ndarray:
    """Return series without its last harmonics where they are below `floor` of the largest term."""
    size = np.abs(series).max(axis=tuple(range(1, series.ndim)))
    felt = np.flatnonzero(size > floor * size.max(initial=0.0)).max(initial=0)
    return series[: 1 + 2 * ((felt + 1) // 2)]


def derivative(series: np.ndarray) -> np.ndarray:
    """Return series of the derivative with respect to the phase."""
    out = np.zeros_like(series)
    h = np.arange(1, len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    out[1::2], out[2::2] = h * series[2::2], -h * series[1::2]
    return out


def shifted(series: np.ndarray, ahead: Any) -> np.ndarray:
    """Return the series of ``f(phase + ahead)``."""
    out = series + 0.0 * ahead
    h = np.arange(1, len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    c, d = np.cos(h * ahead), np.sin(h * ahead)
    out[1::2] = c * series[1::2] + d * series[2::2]
    out[2::2] = c * series[2::2] - d * series[1::2]
    return out


def of_multiple(series: np.ndarray, k: int) -> np.ndarray:
    """Return the series of ``f(k phase)``, k a whole number of either sign."""
    if k == 0:
        return evaluate(series, 0.0)[None]
    H = len(series) // 2
    out = np.zeros((1 + 2 * H * abs(k), *series.shape[1:]), series.dtype)
    out[0] = series[0]
    for h in range(1, H + 1):
        out[2 * h * abs(k) - 1] = series[2 * h - 1]
        out[2 * h * abs(k)] = series[2 * h] * (1.0 if k > 0 else -1.0)
    return out


def _rotation_terms() -> tuple[np.ndarray, np.ndarray]:
    """Linear maps from ``R(0)`` and ``F(0)`` to the series of ``Q R Q'`` and ``Q F``.

    ``Q(phi) = A + B cos phi + C sin phi`` turns both halves of a six-vector about s.
    """
    A, B, C = np.zeros((3, 6, 6))
    for o in (0, 3):
        A[o, o] = 1.0
        B[o + 1, o + 1] = B[o + 2, o + 2] = 1.0
        C[o + 2, o + 1], C[o + 1, o + 2] = 1.0, -1.0
    pairs = [
        [(A, A, 1.0), (B, B, 0.5), (C, C, 0.5)],
        [(A, B, 1.0), (B, A, 1.0)],
        [(A, C, 1.0), (C, A, 1.0)],
        [(B, B, 0.5), (C, C, -0.5)],
        [(B, C, 0.5), (C, B, 0.5)],
    ]
    R_map = np.array([sum(w * np.kron(X, Y) for X, Y, w in terms) for terms in pairs])
    return R_map.reshape(5 * 36, 36), np.array([A, B, C]).reshape(18, 6)


_R_MAP, _F_MAP = _rotation_terms()


def rotate(value: np.ndarray, sign: float) -> np.ndarray:
    """Return series of a 6x6 matrix or 6-vector that turns about s with ``sign * phase``."""
    if value.ndim == 2:
        series = _R_MAP.dot(value.reshape(36)).reshape(5, 6, 6)
    else:
        series = _F_MAP.dot(value).reshape(3, 6)
    if sign < 0:
        series[2::2] = -series[2::2]
    return series


def add(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the sum of two series of any lengths."""
    short, long = (first, second) if len(first) < len(second) else (second, first)
    out = long.astype(np.result_type(long, short))
    out[: len(short)] += short
    return out
