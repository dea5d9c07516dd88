"""Maps of a validation: errors over two axes with the 5 % and 10 % neighbourhoods, or along one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError
from microswim.output.plots.style import BLUE, ORANGE, WIDE, look, panels, readable

if TYPE_CHECKING:
    from microswim.calibration.validate import Validation

STAGES = ("resistance", "propulsion", "velocity")
NAMES = {
    "mean.us": "forward speed",
    "amplitude.uq": "lateral amplitude",
    "mean.os": "body rate",
    "amplitude.or": "rate amplitude",
    "resistance": "stage: resistance",
    "propulsion": "stage: propulsion",
    "velocity": "stage: velocity",
}


def error_maps(result: Validation) -> Any:
    """Return the figure of a validation over one or two axes.

    Raises
    ------
    SpecError
        If the map has more axes.
    """
    axes = {name: v for name, v in result.over.items() if v.size > 1} or result.over
    if len(axes) > 2:
        raise SpecError("over", list(axes), "one or two axes for a picture; the table holds all")
    errors = {q: result.error(q) for q in result.quantities}
    rows = (errors, {name: result.stages[name] for name in STAGES})
    with look():
        figure, grid = panels(2, max(len(errors), len(STAGES)), (WIDE, 4.8))
        last = None
        for places, panels_of in zip(grid, rows):
            for ax, (name, error) in zip(places, panels_of.items()):
                values = 100.0 * error.reshape([v.size for v in axes.values()])
                last = (_line if len(axes) == 1 else _map)(
                    ax, _scaled(result, axes), values, result
                )
                ax.set_title(f"{NAMES.get(name, name)}, worst {_worst(result, name, values)}")
            for ax in places[len(panels_of) :]:
                ax.set_visible(False)
        if last is not None and len(axes) == 2:
            figure.colorbar(last, ax=list(grid.flat), shrink=0.8, pad=0.02, label="error (%)")
            where = "; star: the design of the spec" if result.at else ""
            figure.suptitle(
                f"surrogate against {result.against}; solid: 5 %, dashed: 10 %{where}", fontsize=9
            )
    return figure


def _worst(result: Validation, name: str, values: np.ndarray) -> str:
    """The largest error of a map; with its sign where it is that of one number."""
    if not np.isfinite(values).any():
        return "not known"
    i = int(np.nanargmax(np.abs(values)))
    sign = ""
    if name in result.quantities:
        ours, theirs = (abs(part[name].flat[i]) for part in (result.surrogate, result.reference))
        sign = "+" if ours > theirs else "\u2212"
    worst = float(values.flat[i])
    return f"{sign}{worst:.{0 if worst >= 10.0 else 1}f} %"


def _scaled(result: Validation, axes: dict[str, np.ndarray]) -> dict[str, tuple[Any, Any, str]]:
    """Values, the swimmer's own (None if not on the axis) and label of each axis, readable."""
    out = {}
    for name, values in axes.items():
        factor, label = readable(values, name, result.axis_units.get(name, ""))
        own = result.at.get(name)
        out[name] = (factor * values, None if own is None else factor * own, label)
    return out


def _line(ax: Any, axes: dict[str, Any], values: np.ndarray, result: Validation) -> None:
    (x, own, label), *_ = axes.values()
    ax.plot(x, values, "o-", color=BLUE, markersize=3, linewidth=1)
    for limit, style in zip(result.limits, ("-", "--")):
        ax.axhline(100.0 * limit, color=ORANGE, linewidth=0.8, linestyle=style)
    if own is not None:
        ax.axvline(own, color="k", linewidth=0.8, linestyle=":")
    ax.set_yscale("symlog", linthresh=1.0)
    ax.set(xlabel=label, ylabel="error (%)")


def _map(ax: Any, axes: dict[str, Any], values: np.ndarray, result: Validation) -> Any:
    from matplotlib.colors import LogNorm

    (x, own_x, label_x), (y, own_y, label_y) = axes.values()
    shown = np.ma.masked_invalid(np.clip(values, 0.1, 100.0).T)
    mesh = ax.pcolormesh(x, y, shown, norm=LogNorm(0.1, 100.0), cmap="cividis", shading="nearest")
    if min(values.shape) > 1:
        for limit, style in zip(result.limits, ("-", "--")):
            if np.nanmin(values) < 100.0 * limit < np.nanmax(values):
                level = [100.0 * limit]
                ax.contour(x, y, values.T, level, colors="w", linestyles=style, linewidths=1)
    if own_x is not None and own_y is not None:
        ax.plot(own_x, own_y, "*", color=ORANGE, mec="white", ms=9, clip_on=False)
    ax.set(xlabel=label_x, ylabel=label_y)
    return mesh
