"""Least and greatest values of Fourier series over the period, and what is called an amplitude.

The best of dense samples, polished by Newton's method on the series itself; for many series,
compiled. A *series* is one of `microswim.numerics.series.fourier`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import FAST, compiled, pays
from microswim.numerics.series.fourier import basis, evaluate

SAMPLES = 8  #: of the period, for each term of a series
STEPS = 4  #: of Newton's method
FLAT = 1e-12  #: a curvature so small against the largest term is rounding
TERM = 3e-7  #: seconds of a term of a series as Python


def half_range(series: np.ndarray) -> Any:
    """Return half of peak to peak of each series over the period: what is called an amplitude."""
    if series.ndim == 1 or np.iscomplexobj(series) or not pays(TERM * series.size):
        low, high = extremes(series)
        return (high - low) / 2.0
    from microswim.numerics.series.extremes_of_many import half_ranges

    columns = np.ascontiguousarray(series.reshape(len(series), -1).T)
    return half_ranges.over(len(columns))(columns, _rows(len(series))).reshape(series.shape[1:])


def extremes(series: np.ndarray) -> tuple[Any, Any]:
    """Return the least and greatest value of each series, shape series.shape[1:]."""
    phase = _phases(len(series))
    values = evaluate(series, phase)
    flat = FLAT * np.abs(series).max(axis=0)
    out = []
    for sense in (-1.0, 1.0):
        at = np.argmax(sense * np.real(values), axis=0)
        best = np.take_along_axis(values, at[None], axis=0)[0]
        x = phase[at] + 0.0 * best
        for _ in range(STEPS):
            _, slope, curvature = around.written(series, x)
            bent = np.abs(curvature) > flat
            x = x - np.where(bent, slope, 0.0) / np.where(bent, curvature, 1.0)
        top = around.written(series, x)[0]
        out.append(np.where(sense * top.real >= sense * best.real, top, best)[()])
    return out[0], out[1]


def _phases(terms: int) -> np.ndarray:
    n = SAMPLES * terms
    return 2.0 * np.pi * np.arange(n) / n


@lru_cache(16)
def _rows(terms: int) -> np.ndarray:
    """Value of each term at the samples, (terms, samples)."""
    return np.ascontiguousarray(basis(_phases(terms), terms).T)


@compiled(fastmath=FAST)
def around(series: Any, x: Any) -> tuple[Any, Any, Any]:
    """Return value, slope and curvature of each series at a phase of its own, by angle addition."""
    c1, s1 = np.cos(x), np.sin(x)
    c, s = c1, s1
    value, slope, curvature = series[0] + 0.0 * x, 0.0 * x, 0.0 * x
    for h in range(1, len(series) // 2 + 1):
        a, b = series[2 * h - 1], series[2 * h]
        term = a * c + b * s
        value, curvature = value + term, curvature - h * h * term
        slope = slope + h * (b * c - a * s)
        c, s = c * c1 - s * s1, s * c1 + c * s1
    return value, slope, curvature
