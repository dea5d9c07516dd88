"""Whether a swimmer is clear of its wall and within its channel, for models that would not notice.

By points of its surface, which lie in the wall only if it does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer

PHASES = 24
ALONG = 65


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

    Of a tail that bends only the body is looked at: where the tail goes is solved later.

    Raises
    ------
    SpecError
        One sentence.
    """
    if swimmer.wall is None and swimmer.channel is None:
        return
    points, radii = outline(swimmer)
    if swimmer.wall is not None:
        nearest = points - radii[:, None] * np.array(swimmer.wall.normal)
        swimmer.wall.check_clear(nearest, np.zeros(3))
    elif swimmer.channel is not None:
        within = (points - middle(swimmer)) @ swimmer.channel.axes
        swimmer.channel.check_fits(within, radii)


def outline(swimmer: Swimmer) -> tuple[np.ndarray, np.ndarray]:
    """Return points (n, 3) from the body's centre and the swimmer's thickness about each (n,).

    Of the body's surface, and of each tail's centreline over the whole period.
    """
    surface = swimmer.body.drawing()[0]
    points, radii = [surface], [np.zeros(len(surface))]
    tail = swimmer.tail
    for one in [] if tail.is_absent or tail.settles else tail.each:
        own = one.own
        s, phase = np.meshgrid(
            np.linspace(0.0, float(own.apparent_length), ALONG),
            2.0 * np.pi * np.arange(PHASES) / PHASES,
        )
        line = own.centreline(s, phase)[0].reshape(-1, 3) @ np.asarray(one.placement.rotation).T
        points.append(line + one.placement.root - swimmer.body.centre)
        radii.append(np.full(len(line), float(own.radius)))
    return np.concatenate(points), np.concatenate(radii)
