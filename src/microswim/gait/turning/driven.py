"""The quantities of a robot with a magnet in a rotating field: the second part of the one list."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.basis import Basis
from microswim.gait.gait import Gait
from microswim.gait.quantities import Quantity, magnitude, ratio
from microswim.gait.turning.step_out import Drive
from microswim.numerics.plain import plain

_DRIVEN = (
    Quantity(
        "step_out",
        "frequency",
        "largest frequency of the rotating field that the robot follows",
        lambda b: b.fastest[0] / (2.0 * np.pi),
        of_many=False,
    ),
    Quantity(
        "wobbling_onset",
        "frequency",
        "frequency of the rotating field at which tumbling ends",
        lambda b: b.onset / (2.0 * np.pi),
        of_many=False,
    ),
    Quantity(
        "speed_at_step_out",
        "speed",
        "size of the velocity along the field's axis at step-out",
        lambda b: magnitude(b.fastest[1]),
        of_many=False,
    ),
    Quantity(
        "speed_per_turn",
        "length",
        "advance along the field's axis per turn of the field, at step-out",
        lambda b: 2.0 * np.pi * ratio(magnitude(b.fastest[1]), b.fastest[0]),
        of_many=False,
    ),
    Quantity(
        "driven_speed",
        "speed",
        "size of the mean velocity along the field's axis, at the field's own frequency",
        lambda b: magnitude(b.driven_velocity),
        of_many=False,
    ),
)
DRIVEN = {q.name: q for q in _DRIVEN}


def driven(gait: Gait, drive: Drive | None) -> dict[str, Any]:
    """Return every number of a robot in its field; nothing without one, or if it cannot tilt."""
    if drive is None or not all(gait.free[3:]):
        return {}
    basis = Basis(gait, drive=drive)
    return {q.name: plain(np.real(q.of(basis)), nan=True) for q in _DRIVEN}
