"""Swimmers whose solves are the same: R and F_p know neither the motor's rate nor the last bit.

So a pose that was solved once is found again by a spec that has another frequency or density, holds
other axes, or gives the same length in other units ("1.25 um" is 1.2499999999999999e-06 m).
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from microswim.gait.gait import Gait
from microswim.swimmer.motion import Motion
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.swimmer import Swimmer

DIGITS = 12  #: that count of a number of the spec


def to_digits(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer with the numbers of body, tail, fluid and channel to `DIGITS` digits."""
    parts = ("body", "tail", "fluid", "channel")
    return replace(swimmer, **{name: _rounded(getattr(swimmer, name)) for name in parts})


def _rounded(part: Any) -> Any:
    """A part with its fields rounded; itself where there is nothing to round."""
    if part is None:
        return None
    found = {f.name: getattr(part, f.name) for f in fields(part) if f.init}
    short = {name: _short(value) for name, value in found.items()}
    return replace(part, **short) if repr(short) != repr(found) else part


def _short(value: Any) -> Any:
    if type(value) in (tuple, list):
        return type(value)(_short(v) for v in value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value
    return float(f"{value:.{DIGITS}g}")


def as_solved(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer without what R and F_p do not depend on."""
    tail: Any = swimmer.tail
    if any(f.name == "frequency" for f in fields(tail)):
        tail = replace(tail, frequency=1.0)
    fluid = Fluid(viscosity=swimmer.fluid.viscosity)
    return replace(swimmer, tail=tail, fluid=fluid, motion=Motion())


def of(gait: Gait, swimmer: Swimmer) -> Gait:
    """Return the gait of `as_solved(swimmer)` with the swimmer's own rate, free axes and units."""
    tail, motion = swimmer.tail, swimmer.motion
    own = replace(gait, rate=float(tail.rate), free=motion.mask, units=swimmer.units)
    return own.in_lab_frame(tail.rate, tail.sign) if motion.frequency_frame == "lab" else own
