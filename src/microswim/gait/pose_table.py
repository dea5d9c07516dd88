"""A gait as a function of the pose, compiled: pose and phase in, R, F_p and the gap out.

What `microswim.gait.poses` holds as objects stands here as plain arrays, so that the loop that
follows a path may ask it in every step.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.stepping import pack, row
from microswim.numerics.compiled import compiled

FREE, WALL, TUBE = 0, 1, 2  #: kinds of boundary

#: Numbers of scratch that `resist` wants.
WORK = 256


class PoseTable(NamedTuple):
    """Arrays of a gait as a function of the pose.

    Parameters
    ----------
    kind
        `FREE`, `WALL` or `TUBE`.
    packed
        Series of R (lower triangle) and F_p in free fluid (1 + 2 H, 27), as `stepping.pack` has it.
    boundary
        Lab frame: a point of the wall and its normal into the fluid (6,); a point of the tube's
        axis, its direction and its radius (7,); empty in free fluid.
    """

    kind: int
    packed: np.ndarray
    boundary: np.ndarray


def free_table(gait: Gait) -> PoseTable:
    """Return the table of a gait that knows no boundary."""
    return PoseTable(FREE, np.ascontiguousarray(pack(gait)), np.zeros(0))


@compiled()
def resist(table: Any, x: Any, q: Any, phase: Any, R: Any, F: Any, touch: Any, work: Any) -> None:
    """Write R (6, 6) and F_p (6,) of a pose, body frame, and what is nearest to the boundary.

    Parameters
    ----------
    table
        A `PoseTable`.
    x, q, phase
        Position (3,) of the body's centre, lab; quaternion (4,), ``wxyz``, body to lab; phase of
        the tail (rad).
    R, F
        Written: symmetric positive definite (6, 6); per unit phase rate (6,).
    touch
        Written (7,): the gap, that is the smallest distance from the surface to the boundary,
        negative where it reaches into it, infinite in free fluid; the surface's nearest point, body
        frame, from the body's centre; the boundary's unit normal into the fluid there, body frame.
    work
        Scratch of `WORK` numbers.
    """
    values = work[:27]
    row(table.packed, phase, values)
    touch[0] = np.inf
    for i in range(1, 7):
        touch[i] = 0.0
    m = 0
    for i in range(6):
        F[i] = values[21 + i]
        for j in range(i + 1):
            R[i, j] = values[m]
            R[j, i] = values[m]
            m += 1
