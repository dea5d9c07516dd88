"""A magnetic helix that loses step.

A rigid magnetised helix without a motor in a field that turns ever faster. Dots: mean swimming
speed, stepped in time. Up to the step-out frequency the robot follows the field and its speed
grows in proportion (dashed). Beyond, the viscous torque would exceed the magnetic one: the robot
slips behind, and its speed falls along w - sqrt(w^2 - w_c^2) (solid), so driving faster makes it
slower. w_c is no fit: it is the largest magnetic torque times the mobility about the axis.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

MOMENT, FIELD = 1.0, 60.0  # the magnetic torque is 60 at most, in the units of the base case
TIME, STEP = 1000.0, 0.5


def main():
    gait = ms.Swimmer.preset("tabak/helix-constant").gait()
    robots = ms.Stepper(gait, moment=(0.0, MOMENT, 0.0), locked=True)
    rate = np.linspace(0.02, 0.5, 25)
    state = ms.State.at(position=np.zeros((len(rate), 3)))
    turning = np.stack([rate, 0.0 * rate, 0.0 * rate], axis=1)  # about x, the robots' axis
    for time in np.arange(0.0, TIME, STEP):
        angle = rate * time
        field = FIELD * np.stack([0.0 * angle, np.cos(angle), np.sin(angle)], axis=1)
        state = robots.step(state, dt=STEP, field=field, field_rate=turning)
    mobility = np.linalg.inv(gait.resistance(0.0))
    return {
        "rate": rate,
        "speed": np.abs(state.position[:, 0]) / TIME,
        "speed per rate": float(np.abs(mobility[0, 3]) / mobility[3, 3]),
        "step-out": float(MOMENT * FIELD * mobility[3, 3]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    axes = fig.subplots()
    k, wc = results["speed per rate"], results["step-out"]
    beyond = np.linspace(wc, results["rate"][-1], 100)
    axes.plot([0, wc], [0, k * wc], "--", color="#0072B2", label="in step")
    axes.plot(beyond, k * (beyond - np.sqrt(beyond**2 - wc**2)), color="#D55E00", label="slipping")
    axes.plot(results["rate"], results["speed"], "o", color="#222222", ms=4, label="in time")
    axes.set(xlabel="rate of the field (rad per time)", ylabel="speed (body diameters per time)")
    axes.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("step-out:", results["step-out"], "speed per rate:", results["speed per rate"])
    figure(results).savefig("step_out.svg")
