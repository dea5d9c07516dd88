"""A gait as a function of the pose, compiled: pose and phase in, R, F_p and the gap out.

What `microswim.gait.poses.face` holds as objects stands here as plain arrays, so that the loop that
follows a path may ask it in every step.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.poses.beside_wall import (
    contact,
    free_factors,
    from_factors,
    interpolate,
    place,
)
from microswim.gait.stepping import pack, row
from microswim.numerics.compiled import compiled

FREE, WALL, TUBE = 0, 1, 2  #: kinds of boundary

#: Numbers of scratch that `resist` wants.
WORK = 640


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
    numbers
        Lengths and the like (`beside_wall.NUMBERS`).
    body
        Point (s, rho) of the body's meridian that touches a plane, for equal steps of the angle
        between s and the plane's inward normal, 0 to pi, from the body's centre (n, 2).
    tail
        Centreline at phase 0 from the body's centre (m, 3).
    kinks
        Tilt at which body and tail are equally near to the wall, for equal steps of the tail's
        phase (k,).
    factors
        Coefficients of what the wall adds, see `beside_wall`: side, gap, tilt, harmonic, number.
    """

    kind: int
    packed: np.ndarray
    boundary: np.ndarray
    numbers: np.ndarray
    body: np.ndarray
    tail: np.ndarray
    kinks: np.ndarray
    factors: np.ndarray


def free_table(gait: Gait) -> PoseTable:
    """Return the table of a gait that knows no boundary."""
    nothing, none = np.zeros(0), np.zeros((0, 2))
    packed = np.ascontiguousarray(pack(gait))
    return PoseTable(FREE, packed, nothing, nothing, none, np.zeros((0, 3)), nothing,
                     np.zeros((0, 0, 0, 0, 0)))  # fmt: skip


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
    if table.kind == 1:
        at = work[27:35]
        contact(table.boundary, table.numbers, table.body, table.tail, x, q, phase, touch, at)
        place(table.numbers, table.kinks, touch, phase, at)
        free_factors(table.packed, table.numbers, at, values, work[35:])
        interpolate(table.factors, at, values, work[35:])
        from_factors(table.numbers, touch, values, R, F, work[35:])
        return
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
