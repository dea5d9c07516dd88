"""What is said of a magnet on a swimmer whose rotations are held."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.errors import warn
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait


class HeldWarning(UserWarning):
    """A field would turn the swimmer about axes that ``motion.free`` holds."""


def warn_if_held(gait: Gait, moment: Any) -> None:
    """Warn where a magnetic moment acts on a swimmer that cannot turn about all axes."""
    held = [name for name, free in zip(DEGREES_OF_FREEDOM[3:], gait.free[3:]) if not free]
    if held and np.any(moment):
        warn(
            f"motion.free holds {', '.join(held)}: the field turns the magnet, and the swimmer "
            'cannot tilt as a real one does; motion.free = "all" lets it',
            HeldWarning,
            stacklevel=3,
        )
