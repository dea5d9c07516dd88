"""Finite elements: cost, the four ways of moving the tail, sphere in a cylinder, inertia, designs.

    python benchmarks/bench_fem.py cost coarse standard   # unknowns, seconds by part, memory
    python benchmarks/bench_fem.py ways standard 10       # four ways, channel diameter 10
    python benchmarks/bench_fem.py tube 10 10             # boundary elements in an open tube
    python benchmarks/bench_fem.py sphere                 # against Bohlin and Brenner, three meshes
    python benchmarks/bench_fem.py convergence            # sphere in a box on three meshes
    python benchmarks/bench_fem.py inertia                # Re = 0, 0.01, 0.1, 1
    python benchmarks/bench_fem.py march helix out        # two periods from rest (or plane)
    python benchmarks/bench_fem.py box 0 1 2              # designs of a box, fem and bem
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
from functools import partial
from pathlib import Path

import numpy as np
from clock import keep
from scipy.stats import qmc

import microswim as ms
from microswim.models import bem, fem
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.patches.surface import grid_boxes, sample
from microswim.models.bem.system import rigid_modes, solve_density, wrench_rows
from microswim.models.fem import gait as qs
from microswim.models.fem.mesh import Level, level_named
from microswim.models.fem.swimming import Swim
from microswim.swimmer.geometry.surroundings import Channel

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
    print("level elements unknowns | mesh+spaces displace factorise refactorise solve step | GB")
    rows = []
    for name in levels or ("coarse",):
        flow, times = parts(name)
        named = dict(zip(("set-up", "move", "first factorisation", "again", "solve"), times))
        size, elements = flow.unknowns, flow.mesh.ne
        del flow  # with its factors
        named["a step in time"] = step_in_time(name)
        rows.append({"level": name, "unknowns": size, **named, "GB at most": memory()})
        seconds = " ".join(f"{t:.2f}" for t in named.values())
        print(name, elements, size, "|", seconds, "|", f"{memory():.2f}", flush=True)
    keep("fem", {"seconds by part": rows})


def step_in_time(name, steps=6):
    """Processor seconds of a step at 40 a period, new factors and former ones in turn."""
    run = Swim(base("sheared", density=10.0), Channel(), level_named(name), 40, FOUR.mask)
    march = run.step(run.start())
    run.former, start = None, time.process_time()
    for _ in range(steps):
        march = run.step(march)
    return (time.process_time() - start) / steps


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


def tube(diameter="10", length="10"):
    """Boundary elements inside an open tube at rest, its wall a part of the single layer."""
    R, L = float(diameter) / 2, float(length)
    level, design = bem.get_level("standard"), base()
    body, tail = design.body, design.tail
    swimmer = swimmer_surface(body, tail, 0.0, level.resolution)
    middle = 0.5 * (tail.apparent_length + 2 * body.centre[0])

    def chart(u, v):
        return np.stack([middle + v, R * np.cos(u), R * np.sin(u)], axis=-1)

    ring = max(8, round(2 * np.pi * R / 3))
    edges = np.linspace(-L / 2, L / 2, max(4, round(L / (0.5 * R))) + 1)
    wall = sample(chart, grid_boxes(np.linspace(0, 2 * np.pi, ring + 1), edges))
    still, here = np.zeros(len(wall), bool), np.ones(swimmer.patches, bool)
    inner = swimmer.inner
    both = bem.Surface(
        np.concatenate([swimmer.controls, wall]),
        np.concatenate([swimmer.motion, np.zeros_like(wall)]),
        np.concatenate([swimmer.on_tail, still]),
        swimmer.order,
        None
        if inner is None
        else np.concatenate([inner, np.zeros((len(inner), *wall.shape[:3]))], 1),
    )
    for name, surface, moves in (
        ("free space", swimmer, here),
        ("open tube", both, np.concatenate([here, still])),
    ):
        modes = rigid_modes(surface.nodes, body.centre) * moves[:, None, None, None]
        layer = bem.Layer(surface, float(design.fluid.viscosity), level.rule)
        f = solve_density(layer, modes).density
        resistance = wrench_rows(surface, body.centre, moves) @ f
        propulsion = surface.moments[3].reshape(-1) @ f
        free = [0, 1, 2, 3]
        V = -np.linalg.solve(resistance[np.ix_(free, free)], propulsion[free]) * tail.rate
        print(name, surface.unknowns, f"u_s {V[0]:.5f} Omega_s {V[3]:.5f}", flush=True)


def sphere(*levels):
    """Drag and torque of a sphere on the axis, radius ratio 0.3, relative to the series.

    Without levels: P2/P1 on three meshes and the observed order; else the levels named.
    """
    x = 0.3
    bohlin = 1 - 2.10443 * x + 2.08877 * x**3 - 0.94813 * x**5
    bohlin += -1.372 * x**6 + 3.87 * x**8 - 4.19 * x**10
    channel, found = Channel(diameter=2 / x, length=10 / x), []
    for name in levels or (0.8, 0.4, 0.2):
        level = name if isinstance(name, str) else halving(name)
        R = fem.body_resistance(ms.Sphere(radius=1.0), channel=channel, level=level)
        drag = R[0, 0] / (6 * np.pi) * bohlin - 1
        torque = R[3, 3] / (8 * np.pi) * (1 - 0.7968242 * x**3) - 1
        found.append((drag, torque))
        print(f"{name}: drag {100 * drag:+.3f} %, torque {100 * torque:+.3f} %", flush=True)
    if not levels:
        first, second = -np.diff(found, axis=0)
        print("order", np.log2(first / second))


def halving(h):
    """P2/P1 with mesh size h on a sphere and in proportion elsewhere."""
    sizes = {"tail": 1.6, "body": h, "far": 0.5 * h, "grading": 0.9, "curvature": 1.2 / h}
    return Level(order=2, **sizes)


def inertia():
    """Helix with sheared sections from rest, coarse level, 20 steps a period: means by half period.

    Changes are against the massless fluid at the same steps of the period.
    """
    still = halves(fem.swim(base("sheared"), periods=1, steps_per_period=20))
    for density, periods in ((1.0, 0.5), (10.0, 1), (100.0, 3)):
        design = base("sheared", density=density)
        data = fem.swim(design, periods=periods, steps_per_period=20)
        for i, now in enumerate(halves(data)):
            shown = " ".join(
                f"{x:.5f} ({100 * (x / y - 1):+.2f} %)" for x, y in zip(now, still[i % 2])
            )
            print(f"Re {density / 100} to {0.5 * (i + 1)} periods: {shown}", flush=True)


def convergence():
    """Drag and torque of a sphere in a box, P2/P1, on three meshes; observed order."""
    channel, found = Channel(diameter=5.0, length=5.0, shape="box"), []
    for h in (0.8, 0.4, 0.2):
        R = fem.body_resistance(ms.Sphere(radius=1.0), channel=channel, level=halving(h))
        found.append((R[0, 0] / (6 * np.pi), R[3, 3] / (8 * np.pi)))
        print(f"h {h}: drag {found[-1][0]:.5f} torque {found[-1][1]:.5f}", flush=True)
    first, second = -np.diff(found, axis=0)
    print("order", np.log2(first / second))


def halves(data, steps=10):
    """u_s, Omega_s and lateral speed, means over every ten steps."""
    v = data.velocity.values
    found = np.column_stack([v[:, 0], v[:, 3], np.hypot(v[:, 1], v[:, 2])])
    return [found[i : i + steps].mean(axis=0) for i in range(0, len(found), steps)]


def march(kind="helix", folder="out"):
    """The paper's two periods from rest at Re = 0.01: P2/P1 on the mesh of level fine."""
    level = replace(level_named("fine"), order=2)
    wave = {"kind": ms.PlaneWaveTail, "sections": "sheared", "motion": "translating"}
    design = base(density=1.0, **(wave if kind == "plane" else {}))
    kept = {"checkpoint": Path(folder) / f"{kind}.npz", "checkpoint_every": 5}
    options = {"level": level, "steps_per_period": 20, "channel": Channel(), "progress": True}
    data = fem.swim(design, periods=2, **kept, **options)
    for now in halves(data):
        print(" ".join(f"{x:.5f}" for x in now))


