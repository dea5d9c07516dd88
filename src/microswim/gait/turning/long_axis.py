"""Along which axis of its frame a body alone is long: a file is drawn along any.

A robot with a tail is long along s. A body alone turns most easily about its long axis; the axis
of the frame next to that one is taken, none where two of the three rotations are as easy.
"""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array

AXES = "sqr"
APART = 1.1  #: how much easier than the next the turning about the long axis is


def long_axis(mobility: Array) -> int:
    """Return the axis of the frame (0, 1, 2) next to the long one; 0 where none stands out.

    Parameters
    ----------
    mobility
        Twist by torque (6, 3) of a robot without force.
    """
    turning = np.real(mobility)[3:]
    values, vectors = np.linalg.eigh((turning + turning.T) / 2.0)
    if values[2] < APART * values[1]:
        return 0
    return int(np.argmax(np.abs(vectors[:, 2])))


def seen_along(axis: int, of: Array) -> Array:
    """Return a vector, a tensor or a mobility (6, 3) in the frame whose first axis is the given.

    Its axes follow one another as before, so that a screw keeps its sense.
    """
    for dimension in range(of.ndim):
        parts = np.split(of, of.shape[dimension] // 3, axis=dimension)
        of = np.concatenate([np.roll(p, -axis, axis=dimension) for p in parts], axis=dimension)
    return of
