"""How long a swimmer is."""

from __future__ import annotations

from typing import Any


def nose_to_tip(swimmer: Any) -> Any:
    """Return the length of a swimmer along s, from its body's nose to the tip of its tail at the
    joint; its numbers may be complex.
    """
    return 2.0 * swimmer.body.semi_axes3[0] + swimmer.tail.apparent_length
