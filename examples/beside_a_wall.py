"""Beside a wall.

The base case at some distance from a plane wall, by boundary elements with the wall's image
system. Left axis (dots): forward velocity over that far away. Right axis (squares): rate at which
the wall turns the body about its axis across the wall. Closer to the wall the swimmer turns more
and more in the plane of the wall: this is why bacteria swim in circles near a surface.
"""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import microswim as ms


def main():
    robot = ms.Swimmer.preset("tabak/helix")
    free = robot.gait("bem", level="coarse").mean_velocity
    distance = np.array([0.7, 1.0, 2.5])
    near = []
    for h in distance:
        placed = replace(robot, wall=ms.Wall(float(h)))  # the wall lies at q = -h, its normal is q
        near.append(placed.gait("bem", level="coarse").mean_velocity)
    near = np.array(near)
    return {
        "distance": distance,
        "speed ratio": near[:, 0] / free[0],
        "turning": near[:, 4],
        "speed ratio at 0.7": float(near[0, 0] / free[0]),
        "turning at 0.7": float(near[0, 4]),
        "turning at 2.5": float(near[-1, 4]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    axes = fig.subplots()
    axes.plot(results["distance"], results["speed ratio"], "o-", color="#0072B2")
    axes.set(xlabel="distance of the body's centre from the wall (body diameters)")
    axes.set_ylabel("$u_s$ / far away (dots)", color="#0072B2")
    right = axes.twinx()
    right.plot(results["distance"], results["turning"], "s--", color="#D55E00")
    right.set_ylabel("turning about the normal\n(rad per period; squares)", color="#D55E00")
    return fig


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if isinstance(v, float)), sep="\n")
    figure(results).savefig("beside_a_wall.svg")
