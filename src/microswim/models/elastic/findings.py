"""What there is to say of the motion to which an elastic tail settles, whichever it is."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from microswim.models.elastic.beat import Beat, drive
from microswim.models.elastic.growth import NEUTRAL, multiplier
from microswim.models.elastic.stroke import Stroke
from microswim.models.elastic.whirl import Whirl
from microswim.numerics.series.fourier import evaluate, series_of

TURNED = 1e-6  #: of a turn, from which on a disturbance comes back to its side later
OFTEN = 65  #: phases at which the tip is looked for where it is farthest out


def of_beat(beat: Beat) -> dict[str, Any]:
    """Return the numbers of a beat in the plane: see `microswim.models.elastic.gait.gait`."""
    rod, q = beat.rod, np.real(beat.shape)
    base = drive(beat.problem, beat.phases)
    heading = np.real(base.angle[:, None] + rod.tilt + q @ rod.shapes.T)
    often = np.linspace(0.0, 2.0 * np.pi, OFTEN)
    tip = beat.over_period(np.real(base.place) + np.sin(heading) @ rod.along[-1])
    return {
        "sperm_number": beat.problem.sperm_number,
        "unknowns": int(np.size(q) + np.size(beat.velocity)),
        "newton_steps": beat.steps,
        **_settling(multiplier(beat)),
        "tip_amplitude": float(np.ptp(evaluate(series_of(tip), often))) / 2.0,
        "largest_curvature": float(np.abs(q @ rod.curvatures.T).max()),
    }


def of_stroke(beat: Stroke) -> dict[str, Any]:
    """Return the same of a beat in space."""
    shape, rod = np.real(beat.shape), beat.of.rod
    at, _, _, moved = beat.of.seen(beat.times, beat.state(shape))
    bends = rod.curvatures @ np.swapaxes(shape.reshape(len(shape), 3, -1), -1, -2)
    often = np.linspace(0.0, 2.0 * np.pi, OFTEN)
    tip = evaluate(series_of(at.place[:, -1] + moved.place), often)[:, 1:]
    return {
        "sperm_number": float(np.real(beat.of.drag.normal) ** 0.25),
        "unknowns": int(shape.size + np.size(beat.velocity)),
        "newton_steps": beat.steps,
        **_settling(beat.multiplier),
        "tip_amplitude": float(np.linalg.norm(np.ptp(tip, axis=0))) / 2.0,
        "largest_curvature": float(np.hypot(bends[..., 0], bends[..., 1]).max()),
    }


def of_whirl(found: Whirl) -> dict[str, Any]:
    """Return the same of a shape that turns as a whole."""
    place, strain = np.real(found.pose.place), np.real(found.shape) @ found.rod.curvatures.T
    return {
        "sperm_number": float(np.real(found.drag.normal) ** 0.25),
        "unknowns": int(found.shape.size + len(found.drag.free)),
        "newton_steps": found.steps,
        **_settling(found.growth),
        "tip_amplitude": float(np.hypot(*place[-1, 1:])),
        "largest_curvature": float(np.hypot(*strain[:2]).max()),
    }


def _settling(factor: complex) -> dict[str, Any]:
    size = abs(factor)
    periods = None  # until a disturbance is a millionth of itself; None if it never is
    if size < 1.0 - NEUTRAL:
        periods = math.log(1e-6) / math.log(size) if size > 0.0 else 0.0
    settles = bool(size <= 1.0 + NEUTRAL)
    told = {"growth": size, "settles": settles, "settling_periods": periods}
    return told | ({} if settles else {"leaves": leaving(factor)})


def leaving(factor: complex) -> str:
    """Return how a motion is left whose slowest disturbance changes by this factor in a period."""
    turn = abs(math.atan2(factor.imag, factor.real)) / (2.0 * math.pi)
    if turn < TURNED:
        return "to one side"
    if turn > 0.5 - TURNED:
        return "period-doubles"
    return f"turns once in {1.0 / turn:.3g} periods"
