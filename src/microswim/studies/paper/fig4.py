"""Fig. 4: helical tails, model against reference: forward and lateral velocity, body rotation.

Six panels: against amplitude (a-c) and number of waves (d-f). Lines: the paper's model with both
coefficient sets; circles: our boundary elements in place of the paper's CFD.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from microswim.output.plots.style import WIDE, legend_above, letter, look, panels
from microswim.studies.paper.context import (
    AMPLITUDE,
    PAPER_RANGE,
    SETS,
    WAVES,
    Context,
    circles,
    lines,
    observed,
    sweep,
    swimmer,
)
from microswim.studies.paper.style import LINES, REFERENCE

TITLE = "Fig. 4. Swimmer with a helical tail"
CAPTION = (
    "Helical tails against amplitude (a-c) and number of waves (d-f). Lines: the paper's model "
    "with either set of coefficients; circles: our boundary elements, in place of the paper's "
    "CFD."
)
AXES = {AMPLITUDE: "amplitude, $b$ / body diameter", WAVES: r"number of waves, $N_\lambda$"}
ROWS = (
    r"$\overline{u}_s$ ($D_b$ / period)",
    r"$v_{q,\,\mathrm{max}}$ ($D_b$ / period)",
    r"$\overline{\Omega}_s$ (rev / period)",
)


def compute(context: Context) -> dict[str, Any]:
    """Return both sweeps of the helical tail."""
    return sweep(context, "helix")


def plot(result: dict[str, Any]) -> Figure:
    """Return six panels as in the paper."""
    return six_panels(result, ROWS)


def six_panels(result: dict[str, Any], rows: tuple[str, ...]) -> Figure:
    """Return two columns of sweeps, three rows of quantities."""
    with look():
        figure, axes = panels(2, 3, (WIDE, 4.4))
        for j, parameter in enumerate(AXES):
            part = result[parameter]
            for i, label in enumerate(rows):
                ax = axes[j, i]
                for c in SETS:
                    ax.plot(part["x"], part[c][:, i], **LINES[c])
                ax.plot(part["x_reference"], part["reference"][:, i], **REFERENCE)
                ax.set(xlabel=AXES[parameter], ylabel=label)
                ax.set_ylim(bottom=0.0) if part["sbt"][1, i] > 0 else ax.set_ylim(top=0.0)
                letter(ax, "abcdef"[3 * j + i])
        legend_above(figure, axes[0, 0])
    return figure


def peaks(x: np.ndarray, y: np.ndarray, low: float = 2.2, high: float = 4.8) -> np.ndarray:
    """Return places of the local maxima of y inside (low, high), polished by a parabola."""
    i = np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1
    i = i[(x[i] > low) & (x[i] < high)]
    bend = y[i - 1] - 2.0 * y[i] + y[i + 1]
    return x[i] + 0.5 * (y[i - 1] - y[i + 1]) / bend * (x[1] - x[0])


def peak_places(
    context: Context, tail: str = "helix", coefficients: str = "sbt", quantity: int = 1
) -> np.ndarray:
    """Return numbers of waves between 2.2 and 4.8 at which a line of Fig. 4 or 5 peaks."""
    x = np.linspace(2.0, 5.0, 241)
    return peaks(x, lines(swimmer(tail, coefficients), {WAVES: x})[:, quantity])


def peaks_both_ramps(
    context: Context, tail: str, coefficients: str = "sbt", quantity: int = 1
) -> np.ndarray:
    """Return `peak_places` with the ramp and without it, shape (2, n)."""
    x = np.linspace(2.0, 5.0, 241)
    return np.array([
        peaks(x, lines(swimmer(tail, coefficients, change), {WAVES: x})[:, quantity])
        for change in ({}, {"tail.ramp": 0.0})
    ])  # fmt: skip


def errors_both_rates(context: Context, coefficients: str) -> np.ndarray:
    """Return `error_at` of the body rate at b = 0.15, the tail's rate relative to body and in the
    lab.
    """
    who = swimmer("helix", coefficients, {AMPLITUDE: 0.15})
    reference = observed(context.reference(swimmer("helix", "constant", {AMPLITUDE: 0.15})))[2]
    rates = [
        observed(who.with_({"motion.frequency_frame": frame}).gait())[2]
        for frame in ("body", "lab")
    ]
    return 100.0 * np.abs(np.array(rates) / reference - 1.0)


def lateral_loss(context: Context, coefficients: str = "sbt") -> np.ndarray:
    """Return lateral amplitude at its peaks near N = 1.5, 2.5, 3.5, 4.5, relative to the first."""
    x = np.linspace(1.0, 5.0, 321)
    y = lines(swimmer("helix", coefficients), {WAVES: x})[:, 1]
    tops = np.array([y[(x >= n) & (x <= n + 1)].max() for n in (1, 2, 3, 4)])
    return tops / tops[0]


def last_peak(context: Context, coefficients: str = "sbt") -> float:
    """Return the lateral amplitude at the peak near N = 4.5 over that near 1.5."""
    return float(lateral_loss(context, coefficients)[-1])


def spread(context: Context, coefficients: str = "sbt", quantity: int = 0) -> float:
    """Return how much a line of Fig. 4 varies over 2 to 4 waves, (largest - least) / mean (%)."""
    y = lines(swimmer("helix", coefficients), {WAVES: np.linspace(2.0, 4.0, 81)})[:, quantity]
    return float(100.0 * np.ptp(y) / abs(y.mean()))


def errors(context: Context, tail: str, coefficients: str, parameter: str) -> dict[str, np.ndarray]:
    """Return the model and reference at the circles inside the paper's range, each (n, 3)."""
    low, high = PAPER_RANGE[parameter]
    x = context.sweeps[parameter]
    inside = (x >= low) & (x <= high)
    return {
        "x": x[inside],
        "model": lines(swimmer(tail, coefficients), {parameter: x[inside]}),
        "reference": circles(context, tail, parameter)[inside],
    }


def error(
    context: Context, tail: str, coefficients: str, parameter: str, quantity: int, which: str
) -> float:
    """Return error of the model against our reference: mean or greatest, absolute or in percent."""
    found = errors(context, tail, coefficients, parameter)
    model, reference = found["model"][:, quantity], found["reference"][:, quantity]
    off = np.abs(model - reference)
    off = 100.0 * off / np.abs(reference) if "percent" in which else off
    return float(off.mean() if which.startswith("mean") else off.max())


def error_at(context: Context, coefficients: str, b: float = 0.15, quantity: int = 2) -> float:
    """Return the error of the helical model at one amplitude, percent of the reference."""
    who = swimmer("helix", coefficients, {AMPLITUDE: b})
    model = lines(who, {AMPLITUDE: np.array([b])})[0, quantity]
    reference = observed(context.reference(swimmer("helix", "constant", {AMPLITUDE: b})))[quantity]
    return float(100.0 * abs(model / reference - 1.0))
