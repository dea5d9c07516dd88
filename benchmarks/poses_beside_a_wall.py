"""How well poses that were not solved are met beside a wall.

`python benchmarks/poses_beside_a_wall.py [UNUSED] [FOLDER] [SEED ...]`: the paper's base case by a
plane, at the poses a path takes. Unused poses lie at random: gaps from 0.05 to 3 body radii,
evenly in their logarithm, tilts within 0.5 rad, any phase; they are solved at level standard. So
many are drawn for each SEED. Solves are kept in FOLDER.
"""

import sys
from dataclasses import replace

import numpy as np
from poses_in_a_tube import ROBOT, SEED, missed, rounded, show, told

import microswim as ms
from microswim.calibration.poses import wall
from microswim.calibration.poses.layout import shape_of
from microswim.numerics.files import cache_folder

NEAREST, FARTHEST, STEEPEST = 0.05, 3.0, 0.5  #: gaps in body radii, tilt in rad


def unused(swimmer, count, seed=SEED):
    """Gap, tilt and phase against the wall (count, 3) at random."""
    u = np.random.default_rng(seed).random((count, 3))
    gap = swimmer.body.radius * NEAREST * (FARTHEST / NEAREST) ** u[:, 0]
    return np.stack([gap, STEEPEST * (2 * u[:, 1] - 1), 2 * np.pi * u[:, 2]], axis=-1)


def main(others="64", folder=None, *seeds):
    folder = cache_folder("poses") if folder is None else folder
    swimmer = replace(ROBOT, wall=ms.Wall(1.0))
    poses = wall.beside_wall(swimmer, folder=folder, workers=0, progress=told)
    print("left out, level standard (95 %):", rounded(poses.expected_error))
    shape, asked, words = shape_of(swimmer, 1e-3), [], []
    draws = [unused(swimmer, int(others), int(seed)) for seed in seeds or [SEED]]
    for gap, tilt, psi in np.concatenate(draws):
        asked.append(wall.beside(swimmer, shape, gap, tilt, psi))
        words.append(f"gap {gap:.3f} tilt {tilt:+.2f} phase {psi:.2f}")
    show(missed(poses, asked, [wall.start_of(near.wall) for near in asked], folder), words)


if __name__ == "__main__":
    main(*sys.argv[1:])
