"""A gait as a function of the pose, compiled: pose and phase in, R, F_p and the gap out.

What `microswim.gait.poses.face` holds as objects stands here as plain arrays, so that the loop that
follows a path may ask it in every step.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.poses import any_shape
from microswim.gait.poses.beside_wall import (
    POWER,
    SIGN,
    contact,
    free_factors,
    from_factors,
    interpolate,
    place,
)
from microswim.gait.poses.in_tube import (
    between,
    both,
    features,
    from_logarithm,
    from_power,
    out_of_the_tail,
    turned,
)
from microswim.gait.poses.lubricated import continued
from microswim.gait.poses.tail_near_tube import near_tail
from microswim.gait.poses.tube_contact import nearer_first, touch_tube
from microswim.gait.stepping import pack, row
from microswim.numerics.compiling.compiled import compiled

FREE, WALL, TUBE = 0, 1, 2  #: kinds of boundary

#: Numbers of scratch that `resist` wants; poses at most that are known in a tube.
WORK, MOST = 2400, 1600
_NONE = np.zeros((0, 0))
_NEITHER = np.zeros((2, 0, 0))
_NOWHERE = np.zeros(0)


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
        Coefficients of what the wall adds, see `beside_wall`: side, gap, tilt, turn, number.
    known, weights, carried, root
        Of a tube, see `in_tube`: poses solved in units of the lengths over which L changes, of
        those over which F_p does, and of those of what a flow does; weights of what is interpolated
        between them and of how Poiseuille's flow carries the swimmer; free fluid.
        Of a wall beside a swimmer of any shape, see `any_shape`: the same, and the series of the
        motor's power in free fluid; the centreline is a series in the phase (m, 3 + 6 H), the body
        as `any_shape.support` has it.
    switch
        By a wall: phase at which the tail's nearest turn changes, see `beside_wall.switched`.
    """

    kind: int
    packed: np.ndarray
    boundary: np.ndarray
    numbers: np.ndarray
    body: np.ndarray
    tail: np.ndarray
    kinks: np.ndarray
    factors: np.ndarray
    known: np.ndarray = _NEITHER
    weights: np.ndarray = _NONE
    carried: np.ndarray = _NONE
    root: np.ndarray = _NONE
    switch: np.ndarray = _NOWHERE


def free_table(gait: Gait) -> PoseTable:
    """Return the table of a gait that knows no boundary."""
    nothing, none = np.zeros(0), np.zeros((0, 2))
    packed = np.ascontiguousarray(pack(gait))
    return PoseTable(FREE, packed, nothing, nothing, none, np.zeros((0, 3)), nothing,
                     np.zeros((0, 0, 0, 0, 0)))  # fmt: skip


@compiled()
def near(table: Any, x: Any, q: Any, phase: Any, touch: Any, work: Any) -> Any:
    """Write what of body and of tail is nearest to the boundary, as `resist`; return the gap.

    The scratch holds what `resist` goes on from.
    """
    if table.kind == 2:
        touch_tube(
            table.boundary, table.numbers, table.body, table.tail, x, q, phase, work[28:34], touch,
            work[54:],
        )  # fmt: skip
    elif table.kind == 1 and table.known.shape[1] > 0:
        any_shape.contact(
            table.boundary, table.numbers, table.body, table.tail, x, q, phase, touch, work[28:33]
        )
    elif table.kind == 1:
        contact(
            table.boundary, table.numbers, table.body, table.tail, x, q, phase, touch, work[28:36]
        )
    else:
        for i in range(14):
            touch[i] = 0.0
        touch[0] = touch[7] = np.inf
    return min(touch[0], touch[7])


