"""Seven bacteria from one.

Swimming speed of seven specimens of *Vibrio alginolyticus* of different size and motor speed.
Squares: the model with the drag of the isolated body. Circles: after two interaction coefficients
have been fitted to specimen C alone. Crosses: the measured values that the paper's statements
imply; the measurements themselves are in no text we have. What to see: one fit on one cell brings
the other six along.
"""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

INFERRED = {"C": 6.23, "G": 30.5}  # um/s; C serves the fit


def main():
    cells = {name: ms.Swimmer.preset(f"goto/{name}") for name in "ABCDEFG"}
    measured = {"forward_velocity": (6.23e-6, 0.06e-6), "body_rate_hz": (4.83, 0.05)}
    fit = ms.calibrate(cells["C"], measured)
    fitted = [replace(cell, interaction=fit.swimmer.interaction) for cell in cells.values()]
    return {
        "specimens": list(cells),
        "isolated body": np.array([1e6 * ms.screw(c.gait()).speed for c in cells.values()]),
        "fitted on C": np.array([1e6 * ms.screw(c.gait()).speed for c in fitted]),
        "Gamma_N": float(fit.values[0]),
        "Gamma_R": float(fit.values[1]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    axes = fig.subplots()
    at = np.arange(7)
    axes.plot(at, results["isolated body"], "s", color="#D55E00", mfc="none", label="isolated body")
    axes.plot(at, results["fitted on C"], "o", color="#0072B2", label="fitted on C")
    for name, value in INFERRED.items():
        label = "inferred from the paper" if name == "C" else None
        axes.plot(results["specimens"].index(name), value, "x", color="#222222", ms=9, label=label)
    axes.set_xticks(at, results["specimens"])
    axes.set(xlabel="specimen", ylabel="swimming speed (µm/s)", ylim=(0, None))
    axes.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("Gamma_N, Gamma_R:", results["Gamma_N"], results["Gamma_R"])
    figure(results).savefig("seven_cells.svg")
