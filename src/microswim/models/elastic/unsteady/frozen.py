"""The shape in which a field holds a robot that bends, as another model sees it.

In the field's axes the shape is at rest, so by the body it turns about s at minus the twirl, a tail
like any other. No force acts; the torque is the magnet's, whatever it is:

    R_FF v + R_FT w + F_p rate = 0,    torque = -(R_TF v + R_TT w + T_p rate)

with the body's rate of turning ``w = Q' Omega + twirl e_s``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from microswim.gait import doors
from microswim.models.elastic.problem import elastic_tail
from microswim.models.elastic.space import AXIS
from microswim.models.elastic.unsteady.held_by_field import Held
from microswim.models.elastic.unsteady.numbers import units_of
from microswim.models.elastic.whirled_tail import turning_tail
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True)
class Judged:
    """What a model says of a shape that turns with the field.

    Parameters
    ----------
    velocity
        Along the field's axis, in the swimmer's units.
    torque
        By the fluid about the body's centre, body frame, (3,).
    """

    velocity: float
    torque: np.ndarray


def judged(swimmer: Swimmer, held: Held, model: doors.Model, **options: Any) -> Judged:
    """Return velocity and torque of the shape in which the field holds a robot, by another model.

    Parameters
    ----------
    swimmer
        With an `ElasticTail` and a field that turns.
    held
        As its field holds it.
    model, options
        As `Swimmer.gait` has them.
    """
    at, _, Q, _ = held.of.seen(0.0, held.state)
    units = units_of(swimmer)
    rate = -held.twirl / units.time
    tail = turning_tail(elastic_tail(swimmer), held.of.rod, at, abs(rate) / (2.0 * np.pi) or 1.0)
    alone = replace(swimmer, tail=tail, hook=None, magnet=None, field=None)
    gait = alone.gait(model, **options)
    R, moved = gait.resistance(0.0), gait.propulsion(0.0) * rate
    spin = (Q.T @ held.turning + held.twirl * AXIS) / units.time
    v = -np.linalg.solve(R[:3, :3], R[:3, 3:] @ spin + moved[:3])
    torque = -(R[3:, :3] @ v + R[3:, 3:] @ spin + moved[3:])
    axis = held.turning / np.linalg.norm(held.turning)
    return Judged(float(axis @ (Q @ v)), torque)
