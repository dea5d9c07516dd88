"""Table 2: the seven specimens of Vibrio alginolyticus, to scale."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from microswim import data
from microswim.output.plots.style import BLUE, GREY, PALE, WIDE, look, panels
from microswim.studies.paper.context import Context
from microswim.swimmer.swimmer import Swimmer

TITLE = "Table 2. Specimens of Vibrio alginolyticus"
CAPTION = "The seven specimens, drawn to one scale."
SPECIMENS = "ABCDEFG"
MICRO = 1e6


def compute(context: Context) -> dict[str, Any]:
    """Return the table, and what our presets make of it: the filament's apparent length."""
    table = data.load("tabak-table-2")
    rows = []
    for name in SPECIMENS:
        row = table.sel(specimen=name)
        tail = Swimmer.preset(f"goto/{name}").tail
        rows.append({
            "specimen": name, "frequency (Hz)": float(row.frequency),
            "tail length (µm)": float(row.tail_length),
            "r_s (µm)": float(row.body_semi_axis_s), "r_q (µm)": float(row.body_semi_axis_q),
            "apparent length, ours (µm)": MICRO * float(tail.apparent_length),
            "waves, ours": float(tail.number_of_waves),
        })  # fmt: skip
    return {"rows": rows}


def preset_numbers(context: Context, field: str) -> np.ndarray:
    """Return one column of the table out of our presets, in its unit."""
    paths = {
        "frequency": ("tail.frequency", 1.0), "tail_length": ("tail.length", MICRO),
        "body_semi_axis_s": ("body.semi_axes[0]", MICRO),
        "body_semi_axis_q": ("body.semi_axes[1]", MICRO),
    }  # fmt: skip
    path, unit = paths[field]
    return np.array([unit * Swimmer.preset(f"goto/{n}").numbers[path] for n in SPECIMENS])


def plot(result: dict[str, Any]) -> Figure:
    """Return the seven cells below each other, to scale."""
    with look():
        figure, axes = panels(1, 1, (WIDE, 3.4))
        ax = axes[0, 0]
        for i, name in enumerate(SPECIMENS):
            who = Swimmer.preset(f"goto/{name}")
            r_s, r_q, _ = (MICRO * a for a in who.body.semi_axes3)
            s = np.linspace(0.0, float(who.tail.apparent_length), 500)
            P = MICRO * who.tail.centreline(s, 0.0)[0]
            ax.plot(P[:, 0], P[:, 1] - 1.25 * i, color=BLUE, lw=1.1)
            ax.add_patch(
                Ellipse((-r_s, -1.25 * i), 2 * r_s, 2 * r_q, facecolor=PALE, edgecolor=GREY)
            )
            ax.text(-5.0, -1.25 * i, name, va="center", fontweight="bold")
        ax.set(aspect="equal", xlim=(-5.3, 5.2), xlabel="s (µm)")
        ax.get_yaxis().set_visible(False)
        ax.spines["left"].set_visible(False)
    return figure
