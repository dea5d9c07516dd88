"""Elastic tails: seconds a period and error, beside PyElastica in the same run.

    python benchmarks/bench_elastic.py [PYTHON_WITH_PYELASTICA]

Processor seconds on one thread. PyElastica is asked by another interpreter, one with an environment
of its own, for the same filament: clamped at a base that moves across by 0.02 L, local drag c_n = 2
c_t, sperm number 2, whose thrust has a closed form. Its explicit steps want mass: density is chosen
so small that inertia does not count, and its step from the stretching wave.
"""

from __future__ import annotations

import os

for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import subprocess
import sys
from pathlib import Path

import numpy as np
from clock import timed

import microswim as ms

RATE = 2.0 * np.pi
TRUTH, SIZE = 0.3835, 0.02  #: thrust at a sperm number of 2, in (c_n - c_t) w y0^2
OTHER = Path(__file__).with_name("pyelastica_filament.py")


def filament(sperm_number=2.0, **tail):
    """A filament of length 1, c_n = 1."""
    own = {"length": 1.0, "radius": 0.01, "bending": RATE / sperm_number**4} | tail
    return ms.Swimmer(
        body=ms.NoBody(), tail=ms.ElasticTail(**own), fluid=ms.Fluid(viscosity=1.0),
        coefficients=ms.Constant(normal=1.0, tangential=0.5, spin=False),
        motion=ms.Motion(free="none"),
    )  # fmt: skip


def thrust(swimmer):
    """In units of (c_n - c_t) w y0^2."""
    return -ms.summary(swimmer.gait())["held_wrench"][0] / (0.5 * RATE * SIZE**2)


def free(**tail):
    """The same behind a sphere, free."""
    one = filament(3.0, **tail)
    return ms.Swimmer(
        body=ms.Sphere(radius=0.2), tail=one.tail, fluid=one.fluid,
        coefficients=ms.Constant(normal=1.0, tangential=0.5),
    )  # fmt: skip


def main():
    seconds, found = timed(lambda: thrust(filament(drive="heave", amplitude=SIZE)), 7)
    print(
        f"planar, Sp 2: {1e3 * seconds:7.1f} ms a settled period, thrust {found / TRUTH - 1:+.2%}"
    )
    for name, tail in {
        "planar, free, Sp 3, angle 0.6": {"drive": "pivot", "angle": 0.6},
        "in space, free, Sp 3, tilt 0.6": {"drive": "rotate", "angle": 0.6},
    }.items():
        seconds, _ = timed(lambda t=tail: free(**t).gait(), 7)
        print(f"{name}: {1e3 * seconds:7.1f} ms a settled period")
    for tolerance in (1e-4, 1e-5, 1e-6):
        one = free(drive="rotate", angle=0.6)
        seconds, _ = timed(
            lambda s=one, e=tolerance: ms.path(s, 4.0, memory=True, samples=5, tolerance=e), 1
        )
        print(
            f"followed in space from rest, tolerance {tolerance:g}: "
            f"{1e3 * seconds / 8.0:7.1f} ms a period"
        )  # two marches of four periods
    if len(sys.argv) > 1:
        for elements in ("20", "40"):
            subprocess.run([sys.argv[1], str(OTHER), elements], check=True)


if __name__ == "__main__":
    main()
