"""A swimmer close to one wall of a wide box against the boundary elements beside a plane wall.

The two share neither discretisation nor the way the wall enters (mesh against image system), nor
how place and tilt are said (`Channel` by the swimmer's middle, `Wall` by the body's centre).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.swimmer.geometry.surroundings import Channel, Wall

pytest.importorskip("ngsolve", reason="needs the extra fem")

from microswim.models import fem

pytestmark = [pytest.mark.fem, pytest.mark.slow]

WIDTH = 10.0


def swimmer() -> ms.Swimmer:
    tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=2, radius=0.06)
    return ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0))


@pytest.mark.parametrize("tilt", [0.0, 0.15])
def test_beside_a_wall(tilt):
    """All six mean velocities within 3 % of the largest of their kind (level coarse: 2 %).

    The other walls are ten radii away: on a free swimmer they act with the third power.
    """
    design, distance = swimmer(), 0.8
    middle = 0.5 * (2.0 + 0.06 - 1.0) + 0.5  # of the swimmer, from the body's centre along s
    height = distance + middle * np.sin(tilt)  # nose down: the middle is higher than the body
    channel = Channel(
        diameter=WIDTH, length=WIDTH, shape="box", tilt=tilt,
        position=(0.0, height - 0.5 * WIDTH, 0.0),
    )  # fmt: skip
    held = fem.channel_gait(design, channel=channel, level="coarse", phases=6).mean_velocity
    beside = replace(design, wall=Wall(distance, tilt=tilt)).gait("bem").mean_velocity
    free = design.gait("bem").mean_velocity
    for part in (slice(0, 3), slice(3, 6)):
        size = np.abs(beside[part]).max()
        assert np.abs(beside[part] - free[part]).max() > 0.05 * size  # more than the tolerance
        assert np.abs(held[part] - beside[part]).max() < 0.03 * size, (held, beside, free)
