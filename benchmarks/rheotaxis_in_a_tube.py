"""A helical robot in a tube through which fluid flows: where it goes at each speed, and a picture.

`python benchmarks/rheotaxis_in_a_tube.py [PICTURE]`: poses are solved first, some minutes, and
kept. The robot is the paper's base case in a tube of three body diameters.
"""

import sys
from dataclasses import replace

from matplotlib.figure import Figure

import microswim as ms
from microswim.calibration.poses.tube import in_tube
from microswim.numerics.rigid_motion import rotation_matrix

RADIUS = 1.5
ROBOT = replace(
    ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"}),
    channel=ms.Channel(diameter=2 * RADIUS, length=30.0, position=(0.0, 0.2, 0.3), tilt=0.3),
)
SPEEDS = (0.0, 0.03, 0.1, 0.3)
TIME, SAMPLES = 600.0, 3001


def at_speed(speed, poses):
    """Path of the robot in a flow of a speed on the axis, along x: against the way it heads."""
    flow = ms.PoiseuilleFlow(speed=speed, diameter=2 * RADIUS) if speed else None
    return ms.path(replace(ROBOT, flow=flow), TIME, poses=poses, samples=SAMPLES)


def row(speed, found):
    """Mean velocity, heading, and distance from the axis over the second half."""
    half = SAMPLES // 2
    x, q = found.position.values, found.quaternion.values
    drift = (x[-1] - x[half])[0] / (TIME / 2.0)
    heading = -rotation_matrix(q[half:])[:, 0, 0]
    away = ((x[half:, 1] ** 2 + x[half:, 2] ** 2) ** 0.5).mean()
    return (
        f"| {speed:g} | {drift:.4f} | {heading.mean():.2f} | {heading.min():.2f} | {away:.2f} | "
        f"{found.attrs['outcome']} |"
    )


def picture(paths):
    figure = Figure(figsize=(7.2, 3.2), layout="constrained")
    sides, along = figure.subplots(2, 4)
    for speed, side, end in zip(SPEEDS, sides, along):
        x = paths[speed].position.values
        side.plot(x[:, 0], x[:, 2], color="#0072B2", lw=0.7)
        side.plot(x[0, 0], x[0, 2], "o", color="#222222", ms=3)
        for wall in (-RADIUS, RADIUS):
            side.axhline(wall, color="#222222", lw=1)
        end.plot(x[:, 1], x[:, 2], color="#0072B2", lw=0.7)
        end.plot(x[0, 1], x[0, 2], "o", color="#222222", ms=3)
        end.add_patch(_ring())
        end.set(xlim=(-1.6, 1.6), ylim=(-1.6, 1.6), aspect="equal", xlabel="y")
        side.set(xlabel="x", title=f"flow {speed:g}")
    sides[0].set_ylabel("z")
    along[0].set_ylabel("z")
    return figure


def _ring():
    from matplotlib.patches import Circle

    return Circle((0.0, 0.0), RADIUS, fill=False, color="#222222", lw=1)


def main(name=None, poses=None):
    poses = in_tube(ROBOT) if poses is None else poses
    paths = {speed: at_speed(speed, poses) for speed in SPEEDS}
    print(
        "| flow on the axis | drift along it | heading along it | least | off the axis | outcome |"
    )
    print("|---|---|---|---|---|---|")
    for speed, found in paths.items():
        print(row(speed, found))
    if name:
        picture(paths).savefig(name, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:2])
