"""Fig. 3: ratio c_n / c_t of Lighthill's coefficients against waves and amplitude [Eqs. 7, 8].

For a plane wave alpha is averaged over the wavelength, as in the paper; the constant pair's ratio
is a horizontal line.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from microswim.output.plots.style import (
    BLUE,
    GREY,
    ORANGE,
    WIDE,
    legend_above,
    letter,
    look,
    panels,
)
from microswim.studies.paper.context import AMPLITUDE, TAILS, WAVES, Context, swimmer

TITLE = "Fig. 3. Ratio of the local resistances"
CAPTION = (
    "Ratio of the local resistances of Lighthill's slender-body theory, Eqs. (7) and (8), against "
    "the number of waves and the amplitude. For a plane wave α is averaged over the wavelength, "
    "as in the paper; dotted: the constant pair."
)


def ratio(tail: str, coefficients: str, changes: dict[str, float]) -> float:
    """Return ``c_n / c_t`` of one design."""
    who = swimmer(tail, coefficients, changes)
    c_t, c_n = who.coefficients.pair(who.tail, who.fluid.viscosity)
    return float(c_n / c_t)


def compute(context: Context) -> dict[str, Any]:
    """Return ratios of both tails along both sweeps, and that of the constant pair."""
    out: dict[str, Any] = {"constant": ratio("helix", "constant", {})}
    for parameter, x in ((WAVES, np.linspace(1, 5, 81)), (AMPLITUDE, np.linspace(0.01, 0.15, 57))):
        lines = {t: np.array([ratio(t, "sbt", {parameter: v}) for v in x]) for t in TAILS}
        out[parameter] = {"x": x, **lines}
    return out


def plot(result: dict[str, Any]) -> Figure:
    """Return two panels: against the number of waves and against the amplitude."""
    lines = {
        "helix": {"color": BLUE, "ls": "-", "label": "rotating rigid helix, SBT"},
        "plane_wave": {"color": ORANGE, "ls": (0, (4, 2)), "label": "travelling plane wave, SBT"},
    }
    with look():
        figure, axes = panels(1, 2, (WIDE, 2.7), sharey=True)
        for ax, name, parameter in zip(axes[0], "ab", (WAVES, AMPLITUDE)):
            for tail, line in lines.items():
                ax.plot(result[parameter]["x"], result[parameter][tail], **line)
            ax.axhline(result["constant"], color=GREY, ls=":", label="constant pair")
            letter(ax, name)
        axes[0, 0].set(xlabel=r"number of waves, $N_\lambda$", ylabel="$c_n / c_t$")
        axes[0, 1].set(xlabel="amplitude, $b$ / body diameter")
        legend_above(figure, axes[0, 0])
    return figure
