"""After how many periods of its drive a shape comes back: one, two (it period-doubles), or none."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.array import Array

MOST, ONCE_MORE = 8, 2  #: periods that are told; how often a shape must have come back
PHASES = 16  #: of each period that are compared
CLOSE = 1e-3  #: to this share of its largest change


def repeats_after(times: Array, states: Array, period: float) -> int:
    """Return after how many periods the states (n, d) at the times come back; 0: after none.

    They must have come back over two periods in a row; of up to eight periods the fewest. A path
    that is too short to tell has 0 as well.
    """
    from scipy.interpolate import CubicSpline

    if not period > 0.0 or len(times) < 4:
        return 0
    known = int((times[-1] - times[0]) / period * (1.0 + 1e-12))
    if known < ONCE_MORE + 1:
        return 0
    back = np.minimum(period * np.arange(known * PHASES + 1) / PHASES, times[-1] - times[0])
    seen = CubicSpline(times, states)(times[-1] - back)
    last = states[times >= times[-1] - (MOST if known > MOST else known) * period]
    size = float(np.ptp(last, axis=0).max())
    for n in range(1, min(MOST, known - ONCE_MORE + 1) + 1):
        lag = n * PHASES
        off = np.abs(seen[:-lag] - seen[lag:])[: (ONCE_MORE + n - 1) * PHASES]
        if off.max() <= CLOSE * size or size == 0.0:
            return n
    return 0


def words(count: int) -> str:
    """Return what is said of that number of periods."""
    told: dict[int, Any] = {0: "does not settle within this time", 1: "the period of its drive"}
    told[2] = "twice the period of its drive: it period-doubles"
    return told.get(count, f"{count} times the period of its drive")
