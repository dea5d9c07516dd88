"""Whether the parts of a swimmer fit together; each part has checked itself before."""

from __future__ import annotations

from typing import Any

from microswim.errors import SpecError
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.magnetism.drive import check_units


def check(swimmer: Any) -> None:
    """Refuse parts that contradict one another, or units in which one of them means nothing.

    Raises
    ------
    SpecError
        One sentence.
    """
    if swimmer.wall is not None and swimmer.channel is not None:
        raise SpecError("wall, channel: one of them bounds the fluid; remove the other")
    if swimmer.body.is_absent and swimmer.tail.is_absent:
        raise SpecError(
            'tail.kind = "none": a swimmer needs a body or a tail; give it one of the two'
        )
    _check_region(swimmer)
    check_units(swimmer)
    if swimmer.gravity is not None:
        swimmer.gravity.check_units(swimmer.units, swimmer.fluid.density)
    if swimmer.motion.frequency_frame == "lab" and swimmer.tail.surface_motion != "rigid":
        allowed = '"body" for a tail that does not rotate rigidly'
        raise SpecError("motion.frequency_frame", "lab", allowed)
    if swimmer.motion.frequency_frame == "lab" and not swimmer.tail.is_on_axis:
        allowed = '"body" for tails off the axis s: the body turns about s, the tail does not'
        raise SpecError("motion.frequency_frame", "lab", allowed)


def _check_region(swimmer: Any) -> None:
    region = swimmer.region
    if region is None:
        return
    if not callable(getattr(region, "gait", None)):
        raise SpecError("region", region, "a region calibration", "see calibrate_region")
    if not (swimmer.coefficients.is_usual and swimmer.interaction == Interaction()):
        raise SpecError(
            "region: corrections over a region take the place of the law of local resistance "
            "and of interaction coefficients; leave out [coefficients] and [interaction], or "
            "[region]"
        )
