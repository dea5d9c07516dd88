"""One picture of a thing at hand: behind ``gait.plot()`` and ``swimmer.plot()``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from microswim.gait.gait import Gait
from microswim.output.io.run import dataset, over_the_period
from microswim.output.plots.run import trajectory, velocity
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def of_gait(gait: Gait) -> Figure:
    """Return the figure of velocity, body rate and motor power over a period."""
    return velocity(over_the_period(gait))


def of_swimmer(swimmer: Swimmer) -> Figure:
    """Return the figure of the swimmer to scale and its path by the model that serves it."""
    return trajectory(dataset(swimmer, swimmer.gait("auto")), swimmer.settled)
