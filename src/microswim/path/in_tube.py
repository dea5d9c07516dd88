"""What may act in a tube: its flow is Poiseuille's, as wide as the tube and along it."""

from __future__ import annotations

import numpy as np

from microswim.errors import SpecError
from microswim.swimmer.magnetism.applied_field import unit
from microswim.swimmer.surroundings.flow import PoiseuilleFlow
from microswim.swimmer.swimmer import Swimmer


def check(swimmer: Swimmer) -> None:
    """Refuse a flow that does not stand still on the tube's wall.

    Raises
    ------
    SpecError
        One sentence.
    """
    channel, flow = swimmer.channel, swimmer.flow
    if channel is None or flow is None:
        return
    if not isinstance(flow, PoiseuilleFlow):
        raise SpecError("flow.kind", flow.kind, '"poiseuille" in a [channel]')
    axis, centre = unit(flow.axis), np.asarray(flow.centre, float)
    if np.hypot(axis[1], axis[2]) > 1e-9:
        raise SpecError("flow.axis", flow.axis, "along x in a [channel], which is its axis")
    if np.hypot(centre[1], centre[2]) > 1e-9 * channel.diameter:
        raise SpecError("flow.centre", flow.centre, "on the x axis, that of the [channel]")
    if abs(flow.diameter - channel.diameter) > 1e-9 * channel.diameter:
        raise SpecError(
            "flow.diameter", flow.diameter, f"that of the [channel], {channel.diameter}"
        )
