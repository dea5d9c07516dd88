"""The regimes of a robot that bends: how a field that turns holds it, frequency by frequency.

The field speeds up from the lowest frequency asked for; where it loses the robot is step-out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from microswim.errors import SpecError
from microswim.gait import doors
from microswim.models.elastic.unsteady.frozen import judged
from microswim.models.elastic.unsteady.held_by_field import SHARP, Held, held_by_field
from microswim.models.elastic.unsteady.numbers import units_of
from microswim.numerics.array import Array
from microswim.path.regime_remarks import turns
from microswim.swimmer.magnetism.applied_field import RotatingField
from microswim.swimmer.swimmer import SURROUNDINGS, Swimmer

CLOSE = 0.01  #: share to which step-out is sought
LOST = (float("nan"),) * 3
Judge = tuple[doors.Model, dict[str, Any]]  #: model and options of what judges the shape


@dataclass(frozen=True, eq=False)
class HeldAt:
    """What a robot that bends does at each frequency, (n,) each; NaN where it slips.

    The torque is that of the model that judges over that of local drag.
    """

    angle: Array
    velocity: Array
    error: Array
    torque: Array
    step_out: float
    at_step_out: float
    remarks: tuple[str, ...]


@threadpool_limits.wrap(limits=1)  # small matrices
def held_at(swimmer: Swimmer, frequencies: Array, judge: Judge | None = None) -> HeldAt:
    """Return how the field holds a robot with an elastic tail, its velocity by another model if one
    judges.

    Raises
    ------
    SpecError
        If a drive moves its tail, nothing about it is magnetic, its field does not turn or it is
        not free.
    MicroswimError
        If its filament bends too sharply.
    """
    _check(swimmer)
    asked: list[float] = frequencies.tolist()
    rows, at, lost, last = np.full((len(frequencies), 4), np.nan), None, None, float("nan")
    for i in np.argsort(frequencies).tolist():
        one = _at(swimmer, asked[i])
        found = held_by_field(one, at)
        if found is None:
            lost = asked[i]
            break
        at, last, rows[i] = found, asked[i], _numbers(one, found, judge)
    step_out, velocity, remarks = float("nan"), float("nan"), _remarks(swimmer)
    if lost is None:
        highest = turns(last, swimmer.units)
        said = f"the field holds it up to {highest}, the highest asked for: step-out lies beyond"
        remarks += (said,)
    elif at is None:
        remarks += ("the field loses it below the lowest frequency asked for",)
    else:
        step_out, velocity = _narrowed(swimmer, at, (last, lost), judge)
        remarks += (f"step-out is sought to {CLOSE:.0%}; beyond it microswim path follows it",)
    angle, along, error, torque = rows.T
    return HeldAt(angle, along, error, torque, step_out, velocity, remarks)


def _check(swimmer: Swimmer) -> None:
    tail: Any = swimmer.tail
    if tail.drive != "none":
        raise SpecError("tail.drive", tail.drive, '"none" where a field turns the robot')
    if swimmer.magnet is None and not tail.is_magnetic:
        raise SpecError("magnet, tail.magnet: missing; give the moment of the body or the tail")
    if not isinstance(swimmer.field, RotatingField):
        kind = "missing" if swimmer.field is None else swimmer.field.kind
        raise SpecError("field.kind", kind, '"rotating"', "its frequency is then asked for here")
    if not all(swimmer.motion.mask):
        raise SpecError("motion.free", " ".join(swimmer.motion.free), '"all" of a robot that bends')


def _at(swimmer: Swimmer, frequency: float) -> Swimmer:
    field: Any = swimmer.field
    turned = replace(field, frequency=float(np.sign(field.frequency) * frequency))
    return replace(swimmer, field=turned)


def _numbers(
    swimmer: Swimmer, found: Held, judge: Judge | None
) -> tuple[float, float, float, float]:
    """Angle, velocity along the field's axis, how well that is known, and share of the torque."""
    units, field = units_of(swimmer), swimmer.field
    sense, along = float(np.sign(field.frequency)), found.along  # type: ignore[union-attr]
    velocity, share = sense * along * units.length / units.time, 1.0
    error = SHARP * abs(velocity)
    if judge is not None:
        model, options = judge
        own, other = judged(swimmer, found, "rft"), judged(swimmer, found, model, **options)
        velocity, T = sense * other.velocity, own.torque
        share = float(other.torque @ T / (T @ T))
    return found.angle, velocity, error, share


def _narrowed(
    swimmer: Swimmer, at: Held, between: tuple[float, float], judge: Judge | None
) -> tuple[float, float]:
    """Step-out between a frequency at which it is held and one at which it is not."""
    low, high = between
    while high / low - 1.0 > CLOSE:
        found = held_by_field(_at(swimmer, (low * high) ** 0.5), at)
        if found is None:
            high = (low * high) ** 0.5
        else:
            at, low = found, (low * high) ** 0.5
    return (low * high) ** 0.5, _numbers(_at(swimmer, low), at, judge)[1]


def _remarks(swimmer: Swimmer) -> tuple[str, ...]:
    around = [name for name in swimmer.parts if name in (*SURROUNDINGS, "gravity", "flow", "noise")]
    unknown = [
        f"the regimes of a robot that bends know no {name}" for name in dict.fromkeys(around)
    ]
    return (*swimmer.remarks_on_drag, *unknown)
