"""Look of the figures: one colour-blind-safe palette, journal sizes.

The palette is that of Okabe & Ito (2008); lines differ in their dashes too, so that the figures
survive a grey print. The dashes are the paper's: solid for the constant pair, dashed for
coefficients from slender body theory (SBT), circles for the reference.
"""

from __future__ import annotations

from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, PURPLE, SKY, GREY = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#6E6E6E",
)  # fmt: skip
CONSTANT = {"color": BLUE, "ls": "-", "lw": 1.4, "label": "model, constant $c_n$, $c_t$"}
SBT = {"color": ORANGE, "ls": (0, (4, 2)), "lw": 1.4, "label": "model, $c_n$, $c_t$ from SBT"}
REFERENCE = {
    "color": "black", "ls": "none", "marker": "o", "ms": 4.0, "mfc": "white", "mew": 0.9,
    "zorder": 3, "label": "boundary elements (ours)",
}  # fmt: skip
LINES = {"constant": CONSTANT, "sbt": SBT}
WIDE, NARROW = 7.1, 3.5

_LOOK: dict[str, Any] = {
    "font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8, "legend.fontsize": 7,
    "xtick.labelsize": 7, "ytick.labelsize": 7, "axes.linewidth": 0.7, "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans", "axes.spines.top": False, "axes.spines.right": False,
    "xtick.direction": "out", "ytick.direction": "out", "legend.frameon": False,
    "svg.hashsalt": "microswim", "svg.fonttype": "path", "savefig.dpi": 300,
}  # fmt: skip


def look() -> Any:
    """Context in which figures are made and saved."""
    return rc_context(_LOOK)


def panels(
    rows: int, columns: int, size: tuple[float, float], **options: Any
) -> tuple[Figure, Any]:
    """Figure and array of axes, without pyplot's global state."""
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def letter(axes: Axes, text: str) -> None:
    """Write the panel's letter above its left corner."""
    axes.set_title(f"({text})", loc="left", fontweight="bold")


def legend_above(figure: Figure, axes: Axes, columns: int = 3) -> None:
    """One legend for the whole figure, above it."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=columns)
