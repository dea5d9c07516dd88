"""Picture of a robot led along a path: where it went, how far off it was, and the currents."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.gait.units import unit
from microswim.output.plots.style import (
    BLACK,
    BLUE,
    CYCLE,
    WIDE,
    blank,
    few_ticks,
    letter,
    look,
    readable,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_LINES = 16  #: currents that are drawn


def led(found: Any, path: Any, units: str) -> Figure:
    """Return the figure of a robot led along a path.

    Parameters
    ----------
    found
        What `microswim.control.led.led` gives.
    path
        Corners (k, 3).
    units
        Of the swimmer.
    """
    length = unit(units, "length")
    factor = readable(np.concatenate([path, found.position]), "x", length)[0]
    per, label_t = readable(found.time, "time", unit(units, "time"))
    with look():
        figure = blank(WIDE, 3.6)
        grid = figure.add_gridspec(2, 3, width_ratios=[1.0, 1.0, 1.2])
        above, side = (figure.add_subplot(grid[:, i]) for i in (0, 1))
        off, sent = (figure.add_subplot(grid[i, 2]) for i in (0, 1))
        for axes, (i, j), name in ((above, (0, 1), "a"), (side, (0, 2), "b")):
            axes.plot(*(factor * path[:, [i, j]]).T, "--", color=BLACK, linewidth=0.8)
            axes.plot(*(factor * found.position[:, [i, j]]).T, color=BLUE, linewidth=0.8)
            for k, which in ((i, "x"), (j, "y")):
                axes.set(**{f"{which}label": readable(path, "xyz"[k], length)[1]})
            axes.set_aspect("equal", adjustable="datalim")
            few_ticks(axes, 4)
            letter(axes, name)
        scale, label = readable(found.off, "off the path", length)
        off.plot(per * found.time, scale * found.off, color=BLUE)
        off.set(xlabel=label_t, ylabel=label, ylim=(0.0, None))
        _sent(sent, found, per, units)
        sent.set(xlabel=label_t)
        letter(off, "c")
        letter(sent, "d")
    return figure


def _sent(axes: Any, found: Any, per: float, units: str) -> None:
    """Currents of the coils, or the field without them, over the first turns."""
    sent = found.field if found.currents is None else found.currents[:, :MOST_LINES]
    measured = unit(units, "field") if found.currents is None else "A"
    name = "field" if found.currents is None else "currents"
    factor, label = readable(sent, name, measured)
    first = min(len(sent), 160)
    for k, values in enumerate(sent[:first].T):
        colour = CYCLE[k % len(CYCLE)]
        label_k = "xyz"[k] if found.currents is None else None
        axes.plot(per * found.time[:first], factor * values, color=colour, lw=0.8, label=label_k)
    axes.set(ylabel=label)
    if found.currents is None:
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.45 * (high - low))  # room for the legend
        axes.legend(ncols=3, loc="upper center")
