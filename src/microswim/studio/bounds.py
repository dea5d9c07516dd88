"""What bounds the fluid, for the scene: the wall or the channel about the body's centre.

Both lie still in the lab frame where the swimmer starts. A swimmer that touches them is refused
here already, by points of its surface, since the surrogate would not notice.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.swimmer.swimmer import Swimmer

PHASES = 24
ALONG = 65


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


def middle(swimmer: Swimmer) -> np.ndarray:
    """Return the channel's middle from the body's centre: the swimmer's middle lies at its
    `position`.
    """
    assert swimmer.channel is not None
    half = float(swimmer.body.semi_axes3[0])
    nose = -half if half else -float(swimmer.tail.radius)
    tip = half + float(swimmer.tail.apparent_length) + float(swimmer.tail.radius)
    own = np.array([0.5 * (nose + tip), 0.0, 0.0])
    return own - swimmer.channel.axes @ np.asarray(swimmer.channel.position)


def check(swimmer: Swimmer) -> None:
    """Refuse a swimmer that reaches into its wall or out of its channel, at any phase.

    Raises
    ------
    SpecError
        One sentence.
    """
    if swimmer.wall is None and swimmer.channel is None:
        return
    body, tail = outline(swimmer)
    thick = float(swimmer.tail.radius)
    if swimmer.wall is not None:
        nearest = tail - thick * np.array(swimmer.wall.normal)
        swimmer.wall.check_clear(np.concatenate([body, nearest]), np.zeros(3))
    elif swimmer.channel is not None:
        points = np.concatenate([body, tail]) - middle(swimmer)
        radii = np.repeat([0.0, thick], [len(body), len(tail)])
        swimmer.channel.check_fits(points @ swimmer.channel.axes, radii)


def outline(swimmer: Swimmer) -> tuple[np.ndarray, np.ndarray]:
    """Return points (n, 3) of the body's surface and of the tail's centreline over the whole
    period.
    """
    s, phase = np.meshgrid(
        np.linspace(0.0, float(swimmer.tail.apparent_length), ALONG),
        2.0 * np.pi * np.arange(PHASES) / PHASES,
    )
    line = swimmer.tail.centreline(s, phase)[0].reshape(-1, 3) - swimmer.body.centre
    return swimmer.body.drawing()[0], line
