"""What bounds the fluid, for the scene: the wall or the channel about the body's centre.

Both lie still in the lab frame where the swimmer starts.
"""

from __future__ import annotations

from typing import Any

from microswim.swimmer.surroundings.clearance import middle
from microswim.swimmer.swimmer import Swimmer


def scene(swimmer: Swimmer) -> dict[str, Any] | None:
    """Return the pose and size of the wall or the channel, from the body's centre, in its axes; or
    nothing.
    """
    if swimmer.wall is not None:
        wall = swimmer.wall
        return {"kind": "wall", "distance": float(wall.distance), "normal": list(wall.normal)}
    if swimmer.channel is not None:
        channel = swimmer.channel
        return {
            "kind": channel.shape,
            "diameter": float(channel.diameter),
            "length": float(channel.length),
            "middle": [float(x) for x in middle(swimmer)],
            "tilt": float(channel.tilt),
            "azimuth": float(channel.azimuth),
            "open": channel.ends == "open",
        }
    return None
