"""A bacterium beside a wall in a shear: where it goes at each shear rate, and a picture.

`python benchmarks/rheotaxis.py [PICTURE]`: poses are solved first, some minutes, and kept. The cell
is like E. coli: a spheroid of 2.5 um by 0.9 um, a left-handed flagellum of 6.5 um at 130 Hz.
"""

import sys
from dataclasses import replace

from matplotlib.figure import Figure

import microswim as ms
from microswim.calibration.poses.wall import beside_wall
from microswim.numerics.rigid_motion import rotation_matrix

CELL = ms.Swimmer(
    body=ms.Spheroid(semi_axes=(1.25e-6, 0.45e-6)),
    tail=ms.HelicalTail(
        length=6.5e-6, amplitude=0.2e-6, waves=2.6, radius=0.05e-6, frequency=130.0, ramp=0.3
    ),
    fluid=ms.Fluid(viscosity=1e-3, density=1000.0),
    units="SI",
    wall=ms.Wall(1.2e-6),
)
RATES = (0.0, 0.25, 0.5, 4.0)
TIME, SAMPLES = 40.0, 2001
UM = 1e6


def in_shear(rate, poses):
    """Path of the cell at a shear rate, along x."""
    cell = replace(CELL, flow=ms.ShearFlow(rate=rate) if rate else None)
    return ms.path(cell, TIME, poses=poses, samples=SAMPLES)


def row(rate, found):
    """Mean velocity, heading and gap over the second half."""
    half = SAMPLES // 2
    x, q = found.position.values, found.quaternion.values
    drift = UM * (x[-1] - x[half]) / (TIME / 2.0)
    heading = -rotation_matrix(q[half:])[:, :, 0].mean(axis=0)
    gap = UM * float(found.gap.values[half:].mean())
    return f"| {rate:g} | {drift[0]:.1f} | {drift[1]:.1f} | {heading[0]:.2f} | {gap:.2f} |"


def picture(paths):
    figure = Figure(figsize=(7.2, 2.6), layout="constrained")
    for axes, rate in zip(figure.subplots(1, 4), RATES):
        x = UM * paths[rate].position.values
        axes.plot(x[:, 0], x[:, 1], color="#0072B2", lw=1)
        axes.plot(*x[0, :2], "o", color="#222222", ms=4)
        axes.set(xlabel="x (µm)", title=f"{rate:g} per second")
        axes.set_aspect("equal", "datalim")
    figure.axes[0].set_ylabel("y (µm)")
    return figure


def main(name=None, poses=None):
    poses = beside_wall(CELL) if poses is None else poses
    paths = {rate: in_shear(rate, poses) for rate in RATES}
    print("| shear (1/s) | drift along the flow (um/s) | across it | heading along it | gap (um) |")
    print("|---|---|---|---|---|")
    for rate, found in paths.items():
        print(row(rate, found))
    if name:
        picture(paths).savefig(name, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:2])
