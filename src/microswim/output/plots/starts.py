"""Picture of a map of starts: how the path from each ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError
from microswim.output.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    NARROW,
    ORANGE,
    PALE,
    SKY,
    look,
    panels,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

#: Of each outcome; all else is a path that could not be followed.
COLOURS = {
    "free": PALE, "escaped": SKY, "orbits": BLUE, "trapped": GREEN, "touched": ORANGE,
    "inside": GREY,
}  # fmt: skip
FAILED = "no path"


def starts(found: xr.Dataset) -> Figure:
    """Return the figure of a map over one name or two.

    Parameters
    ----------
    found
        What `microswim.starts` gives.

    Raises
    ------
    SpecError
        If the map is over more than two names.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix")
    >>> found = ms.starts(robot, 1.0, {"tilt": [0.0, 0.5]}, model="rft", workers=0)
    >>> ms.plots.starts(found).axes[0].get_xlabel()
    'tilt (rad)'
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    dims = [str(d) for d in found.outcome.dims]
    if len(dims) > 2:
        raise SpecError("found", f"a map over {', '.join(dims)}", "one over one name or two")
    words = [*COLOURS, FAILED]
    codes = np.vectorize(lambda w: words.index(w if w in COLOURS else FAILED))(found.outcome.values)
    with look():
        figure, axes = panels(1, 1, (NARROW, 3.0 if len(dims) == 2 else 1.6))
        ax = axes[0][0]
        x = np.arange(found.sizes[dims[0]])
        y = np.arange(found.sizes[dims[1]]) if len(dims) == 2 else np.arange(1)
        colours = ListedColormap([*COLOURS.values(), BLACK])
        ax.pcolormesh(
            x, y, codes.reshape(len(x), -1).T, cmap=colours, vmin=-0.5, vmax=len(words) - 0.5,
            edgecolors="white", linewidth=0.5, shading="nearest",
        )  # fmt: skip
        _ticks(ax.xaxis, found, dims[0])
        if len(dims) == 2:
            _ticks(ax.yaxis, found, dims[1])
        else:
            ax.set_yticks([])
        seen = [Patch(color=colours(i), label=words[i]) for i in sorted(set(codes.ravel()))]
        figure.legend(
            handles=seen, loc="outside upper center", ncols=min(len(seen), 3), frameon=False
        )
    return figure


def _ticks(axis: Any, found: xr.Dataset, name: str) -> None:
    """Label an axis of cells by its values, some of them where there are many."""
    values = found[name].values
    every = max(1, -(-len(values) // 8))
    own = found[name].attrs.get("units", "")
    said = [f"{v:.3g}" if isinstance(v, (int, float)) else str(v) for v in values.tolist()]
    axis.set_ticks(range(0, len(values), every), said[::every])
    axis.set_label_text(f"{name} ({own})" if own else name)