def box(*numbers):
    """Twenty designs of the box b, N, r_b, L, helix and plane wave in turn: fem and bem.

    The channel is 20 wide and long, so that its walls count less than the mesh (level coarse).
    """
    channel = Channel(diameter=20.0, length=20.0)
    for i in map(int, numbers or range(20)):
        design = of_the_box(i)
        tail = design.tail
        shown = f"b {tail.amplitude:.3f} N {tail.number_of_waves:.2f} r_b {design.body.radius:.2f}"
        print(f"{i} {tail.kind} {shown} L {tail.length:.2f}", end=" | ", flush=True)
        try:
            options = {"channel": channel, "level": "coarse", "phases": 4}
            seconds, gait = clocked(partial(design.gait, "fem", **options))
        except ms.MicroswimError as refusal:
            print(refusal, flush=True)
            continue
        print(gait.info["mesh"], gait.info["elements"], f"{seconds:.0f} s", end=" | ")
        fem_says, bem_says = gait.mean_velocity, design.gait("bem").mean_velocity
        for j in (0, 3) if i % 2 == 0 else (0,):
            off = 100 * (fem_says[j] / bem_says[j] - 1)
            print(f"{fem_says[j]:.5f} {bem_says[j]:.5f} {off:+.1f} %", end=" | ")
        print(flush=True)


