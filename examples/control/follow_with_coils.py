"""A robot follows a path on the currents of eight coils.

Left: the path (dashed) and what a printed helix of 2 mm swims; the robot and its coils are a spec
file, and any other with a magnet and coils may be given instead. Right: the currents, and how far
the robot is off. In each step the follower says how the field shall turn, the coils' calibration
which currents make it where the robot is with as little pull as they can, and the robot feels field
and pull of these currents, held over the step.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

SPEC = Path(__file__).with_name("coil_robot.toml")
STRENGTH, FREQUENCY, DT = 5e-3, 8.0, 4e-3  # T, Hz, s


def path(points=40, length=2e-3):
    """A rising bend, metres."""
    t = np.linspace(0.0, 1.0, points)
    return length * np.stack([-t, 0.4 * np.sin(3.0 * t), 0.3 * (1 - np.cos(4.0 * t))], axis=-1)


def main(spec=SPEC, seconds=8.0):
    robot = ms.Swimmer.from_toml(spec)
    wanted = path()
    follow = ms.PathFollower(swimmer=robot, path=wanted, strength=STRENGTH, frequency=FREQUENCY)
    stepper = ms.Stepper.of(robot, locked=True)
    state, rows = ms.State.at(), []
    for k in range(int(seconds / DT)):
        command = follow(state, dt=DT)
        if command.done:
            break
        state = stepper.step(state, dt=DT, **command.inputs)
        rows.append((k * DT, *state.position, command.off, *command.currents))
    rows = np.array(rows)
    return {
        "arrived": command.done,
        "off the path (mm, rms)": float(1e3 * np.sqrt(np.mean(rows[:, 4] ** 2))),
        "largest current (A)": float(np.abs(rows[:, 5:]).max()),
        "rows": rows,
        "path": wanted,
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.4), layout="constrained")
    grid = fig.add_gridspec(2, 2)
    left, top, low = (fig.add_subplot(grid[at]) for at in ((slice(2), 0), (0, 1), (1, 1)))
    rows, wanted = results["rows"], 1e3 * results["path"]
    for axis, name, colour in ((1, "y", "#D55E00"), (2, "z", "#0072B2")):
        left.plot(wanted[:, 0], wanted[:, axis], "--", color="#222222", lw=1)
        left.plot(1e3 * rows[:, 1], 1e3 * rows[:, 1 + axis], color=colour, lw=1, label=name)
    left.set(xlabel="x (mm)", ylabel="y, z (mm)", aspect="equal")
    left.legend(frameon=False, fontsize=8)
    some = rows[rows[:, 0] < 0.5]
    top.plot(some[:, 0], 1e3 * some[:, 5:9], lw=0.8)
    top.set(ylabel="currents (mA)", xlim=(0, 0.5), xlabel="time (s)")
    low.plot(rows[:, 0], 1e3 * rows[:, 4], color="#222222", lw=0.9)
    low.set(xlabel="time (s)", ylabel="off the path (mm)", ylim=(0, None))
    return fig


if __name__ == "__main__":
    results = main(*sys.argv[1:2])
    print({k: v for k, v in results.items() if isinstance(v, float)}, results["arrived"])
    figure(results).savefig("follow_with_coils.svg")
