"""What a calibrated evaluation costs, against plain resistive force theory.

    python benchmarks/bench_region.py

Corrections over the region of the acceptance from 100 designs, helix and plane wave. Their cost
does not depend on what was learnt, so the reference is the surrogate under another law. Figures
are processor seconds on one core, the least of several runs, both models in turn in this one
run. Results go to benchmarks/results/region.json and, as a table, to the screen.
"""

from __future__ import annotations

import os

for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from clock import least

import microswim as ms

RESULTS = Path(__file__).parent / "results" / "region.json"
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


def main():
    """Measure, print, store."""
    warnings.simplefilter("ignore")
    ms.warm_up()
    results = {kind: measured(kind) for kind in ("helix", "plane_wave")}
    for kind, parts in results.items():
        for what, t in parts.items():
            shown = ", ".join(f"{name} {value:.2f}" for name, value in t.items())
            print(f"{kind}, {what}: {shown}")
    RESULTS.parent.mkdir(exist_ok=True)
    RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