@compiled()
def resist(table: Any, x: Any, q: Any, phase: Any, R: Any, F: Any, touch: Any, work: Any) -> Any:
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
        Written (14,): the gap, that is the smallest distance from the surface to the boundary,
        negative where it reaches into it, infinite in free fluid; the moment about the body's
        centre of the boundary's normal into the fluid where the surface is nearest, and that
        normal, body frame: the wrench of a unit force there (means of both where several points of
        a body in a tube are near, see `rings`). Then the same of the part, body or tail, that is
        further away.
    work
        Scratch of `WORK` numbers.

    Returns
    -------
    float
        Power of the motor per squared rate while the body is held; 0 where the table does not know
        it, as in free fluid: the gait itself has that.
    """
    values = work[:28]
    near(table, x, q, phase, touch, work)
    if table.kind == 2:
        line, z = work[28:34], work[34:54]
        parts = table.body, table.tail
        features(line, touch[0], touch[7], parts, table.numbers, table.boundary[6], z)
        both(table.known, table.weights, z, values, work[54:])
        from_logarithm(table.root, values, R, F, work[54:])
        share = table.root[7, 1]
        near_tail(line, table.tail, table.numbers, table.boundary[6], share, R, F, work[54:])
        power = from_power(table.root, values, R, F, work[54:])
        power += continued(table.numbers, touch, R, F, work[54:])
        nearer_first(touch)
        out_of_the_tail(table.numbers[SIGN] * phase, R, F, touch)
        return power
    if table.kind == 1 and table.known.shape[1] > 0:
        return _of_any_shape(table, phase, R, F, touch, work)
    if table.kind == 1:
        at = work[28:36]
        values[27] = 0.0
        place(table.numbers, table.kinks, table.switch, touch, phase, at)
        free_factors(table.packed, table.numbers, at, values, work[36:])
        interpolate(table.factors, at, values, work[36:])
        moved = from_factors(table.numbers, touch, values, R, F, work[36:])
        moved += continued(table.numbers, touch, R, F, work[36:])
        nearer_first(touch)
        free = table.numbers[POWER]
        return moved + free * np.exp(values[27]) if free > 0.0 else 0.0
    row(table.packed, phase, values[:27])
    m = 0
    for i in range(6):
        F[i] = values[21 + i]
        for j in range(i + 1):
            R[i, j] = values[m]
            R[j, i] = values[m]
            m += 1
    return 0.0


@compiled()
def _of_any_shape(table: Any, phase: Any, R: Any, F: Any, touch: Any, work: Any) -> Any:
    """Write R and F_p of a swimmer of any shape beside a wall, after `near`; return G."""
    values, at, n, signs, z = work[:28], work[28:33], work[33:36], work[36:42], work[42:54]
    for i in range(3):
        n[i] = at[i]
    of_q, of_r, turn = any_shape.folded(table.numbers, n, phase)
    any_shape.signs_of(of_q, of_r, signs)
    h = any_shape.features(n, at[3], turn, touch[0], touch[7], table.tail, table.numbers, z)
    both(table.known, table.weights, z, values, work[54:])
    power = any_shape.from_free(
        table.packed, table.root, turn, values, h, signs, R, F, work[54:]
    )  # fmt: skip
    power += any_shape.nearer(table.numbers, touch, at[4], R, F, work[54:])
    nearer_first(touch)
    return power


@compiled()
def carry(table: Any, x: Any, q: Any, phase: Any, D: Any, work: Any) -> None:
    """Write how Poiseuille's flow of unit speed carries a swimmer in a tube, beyond what it is.

    D (6,), body frame: the velocity of the swimmer that nothing else moves, less the flow and its
    rotation at the body's centre.
    """
    values, line, z, touch = work[:18], work[28:34], work[34:54], work[-14:]
    near(table, x, q, phase, touch, work)
    parts = table.body, table.tail
    features(line, touch[0], touch[7], parts, table.numbers, table.boundary[6], z)
    between(table.known[2], table.carried, z, values, work[54:])
    for i in range(6):  # D t', times t: the same for either sense of the line
        D[i] = 0.0
        for j in range(3):
            D[i] += values[3 * i + j] * line[j]
    turned(table.numbers[SIGN] * phase, D, 0)
    turned(table.numbers[SIGN] * phase, D, 3)
