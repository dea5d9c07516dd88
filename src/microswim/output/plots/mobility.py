"""The surface of a rigid body with its centre of mobility, to scale."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from microswim import checks
from microswim.models.bem.output import quads_of
from microswim.models.bem.patches.surface import positions
from microswim.output.io.surface import Surface
from microswim.output.plots.drawing import Camera, draw_surface, scale_bar, triad
from microswim.output.plots.style import BLACK, blank, look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from microswim.models.bem.mobility import Mobility


@checks.given(found=partial(checks.instance, kind="Mobility"))
def mobility(found: Mobility) -> Figure:
    """Draw the surface that was solved on, with the centre of mobility as a cross.

    Examples
    --------
    >>> import microswim as ms
    >>> found = ms.mobility(ms.Sphere(radius=1.0), level="coarse")
    >>> ms.plots.mobility(found).axes[0].get_aspect()
    1.0
    """
    side = 4
    points = positions(found.surface, side).reshape(-1, 3)
    quads = quads_of(found.surface.patches, side)
    part = np.repeat(found.surface.on_tail.astype(int), (side - 1) ** 2)
    with look():
        figure = blank(5.2, 3.6)
        axes = figure.subplots()
        camera = Camera.behind(np.eye(3), 30.0, 22.0)
        draw_surface(axes, Surface(points, quads, part), camera)
        x, y, _ = camera.project(found.centre_of_mobility)
        axes.plot([x], [y], marker="+", ms=9, mew=1.6, color=BLACK, zorder=6)
        axes.annotate("centre of mobility", (x, y), (6, 6), textcoords="offset points",
                      fontsize=7, zorder=6)  # fmt: skip
        axes.set_aspect("equal")
        scale_bar(axes, float(np.ptp(points, axis=0).max()), "m" if found.units == "SI" else "")
        triad(axes, camera)
        axes.set_axis_off()
    return figure
