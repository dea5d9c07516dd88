"""Tumbles: turns on the spot, at random times, about random axes across s.

Their number in a time dt is Poisson's, ``dt / run_time`` in the mean; each turns the heading by the
same angle, so that ``<u(0) u(t)> = exp(-t (1 - cos a) / run_time)``.
"""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply


def tumbled(quaternion: Array, expected: float, angle: float, random: np.random.Generator) -> Array:
    """Return attitudes (n, 4) after the tumbles of a time.

    Parameters
    ----------
    quaternion
        Attitudes ``wxyz`` before.
    expected
        Mean number of tumbles in that time.
    angle
        By which each turns the axis s (rad).
    random
        Where the random numbers come from.
    """
    out, left = np.array(quaternion), random.poisson(expected, len(quaternion))
    while (left > 0).any():
        here = np.flatnonzero(left > 0)
        about = 2.0 * np.pi * random.random(here.size)
        sine = np.sin(angle / 2.0)
        turn = np.stack(
            [np.full(here.size, np.cos(angle / 2.0)), np.zeros(here.size),
             sine * np.cos(about), sine * np.sin(about)], axis=-1,
        )  # fmt: skip
        out[here] = multiply(out[here], turn)
        left[here] -= 1
    return out
