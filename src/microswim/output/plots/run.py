"""Figures of a run, from its Dataset: the path with the swimmer to scale, and the velocities.

Two-column journal width; colours that the colour-blind tell apart, with a line style each; units on
every axis.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from microswim import checks
from microswim.gait.readable import label, prefixed
from microswim.gait.units import unit
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.output.io.surface import surface
from microswim.output.plots.drawing import Camera, draw_surface, scale_bar, triad
from microswim.output.plots.style import (
    BLACK,
    GREY,
    LINES,
    ORANGE,
    PURPLE,
    WIDE,
    blank,
    few_ticks,
    look,
)
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@checks.given(run=checks.dataset, swimmer=checks.swimmer)
def trajectory(run: xr.Dataset, swimmer: Swimmer | None = None) -> Figure:
    """Return the path of a run: the swimmer drawn to scale, the path seen from behind, and in time.

    Parameters
    ----------
    run
        Dataset of `microswim.io.dataset`.
    swimmer
        The swimmer; by default that of the run's ``spec`` attribute, and none if it has none.

    Returns
    -------
    matplotlib.figure.Figure
        Call its ``savefig``.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> run = ms.io.dataset(swimmer, swimmer.gait(), periods=2)
    >>> ms.plots.trajectory(run, swimmer).axes[1].get_xlabel()
    'sideways'
    """
    swimmer = _swimmer_of(run) if swimmer is None else swimmer
    with look():
        figure = blank(WIDE, 4.4)
        halves: Any = figure.subfigures(2, 1, height_ratios=[1.15, 1.0])
        top, bottom = halves
        basis = _directions(run)
        _scene(top.subplots(), run, swimmer, basis)
        behind, time = bottom.subplots(1, 2, width_ratios=[1.0, 1.9])
        _behind(behind, run, basis)
        _in_time(time, run, basis)
        return figure


@checks.given(run=checks.dataset)
def velocity(run: xr.Dataset) -> Figure:
    """Return the velocity, body rate and motor power over one period of the tail.

    Parameters
    ----------
    run
        Dataset of `microswim.io.dataset`.

    Returns
    -------
    matplotlib.figure.Figure
        Call its ``savefig``.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/plane_wave")
    >>> run = ms.io.dataset(swimmer, swimmer.gait(), periods=2)
    >>> ms.plots.velocity(run).axes[0].get_xlabel()
    'phase of the tail (periods)'
    """
    with look():
        figure = blank(WIDE, 2.5)
        linear, angular, power = figure.subplots(1, 3)
        speed, rate = (unit(run.attrs["units"], kind) for kind in ("speed", "rate"))
        _components(linear, run, slice(0, 3), "velocity", speed, "u")
        _components(angular, run, slice(3, 6), "body rate", rate, r"\Omega")
        _power(power, run)
        for axes, letter in zip((linear, angular, power), "abc"):
            axes.set(xlabel="phase of the tail (periods)", xlim=(0, 1))
            _title(axes, letter, "")
        return figure


NARROW = 0.125  #: height over width of a track, below which it is drawn higher


def track_and_fit(track: np.ndarray, path: np.ndarray, unit: str) -> Figure:
    """Draw a measured track and the fitted path in the image plane.

    Parameters
    ----------
    track, path
        Positions, (n, 2) or (n, 3).
    unit
        Of both: ``"m"``, or ``"length"``.

    Returns
    -------
    matplotlib.figure.Figure
        Both from the first point of the track, in one unit and to scale; of a track that is next
        to a line along x, y is drawn larger, and says so.
    """
    track, path = (x[:, :2] - track[0, :2] for x in (track, path))
    wide, high = np.ptp(track, axis=0)
    narrow = bool(high < NARROW * wide)
    units = [prefixed(float(np.abs(x).max()), unit) for x in (track.T if narrow else (track,) * 2)]
    factor = np.array([size for size, _ in units])
    with look():
        figure = blank(5.0, 4.0)
        axes = figure.subplots()
        axes.plot(*(factor * track).T, ".", color=GREY, ms=3, label="track")
        axes.plot(*(factor * path).T, color=ORANGE, lw=1.0, label="fit")
        names = ["x from the start", "y from the start"]
        if narrow:
            names[1] += ", drawn larger than x"
        else:
            axes.set(aspect="equal", adjustable="datalim")
        labels = [label(name, shown) for name, (_, shown) in zip(names, units)]
        axes.set(xlabel=labels[0], ylabel=labels[1])
        few_ticks(axes, 4)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=2)
    return figure


def _swimmer_of(run: xr.Dataset) -> Swimmer | None:
    from microswim.spec.file import from_dict
    from microswim.spec.readers.text import toml
    from microswim.spec.several import several

    tables = toml(run.attrs.get("spec", ""), "the spec of this run")
    tails = several(tables.get("tail"))  # the function of a custom one is not trusted here
    custom = any(tail.get("kind") == "custom" for tail in tails)
    return None if custom or not tables else from_dict(tables)


def _directions(run: xr.Dataset) -> np.ndarray:
    """Rows: direction of swimming and two across it, the last as upright as can be.

    From the mean place of the first period to that of the last, which leaves out the wobble.
    """
    x, count = run.position.values, _periods(run)
    first, last = count <= 1.0, count >= count[-1] - 1.0
    net = x[last].mean(axis=0) - x[first].mean(axis=0) if count[-1] >= 2 else x[-1] - x[0]
    along = net / np.linalg.norm(net) if np.linalg.norm(net) > 0 else np.array([-1.0, 0.0, 0.0])
    z = np.eye(3)[2] if abs(along[2]) < 0.8 else np.eye(3)[1]
    up = z - (z @ along) * along
    up /= np.linalg.norm(up)
    return np.array([along, np.cross(up, along), up])


def _scene(axes: Axes, run: xr.Dataset, swimmer: Swimmer | None, basis: np.ndarray) -> None:
    """The path in space, with the swimmer at its end and, if there is room, at its start."""
    camera = Camera.behind(basis, azimuth=-28.0, elevation=16.0)
    x, q = run.position.values, run.quaternion.values
    extent = float(np.ptp(x @ basis[0])) or 1.0
    if swimmer is not None:
        extent = float(nose_to_tip(swimmer))
        room = np.linalg.norm(x[-1] - x[0]) > 0.75 * extent
        for i, strength in ((0, 0.22), (len(x) - 1, 1.0)) if room else ((len(x) - 1, 1.0),):
            mesh = surface(swimmer, float(run.motor_phase[i]), fineness=2.2)
            draw_surface(axes, mesh.moved(x[i], rotation_matrix(q[i])), camera, strength)
    path = camera.project(x)
    axes.plot(path[:, 0], path[:, 1], color=BLACK, lw=0.8, zorder=2.5, solid_joinstyle="round")
    axes.plot(*path[0, :2], "o", ms=3.5, mfc="white", mec=BLACK, mew=0.9, zorder=6)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.margins(0.03, 0.06)
    _title(axes, "a", "swimmer and path, to scale")
    scale_bar(axes, extent, unit(run.attrs["units"], "length"))
    triad(axes, camera)


def _behind(axes: Axes, run: xr.Dataset, basis: np.ndarray) -> None:
    """The path of the body's centre seen along the direction of swimming, coloured by time."""
    from matplotlib.collections import LineCollection

    across = (run.position.values - run.position.values[0]) @ basis[1:].T
    middle = (across.max(axis=0) + across.min(axis=0)) / 2.0
    reach = 0.55 * max(float(np.ptp(across, axis=0).max()), 1e-3 * float(run.body_length))
    factor, unit = prefixed(reach, run.position.attrs["units"])
    across, middle, reach = factor * across, factor * middle, factor * reach
    segments = np.stack([across[:-1], across[1:]], axis=1)
    colours = LineCollection(list(segments), array=_periods(run)[:-1], cmap="cividis", lw=0.8)
    axes.add_collection(colours)
    axes.plot(*across[0], "o", ms=3.5, mfc="white", mec=BLACK, mew=0.9)
    (left, low), (right, high) = middle - reach, middle + reach
    axes.set(xlim=(left, right), ylim=(low, high))
    axes.set(xlabel=label("sideways", unit), ylabel=label("upwards", unit), aspect="equal")
    bar = axes.figure.colorbar(colours, ax=axes, pad=0.03, aspect=18)
    bar.set_label("time (periods)")
    bar.outline.set_visible(False)
    _title(axes, "b", "centre of the body, from behind")


