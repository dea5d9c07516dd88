"""What turns a swimmer from outside: its magnet in its rotating field."""

from __future__ import annotations

from typing import Any

from microswim.gait.step_out import Drive


def drive_of(swimmer: Any) -> Drive | None:
    """Return the drive of a swimmer, None if it has no magnet or no field that rotates."""
    magnet, field = swimmer.magnet, swimmer.field
    if magnet is None or field is None or field.kind != "rotating":
        return None
    sense = -1.0 if field.frequency.real < 0 else 1.0
    return Drive(magnet.vector, field.strength, sense * field.cone)
