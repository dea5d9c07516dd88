"""Where the fastest helix is.

Swimming speed over amplitude and number of waves; bright is fast. Without a limit one would take
a single wide turn. But this motor gives a torque of 150 (in the units of the base case), and only
what lies left of the dashed line can be driven. Star: the optimum that `microswim.design` finds
under that limit. It sits on the dashed line, at its brightest place: the motor sets the
amplitude, the fluid the three waves.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

LIMIT = 150.0


def main():
    robot = ms.Swimmer.preset("tabak/helix-constant")
    best = ms.design(
        robot,
        {"tail.amplitude": (0.02, 0.3), "tail.waves": (0.5, 4.0)},
        maximize="swimming_speed",
        subject_to=f"mean_torque <= {LIMIT}",
    )
    amplitude, waves = np.linspace(0.02, 0.3, 57), np.linspace(0.5, 4.0, 51)
    grid = np.meshgrid(amplitude, waves, indexing="ij")
    names = ("tail.amplitude", "tail.waves")
    many = ms.evaluate(robot, dict(zip(names, (g.ravel() for g in grid))))
    return {
        "amplitude": amplitude,
        "waves": waves,
        "speed": many["swimming_speed"].reshape(grid[0].shape),
        "torque": many["mean_torque"].reshape(grid[0].shape),
        "best amplitude": best.values["tail.amplitude"],
        "best number of waves": best.values["tail.waves"],
        "best speed": best.value,
        "torque of the best": best.quantities["mean_torque"],
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.6), layout="constrained")
    axes = fig.subplots()
    x, y = results["amplitude"], results["waves"]
    filled = axes.contourf(x, y, results["speed"].T, levels=16, cmap="cividis")
    fig.colorbar(filled, label="swimming speed (body diameters per period)")
    axes.contour(x, y, results["torque"].T, [LIMIT], colors="#f5f5f5", linestyles="--")
    best = results["best amplitude"], results["best number of waves"]
    axes.plot(*best, "*", color="#D55E00", mec="#f5f5f5", ms=14)
    axes.set(xlabel="amplitude of the helix (body diameters)", ylabel="number of waves")
    return fig


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if isinstance(v, float)), sep="\n")
    figure(results).savefig("best_helix.svg")
