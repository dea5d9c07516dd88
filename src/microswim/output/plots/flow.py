"""The flow in a plane: speed in colours, streamlines, the swimmer's shadow over them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from microswim.gait.units import unit
from microswim.output.plots.style import NARROW, WIDE, blank, look, readable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def cut(
    sides: Mapping[str, np.ndarray],
    velocity: np.ndarray,
    shadow: np.ndarray,
    units: str,
    ax: Axes | None = None,
    decades: float | None = None,
) -> Figure:
    """Draw speed and streamlines in a plane.

    Parameters
    ----------
    sides
        Name and places of the axis across (n,), then of the one up (m,).
    velocity
        Of the fluid, (m, n, 3): across, up, and out of the plane.
    shadow
        Polygons of the swimmer in the plane, (k, corners, 2).
    units
        ``"SI"`` or ``"dimensionless"``.
    ax
        Where to draw; a new figure by default.
    decades
        Of speed that the colours span below the largest, by its logarithm; None: speed itself.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LogNorm

    (across, x), (up, y) = sides.items()
    speed = np.linalg.norm(velocity, axis=-1)
    size, name_x = readable(np.concatenate([x, y]), across, unit(units, "length"))
    name_y = name_x.replace(across, up, 1)
    rate, colours = readable(speed, "speed", unit(units, "speed"))
    x, y, shadow = size * x, size * y, size * shadow
    with look():
        axes = blank(WIDE, NARROW).subplots() if ax is None else ax
        shown, norm = rate * speed, None
        if decades is not None:
            norm = LogNorm(float(shown.max()) * 10.0**-decades, float(shown.max()))
        filled = axes.pcolormesh(
            x, y, shown, shading="gouraud", rasterized=True, cmap="viridis", norm=norm
        )
        u, v = velocity[..., 0], velocity[..., 1]
        axes.streamplot(x, y, u, v, color="w", linewidth=0.6, density=1.1, arrowsize=0.7)
        axes.figure.colorbar(filled, ax=axes, label=colours)
        grey = {"facecolor": "0.75", "edgecolor": "0.75", "linewidth": 0.3}
        axes.add_collection(PolyCollection(list(shadow), zorder=3, rasterized=True, **grey))
        axes.set(xlabel=name_x, ylabel=name_y, aspect="equal")
        axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    return axes.figure  # type: ignore[return-value]
