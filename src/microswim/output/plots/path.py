"""Picture of a path: from above, from the side, and in time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from microswim import checks
from microswim.gait.units import unit
from microswim.output.plots.style import (
    BLACK,
    BLUE,
    CYCLE,
    GREY,
    LINES,
    WIDE,
    blank,
    few_ticks,
    letter,
    log_ticks,
    look,
    readable,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 60  #: paths that are drawn


@checks.given(found=checks.dataset)
def path(found: xr.Dataset) -> Figure:
    """Draw a path from above (x, y), from the side (x, z) and in time.

    In a tube from the side (x, z), along its axis (y, z) and in time. Of motors that give a torque
    also how often each turns, and its phase against the first.

    Parameters
    ----------
    found
        What `microswim.path` gives; of many paths the first sixty are drawn.

    Returns
    -------
    matplotlib.figure.Figure
        Call its ``savefig``.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> ms.plots.path(ms.path(swimmer, time=1.0)).axes[0].get_xlabel()
    'x'
    """
    x = found.position.values
    places = x[:MOST] if x.ndim == 3 else x[None]
    length = found.position.attrs["units"]
    factor, _ = readable(places, "", length)
    with look():
        by_torque = "tail" in found.dims
        figure = blank(WIDE, 5.2 if by_torque else 3.0)
        grid = figure.add_gridspec(1 + by_torque, 6, height_ratios=[1.0, 0.7][: 1 + by_torque])
        above, side, time = (figure.add_subplot(grid[0, 2 * n : 2 * n + 2]) for n in range(3))
        if by_torque:
            wide = 2 if "hook_bend" in found else 3
            each = [grid[1, k : k + wide] for k in range(0, 6, wide)]
            _motors(figure.add_subplot(each[0]), figure.add_subplot(each[1]), found)
            if "hook_bend" in found:
                _hooks(figure.add_subplot(each[2]), found)
        in_tube = found.attrs.get("boundary") == "tube"
        planes = ((0, 2), (1, 2)) if in_tube else ((0, 1), (0, 2))
        _planes((above, side), places, planes, length)
        if in_tube:
            _tube(above, side, factor * float(found.attrs["tube_radius"]))
        elif "gap" in found:  # the wall is the plane z = 0
            side.axhline(0.0, color=BLACK, linewidth=1.5)
        _in_time(time, found, places)
        letter(time, "c")
        return figure


def _planes(both: Any, places: np.ndarray, planes: Any, length: str) -> None:
    """The paths in two planes, (a) and (b), with the names of their axes."""
    factor, _ = readable(places, "", length)
    for axes, (i, j), name in zip(both, planes, "ab", strict=True):
        _plane(axes, factor * places, i, j)
        for k, which in ((i, "x"), (j, "y")):
            label = readable(places, "xyz"[k], length)[1]
            axes.set(**{f"{which}label": label.replace(" (length)", "")})
        letter(axes, name)


def _plane(axes: Axes, places: np.ndarray, i: int, j: int) -> None:
    """The paths in the plane of two axes of the lab: dot at the start, ring at the end."""
    many = len(places) > 1
    for k, x in enumerate(places):
        colour = CYCLE[k % len(CYCLE)] if many else BLUE
        axes.plot(x[:, i], x[:, j], color=colour, linewidth=0.6 if many else 1.0)
        axes.plot(x[-1, i], x[-1, j], "o", color=colour, markersize=3, markerfacecolor="white")
    axes.plot(places[:, 0, i], places[:, 0, j], "o", color=BLACK, markersize=3.5)
    low, high = places[..., [i, j]].min(axis=(0, 1)), places[..., [i, j]].max(axis=(0, 1))
    half = 0.55 * max(float((high - low).max()), 1e-12)
    middle = (low + high) / 2.0
    axes.set(
        xlim=(middle[0] - half, middle[0] + half),
        ylim=(middle[1] - half, middle[1] + half),
        aspect="equal",
    )
    few_ticks(axes, 4)


def _tube(side: Axes, along: Axes, radius: float) -> None:
    """The tube's wall, from the side and along its axis, all of which is shown."""
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    along.plot(radius * np.cos(turn), radius * np.sin(turn), color=BLACK, linewidth=1.5)
    along.set(xlim=(-1.1 * radius, 1.1 * radius), ylim=(-1.1 * radius, 1.1 * radius))
    for at in (-radius, radius):
        side.axhline(at, color=BLACK, linewidth=1.5)
    side.set(aspect="auto", ylim=(-1.1 * radius, 1.1 * radius))  # a tube is longer than wide


