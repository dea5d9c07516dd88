"""Table 3: interaction coefficients by the inverse problem, and by direct ratios.

The paper solves Eq. (15) backwards for the velocities of its CFD. For the helix those are printed,
so its table can be checked; for the plane wave they are not. The same problem is solved for the
velocities of our reference.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from microswim import data
from microswim.calibration.calibrate import calibrate
from microswim.calibration.unknowns import usual
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
from microswim.studies.paper.context import SETS, TAILS, Context, observed, swimmer

TITLE = "Table 3. Interaction coefficients"
CAPTION = (
    "Interaction coefficients that make Eq. (15) give the velocities of the CFD, and direct "
    "ratios of force to velocity. The CFD's velocities are printed for the helix alone; beside "
    "them stand those of our reference."
)
PRINTED_CFD = {"mean.us": -0.038, "amplitude.uq": 0.015, "mean.os": -0.4}
COLUMNS = {
    "helix": ("gamma_N_s", "gamma_N_q", "gamma_R_s"),
    "plane_wave": ("gamma_N_s", "gamma_N_q", "gamma_R_r"),
}


def printed(tail: str, coefficients: str) -> np.ndarray:
    """Return the paper's three coefficients."""
    row = data.load("tabak-table-3").sel(tail=tail, coefficients=coefficients)
    return np.array([float(row[c]) for c in COLUMNS[tail]])


def from_printed_cfd(context: Context, coefficients: str) -> np.ndarray:
    """Return the inverse problem for the helix with the velocities that the paper prints."""
    start = swimmer("helix", coefficients)
    velocities = {k: (v, abs(v) * 0.01) for k, v in PRINTED_CFD.items()}
    key = ("printed", coefficients)
    return context.once(key, lambda: calibrate(start, velocities).values)


def from_reference(context: Context, tail: str, coefficients: str) -> np.ndarray:
    """Return the inverse problem with the velocities of our reference."""
    start = swimmer(tail, coefficients)
    key = ("table3", tail, coefficients)
    names = usual(start)
    return context.once(key, lambda: calibrate(start, context.reference(start), names).values)


def ratios(context: Context, tail: str) -> np.ndarray:
    """Return the direct ratios of force to velocity of the reference's body (``Section 3.2.1``)."""
    start = swimmer(tail, "constant")
    return calibrate(start, context.reference(start), method="ratios").values


def ratio(context: Context, tail: str, index: int) -> float:
    """Return one entry of `ratios`."""
    return float(ratios(context, tail)[index])


def plane_wave_drag(context: Context) -> np.ndarray:
    """Return ``gamma_N,s`` by direct ratio for three ways in which the plane wave's surface may
    move.
    """
    out = []
    ways = (
        ("sheared", "translating"),
        ("perpendicular", "translating"),
        ("perpendicular", "bending"),
    )
    for sections, motion in ways:
        start = swimmer("plane_wave", "constant").with_(
            {"tail.sections": sections, "tail.surface_motion": motion}
        )
        gait = context.reference(start)
        phase = 2.0 * np.pi * np.arange(48) / 48
        drag = -gait.body_wrench(phase)[:, 0].mean() / gait.velocity(phase)[:, 0].mean()
        out.append(drag / start.body.diagonal(start.fluid.viscosity)[0])
    return np.array(out)


def drag_ratio_of_printed(context: Context) -> float:
    """Return the drag factor from the printed drag and velocity, ``81.7 / (6 pi mu r_b 0.038)``."""
    return float(81.7 / (swimmer("helix", "constant").body.diagonal(100.0)[0] * 0.038))


def lateral_ratio_of_printed(context: Context) -> float:
    """Return the lateral factor from the printed force and velocity, ``7.235 / (6 pi mu r_b
    0.015)``.
    """
    return float(7.235 / (swimmer("helix", "constant").body.diagonal(100.0)[1] * 0.015))


def one(context: Context, source: str, index: int, coefficients: str, tail: str = "helix") -> float:
    """Return one coefficient by the inverse problem for the printed velocities or our reference."""
    if source == "cfd":
        return float(from_printed_cfd(context, coefficients)[index])
    return float(from_reference(context, tail, coefficients)[index])


def base_component(context: Context, index: int, coefficients: str) -> float:
    """Return one entry of `base_case`."""
    return float(base_case(context, coefficients)[index])


def sign_of_turn(context: Context, coefficients: str) -> float:
    """Return sign of the plane wave's ``gamma_R,r`` by the inverse problem for our reference."""
    return float(np.sign(from_reference(context, "plane_wave", coefficients)[2]))


def base_case(context: Context, coefficients: str) -> np.ndarray:
    """Return base case of the helix with Table 3's coefficients: u_s, lateral, Omega_s (rad)."""
    return observed(swimmer("helix", coefficients).gait()) * np.array([1.0, 1.0, 2.0 * np.pi])


def total_is_definite(context: Context, coefficients: str = "constant") -> float:
    """Return the least eigenvalue of the plane wave's total R over the free motions, over the
    greatest.
    """
    gait = swimmer("plane_wave", coefficients).gait()
    f = np.flatnonzero(gait.free)
    phases = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    values = np.linalg.eigvalsh(gait.resistance(phases)[:, f[:, None], f])
    return float(values.min() / values.max())


def compute(context: Context) -> dict[str, Any]:
    """Return rows: tail, coefficients, the paper's, from the printed CFD, from our reference."""
    rows = []
    for tail in TAILS:
        for c in SETS:
            row: dict[str, Any] = {"tail": tail, "coefficients": c}
            mine = from_printed_cfd(context, c) if tail == "helix" else np.full(3, np.nan)
            ours = from_reference(context, tail, c) if context.circles else np.full(3, np.nan)
            for i, name in enumerate(COLUMNS[tail]):
                axis = "turn" if i == 2 else name[-1]
                row |= {f"γ_{axis} paper": printed(tail, c)[i],
                        f"γ_{axis} from its CFD": mine[i],
                        f"γ_{axis} from our reference": ours[i]}  # fmt: skip
            rows.append(row)
    return {"rows": rows}


def plot(result: dict[str, Any]) -> Figure:
    """Return three panels, one per coefficient; groups are tails and coefficient sets."""
    names = ["helix\nconst.", "helix\nSBT", "plane w.\nconst.", "plane w.\nSBT"]
    labels = {"s": r"$\gamma_{N,s}$", "q": r"$\gamma_{N,q}$",
              "turn": r"$\gamma_{R,s}$ (helix), $\gamma_{R,r}$ (plane wave)"}  # fmt: skip
    sources = (("paper", "the paper", GREY, "s"),
               ("from its CFD", "ours, for its CFD", ORANGE, "D"),
               ("from our reference", "ours, for our reference", BLUE, "o"))  # fmt: skip
    with look():
        figure, axes = panels(1, 3, (WIDE, 2.6))
        x = np.arange(4)
        for ax, (axis, label), name in zip(axes[0], labels.items(), "abc"):
            for j, (key, text, colour, mark) in enumerate(sources):
                y = [row[f"γ_{axis} {key}"] for row in result["rows"]]
                ax.plot(
                    x + 0.2 * (j - 1), y, ls="none", marker=mark, color=colour, label=text, ms=5
                )
            ax.axhline(1.0, color="black", lw=0.5, ls=":")
            ax.axhline(0.0, color="black", lw=0.7)
            ax.set(xticks=x, ylabel=label)
            ax.set_xticklabels(names, fontsize=6)
            letter(ax, name)
        legend_above(figure, axes[0, 0])
    return figure