def _in_time(axes: Axes, run: xr.Dataset, basis: np.ndarray) -> None:
    """The first periods: displacement along and across the direction of swimming."""
    time = _periods(run)
    keep = time <= min(4.0, float(time[-1])) + 1e-9
    moved = (run.position.values - run.position.values[0])[keep] @ basis.T
    factor, unit = prefixed(float(np.abs(moved).max()), run.position.attrs["units"])
    for values, name, (colour, style) in zip(moved.T, ("forwards", "sideways", "upwards"), LINES):
        axes.plot(time[keep], factor * values, color=colour, ls=style, label=name)
    axes.set(xlabel="time (periods)", ylabel=label("displacement", unit))
    axes.set_xlim(0, float(time[keep][-1]) or 1.0)
    axes.legend(loc="upper left")
    _title(axes, "c", "centre of the body, first periods")


def _title(axes: Axes, letter: str, text: str) -> None:
    axes.set_title(rf"$\mathbf{{{letter}}}$   {text}", loc="left", fontsize=8)


def _periods(run: xr.Dataset) -> np.ndarray:
    return np.abs(run.motor_phase.values - run.motor_phase.values[0]) / (2.0 * np.pi)


def _components(
    axes: Axes, run: xr.Dataset, which: slice, name: str, unit: str, symbol: str
) -> None:
    """Three components over the period, their means as thin dotted lines."""
    values = run.velocity.values[:, which]
    factor, unit = prefixed(float(np.abs(values).max()), unit)
    turns = run.phase.values / (2.0 * np.pi)
    means = run.mean_velocity.values[which]
    for v, mean, axis, (colour, style) in zip(values.T, means, "sqr", LINES):
        axes.axhline(factor * mean, color=colour, lw=0.6, ls=":", zorder=1)
        axes.plot(turns, factor * v, color=colour, ls=style, label=f"${symbol}_{axis}$")
    _roomy(axes, factor * values)
    axes.set_ylabel(f"{name} ({unit})")
    axes.legend(ncols=3, loc="upper center", columnspacing=1.0, handlelength=1.9)
    if which.start == 3 and run.frequency != 0:
        per_turn = abs(float(2.0 * np.pi * run.frequency)) * factor
        right = axes.secondary_yaxis(
            "right",
            functions=(lambda y: np.divide(y, per_turn), lambda y: np.multiply(y, per_turn)),
        )
        right.set_ylabel("(revolutions per period)")


def _power(axes: Axes, run: xr.Dataset) -> None:
    values = run.power.values
    factor, unit = prefixed(float(np.abs(values).max()), run.power.attrs["units"])
    turns = run.phase.values / (2.0 * np.pi)
    mean = factor * float(run.mean_power)
    axes.axhline(mean, color=GREY, lw=0.6, ls=":")
    axes.plot(turns, factor * values, color=PURPLE)
    _roomy(axes, np.append(factor * values, 0.0))
    axes.set_ylabel(label("motor power", unit))


def _roomy(axes: Axes, values: Any) -> None:
    """Limits with room for the legend above, and never narrower than the rounding of zeros."""
    low, high = float(np.min(values)), float(np.max(values))
    span = max(high - low, 0.05 * max(abs(low), abs(high)), 1e-12)
    axes.set_ylim(low - 0.08 * span, high + 0.28 * span)
