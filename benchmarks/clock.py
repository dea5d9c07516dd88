"""The clock of the benchmarks: processor seconds, so that other work counts little."""

from __future__ import annotations

import time

import numpy as np


def timed(function, repeats=15, calls=1):
    """Least processor seconds of a call over several rounds, and what the last call returned.

    Compilation falls into the first round.
    """
    best = np.inf
    for _ in range(repeats):
        start = time.process_time()
        for _ in range(calls):
            result = function()
        best = min(best, (time.process_time() - start) / calls)
    return best, result


def least(function, repeats=15, calls=1):
    """Least processor seconds of a call, as `timed` has them."""
    return timed(function, repeats, calls)[0]
