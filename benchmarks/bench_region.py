"""What a calibrated evaluation costs, against plain resistive force theory.

    python benchmarks/bench_region.py

Corrections over the region of the acceptance from 100 designs, helix and plane wave. Their cost
does not depend on what was learnt, so the reference is the surrogate under another law. Figures
are processor seconds on one core, the least of several runs, both models in turn in this one run;
what 100 solves of boundary elements and their fit take is told by the clock, on all cores. Results
go to benchmarks/results/region.json and, as a table, to the screen.
"""

from __future__ import annotations

import os

for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

import time
import warnings
from dataclasses import replace

import numpy as np
from clock import keep, least

import microswim as ms
from microswim.calibration.atlas.everywhere import everywhere

REGION = {
    "tail.amplitude": (0.03, 0.2),
    "tail.waves": (0.8, 4.5),
    "tail.length": (1.2, 3.0),
    "body.radius": (0.3, 0.7),
}
DESIGNS = 2000


def velocity(swimmer):
    """What an answer needs: a gait, its mean velocity and expected error."""
    gait = swimmer.gait()
    return gait.mean_velocity, gait.info.get("expected_error")


def measured(kind):
    """Microseconds per gait and per design of a batch, plain and calibrated."""
    usual = ms.Swimmer.preset(f"tabak/{kind}")  # Lighthill's law, the default
    plain = replace(usual, coefficients=ms.GrayHancock())
    other = replace(plain, coefficients=ms.Cox())
    fitted = ms.calibrate_region(other, REGION, "rft", solves=100, workers=0).swimmer
    rng = np.random.default_rng(0)
    many = {name: rng.uniform(*bounds, DESIGNS) for name, bounds in REGION.items()}
    out = {}
    for what, run, calls, each in (
        ("gait", velocity, 100, 1),
        ("batch", lambda s: ms.evaluate(s, many), 1, DESIGNS),
    ):
        swimmers = {"plain": usual, "plain, Gray and Hancock": plain, "calibrated": fitted}
        times = {k: 1e6 * least(lambda: run(s), 9, calls) / each for k, s in swimmers.items()}  # noqa: B023
        out[what] = times | {
            "ratio": times["calibrated"] / times["plain"],
            "ratio to Gray and Hancock": times["calibrated"] / times["plain, Gray and Hancock"],
        }
    return out


def atlas(kind):
    """Microseconds per gait and per design of a batch, by the atlas and by plain local drag."""
    known = ms.Swimmer.preset(f"tabak/{kind}")
    one = ms.Swimmer(body=known.body, tail=known.tail, fluid=known.fluid)
    many = everywhere(one)
    rng = np.random.default_rng(0)
    values = {name: rng.uniform(*bounds, DESIGNS) for name, bounds in REGION.items()}
    runs = {
        "gait, plain": (lambda: velocity(known), 100, 1),
        "gait": (lambda: one.gait("atlas").mean_velocity, 100, 1),
        "batch": (lambda: ms.evaluate(many, values), 1, DESIGNS),
    }
    rounds = [
        {name: 1e6 * least(run, 1, calls) / each for name, (run, calls, each) in runs.items()}
        for _ in range(30)
    ]
    found = {name: min(least_of[name] for least_of in rounds) for name in runs}
    found["solves"] = many.region.atlas.about["solves"]
    return {**found, "gait over plain": found["gait"] / found["gait, plain"]}


def calibration(kind):
    """Seconds by the clock of a calibration over the region by 100 boundary-element solves."""
    swimmer = ms.Swimmer.preset(f"tabak/{kind}")
    start = time.perf_counter()
    ms.calibrate_region(swimmer, REGION, "bem", solves=100)
    return time.perf_counter() - start


def main():
    """Measure, print, store."""
    warnings.simplefilter("ignore")
    ms.warm_up()
    kinds = ("helix", "plane_wave")
    results = {kind: measured(kind) for kind in kinds}
    for kind, parts in results.items():
        for what, t in parts.items():
            shown = ", ".join(f"{name} {value:.2f}" for name, value in t.items())
            print(f"{kind}, {what}: {shown}")
    shipped = {kind: atlas(kind) for kind in kinds}
    print("by the atlas:", shipped)
    seconds = {kind: calibration(kind) for kind in kinds}
    print("seconds of 100 solves and the fit:", seconds)
    results["by the atlas"] = shipped
    keep("region", {**results, "seconds of 100 solves and the fit, all cores": seconds})


if __name__ == "__main__":
    main()
