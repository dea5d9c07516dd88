"""A first swim.

The base case of the paper: a sphere of diameter 1 pushed by a left-handed helix of three turns.
Look at the top picture first: body and tail are drawn to scale, the line is the path of the
body's centre. It advances by 0.037 body diameters per turn of the motor, body first. Below, seen
from behind: the centre runs round a small circle, because the ramp at the root leaves the three
turns slightly unbalanced.
"""

import microswim as ms


def main():
    swimmer = ms.Swimmer.preset("tabak/helix-constant")
    gait = swimmer.gait()
    run = ms.io.dataset(swimmer, gait, periods=25)
    screw = ms.screw(gait)
    return {
        "forward velocity": gait.mean_velocity[0],
        "body rate": gait.mean_velocity[3],
        "swimming speed": screw.speed,
        "radius of the path": screw.radius,
        "run": run,
        "swimmer": swimmer,
    }


def figure(results):
    return ms.plots.trajectory(results["run"], results["swimmer"])


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if isinstance(v, float)), sep="\n")
    figure(results).savefig("first_swim.svg")
