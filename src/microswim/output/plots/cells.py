"""Pictures of filmed cells: a track with its averaged path and displacement; a beat and its fit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.gait.readable import label, prefixed
from microswim.output.plots.style import BLUE, GREY, ORANGE, WIDE, blank, few_ticks, log_ticks, look

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


def beat(found: Any, unit: str) -> Figure:
    """Draw a filmed beat with its fit, and the modes of its tangent angle along the filament.

    Parameters
    ----------
    found
        What `read_waveform` found.
    unit
        ``"m"``, or empty for numbers without units.

    Returns
    -------
    matplotlib.figure.Figure
        Up to ten frames: points as filmed, lines as fitted.
    """
    with look():
        seen = ("q", "r") if found.modes_out is not None else ("q",)
        figure = blank(WIDE, 3.0)
        *views, right = figure.subplots(1, 1 + len(seen))
        for i, axes in enumerate(views):
            _frames(axes, found, unit, (seen[i], 1 + i))
            title = "points as filmed, lines as fitted" if len(seen) == 1 else f"s and {seen[i]}"
            axes.set_title(title, loc="left")
        _angles(right, found, unit)
        return figure


def _frames(axes: Axes, found: Any, unit: str, across: tuple[str, int]) -> None:
    """Frames along the head and across it; the name and number of that coordinate."""
    name, column = across
    points, angle = found.beat, found.beat.angle is not None
    factor, shown = prefixed(found.length, unit)
    frames = points.frames
    for t in frames[:: max(len(frames) // 10, 1)]:
        here = np.flatnonzero(points.time == t)
        here = here[np.argsort(points.s[here])]
        s = factor * points.s[here]
        filmed, fitted = found.filmed[here], found.fitted[here]
        x, y = (s, filmed[:, 0]) if angle else (factor * filmed[:, [0, column]]).T
        axes.plot(x, y, ".", color=GREY, ms=2.0)
        x, y = (s, fitted[:, 0]) if angle else (factor * fitted[:, [0, column]]).T
        axes.plot(x, y, color=ORANGE, lw=0.9)
    if angle:
        axes.set(xlabel=label("s", shown), ylabel="tangent angle (rad)")
    else:
        axes.set(aspect="equal", xlabel=label("s, along the head", shown))
        axes.set(ylabel=label(name, shown))


def _angles(axes: Axes, found: Any, unit: str) -> None:
    """Mean and harmonics of the tangent angle along the filament, dotted out of the plane."""
    factor, shown = prefixed(found.length, unit)
    y = np.linspace(-1.0, 1.0, 200)
    s = factor * found.length * (y + 1.0) / 2.0
    for modes, line in ((found.modes, "-"), (found.modes_out, ":")):
        if modes is None:
            continue
        axes.set_prop_cycle(None)
        mean = np.polynomial.legendre.legval(y, modes[:, 0])
        axes.plot(s, mean, color=GREY, lw=1.2, ls="--" if line == "-" else line, label="mean")
        for h in range(1, modes.shape[1] // 2 + 1):
            wave = np.polynomial.legendre.legval(y, modes[:, 2 * h - 1] - 1j * modes[:, 2 * h])
            axes.plot(s, np.abs(wave), ls=line, label=f"harmonic {h}")
    axes.set(xlabel=label("s", shown), ylabel="amplitude of the tangent angle (rad)")
    if found.modes_out is not None:
        axes.set_title("dotted: out of the plane", loc="left")
    handles, names = axes.get_legend_handles_labels()
    few = len(handles) if found.modes_out is None else len(handles) // 2
    axes.legend(handles[:few], names[:few])


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
    scale = "log" if (value > 0).any() else "linear"  # of a cell that stands still
    axes.set(xscale="log", yscale=scale, xlabel=label("time apart", time))
    log_ticks(axes)
    axes.set(ylabel=label("mean squared displacement", f"{shown}²" if shown else ""))
    axes.legend(loc="upper left")
