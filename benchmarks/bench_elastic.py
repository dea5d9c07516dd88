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


def free(sperm_number=3.0, **tail):
    """The same behind a sphere, free."""
    one = filament(sperm_number, **tail)
    return ms.Swimmer(
        body=ms.Sphere(radius=0.2), tail=one.tail, fluid=one.fluid,
        coefficients=ms.Constant(normal=1.0, tangential=0.5),
    )  # fmt: skip


HELIX = {"rest_radius": 0.05, "rest_pitch": 0.6}
STIFF = RATE / 3.0**4  #: bending at a sperm number of 3
#: Free swimmers at a sperm number of 3: in the plane, turning as a whole, and beating in space.
FREE = {
    "planar, heave 0.2": {"drive": "heave", "amplitude": 0.2},
    "planar, angle 0.6": {"drive": "pivot", "angle": 0.6},
    "planar, inner moment": {"drive": "moment", "moment": 5.0 * STIFF, "wavelength": 0.7},
    "in space, turning, tilt 0.6": {"drive": "rotate", "angle": 0.6},
    "in space, helix at rest, heave 0.2": {"drive": "heave", "amplitude": 0.2, **HELIX},
    "in space, helix at rest, angle 0.6": {"drive": "pivot", "angle": 0.6, **HELIX},
    "in space, helix at rest, inner moment": {
        "drive": "moment", "moment": 5.0 * STIFF, "wavelength": 0.7, **HELIX,
    },
}  # fmt: skip
PERIODS = 8  #: in time from rest, the last of which is compared


def marched(swimmer):
    """Power and way in the last of some periods from rest, whose steps know of no period."""
    path = ms.path(swimmer, float(PERIODS), memory=True, samples=PERIODS + 1)
    way = np.linalg.norm(np.diff(path.position.values, axis=0)[-1])
    return path.dissipated.values[-1] - path.dissipated.values[-2], way


def gait_way(swimmer, gait):
    """Way in a period."""
    path = ms.trajectory(gait, [0.0, 1.0])
    return np.linalg.norm(path.position.values[-1] - path.position.values[0])


def main():
    seconds, found = timed(lambda: thrust(filament(drive="heave", amplitude=SIZE)), 7)
    print(
        f"planar, Sp 2: {1e3 * seconds:7.1f} ms a settled period, thrust {found / TRUTH - 1:+.2%}"
    )
    for name, tail in FREE.items():
        one = free(**tail)
        seconds, gait = timed(one.gait, 7)
        power, way = marched(one)
        print(
            f"{name}: {1e3 * seconds:7.1f} ms a settled period; against marching from rest power "
            f"{gait.mean_power / power - 1:+.3%}, way {gait_way(one, gait) / way - 1:+.3%}"
        )
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
