"""Boundaries that are made up: what they add to R grows towards contact, and nothing is solved.

For laws that hold whatever was solved: of paths, of steps, of what is exported.
"""

from dataclasses import replace

import numpy as np

import microswim as ms
from microswim.calibration.poses import fit, layout, scattered, tube
from microswim.calibration.poses import lines as tube_lines
from microswim.calibration.poses.solved import SolvedPoses, power_of
from microswim.calibration.poses.wall import start_of
from microswim.gait.poses import beside_wall, in_tube
from microswim.gait.poses.table import TUBE, WALL, PoseTable
from microswim.gait.stepping import pack

RADIUS = 1.5
ADDED = np.zeros(28)
ADDED[:6] = -0.9, -0.3, -0.3, -0.3, -0.3, -0.3  # to log D, times xi, which is negative
ADDED[[6, 12]] = 0.05, -0.05
ADDED[27] = -0.2


def beside(swimmer, distance=1.0):
    """A gait at every pose beside the made-up wall."""
    shape = layout.shape_of(swimmer, 0.01)
    lowest = float(shape.numbers[beside_wall.LOWEST])
    values = np.empty((2, 6, 5, 5, 28))
    for i in range(6):
        values[:, i] = lowest * (1 - i / 5) * ADDED
    gait = replace(swimmer, wall=None).gait()
    numbers = shape.numbers.copy()
    numbers[beside_wall.POWER] = power_of(gait)
    table = PoseTable(
        WALL, pack(gait), np.array([0.0, 0, 0, 0, 0, 1]), numbers, shape.body, shape.tail,
        shape.kinks, fit.coefficients(values), switch=shape.switch,
    )  # fmt: skip
    start = start_of(swimmer.wall or ms.Wall(distance))
    return SolvedPoses(gait, table, start, {})


def inside(swimmer, adds=0.4, radius=RADIUS):
    """A gait at every pose in the made-up tube: the nearer, the harder to move."""
    shape = tube.in_a_tube(swimmer, 0.02)
    numbers = tube.numbers_of(shape, 0.02)
    _, Z = tube_lines.places(shape, numbers, radius, 40, 200)
    Y = np.zeros((len(Z), 46))
    for m, (i, j) in enumerate(zip(*np.tril_indices(6), strict=True)):
        Y[:, m] = -adds * Z[:, 8:10].sum(axis=1) if i == j else 0.0
    known, (L, rest, carried) = scattered.known_of_each(Z, Y[:, :21], Y[:, 21:28], Y[:, 28:])
    gait = replace(swimmer, channel=None).gait()
    root = tube.root_of(gait)
    root[in_tube.SHARED] = 1.0
    table = PoseTable(
        TUBE, pack(gait), np.array([0.0, 0, 0, 1, 0, 0, radius]), numbers, shape.body, shape.tail,
        np.zeros(0), np.zeros((0, 0, 0, 0, 0)), known, np.concatenate([L, rest]), carried, root,
    )  # fmt: skip
    return SolvedPoses(gait, table, tube.start_of(swimmer), {})