def _motors(rates: Axes, phases: Axes, found: xr.Dataset) -> None:
    """Turns per time of each motor, and how its phase stands to the first one's."""
    per, label_t = readable(found.time.values, "time", found.time.attrs["units"])
    t, turns = per * found.time.values, found.rate.values / (2.0 * np.pi)
    factor, name = readable(turns, "frequency", unit(found.attrs["units"], "frequency"))
    ahead = found.phase.values - found.phase.values[:, :1]
    for n in range(turns.shape[1]):
        colour = CYCLE[n % len(CYCLE)]
        rates.plot(
            t, factor * turns[:, n], color=colour, ls="-" if n == 0 else "--", label=f"tail {n}"
        )
        if turns.shape[1] == 1:
            phases.plot(t, found.phase[:, n], color=colour)
        elif n:
            phases.plot(t, ahead[:, n], color=colour)
    rates.set(xlabel=label_t, ylabel=name)
    if turns.shape[1] > 1:
        rates.legend()
    of = "phase" if turns.shape[1] == 1 else "phase against tail 0"
    phases.set(xlabel=label_t, ylabel=f"{of} (rad)")
    low, high = phases.get_ylim()
    if high - low < 1e-3:  # in step but for the error of the time steps
        phases.set(ylim=((low + high) / 2.0 - 0.5, (low + high) / 2.0 + 0.5))
    letter(rates, "d")
    letter(phases, "e")


def _hooks(axes: Axes, found: xr.Dataset) -> None:
    """The bend of each hook."""
    per, label_t = readable(found.time.values, "time", found.time.attrs["units"])
    for n, bend in enumerate(np.degrees(found.hook_bend.values.T)):
        style = "-" if n == 0 else "--"
        axes.plot(per * found.time.values, bend, color=CYCLE[n % len(CYCLE)], ls=style)
    axes.set(xlabel=label_t, ylabel="bend of the hook (deg)", ylim=(0.0, None))
    letter(axes, "f")


def _in_time(axes: Axes, found: xr.Dataset, places: np.ndarray) -> None:
    """Displacement in time; beside a boundary the gap; of many paths the mean square."""
    units = found.attrs["units"]
    t = found.time.values
    per, label_t = readable(t, "time", unit(units, "time"))
    if "path" in found.dims:
        moved = found.position.values - found.position.values[:, :1]
        square = (moved**2).sum(axis=-1).mean(axis=0)
        factor, name = readable(np.sqrt(square), "", unit(units, "length"))
        axes.loglog(per * t[1:], factor**2 * square[1:], color=BLUE)
        log_ticks(axes)
        inner = name.strip(" ()")
        axes.set(xlabel=label_t, ylabel=f"mean square displacement ({inner}$^2$)")
        return
    shown: Any
    if "gap" in found:
        factor, name = readable(found.gap.values, "gap to the wall", unit(units, "length"))
        axes.plot(per * t, factor * found.gap.values, color=BLUE)
        axes.set(ylim=(0.0, None))
    else:
        moved = places[0] - places[0, 0]
        factor, name = readable(moved, "displacement", unit(units, "length"))
        for values, shown, (colour, style) in zip(moved.T, "xyz", LINES):
            axes.plot(per * t, factor * values, color=colour, ls=style, label=shown)
        axes.axhline(0.0, color=GREY, linewidth=0.4)
        axes.legend()
    axes.set(xlabel=label_t, ylabel=name)


@checks.given(found=checks.dataset)
def group_path(found: xr.Dataset) -> Figure:
    """Draw the paths of several swimmers from above (x, y), from the side (x, z), and how far they
    are from each other in time.

    Parameters
    ----------
    found
        What `microswim.group_path` gives.

    Returns
    -------
    matplotlib.figure.Figure
        Call its ``savefig``.

    Examples
    --------
    >>> import microswim as ms
    >>> one = ms.Group((ms.Member(swimmer=ms.Swimmer.preset("tabak/helix")),))
    >>> ms.plots.group_path(ms.group_path(one, [0.0, 0.5], level="coarse")).axes[0].get_xlabel()
    'x'
    """
    places = found.position.transpose("swimmer", "time", "axis").values
    length, units = found.position.attrs["units"], found.attrs["units"]
    with look():
        figure = blank(WIDE, 3.0)
        above, side, time = figure.subplots(1, 3, width_ratios=[1.0, 1.0, 1.1])
        _planes((above, side), places, ((0, 1), (0, 2)), length)
        per, label_t = readable(found.time.values, "time", unit(units, "time"))
        _apart(time, per * found.time.values, places, length)
        time.set(xlabel=label_t)
        letter(time, "c")
        return figure


def _apart(axes: Axes, t: np.ndarray, places: np.ndarray, length: str) -> None:
    """How far each swimmer is from the nearest other; of one alone, from where it began."""
    if len(places) == 1:
        far, what = np.linalg.norm(places - places[:, :1], axis=-1), "displacement"
    else:
        gaps = np.linalg.norm(places[:, None] - places[None], axis=-1)
        gaps[np.arange(len(places)), np.arange(len(places))] = np.inf
        far, what = gaps.min(axis=1), "to the nearest body"
    factor, name = readable(far, what, length)
    for k, values in enumerate(far):
        axes.plot(t, factor * values, color=CYCLE[k % len(CYCLE)], label=f"swimmer {k}")
    axes.set(ylabel=name, ylim=(0.0, None))
    if 1 < len(places) <= len(CYCLE):
        axes.legend()
