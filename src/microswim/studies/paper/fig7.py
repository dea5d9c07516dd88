"""Fig. 7: Lighthill's periodic integrals A_1 and A_2 against alpha squared [Tabak Eqs. 25-28].

The paper does not say which epsilon its curves have. Drawn are the base case's filament and
wavelength, ``epsilon = 5.2 r_t alpha / lambda``, and the limit of a thin filament.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from microswim.output.plots.style import BLUE, NARROW, ORANGE, look, panels
from microswim.studies.paper.context import Context, swimmer
from microswim.swimmer.drag.lighthill import lighthill_integrals
from microswim.swimmer.geometry.tails.kinds import as_wave

THIN = 1e-7  # epsilon of a thin filament; the integrals then differ from their limit by 1e-14
TITLE = "Fig. 7. Lighthill's integrals"
CAPTION = (
    "Lighthill's integrals A₁ and A₂ of Eqs. (27) and (28) against α². The paper does not say "
    "which ε its curves have: drawn are that of the base case and the limit of a thin filament."
)


def compute(context: Context) -> dict[str, Any]:
    """Return both integrals over alpha squared from 0.05 to 1."""
    square = np.linspace(0.05, 1.0, 120)
    alpha = np.sqrt(square)
    tail = as_wave(swimmer("helix", "sbt").tail)
    epsilon = 5.2 * tail.radius * alpha * tail.wavenumber / (2.0 * np.pi)
    return {
        "alpha_squared": square,
        "base": np.array(lighthill_integrals(alpha, epsilon)),
        "thin": np.array(lighthill_integrals(alpha, THIN)),
    }


def plot(result: dict[str, Any]) -> Figure:
    """Return A_1 and A_2 against alpha squared."""
    with look():
        figure, axes = panels(1, 1, (NARROW, 2.6))
        ax, x = axes[0, 0], result["alpha_squared"]
        for i, (colour, dash) in enumerate(((BLUE, "-"), (ORANGE, (0, (4, 2))))):
            ax.plot(x, result["base"][i], color=colour, ls=dash, label=f"$A_{i + 1}$, base case")
            ax.plot(
                x,
                result["thin"][i],
                color=colour,
                ls=":",
                lw=1,
                label=rf"$A_{i + 1}$, $\epsilon\to 0$",
            )
        ax.set(xlabel=r"$\alpha^2$", ylabel="$A_1$, $A_2$", xlim=(0, 1))
        ax.legend()
    return figure


def unity_limit(context: Context) -> np.ndarray:
    """Return ``A_1, A_2`` of a straight thin filament, alpha = 1, epsilon to 0."""
    return np.array(lighthill_integrals(1.0, THIN))
