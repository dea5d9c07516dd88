"""Pictures of filmed cells: the track with its averaged path, and its mean squared displacement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.gait.readable import label, prefixed
from microswim.output.plots.style import BLUE, GREY, ORANGE, WIDE, blank, few_ticks, look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def cell(track: np.ndarray, found: Any, unit: str, time: str) -> Figure:
    """Draw a track with the path without its wobble, and its mean squared displacement.

    Parameters
    ----------
    track
        Positions, (n, 2) or (n, 3).
    found
        What `describe_track` found.
    unit, time
        ``"m"`` and ``"s"``, or empty for numbers without units.

    Returns
    -------
    matplotlib.figure.Figure
        In 3-D the view along z.
    """
    with look():
        figure = blank(WIDE, 3.0)
        left, right = figure.subplots(1, 2)
        _path(left, track[:, :2], found.path[:, :2], unit)
        _displacement(right, found, unit, time)
        figure.suptitle(f"track {found.name}", fontsize=8, x=0.02, ha="left")
        return figure


def _path(axes: Axes, track: np.ndarray, path: np.ndarray, unit: str) -> None:
    start = track[0]
    factor, shown = prefixed(float(np.abs(track - start).max()), unit)
    axes.plot(*(factor * (track - start)).T, ".", color=GREY, ms=2.5, label="track")
    axes.plot(*(factor * (path - start)).T, color=ORANGE, lw=1.2, label="without wobble")
    axes.set(aspect="equal", adjustable="datalim")
    axes.set(**{f"{x}label": label(f"{x} from the start", shown) for x in "xy"})
    few_ticks(axes, 4)
    axes.legend(loc="best")


def _displacement(axes: Axes, found: Any, unit: str, time: str) -> None:
    lag, (value, low, high) = found.lag, found.displacement.T
    factor, shown = prefixed(float(np.sqrt(np.nanmax(value, initial=0.0))), unit)
    bounded = np.isfinite(high)
    axes.fill_between(
        lag[bounded],
        factor**2 * np.maximum(low, 1e-3 * value)[bounded],
        factor**2 * high[bounded],
        color=BLUE,
        alpha=0.25,
        lw=0,
        label="95 %",
    )
    axes.plot(lag, factor**2 * value, "o-", color=BLUE, ms=2.5, lw=0.8)
    axes.set(xscale="log", yscale="log", xlabel=label("time apart", time))
    axes.set(ylabel=label("mean squared displacement", f"{shown}²" if shown else ""))
    axes.legend(loc="upper left")
