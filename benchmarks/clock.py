"""The clock of the benchmarks: processor seconds, so that other work counts little."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import numpy as np

RESULTS = Path(__file__).parent / "results"


def keep(name, results):
    """Write the results of a benchmark, and on which processor they were measured."""
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps({"processor": processor(), **results}, indent=1) + "\n"
    (RESULTS / f"{name}.json").write_text(text, encoding="utf-8")


def processor():
    """Its name and the widest lanes that compiled code takes here, as the tables say it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    known = dict(line.split(":", 1) for line in lines if ":" in line)
    known = {k.strip(): v.strip() for k, v in known.items()}
    name = known.get("model name", "unknown processor").replace("(R)", "")
    narrow = "NUMBA_CPU_NAME" in os.environ
    flags = known.get("flags", "")
    lanes = "AVX-512" if "avx512f" in flags and not narrow else "AVX2" * ("avx2" in flags)
    return ", ".join(filter(None, (name, lanes)))


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
