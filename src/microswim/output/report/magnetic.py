"""What magnet and field of a spec work out to: moment, B, and how hard it can turn the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from microswim.gait.readable import quantity
from microswim.gait.units import unit

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer


def magnetic(swimmer: Swimmer) -> dict[str, float]:
    """Return size of the moment, of B at the origin and time zero, and the largest torque.

    The torque is ``m B`` of a permanent magnet, half of ``B^2`` times the spread of a soft one's
    moments per field.
    """
    found: dict[str, float] = {}
    magnet, field = swimmer.magnet, swimmer.field
    B = None if field is None else float(np.linalg.norm(field.at(0.0)))
    if magnet is not None and magnet.susceptibility is None:
        found["magnetic_moment"] = float(np.linalg.norm(magnet.vector))
    if B is not None:
        found["field_strength"] = B
    if magnet is not None and B is not None:
        soft = float(np.ptp(np.linalg.eigvalsh(magnet.softness))) * B / 2.0
        found["largest_torque"] = B * found.get("magnetic_moment", soft)
    return found


def rows(swimmer: Swimmer) -> list[tuple[str, str, str]]:
    """Return the rows of a table of these."""
    told = {
        "magnetic_moment": ("magnetic moment", "moment", "fixed in the body"),
        "field_strength": ("field", "field", "size of B at the origin, at the start"),
        "largest_torque": ("largest torque", "torque", "of the field on the magnet"),
    }
    return [
        (told[name][0], quantity(value, unit(swimmer.units, told[name][1])), told[name][2])
        for name, value in magnetic(swimmer).items()
    ]