def of_the_box(i):
    """Design i of a Latin hypercube of twenty."""
    low, high = np.array([0.03, 0.8, 0.3, 1.2]), np.array([0.2, 4.5, 0.7, 3.0])
    places = low + (high - low) * qmc.LatinHypercube(4, seed=20).random(20)
    b, waves, body, length = map(float, places[i])
    kind = (ms.HelicalTail, ms.PlaneWaveTail)[i % 2]
    return ms.Swimmer(
        body=ms.Sphere(radius=body),
        tail=kind(length=length, amplitude=b, waves=waves, radius=0.05),
        fluid=ms.Fluid(viscosity=1.0),
        motion=FOUR,
    )


def designs(level="coarse", steepest="0"):
    """Smallest Jacobian of the displaced mesh over a period, or of one filled in where it folds.

    `steepest`: only designs of at least that amplitude times number of waves.
    """
    for kind, sections, motion in (
        (ms.HelicalTail, "perpendicular", "rigid"),
        (ms.HelicalTail, "sheared", "rigid"),
        (ms.PlaneWaveTail, "sheared", "translating"),
    ):
        for amplitude in (0.01, 0.05, 0.1, 0.15):
            for waves in (1, 2, 3, 4, 5):
                if amplitude * waves < float(steepest):
                    continue
                design = base(sections, motion, kind=kind, amplitude=amplitude, waves=waves)
                wave = qs.wave_in(Channel(), design)
                anew, mesh_at = qs.meshes(wave, Channel(), level_named(level))
                laid = mesh_at(0.0)
                least = laid.flow.smallest_jacobian(laid.places)
                least = least if anew else qs.smallest_jacobian(wave, laid.flow)
                how = f"{'filled in' if anew else 'displaced'}, {laid.flow.mesh.ne} elements"
                print(kind.kind, sections, amplitude, waves, f"{least:.2f}", how, flush=True)


def film(folder="out"):
    """One period of the helix at Re = 0.1 on the coarse mesh: flow files, picture, animation."""
    from microswim.models.fem import picture

    flows = Path(folder) / "flow"
    options = {"periods": 1, "steps_per_period": 20, "checkpoint_every": 2, "vtk": flows}
    fem.swim(base("sheared", density=10.0), progress=print, **options)
    picture.render(picture.flow_files(flows)[-1], Path(folder) / "flow.png")
    picture.animate(flows, Path(folder) / "flow.gif")


if __name__ == "__main__":
    what, *rest = sys.argv[1:] or ["cost"]
    commands = (cost, ways, tube, sphere, convergence, inertia, march, designs, box, film)
    {f.__name__: f for f in commands}[what](*rest)
