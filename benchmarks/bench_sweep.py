"""Sweeps at the limit: a million surrogate designs to disk, a hundred boundary-element designs.

    python benchmarks/bench_sweep.py [--designs 1000000] [--bem 100] [--level coarse] [--workers 2]

Prints one JSON object. The efficiency of the boundary-element sweep is the time that its solves
take one after the other in one warm single-threaded process, over workers x wall time; start of
the workers, their import and the store are therefore counted as losses.
"""

import argparse
import json
import os
import resource
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np
from clock import keep

import microswim as ms
from microswim.jobs.worker import Worker
from microswim.studies.sweeps.engines import Task
from microswim.studies.sweeps.rows import Job, solve_rows
from microswim.studies.sweeps.space import Space

BASE = "tabak/helix"


def cpu():
    """Processor seconds of this process and its ended children."""
    used = [resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def surrogate(count):
    """Designs of a square grid to disk; warm kernels, as in a second sweep of a session."""
    swimmer, n = ms.Swimmer.preset(BASE), round(count**0.5)
    axes = {"tail.amplitude": np.linspace(0.01, 0.15, n), "tail.waves": np.linspace(1.0, 4.0, n)}
    ms.sweep(swimmer, {k: v[:3] for k, v in axes.items()})
    with tempfile.TemporaryDirectory() as folder:
        used, begun = cpu(), time.perf_counter()
        result = ms.sweep(swimmer, axes, out=Path(folder) / "a.zarr")
        wall = time.perf_counter() - begun
        used = cpu() - used
        failed = int((result.status != 1).sum())
        size = sum(f.stat().st_size for f in Path(folder).rglob("*") if f.is_file())
    return {
        "designs": n * n,
        "failed": failed,
        "wall_seconds": wall,
        "cpu_seconds": used,
        "megabytes": size / 1e6,
    }


def answer(worker, task):
    """Wait for the rows of a task."""
    worker.ask(task.columns)
    what = "ready"
    while what == "ready":
        _, what, value = worker.heard.get()
    if what != "done":
        raise SystemExit(f"the worker {what}: {value}")


def reference(count, level, workers):
    """Boundary-element designs in processes, against the same solves in one warm process."""
    swimmer = ms.Swimmer.preset(BASE)
    over = {
        "tail.amplitude": np.linspace(0.05, 0.12, max(1, count // 10)),
        "tail.waves": np.linspace(1.5, 3.5, min(10, count)),
    }
    job, space = Job(swimmer, "bem", {"level": level}), Space.of(over, 64)
    worker = Worker(partial(solve_rows, job))
    answer(worker, Task(space, 0, 1))
    some = np.linspace(0, space.size - 1, min(20, space.size)).astype(int)
    begun = time.perf_counter()
    for i in some:
        answer(worker, Task(space, int(i), int(i) + 1))
    alone = (time.perf_counter() - begun) / len(some) * space.size
    worker.stop()
    with tempfile.TemporaryDirectory() as folder:
        used, begun = cpu(), time.perf_counter()
        result = ms.sweep(
            swimmer, over, "bem", out=Path(folder) / "b.zarr", workers=workers, level=level
        )
        wall = time.perf_counter() - begun
        used = cpu() - used
        failed = int((result.status != 1).sum())
    return {
        "designs": space.size,
        "failed": failed,
        "level": level,
        "workers": workers,
        "wall_seconds": wall,
        "cpu_seconds": used,
        "cores_busy": used / wall,
        "seconds_one_after_the_other": alone,
        "efficiency": alone / (workers * wall),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=1_000_000)
    parser.add_argument("--bem", type=int, default=100)
    parser.add_argument("--level", default="coarse")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    report = {"cores": os.cpu_count(), "load": os.getloadavg()[0]}
    if given.designs:
        report["surrogate"] = surrogate(given.designs)
    if given.bem:
        report["reference"] = reference(given.bem, given.level, given.workers)
    keep("sweep", report)
    print(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
