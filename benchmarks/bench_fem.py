"""Finite elements: cost, the four ways of moving the tail, sphere in a cylinder, inertia, designs.

    python benchmarks/bench_fem.py cost coarse standard   # unknowns, seconds by part, memory
    python benchmarks/bench_fem.py ways standard 10       # four ways, channel diameter 10
    python benchmarks/bench_fem.py sphere coarse standard # against Bohlin and Brenner
    python benchmarks/bench_fem.py inertia                # Re = 0, 0.01, 0.1, 1
    python benchmarks/bench_fem.py designs coarse         # smallest Jacobian over twenty designs
    python benchmarks/bench_fem.py film out               # flow files, picture and animation

Set OMP_NUM_THREADS=1 for one core. Seconds are processor seconds, so that other work on the machine
counts little; the numbers in docs/accuracy-fem.md come from here. `make bench` runs `cost coarse`.
"""

from __future__ import annotations

import resource
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import microswim as ms
from microswim.reference import fem
from microswim.reference.fem import quasi_steady as qs
from microswim.reference.fem.mesh import level_named
from microswim.surroundings import Channel

FOUR = ms.Motion(free=("us", "uq", "ur", "os"))


def base(sections="perpendicular", motion="rigid", density=0.0, kind=ms.HelicalTail, **tail):
    """The paper's base case (Table 1), four degrees of freedom free."""
    shape = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05, **tail}
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5),
        tail=kind(sections=sections, surface_motion=motion, **shape),
        fluid=ms.Fluid(viscosity=100.0, density=density),
        motion=FOUR,
    )


def clocked(function, *args):
    """Processor seconds and result."""
    start = time.process_time()
    result = function(*args)
    return time.process_time() - start, result


def memory():
    """Peak memory of this process in GB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def cost(*levels):
    """One quasi-steady design by part."""
    print("level elements unknowns | mesh+spaces displace factorise refactorise solve | GB")
    for name in levels or ("coarse",):
        flow, times = parts(name)
        seconds = " ".join(f"{t:.2f}" for t in times)
        print(name, flow.mesh.ne, flow.unknowns, "|", seconds, "|", f"{memory():.2f}", flush=True)


def parts(name):
    """Processor seconds of set-up, displacement, two factorisations and a solve."""
    setup, (wave, flow) = clocked(qs.problem, base(), Channel(), level_named(name))
    X = flow.nodes.points
    move, _ = clocked(lambda: flow.move(X + wave.displacement(X, 0.0)))
    first, _ = clocked(flow.factorise, 1.0)
    again, _ = clocked(flow.factorise, 1.0)
    solve, _ = clocked(flow.solve, qs.tail_data(wave, flow, 0.0))
    return flow, (setup, move, first, again, solve)


def ways(level="standard", diameter="10"):
    """Sections x surface motion: velocity, tail's thrust and torque of the held swimmer."""
    channel = Channel(diameter=float(diameter), length=float(diameter))
    for sections in ("perpendicular", "sheared"):
        wave, flow = qs.problem(base(sections), channel, level_named(level))
        for motion in ("rigid", "translating"):
            design = base(sections, motion)
            shot = qs.snapshot(replace(wave, swimmer=design), flow, 0.0, 100.0)
            gait = qs._assembled(design, [shot], True, {})
            tail = -(shot.propulsion - shot.body_propulsion) * gait.rate
            u, lateral = gait.mean_velocity, gait.velocity_amplitude[1]
            print(f"{sections} {motion}: u_s {u[0]:.5f} Omega_s {u[3]:.4f} lateral {lateral:.4f}")
            print(f"  held: thrust {tail[0]:.2f} torque {tail[3]:.2f}", flush=True)


def sphere(*levels):
    """Drag and torque of a sphere on the axis, radius ratio 0.3, relative to the series."""
    x = 0.3
    bohlin = 1 - 2.10443 * x + 2.08877 * x**3 - 0.94813 * x**5
    bohlin += -1.372 * x**6 + 3.87 * x**8 - 4.19 * x**10
    channel = Channel(diameter=2 / x, length=10 / x)
    for name in levels or ("coarse", "standard"):
        R = fem.body_resistance(ms.Sphere(radius=1.0), channel=channel, level=name)
        drag = R[0, 0] / (6 * np.pi) * bohlin - 1
        torque = R[3, 3] / (8 * np.pi) * (1 - 0.7968242 * x**3) - 1
        print(f"{name}: drag {100 * drag:+.2f} %, torque {100 * torque:+.2f} %", flush=True)


def inertia():
    """Helix with sheared sections from rest, coarse level, 20 steps a period."""
    for density, periods in ((0.0, 0.1), (1.0, 0.25), (10.0, 0.5), (100.0, 1.5)):
        design = base("sheared", density=density)
        seconds, data = clocked(
            lambda d=design, p=periods: fem.swim(d, periods=p, steps_per_period=20)
        )
        v = data.velocity.values[-1]
        print(f"Re {density / 100}: u_s {v[0]:.5f} Omega_s {v[3]:.5f}", end=" ")
        print(f"lateral {np.hypot(v[1], v[2]):.5f} ({seconds:.0f} s)", flush=True)


def designs(level="coarse"):
    """Smallest Jacobian over a period; remeshed where the first mesh folds."""
    for kind, sections in (
        (ms.HelicalTail, "perpendicular"),
        (ms.HelicalTail, "sheared"),
        (ms.PlaneWaveTail, "sheared"),
    ):
        for amplitude in (0.01, 0.05, 0.1, 0.15):
            for waves in (1, 2, 3, 4, 5):
                tail = {"amplitude": amplitude, "waves": waves}
                motion = "rigid" if kind is ms.HelicalTail else "translating"
                design = base(sections, motion, kind=kind, **tail)
                try:
                    wave, flow = qs.problem(design, Channel(), level_named(level))
                    said = f"{qs.smallest_jacobian(wave, flow):.2f}, {flow.mesh.ne} elements"
                except ms.MicroswimError as refusal:
                    said = f"refused: {refusal}"
                print(kind.kind, sections, amplitude, waves, said, flush=True)


def film(folder="out"):
    """One period of the helix at Re = 0.1 on the coarse mesh: flow files, picture, animation."""
    from microswim.reference.fem import picture

    flows = Path(folder) / "flow"
    options = {"periods": 1, "steps_per_period": 20, "checkpoint_every": 2, "vtk": flows}
    fem.swim(base("sheared", density=10.0), progress=True, **options)
    picture.render(picture.flow_files(flows)[-1], Path(folder) / "flow.png")
    picture.animate(flows, Path(folder) / "flow.gif")


if __name__ == "__main__":
    what, *rest = sys.argv[1:] or ["cost"]
    {f.__name__: f for f in (cost, ways, sphere, inertia, designs, film)}[what](*rest)
