"""How far resistive force theory is from boundary elements for bent beats: sperm that circle.

    python benchmarks/accuracy_flagella.py      (two minutes on one core)

The figures of docs/identify.md and of `microswim.calibration.atlas.expected`: 24 flagella on flat
heads, of random bend, wave and size. Relative differences of u_s and of the mean w_r, of the
amplitude of u_q, and of the path's curvature.
"""

import sys
from dataclasses import replace

import numpy as np

import microswim as ms

DESIGNS, SEED = 24, 23
NAMES = ("us", "uq", "or", "path_curvature")
LAWS = {"lighthill": ms.Lighthill(), "gray_hancock": ms.GrayHancock(), "cox": ms.Cox()}


def design(rng):
    """A flagellum of length 1 on a flat head; the wave grows along it, its axis is bent."""
    head = float(np.exp(rng.uniform(np.log(0.04), np.log(0.12))))
    flat = np.array([1.0, rng.uniform(0.4, 0.8), rng.uniform(0.15, 0.5)])
    waves = float(rng.uniform(0.6, 1.6))
    tail = ms.PlaneWaveTail(
        length=1.0, length_measure="arc", waves=waves, ramp=1.0,
        amplitude=float(rng.uniform(0.5, 1.8)) / (2.0 * np.pi * waves),
        radius=float(np.exp(rng.uniform(np.log(0.003), np.log(0.01)))),
        mean_curvature=float(rng.uniform(0.3, 1.5) * rng.choice([-1, 1])),
    )  # fmt: skip
    body = ms.Ellipsoid(semi_axes=tuple(head * flat))
    return ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0))


def numbers(gait):
    """What is compared, of one gait."""
    mean, size = gait.mean_velocity, gait.velocity_amplitude
    return np.array([mean[0], size[1], mean[5], ms.summary(gait)["path_curvature"]])


def main():
    rng, found = np.random.default_rng(SEED), []
    while len(found) < DESIGNS:
        swimmer = design(rng)
        truth = numbers(swimmer.gait("bem", level="coarse"))
        by_law = (replace(swimmer, coefficients=law).gait("rft") for law in LAWS.values())
        found.append([numbers(gait) / truth - 1.0 for gait in by_law])
        print(len(found), np.round(found[-1], 3).tolist(), file=sys.stderr, flush=True)
    for law, off in zip(LAWS, np.moveaxis(found, 1, 0)):
        for name, column in zip(NAMES, off.T):
            ends = f"{column.min():.1%} to {column.max():.1%}"
            print(f"{law:14s}{name:16s}median {np.median(column):.1%}, {ends}")


if __name__ == "__main__":
    main()
