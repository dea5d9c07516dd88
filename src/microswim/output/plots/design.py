"""Pictures of designs: map with optimum and neighbourhood, front, sensitivity, spread, swimmers."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from microswim import checks
from microswim.errors import SpecError, nearest
from microswim.gait.quantities import QUANTITIES, current
from microswim.gait.readable import quantity
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.units import unit
from microswim.output.io.surface import surface
from microswim.output.plots import doubt
from microswim.output.plots.drawing import Camera, draw_surface, scale_bar
from microswim.output.plots.style import BLUE, ORANGE, WIDE, blank, few_ticks, look, readable
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import designs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from microswim.studies.optimisation.search import Optimum

STAR = {"color": ORANGE, "mec": "white", "ms": 12, "clip_on": False, "ls": "none", "zorder": 5}


def swimmers(axes: Axes, robots: Sequence[Swimmer], names: Sequence[str] = ()) -> None:
    """Draw swimmers to one scale, one above the other, the body to the left.

    Parameters
    ----------
    axes
        Where to draw.
    robots
        The swimmers, from top to bottom.
    names
        A word beside each.
    """
    camera, top, ends = Camera(np.eye(3)), 0.0, []
    for i, robot in enumerate(robots):
        mesh = surface(robot, 0.0)
        low, high = mesh.points[:, 1].min(), mesh.points[:, 1].max()
        shift = np.array([-mesh.points[:, 0].min(), top - high, 0.0])
        draw_surface(axes, mesh.moved(shift, np.eye(3)), camera)
        if i < len(names):
            end = float(np.ptp(mesh.points[:, 0]))
            ends.append((end, top - high, names[i]))
        top -= (high - low) + 0.25 * robots[0].body.semi_axes3[1] + 0.02 * abs(top)
    axes.set_aspect("equal")
    axes.autoscale_view()
    for end, height, name in ends:
        axes.annotate(
            name, (end, height), (4, 0), textcoords="offset points", va="center", fontsize=7
        )
    axes.axis("off")
    length = float(f"{robots[0].tail.apparent_length / 2:.0e}")
    scale_bar(axes, length, unit(robots[0].units, "length"))


@checks.given(
    result=checks.dataset,
    merit=checks.text,
    optimum=partial(checks.instance, kind="Optimum"),
    region=checks.mapping,
    label=checks.text,
)
def design_map(
    result: xr.Dataset,
    merit: str = "swimming_speed",
    *,
    optimum: Optimum | None = None,
    region: Mapping[str, tuple[float, float]] | None = None,
    label: str | None = None,
) -> Figure:
    """Return contours of a result of a sweep over two numbers, with the optimum and the
    neighbourhood; over one number its curve.

    How wrong u_s may be is drawn where it is known: as lines on a map, hatched from 20 % on and
    where it is not known, and as a band about a curve of a speed.

    Parameters
    ----------
    result
        Of `sweep`, over one or two dotted names; failed designs stay white.
    merit
        Its variable; ``mean_velocity.us`` takes a component.
    optimum
        Marked, and drawn to scale beside the map.
    region
        Dotted name to ``(low, high)``: the calibrated neighbourhood, drawn as a frame.
    label
        Name of the colours.

    Returns
    -------
    matplotlib.figure.Figure
        Call its ``savefig``.

    Raises
    ------
    SpecError
        If the result does not vary over one or two numbers, or has no such variable.

    Examples
    --------
    >>> import microswim as ms
    >>> over = {"tail.amplitude": [0.05, 0.1, 0.15], "tail.waves": [1, 2, 3]}
    >>> result = ms.sweep(ms.Swimmer.preset("tabak/helix"), over)
    >>> ms.plots.design_map(result).axes[0].get_xlabel()
    'tail.waves'
    """
    name, _, component = merit.partition(".")
    if name not in result:
        raise SpecError("merit", merit, "a variable of the result", nearest(name, map(str, result)))
    values = result[name].sel(component=component) if component else result[name]
    if values.ndim == 1 and values.dims[0] in result.coords:
        return _curve(result, values, merit, label)
    if values.ndim != 2:
        over = ", ".join(map(str, values.dims))
        raise SpecError("result", f"over {over}", "over one or two numbers")
    y, x = values.dims
    with look():
        figure = blank(WIDE, 3.4)
        if optimum is None:
            axes = figure.subplots()
        else:
            axes, side = figure.subplots(1, 2, width_ratios=[2.2, 1.0])
            swimmers(side, [optimum.swimmer])
            said = _value(optimum.objective, optimum.value, optimum.swimmer.units)
            words = f"optimum: {optimum.objective.replace('_', ' ')} = {said}"
            side.set_title(textwrap.fill(words, 26))
        size, colours = _axis(values, label or merit.replace("_", " "))
        (fx, name_x), (fy, name_y) = (_axis(result[n], str(n)) for n in (x, y))
        at_x, at_y, shown = fx * result[x], fy * result[y], size * values
        filled = axes.contourf(at_x, at_y, shown, levels=16, cmap="viridis")
        figure.colorbar(filled, ax=axes, label=colours)
        levels = np.asarray(filled.levels)[::3]
        lines = axes.contour(at_x, at_y, shown, levels=levels, colors="white", linewidths=0.4)
        axes.clabel(lines, fontsize=6, fmt="%.3g")
        doubt.on_map(axes, result, at_x, at_y)
        if region and x in region and y in region:
            (a, b), (c, d) = np.multiply(region[str(x)], fx), np.multiply(region[str(y)], fy)
            axes.plot([a, b, b, a, a], [c, c, d, d, c], "w--", lw=1.2, label="calibrated")
        if optimum is not None and {x, y} <= set(optimum.values):
            star = fx * optimum.values[str(x)], fy * optimum.values[str(y)]
            axes.plot(*star, "*", **STAR, label="optimum")
            _make_room(axes, star)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="best", frameon=True, facecolor="white", framealpha=0.8)
        axes.set(xlabel=name_x, ylabel=name_y)
    return figure


def _curve(result: xr.Dataset, values: xr.DataArray, merit: str, label: str | None) -> Figure:
    """Values over one number."""
    with look():
        figure = blank(WIDE * 0.62, 2.8)
        axes = figure.subplots()
        (x,) = values.dims
        (fx, name_x), (fy, name_y) = (
            _axis(result[x], str(x)),
            _axis(values, label or merit.replace("_", " ")),
        )
        doubt.curve(axes, fx * result[x], fy * values, result, merit in doubt.OF_SPEED)
        axes.set(xlabel=name_x, ylabel=name_y)
    return figure


def _value(name: str, value: float, units: str) -> str:
    """A quantity with its unit; a number where it is an expression."""
    known = QUANTITIES | DRIVEN
    if name not in known:
        return f"{value:.3g}"
    return quantity(value, unit(units, known[name].dimension), 3)


def _axis(values: xr.DataArray, name: str) -> tuple[float, str]:
    """Factor and label of an axis; its unit stands in the attribute ``units``."""
    return readable(values, name, values.attrs.get("units", ""))


def _make_room(axes: Axes, place: Sequence[float]) -> None:
    """Widen the map where a mark lies on its edge, so that the whole mark is seen."""
    for side, at in zip("xy", place):
        low, high = getattr(axes, f"get_{side}lim")()
        margin = 0.05 * (high - low)
        ends = low - margin * (at < low + margin), high + margin * (at > high - margin)
        getattr(axes, f"set_{side}lim")(*ends)


@checks.given(result=checks.dataset, swimmer=checks.swimmer, drawn=checks.at_least(0))
def front(result: xr.Dataset, swimmer: Swimmer, drawn: int = 4) -> Figure:
    """Return a Pareto front of two or three objectives, with designs along it to scale.

    Parameters
    ----------
    result
        Of `pareto`.
    swimmer
        The swimmer it varied.
    drawn
        How many designs to draw.

    Returns
    -------
    matplotlib.figure.Figure
        Call its ``savefig``.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix")
    >>> wishes = {"maximize": ["swimming_speed"], "minimize": ["mean_torque"]}
    >>> small = {"population": 8, "generations": 2}
    >>> front = ms.pareto(robot, {"tail.amplitude": (0.05, 0.15)}, **wishes, **small)
    >>> len(ms.plots.front(front, robot).axes)
    2
    """
    texts = [text.split(" ", 1)[1] for text in result.attrs["objectives"]]
    wanted = [
        text.replace("maximize", "more is better").replace("minimize", "less is better")
        for text in result.attrs["objectives"]
    ]
    x, y = texts[1], texts[0]
    n = result.sizes["design"]
    reach = np.linspace(float(result[y].min()), float(result[y].max()), drawn)
    picked = list(dict.fromkeys(int(np.abs(result[y].values - r).argmin()) for r in reach))[::-1]
    said = [_axis(result[text], text.replace("_", " ")) for text in texts]
    result = result.assign({text: f * result[text] for text, (f, _) in zip(texts, said)})
    with look():
        figure = blank(WIDE, 3.4)
        axes, side = figure.subplots(1, 2, width_ratios=[1.6, 1.0])
        third = result[texts[2]] if len(texts) > 2 else None
        doubt.bars(axes, result[x], result[y], result, (x, y))
        dots = axes.scatter(result[x], result[y], c=BLUE if third is None else third, s=9)
        if third is not None:
            figure.colorbar(dots, ax=axes, label=said[2][1])
        chosen = result.isel(design=picked)
        axes.scatter(
            chosen[x], chosen[y], s=40, facecolors="none", edgecolors=ORANGE, linewidths=1.3
        )
        letters = "ABCDEFGH"[: len(picked)]
        for letter, i in zip(letters, picked):
            at = (float(result[x][i]), float(result[y][i]))
            axes.annotate(letter, at, (5, -9), textcoords="offset points", color=ORANGE)
        axes.set(xlabel=f"{said[1][1]}, {wanted[1].split()[0]} is better", title=f"{n} designs")
        axes.set_ylabel(f"{said[0][1]}, {wanted[0].split()[0]} is better")
        swimmers(side, designs(swimmer, chosen), letters)
    return figure


def sensitivity(optimum: Optimum, most: int = 10) -> Figure:
    """Return bars: what one per cent of each number does to the optimum, and how far each may move.

    Parameters
    ----------
    optimum
        Of `design`.
    most
        How many numbers to show.
    """
    items = list(optimum.sensitivity.items())
    varied = [(k, s) for k, s in items if s.varied]
    shown = [item for item in items if abs(item[1].elasticity) > 1e-6][:most][::-1]
    with look():
        figure = blank(WIDE, 3.2)
        left, right = figure.subplots(1, 2, width_ratios=[1.5, 1.0])
        colours = [ORANGE if s.varied else BLUE for _, s in shown]
        left.barh([k for k, _ in shown], [s.elasticity for _, s in shown], color=colours)
        left.axvline(0.0, color="k", lw=0.7)
        left.set(xlabel=f"% of {optimum.objective} per % of the number")
        limited = any(s.varied for _, s in shown)
        note = " (orange: varied, at a limit)" if limited else ""
        left.set_title(f"what the optimum depends on{note}")
        room = [100 * (s.room or 0.0) / abs(s.value) for _, s in varied]
        right.barh([k for k, _ in varied], room, color=ORANGE)
        right.set(xlabel="± % that cost 1 % of the objective", title="room of what varied")
    return figure


def indices(result: xr.Dataset) -> Figure:
    """Return bars of Sobol indices with their 95 % intervals; result of `sobol_indices`."""
    order = np.argsort(result.total.values)
    found = result.isel(name=order)
    at = np.arange(found.sizes["name"])
    with look():
        figure = blank(WIDE * 0.62, 0.9 + 0.38 * len(at))
        axes = figure.subplots()
        for shift, key, colour in [(0.19, "first", BLUE), (-0.19, "total", ORANGE)]:
            axes.barh(
                at + shift, found[key], 0.36, xerr=found[f"{key}_error"], color=colour, label=key
            )
        axes.set_yticks(at, found.name.values)
        axes.set(xlabel=f"share of the variance of {result.attrs['merit']}")
        axes.legend(loc="lower right")
    return figure


def robustness(
    made: xr.Dataset, merit: str = "swimming_speed", nominal: float | None = None
) -> Figure:
    """Return the histogram of a merit over made robots, good and bad; result of `robustness`."""
    merit = current(merit)
    factor, name = _axis(made[merit], merit.replace("_", " "))
    values, good = factor * made[merit].values, made.good.values
    inside = np.isfinite(values)
    edges = np.histogram_bin_edges(values[inside], 48)
    with look():
        figure = blank(WIDE * 0.62, 2.6)
        axes = figure.subplots()
        parts = {"good": (good & inside, BLUE), "not good": (~good & inside, ORANGE)}
        there = {name: (values[which], colour) for name, (which, colour) in parts.items()}
        data, colours = zip(*(entry for entry in there.values() if len(entry[0])))
        names = [name for name, entry in there.items() if len(entry[0])]
        axes.hist(data, list(edges), stacked=True, color=colours, label=names)
        if nominal is not None:
            axes.axvline(factor * nominal, color="k", lw=1, ls="--", label="as designed")
        part = made.attrs["yield"]
        axes.set(xlabel=name, ylabel="robots", title=f"yield {100 * part:.1f} %")
        axes.legend()
        few_ticks(axes)
    return figure
