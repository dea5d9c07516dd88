"""Two tails of opposite hands.

A sphere with two helical tails that are mirror images of one another, the tails spread more and
more. The mirror forbids rolling about the axis: what one tail does to the body the other undoes.
What it allows is a turn about the axis along which the tails are spread, so the robot swims on a
circle. Left: speed of the head; right: radius of its circle. Tails that are spread further turn the
robot on a tighter circle, on which the head swings about the middle and so is faster.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms


def main():
    robot = ms.Swimmer.preset("several/two-tails")
    spread = np.linspace(0.1, 1.2, 12)
    means = []
    for q in spread:
        directions = {"tail[0].direction": (1.0, q, 0.0), "tail[1].direction": (1.0, -q, 0.0)}
        means.append(robot.with_(directions).gait().mean_velocity)
    means = np.array(means)
    return {
        "angle": np.degrees(np.arctan(spread)),
        "means": means,
        "speed": np.linalg.norm(means[:, :3], axis=1),
        "radius": np.linalg.norm(means[:, :3], axis=1) / np.abs(means[:, 4]),
        "rolling over turning": float(np.abs(means[:, 3] / means[:, 4]).max()),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    left, right = fig.subplots(1, 2)
    left.plot(results["angle"], results["speed"], "o-", color="#0072B2")
    left.set(ylabel="speed (body diameters/turn)", ylim=(0, None))
    right.plot(results["angle"], results["radius"], "s-", color="#D55E00")
    right.set(ylabel="radius (body diameters)", ylim=(0, None))
    for axes in (left, right):
        axes.set(xlabel="angle of each tail off the axis (degrees)")
    return fig


if __name__ == "__main__":
    results = main()
    print("rolling over turning:", results["rolling over turning"])
    figure(results).savefig("two_tails.svg")
