"""The expected error of designs, drawn: a band about a curve, lines and hatching on a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from microswim.gait.readable import percent
from microswim.output.plots.style import BLACK, BLUE, PALE_BLUE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Errors that lines of a map stand for; from `LARGE` on, and where none is known, it is hatched.
LEVELS = np.array([0.001, 0.01, 0.05])
LARGE = 0.2
#: What the expected error of u_s is that of.
OF_SPEED = ("swimming_speed", "mean_velocity.us")


def of(result: xr.Dataset) -> xr.DataArray | None:
    """Return the expected errors of a result's designs, None where none is known."""
    error = result.get("expected_error")
    return error if error is not None and np.isfinite(error.values).any() else None


def said(result: xr.Dataset) -> str:
    """Return in words how wrong u_s of a result's designs may be."""
    error = of(result)
    if error is None:
        return "expected error of u_s: not known"
    low, high = (percent(float(f(error.values))) for f in (np.nanmin, np.nanmax))
    return f"expected error of u_s: {low if low == high else f'{low[:-2]} to {high}'}"


def on_map(axes: Axes, result: xr.Dataset, x: Any, y: Any) -> None:
    """Draw lines of equal expected error; hatch where it is large or not known."""
    axes.set_title(said(result), fontsize=8)
    error = of(result)
    if error is None:
        return
    low, high = float(error.min()), float(error.max())
    inside = LEVELS[(low < LEVELS) & (high > LEVELS)]
    if inside.size:
        lines = axes.contour(
            x, y, error, levels=inside, colors="k", linestyles="--", linewidths=0.9
        )
        axes.clabel(lines, fontsize=6, fmt=lambda v: f"{100 * v:.3g} % error")
    doubtful = error.fillna(2.0 * LARGE)
    if doubtful.max() > LARGE:
        top = max(float(doubtful.max()), 2.0 * LARGE)
        axes.contourf(x, y, doubtful, levels=[LARGE, top], colors="none", hatches=["////"])


def curve(axes: Axes, x: Any, values: Any, result: xr.Dataset, of_speed: bool) -> None:
    """Draw values over a number, with the band within which 95 of 100 such designs lie."""
    axes.set_title(said(result), fontsize=8)
    axes.plot(x, values, ".-", color=BLUE, ms=3)
    error = of(result)
    if error is not None and of_speed:
        off = np.abs(values) * error
        axes.fill_between(x, values - off, values + off, color=PALE_BLUE, lw=0, zorder=0)


def bars(axes: Axes, x: Any, y: Any, result: xr.Dataset, names: tuple[str, str]) -> None:
    """Draw the expected error of a speed on either axis."""
    error = of(result)
    if error is None:
        return
    off = [np.abs(v) * error if name in OF_SPEED else None for v, name in zip((x, y), names)]
    axes.errorbar(x, y, off[1], off[0], fmt="none", ecolor=BLACK, elinewidth=0.4, zorder=0)
