"""A magnetic helix that loses step.

A rigid magnetised helix without a motor in a field that turns ever faster, free to tilt. Line:
mean velocity along the field's axis of every state that it can be held in, solved. Dots: the same,
stepped in time from a robot that lies along the axis. Up to step-out the robot follows the field,
faster in proportion; beyond, the viscous torque would exceed the magnetic one: the robot slips
behind, and driving it faster makes it slower. Dashed, a robot on a rail, which cannot tilt:
w up to w_c, then w - sqrt(w^2 - w_c^2). With the moment across the helix the free robot hardly
differs from it.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

MOMENT, FIELD = 1.0, 60.0  # the magnetic torque is 60 at most, in the units of the base case
TURNS, FEW = 90, 30  # turns of the field that are followed, and left out at the start
STEP = np.pi / 8  # turn of the field in a step


def main():
    robot = ms.Swimmer.preset(
        "tabak/helix-constant",
        {
            "motion.free": "all",
            "magnet": {"moment": [0, MOMENT, 0]},
            "field": {"kind": "rotating", "strength": FIELD, "frequency": 0.01},
        },
    )
    gait = robot.gait()
    rate = np.linspace(0.02, 0.5, 25)
    told = ms.regimes(robot, rate / (2.0 * np.pi), gait=gait)
    robots = ms.Stepper(gait, robot, locked=True)
    state = ms.State.at(position=np.zeros((len(rate), 3)))
    turning = np.stack([rate, 0.0 * rate, 0.0 * rate], axis=1)  # about x, the robots' axis
    path = [state.position[:, 0]]
    for n in range(int(TURNS * 2.0 * np.pi / STEP)):
        B = robot.field.strength * np.array([0.0, np.cos(n * STEP), np.sin(n * STEP)])
        state = _each(robots, state, rate, B, turning)
        path.append(state.position[:, 0])
    last = np.array(path[int(FEW * 2.0 * np.pi / STEP) :])
    window = np.sin(np.pi * (np.arange(len(last) - 1) + 0.5) / (len(last) - 1)) ** 2
    mean = window @ np.diff(last, axis=0) / (window.sum() * STEP / rate)
    mobility = np.linalg.inv(gait.resistance(0.0))
    return {
        "rate": rate,
        "velocity": mean,
        "told": told,
        "rail step-out": float(MOMENT * FIELD * mobility[3, 3]),
        "rail velocity per rate": float(mobility[0, 3] / mobility[3, 3]),
    }


def _each(robots, state, rate, B, turning):
    """One step of each robot, of a time in which its own field turns by the same angle."""
    made = [
        robots.step(ms.State(one), dt=STEP / w, field=B, field_rate=about).values
        for one, w, about in zip(state.values, rate, turning)
    ]
    return ms.State(np.array(made))


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    axes = fig.subplots()
    told, k, wc = results["told"], results["rail velocity per rate"], results["rail step-out"]
    w = np.linspace(0.0, results["rate"][-1], 400)
    rail = k * (w - np.sqrt(np.maximum(w**2 - wc**2, 0.0)))
    turn = 2.0 * np.pi
    axes.plot(w, rail, "--", color="#6E6E6E", lw=1, label="on a rail")
    axes.plot(turn * told.frequency, told.velocity, color="#0072B2", label="solved")
    for f, states in zip(told.frequency, told.others):
        for _, velocity in states:
            axes.plot(turn * f, velocity, "_", color="#0072B2", ms=5)
    axes.plot(results["rate"], results["velocity"], "o", color="#222222", ms=4, label="in time")
    axes.axvline(turn * told.step_out, color="#D55E00", lw=1, ls=":", label="step-out")
    axes.set(xlabel="rate of the field (rad per time)", ylabel="velocity (body diameters per time)")
    axes.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("step-out:", 2.0 * np.pi * results["told"].step_out, "rail:", results["rail step-out"])
    figure(results).savefig("step_out.svg")
