"""How cost grows with nodes, designs, phases and workers: seconds and fitted exponents.

    python benchmarks/bench_growth.py

Processor seconds on one thread, the least of several runs; workers by wall time, since sharing is
the point there. Growth with the unknowns of the boundary elements is in bench_bem.py. Results go
to benchmarks/results/growth.json and to the screen.
"""

from __future__ import annotations

import os

for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import time

import numpy as np
from clock import keep, least

import microswim as ms
from microswim.jobs import processes, references
from microswim.models.rft import gait as rft
from microswim.models.rft import plane_wave as planarwave
from microswim.models.rft import segment as kernels
from microswim.numerics.quadrature import gauss

HELIX, WAVE = (ms.Swimmer.preset(f"tabak/{name}") for name in ("helix", "plane_wave"))


def nodes():
    """The plain quadrature of one helix."""
    p, ramp = rft.parameters(HELIX), gauss(8)
    for n in (8, 16, 32, 64, 128, 256, 512):
        rule = gauss(n)
        yield n, least(lambda r=rule: kernels.wave_tail(0, True, p, 0.0, ramp, r), 9, 300)


def phases():
    """All phases of one plane wave from one table of sines."""
    p = rft.parameters(WAVE)
    rules = rft.rules(WAVE)
    for m in (4, 8, 16, 32, 64, 128):
        phase = np.linspace(0.0, np.pi, m)
        yield m, least(lambda f=phase: planarwave.wave_phases(True, p, f, *rules), 9, 30)


def designs(swimmer, most):
    """Batched evaluation from numbers of the spec to speeds and powers."""
    for n in 10 ** np.arange(1, most + 1):
        values = {"tail.amplitude": np.linspace(0.03, 0.12, n)}
        yield n, least(lambda v=values: ms.evaluate(swimmer, v), 3, max(1, 3000 // n))


def workers():
    """Wall seconds of 24 coarse boundary-element gaits, workers started and warm included."""
    swimmers = [HELIX.with_({"tail.waves": w}) for w in np.linspace(1.5, 3.5, 24)]
    for count in range(1, processes.cores() + 1):
        best = np.inf
        for _ in range(2):
            start = time.perf_counter()
            references.gaits(swimmers, "bem", workers=count, level="coarse")
            best = min(best, time.perf_counter() - start)
        yield count, best


PARTS = {
    "nodes of one helix": nodes,
    "phases of one plane wave": phases,
    "designs, helix": lambda: designs(HELIX, 7),
    "designs, plane wave": lambda: designs(WAVE, 6),
    "workers, boundary elements": workers,
}


def main():
    """Run all, fit the exponent over the upper half, print and keep."""
    ms.warm_up()
    results = {}
    for name, part in PARTS.items():
        x, seconds = np.array(list(part())).T
        half = slice(len(x) // 2 if len(x) > 2 else 0, None)
        exponent = np.polyfit(np.log(x[half]), np.log(seconds[half]), 1)[0]
        results[name] = {
            "x": x.tolist(),
            "seconds": seconds.tolist(),
            "exponent": float(exponent),
        }
        print(f"{name:28s} exponent {exponent:5.2f}   last: {x[-1]:g} in {seconds[-1]:.3g} s")
    keep("growth", results)


if __name__ == "__main__":
    main()
