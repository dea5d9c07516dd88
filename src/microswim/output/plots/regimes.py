"""Picture of the regimes of a magnetic robot: velocity and precession over the frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.gait.units import unit
from microswim.output.plots.style import (
    BLACK,
    BLUE,
    CYCLE,
    NARROW,
    ORANGE,
    PALE,
    PALE_BLUE,
    PALE_GREEN,
    PALE_ORANGE,
    WIDE,
    letter,
    look,
    panels,
    readable,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from microswim.path.regimes import Regimes

SHADES = {
    "tumbling": PALE,
    "wobbling": PALE_BLUE,
    "synchronous": PALE_GREEN,
    "stepped out": PALE_ORANGE,
    "not held": "white",
}


def regimes(found: Regimes) -> Figure:
    """Return the figure: velocity along the axis above, precession angle below, regimes shaded.

    Parameters
    ----------
    found
        What `microswim.regimes` gives.
    """
    order = np.argsort(found.frequency)
    f, name = _frequency(found)
    v, label_v = readable(found.velocity, "velocity along the axis", unit(found.units, "speed"))
    with look():
        figure, axes = panels(2, 1, (WIDE, 4.4), sharex=True)
        (upper,), (lower,) = axes
        for ax in (upper, lower):
            _shade(ax, found, f, order)
            ax.axvline(f * found.step_out, color=BLACK, linewidth=0.8, linestyle=":")
        x = f * found.frequency[order]
        upper.axhline(0.0, color=BLACK, linewidth=0.5)
        for i in order:
            at, states = f * found.frequency[i], found.others[i]
            upper.plot([at] * len(states), [v * s[1] for s in states], ".", color=BLUE, ms=3)
            lower.plot(
                [at] * len(states), [np.degrees(s[0]) for s in states], ".", color=BLUE, ms=3
            )
        upper.plot(x, v * found.velocity[order], "-o", color=BLUE, ms=2)
        angle = np.degrees(found.precession_angle[order])
        lower.plot(x, angle, "-o", color=BLUE, ms=2, label="raising the frequency slowly")
        if any(found.others):
            lower.plot([], [], ".", color=BLUE, ms=3, label="other states that are held")
        _closed_form(lower, found, f)
        upper.set(ylabel=label_v)
        lower.set(ylabel="precession angle (deg)", xlabel=name, ylim=(-2, 92))
        lower.legend(loc="upper right")
        letter(upper, "a")
        letter(lower, "b")
        figure.legend(handles=_patches(found.regime), loc="outside upper center", ncols=4)
    return figure


def regime_map(
    many: Sequence[Regimes], values: Any, name: str, measured_in: str, start: str = ""
) -> Figure:
    """Return the figure of regimes over the frequency and one more number of the spec.

    Parameters
    ----------
    many, values
        Results, and the value of the number in each.
    name, measured_in
        Of the number, and its unit.
    start
        What stands before the name.
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap

    names = list(SHADES)
    grid = np.array([[names.index(r) for r in one.regime] for one in many])
    f, label_f = _frequency(many[0])
    if measured_in == "rad":
        factor, label = 180.0 / np.pi, f"{start}{name} (deg)"
    else:
        factor, label = readable(values, f"{start}{name}", measured_in)
    y = factor * np.asarray(values, float)
    with look():
        figure, ((ax,),) = panels(1, 1, (NARROW + 1.0, 3.2))
        colours = ListedColormap(list(SHADES.values()))
        norm = BoundaryNorm(np.arange(-0.5, 4.0), 4)
        x = f * many[0].frequency
        ax.pcolormesh(x, y, grid, cmap=colours, norm=norm, shading="nearest")
        limits = {"step-out": ([m.step_out for m in many], ORANGE, "-")}
        limits["wobbling from here on"] = ([m.wobbling_onset for m in many], BLUE, "--")
        for text, (edge, colour, style) in limits.items():
            ax.plot(f * np.array(edge), y, style, color=colour, label=text)
        ax.set(xlabel=label_f, ylabel=label, xlim=(x.min(), x.max()))
        figure.legend(
            handles=[*ax.get_legend_handles_labels()[0], *_patches(np.array(names)[grid].ravel())],
            loc="outside upper center",
            ncols=3,
        )
    return figure


def _frequency(found: Regimes) -> tuple[float, str]:
    kind = unit(found.units, "frequency")
    return readable(found.frequency, "frequency of the field", kind)


def _shade(ax: Axes, found: Regimes, factor: float, order: Any) -> None:
    """Shade each regime up to where it ends: onset, step-out, or half-way to the next."""
    x, regime = found.frequency[order], [found.regime[i] for i in order]
    inner = (x[1:] + x[:-1]) / 2.0
    for edge in (found.wobbling_onset, found.step_out):
        inner = np.where((x[:-1] <= edge) & (edge < x[1:]), edge, inner)
    edges = factor * np.concatenate([x[:1], inner, x[-1:]])
    for i, name in enumerate(regime):
        ax.axvspan(edges[i], edges[i + 1], color=SHADES[name], linewidth=0.0)
    if edges[0] < edges[-1]:
        ax.set_xlim(edges[0], edges[-1])


def _patches(regime: Any) -> list[Any]:
    from matplotlib.patches import Patch

    return [Patch(color=colour, label=n) for n, colour in SHADES.items() if n in set(regime)]


def _closed_form(ax: Axes, found: Regimes, factor: float) -> None:
    exact = found.closed_form
    if exact is None:
        return
    f = np.linspace(found.frequency.min(), found.frequency.max(), 400)
    angle = np.degrees(exact.precession_angle(2.0 * np.pi * f))
    text = "closed form, axisymmetric"
    ax.plot(factor * f, angle, "--", color=CYCLE[1], linewidth=1.0, label=text)
