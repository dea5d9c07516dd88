"""Maps of a validation: errors over two axes with the 5 % and 10 % neighbourhoods, or along one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError

if TYPE_CHECKING:
    from microswim.calibration.validate import Validation

COLOURS = ("#0072B2", "#D55E00")
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
    """Figure of a validation over one or two axes.

    Raises
    ------
    SpecError
        If the map has more axes.
    """
    from matplotlib.figure import Figure

    axes = {name: v for name, v in result.over.items() if v.size > 1} or result.over
    if len(axes) > 2:
        raise SpecError("over", list(axes), "one or two axes for a picture; the table holds all")
    panels = {q: result.error(q) for q in result.quantities}
    panels |= {name: result.stages[name] for name in ("resistance", "propulsion", "velocity")}
    columns = max(len(result.quantities), 3)
    figure = Figure(figsize=(7.2, 4.8), layout="constrained")
    grid = figure.subplots(2, columns, squeeze=False)
    for ax in grid.flat:
        ax.set_visible(False)
    last = None
    for i, (name, error) in enumerate(panels.items()):
        n = len(result.quantities)
        ax = grid[0, i] if i < n else grid[1, i - n]
        ax.set_visible(True)
        values = 100.0 * error.reshape([v.size for v in axes.values()])
        last = (_line if len(axes) == 1 else _map)(ax, axes, values, result.limits)
        ax.set_title(NAMES.get(name, name), fontsize=8)
        ax.tick_params(labelsize=7)
    if last is not None and len(axes) == 2:
        bar = figure.colorbar(last, ax=list(grid.flat), shrink=0.8, pad=0.02)
        bar.set_label("error (%)", fontsize=8)
        bar.ax.tick_params(labelsize=7)
        figure.suptitle(f"surrogate against {result.against}; solid: 5 %, dashed: 10 %", fontsize=9)
    return figure


def _line(
    ax: Any, axes: dict[str, np.ndarray], values: np.ndarray, limits: Sequence[float]
) -> None:
    (name, x), *_ = axes.items()
    ax.plot(x, values, "o-", color=COLOURS[0], markersize=3, linewidth=1)
    for limit, style in zip(limits, ("-", "--")):
        ax.axhline(100.0 * limit, color=COLOURS[1], linewidth=0.8, linestyle=style)
    ax.set_yscale("symlog", linthresh=1.0)
    ax.set_xlabel(name, fontsize=7)
    ax.set_ylabel("error (%)", fontsize=7)


def _map(ax: Any, axes: dict[str, np.ndarray], values: np.ndarray, limits: Sequence[float]) -> Any:
    from matplotlib.colors import LogNorm

    (one, x), (other, y) = axes.items()
    shown = np.ma.masked_invalid(np.clip(values, 0.1, 100.0).T)
    mesh = ax.pcolormesh(x, y, shown, norm=LogNorm(0.1, 100.0), cmap="cividis", shading="nearest")
    if min(values.shape) > 1:
        for limit, style in zip(limits, ("-", "--")):
            if np.nanmin(values) < 100.0 * limit < np.nanmax(values):
                ax.contour(
                    x, y, values.T, [100.0 * limit], colors="w", linestyles=style, linewidths=1
                )
    ax.set_xlabel(one, fontsize=7)
    ax.set_ylabel(other, fontsize=7)
    return mesh
