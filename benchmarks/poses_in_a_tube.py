"""How well poses that were not solved are met in a tube.

`python benchmarks/poses_in_a_tube.py RADIUS [POSES] [UNUSED] [FOLDER] [SEED]`: the paper's base
case (body radius 0.5) in a tube, at most POSES poses, as a path takes them. Unused poses lie at
random in place and direction, their gaps from 0.05 body radii; they are solved at level standard.
Solves are kept in FOLDER.
"""

import sys
from dataclasses import replace

import numpy as np

import microswim as ms
from microswim.calibration.poses import lines as tube_lines
from microswim.calibration.poses import scattered, tube
from microswim.calibration.poses.layout import shape_of
from microswim.calibration.poses.solved import Table, scales
from microswim.gait.poses import in_tube as inside
from microswim.jobs import references
from microswim.models.bem.levels import named
from microswim.numerics.files import cache_folder

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
SEED = 2026  #: of the unused poses
CLOSEST = 0.05  #: smallest gap of the unused poses, in body radii


def unused(swimmer, radius, count, seed=SEED):
    """Lines (count, 6) at random, their gaps (count, 2)."""
    shape = shape_of(swimmer, CLOSEST)
    numbers = tube.numbers_of(shape, CLOSEST)
    lines, _ = tube_lines.places(shape, numbers, radius, count, among=count, seed=seed)
    gaps, Z = np.empty((len(lines), 2)), np.empty((len(lines), inside.FEATURES))
    inside.of_lines(lines, shape.body, shape.tail, numbers, radius, gaps, Z)
    return lines, gaps


def missed(poses, asked, starts, folder):
    """Misses of the six velocities in units of speed and rate of turning in free fluid."""
    truth = references.gaits(
        asked,
        "bem",
        level=replace(named("standard", asked[0]), phases=1, single=True),
        folder=folder,
        workers=0,
    )
    scale = scales(poses.gait)
    found = np.full((len(asked), 6), np.nan)
    for i, (start, gait) in enumerate(zip(starts, truth, strict=True)):
        if isinstance(gait, str):
            print("not solved:", gait)
            continue
        R, F = Table(poses.table).at(*start, 0.0)
        found[i] = (-np.linalg.solve(R, F) - gait.at_rate(1.0).velocity(0.0)) / scale
    return found


def told(done, of):
    """Say now and then how many are solved."""
    if done % 50 == 0:
        print(done, "of", of, file=sys.stderr, flush=True)


def show(off, words):
    """Print each pose in words, median, 95 % and worst, and how many are within 1 %."""
    for text, row in zip(words, off, strict=True):
        print(f"  {text}", np.round(100 * row, 2))
    off = np.abs(off[np.isfinite(off[:, 0])])
    for name, rows in (("median", np.median(off, 0)), ("95 %", np.quantile(off, 0.95, 0)),
                       ("worst", off.max(0))):  # fmt: skip
        print(f"| {name} |", " | ".join(f"{100 * x:.2f} %" for x in rows), "|")
    print(f"{int((off.max(axis=1) < 0.01).sum())} of {len(off)} within 1 % in every velocity")


def rounded(error):
    """What a path tells of its poses, in four digits."""
    return {k: v if k == "how" else round(v, 4) for k, v in error.items()}


def main(radius="1.5", count="600", others="64", folder=None, seed=SEED):
    radius = float(radius)
    folder = cache_folder("poses") if folder is None else folder
    swimmer = replace(ROBOT, channel=ms.Channel(diameter=2 * radius, length=30.0))

    poses = tube.in_tube(
        swimmer,
        scatter=scattered.Scatter(poses=int(count)),
        folder=folder,
        workers=0,
        progress=told,
    )
    used = poses.table.known.shape[2]
    print(f"radius {radius}, {used} poses; left out, level standard (95 %):")
    print("  ", rounded(poses.expected_error))
    lines, gaps = unused(swimmer, radius, int(others), int(seed))
    tilts = np.degrees(np.arccos(np.abs(lines[:, 0])))
    words = [f"tilt {tilt:5.1f} gaps {a:.3f} {b:.3f}" for tilt, (a, b) in zip(tilts, gaps)]
    free = replace(swimmer, channel=None)
    asked = [tube.beside(free, radius, line) for line in lines]
    show(missed(poses, asked, [tube.start_of(near) for near in asked], folder), words)


if __name__ == "__main__":
    main(*sys.argv[1:])
