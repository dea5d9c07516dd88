"""The clock of the benchmarks: processor seconds, so that other work counts little."""

from __future__ import annotations

import time

import numpy as np


def least(function, repeats=15, calls=1):
    """Least processor seconds of a call over several rounds; compilation falls into the first."""
    best = np.inf
    for _ in range(repeats):
        start = time.process_time()
        for _ in range(calls):
            function()
        best = min(best, (time.process_time() - start) / calls)
    return best
