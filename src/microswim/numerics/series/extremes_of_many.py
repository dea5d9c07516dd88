"""Amplitudes of many series, compiled: what `microswim.numerics.series.extremes` does with one."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import FAST, compiled, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.series.extremes import FLAT, STEPS, around

BLOCK = 64  #: series that share scratch
ROUNDING = 1e-15  #: a term so small against the largest is rounding


@compiled(fastmath=FAST)
def sample(series: Any, rows: Any, values: Any) -> Any:
    """Fill in the values of a series at the samples; returns the size of its largest term."""
    largest = 0.0
    for term in series:
        largest = max(largest, abs(term))
    values[:] = 0.0
    for i in range(len(series)):
        if abs(series[i]) > ROUNDING * largest:
            for j in range(len(values)):
                values[j] += series[i] * rows[i, j]
    return largest


@compiled(fastmath=FAST)
def polished(series: Any, best: Any, x: Any, flat: Any, sense: Any) -> Any:
    """Return the extreme value of a series near the phase x, where it is `best`."""
    for _ in range(STEPS):
        _, slope, curvature = around(series, x)
        if abs(curvature) > flat:
            x -= slope / curvature
    return sense * max(sense * best, sense * around(series, x)[0])


@loop(fastmath=FAST)
def half_ranges(columns: Any, rows: Any) -> Any:
    """Return half of peak to peak of each series of columns (n, terms); rows (terms, samples)."""
    n, m = len(columns), rows.shape[1]
    out = np.empty(n)
    blocks = (n + BLOCK - 1) // BLOCK
    for block in prange(blocks):
        values = np.empty(m)
        for i in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            series = columns[i]
            largest = sample(series, rows, values)
            if largest == 0.0:
                out[i] = 0.0
                continue
            flat = FLAT * largest
            low, high = np.argmin(values), np.argmax(values)
            top = polished(series, values[high], 2.0 * np.pi * high / m, flat, 1.0)
            bottom = polished(series, values[low], 2.0 * np.pi * low / m, flat, -1.0)
            out[i] = (top - bottom) / 2.0
    return out
