"""The one look of all figures: a palette that the colour-blind tell apart, journal sizes.

A swimmer has the colours of the page and of films (`gait.palette`).

The palette is that of Okabe & Ito (2008); lines differ in their dashes too, so that figures survive
a grey print. Letters are outlines in SVG, the same on every machine.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from microswim.gait.palette import BODY as BODY
from microswim.gait.palette import TAIL as TAIL
from microswim.gait.readable import label, prefixed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
SKY, GREY, BLACK = "#56B4E9", "#6E6E6E", "#222222"
PALE_BLUE, PALE_ORANGE, PALE_GREEN = "#D3E6F3", "#F8DFD2", "#D5EEE4"  # behind lines
PALE = "#E6E6E6"
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, "#E69F00", GREY, BLACK)
LINES = ((BLUE, "-"), (ORANGE, (0, (5, 1.5))), (BLACK, (0, (5, 1, 1, 1))))
WIDE, NARROW = 7.2, 3.5  # inches: two columns, one

STYLE: dict[str, Any] = {
    "hatch.linewidth": 0.4,
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 300,
    "svg.fonttype": "path",
    "svg.hashsalt": "microswim",
    "pdf.fonttype": 42,
}


def look() -> Any:
    """Return the context in which figures are made and saved."""
    from matplotlib import rc_context
    from matplotlib.rcsetup import cycler

    style: Any = STYLE | {"axes.prop_cycle": cycler(color=CYCLE)}
    return rc_context(style)


def blank(width: float, height: float) -> Figure:
    """Return an empty figure of a size in inches, without pyplot's global state."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def panels(
    rows: int, columns: int, size: tuple[float, float], **options: Any
) -> tuple[Figure, Any]:
    """Return a figure and its array of axes."""
    figure = blank(*size)
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def letter(axes: Axes, text: str) -> None:
    """Write the panel's letter above its left corner."""
    axes.set_title(f"({text})", loc="left", fontweight="bold")


def legend_above(figure: Figure, axes: Axes, columns: int = 3) -> None:
    """Put one legend for the whole figure above it, of what is drawn."""
    drawn = [
        (handle, text)
        for handle, text in zip(*axes.get_legend_handles_labels())
        if _is_drawn(handle)
    ]
    figure.legend(*zip(*drawn), loc="outside upper center", ncols=columns)


def _is_drawn(handle: Any) -> bool:
    """Whether a line has a point that is a number; anything else counts as drawn."""
    import numpy as np

    points = getattr(handle, "get_ydata", None)
    return points is None or bool(np.isfinite(np.asarray(points(), dtype=float)).any())


def few_ticks(axes: Axes, most: int = 5) -> None:
    """Thin out the numbers along x, so that long ones do not run into each other."""
    from matplotlib.ticker import MaxNLocator

    axes.xaxis.set_major_locator(MaxNLocator(most))


def log_ticks(axes: Axes) -> None:
    """Name 1, 2 and 5 of each decade along a logarithmic x; over three decades the tens alone."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axes.get_xlim()
    narrow = high < 1000.0 * low
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if narrow else (1.0,)))
    axes.xaxis.set_minor_formatter(NullFormatter())
    if narrow:
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))


def readable(values: Any, name: str, unit: str) -> tuple[float, str]:
    """Return the factor and the label of an axis in a unit that reads well.

    Examples
    --------
    >>> from microswim.output.plots.style import readable
    >>> readable([1e-6, 3e-6], "tail.radius", "m")[1]
    'tail.radius (µm)'
    """
    import numpy as np

    size = np.abs(np.asarray(values, dtype=float))
    factor, shown = prefixed(float(np.nanmax(size, initial=0.0)), unit)
    return factor, label(name, shown)
