"""What one calibration point is worth.

Forward velocity against the amplitude of the helix. Dots: boundary elements, the reference.
Dashed: the surrogate as it comes, far too fast for so thick a filament. Solid: the surrogate with
interaction coefficients fitted at amplitude 0.1 alone (ring). It is right there by construction
and drifts away on both sides: one point has a small neighbourhood. A calibration over a region
(`calibrate_region`) has not.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

AT = 0.1


def main():
    robot = ms.Swimmer.preset("tabak/helix")
    amplitude = np.array([0.04, 0.07, 0.1, 0.13])
    solved = [robot.with_({"tail.amplitude": b}).gait("bem", level="coarse") for b in amplitude]
    fit = ms.calibrate(robot, solved[2])
    fine = np.linspace(0.02, 0.15, 40)
    plain = ms.evaluate(robot, {"tail.amplitude": fine})["mean_velocity"][:, 0]
    fitted = ms.evaluate(fit.swimmer, {"tail.amplitude": fine})["mean_velocity"][:, 0]
    reference = np.array([g.mean_velocity[0] for g in solved])
    return {
        "amplitude": amplitude,
        "reference": reference,
        "fine": fine,
        "plain": plain,
        "fitted": fitted,
        "error at the point": float(fit.swimmer.gait().mean_velocity[0] / reference[2] - 1.0),
        "error at 0.04": float(np.interp(0.04, fine, fitted) / reference[0] - 1.0),
        "plain over reference": float(np.interp(AT, fine, plain) / reference[2]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    axes = fig.subplots()
    axes.plot(results["fine"], -results["plain"], "--", color="#D55E00", label="surrogate")
    axes.plot(results["fine"], -results["fitted"], color="#0072B2", label="fitted at 0.1")
    axes.plot(results["amplitude"], -results["reference"], "o", color="#222222", label="reference")
    axes.plot(AT, -results["reference"][2], "o", mfc="none", mec="#0072B2", ms=12)
    axes.set(
        xlabel="amplitude of the helix (body diameters)",
        ylabel="$-u_s$ (body diameters per period)",
        ylim=(0, None),
    )
    axes.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if isinstance(v, float)), sep="\n")
    figure(results).savefig("one_point_calibration.svg")
