"""What turns a swimmer from outside: its magnet in its rotating field."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.turning.step_out import Drive


def drive_of(swimmer: Any) -> Drive | None:
    """Return the drive of a swimmer, None if it has no magnet or no field that rotates.

    None also of one whose tail bends as it turns: `microswim.regimes` asks how that one is held.
    """
    magnet, field = swimmer.magnet, swimmer.field
    if magnet is None or field is None or field.kind != "rotating" or swimmer.tail.settles:
        return None
    sense = -1.0 if field.frequency.real < 0 else 1.0
    return Drive(
        magnet.vector,
        field.strength,
        sense * field.cone,
        2.0 * np.pi * sense * field.frequency,
        None if magnet.susceptibility is None else magnet.softness,
    )


def check_units(swimmer: Any) -> None:
    """Refuse a magnet or a field that only SI knows, on a swimmer without units."""
    magnet, field = swimmer.magnet, swimmer.field
    if swimmer.units == "SI":
        return
    if magnet is not None and magnet.moment is None:
        way = "remanence" if magnet.susceptibility is None else "susceptibility"
        raise SpecError(f"magnet.{way}: for a swimmer in SI; without units give the moment")
    if field is not None:
        check_field_units(field, swimmer.units)


def check_field_units(field: Any, units: str) -> None:
    """Refuse a field that only SI knows, of swimmers without units."""
    if field.needs_si and units != "SI":
        raise SpecError("field.kind", field.kind, '"rotating" or "uniform" without units')
