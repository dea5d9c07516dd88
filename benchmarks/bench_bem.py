"""Boundary elements: cost, accuracy over designs, Rodenborn's helix, peers.

    python benchmarks/bench_bem.py                # cost, scaling, peers
    python benchmarks/bench_bem.py cost           # split of three designs, per cent of peak
    python benchmarks/bench_bem.py scaling        # seconds against unknowns, fitted exponents
    python benchmarks/bench_bem.py peers          # regularised Stokeslets at equal accuracy
    python benchmarks/bench_bem.py others PYTHON_WITH_MIME PYTHON_WITH_PYGRPY   # one matrix R
    python benchmarks/bench_bem.py designs 60     # coarse, standard against fine over the range
    python benchmarks/bench_bem.py levels         # base case by level and order
    python benchmarks/bench_bem.py rodenborn      # measured helix, five pitches
    python benchmarks/bench_bem.py wall           # sphere near a wall, by level

Seconds are processor seconds on one thread, the least of several runs, so that other work on the
machine counts little. Results go to the screen and to benchmarks/results/bem.json, one entry per
part; docs/accuracy-bem.md is made from them.
"""

from __future__ import annotations

import os

for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import json
import resource
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import peers_of_bem
from clock import RESULTS, keep, least, timed
from scipy.linalg import lu_factor
from scipy.spatial.distance import cdist

import microswim as ms
from microswim.data import load
from microswim.models import bem
from microswim.models.bem.gait import gait as by_elements
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.system import Layer, rigid_modes

KEPT = RESULTS / "bem.json"
LEVEL_ORDERS = [
    ("coarse", 2),
    ("coarse", 3),
    ("coarse", 4),
    ("standard", 2),
    ("standard", 3),
    ("standard", 4),
    ("fine", 2),
    ("fine", 3),
]


def swimmer(amplitude=0.1, waves=3.0, body=0.5, length=2.0):
    tail = ms.HelicalTail(length=length, amplitude=amplitude, waves=waves, radius=0.05)
    return ms.Swimmer(body=ms.Sphere(radius=body), tail=tail, fluid=ms.Fluid(viscosity=100.0))


def peak_flops(kind=float, n=1500):
    """Floating point operations per second of a matrix product: what LAPACK could reach here."""
    a = np.random.default_rng(0).normal(size=(n, n)).astype(kind)
    seconds = least(lambda: a @ a, 5)
    return 2 * n**3 / seconds


def split(one, level="standard", repeats=5):
    """Processor seconds of a gait and of its parts."""
    chosen = bem.get_level(level) if isinstance(level, str) else level
    mesh, surface = timed(
        lambda: swimmer_surface(one.body, one.tail, 0.0, chosen.resolution), repeats
    )
    layer = Layer(surface, 100.0, chosen.rule)
    assembly, A = timed(layer.rows, repeats)
    A[-1, -1] = 1.0
    single = A.astype(np.float32)
    whole, gait = timed(lambda: one.gait(model="bem", level=chosen), repeats)
    return {
        "unknowns": surface.unknowns,
        "gait": whole,
        "geometry": mesh,
        "assembly": assembly,
        "factorisation": least(lambda: lu_factor(A, check_finite=False), repeats),
        "factorisation, single precision": least(
            lambda: lu_factor(single, check_finite=False), repeats
        ),
        "u_s": float(gait.mean_velocity[0]),
        "Omega_s": float(gait.mean_velocity[3]),
    }


def cost():
    """Three designs at standard, the base case at coarse: where the time goes."""
    peak = peak_flops()
    print(f"matrix product: {peak / 1e9:.1f} Gflop/s on one thread")
    rows = []
    swimmer().gait(model="bem")
    for level, design in (
        ("coarse", {}),
        ("standard", {}),
        ("standard", {"amplitude": 0.2, "waves": 4.5, "length": 3.0}),
        ("standard", {"waves": 0.8, "length": 1.2}),
    ):
        row = split(swimmer(**design), level)
        row["peak"] = 2 / 3 * row["unknowns"] ** 3 / row["factorisation"] / peak
        parts = ", ".join(f"{k} {row[k]:.3f}" for k in list(row)[1:6])
        print(
            f"{level} {design or 'base case'}: {row['unknowns']} unknowns; {parts} s; "
            f"LU at {row['peak']:.0%} of peak"
        )
        rows.append({"level": level, "design": design, **row})
    wave = ms.Swimmer.preset("tabak/plane_wave")
    beat = least(lambda: wave.gait(model="bem"), 3)
    judged = least(lambda: by_elements(wave, estimate_error=True), 3)
    whole = least(lambda: by_elements(swimmer(), estimate_error=True), 5)
    extra = {"helix": whole / rows[1]["gait"] - 1.0, "plane wave": judged / beat - 1.0}
    print(f"a plane wave at its phases: {beat:.2f} s; its error estimated, more by: {extra}")
    return {
        "matrix product, flop/s": peak,
        "seconds of a plane wave": beat,
        "estimate of the error, over the solve": extra,
        "designs": rows,
    }


def scaling():
    """Base case on ever finer patches of order 3: exponents of assembly and factorisation."""
    level = bem.get_level("standard")
    rows = []
    for size in (8.0, 5.0, 3.2, 2.2, 1.4, 1.0, 0.57):
        r = replace(
            level.resolution,
            panel=0.6 * size,
            stretch=size,
            bend=0.2 * size,
            wave=0.25 * size,
            body=round(8.0 / size),
        )
        repeats = 2 if size > 2.0 else 1
        rows.append(split(swimmer(), replace(level, resolution=r), repeats))
        rows[-1]["GB at most"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        shown = {k: round(v, 4) for k, v in rows[-1].items()}
        print(shown, flush=True)
    n = np.log([r["unknowns"] for r in rows])
    fits = {k: float(np.polyfit(n, np.log([r[k] for r in rows]), 1)[0]) for k in list(rows[0])[1:5]}
    print("exponents:", {k: round(v, 2) for k, v in fits.items()})
    return {"rows": rows, "exponents": fits}


def random_designs(count, seed=20):
    """Half of them from the whole range, half from its steep corner: b, N, r_b, L."""
    rng = np.random.default_rng(seed)
    whole = rng.uniform((0.03, 0.8, 0.3, 1.2), (0.2, 4.5, 0.7, 3.0), (count - count // 2, 4))
    corner = rng.uniform((0.15, 2.5, 0.3, 1.2), (0.2, 4.5, 0.7, 1.5), (count // 2, 4))
    return np.concatenate([whole, corner])


def designs(count="60"):
    """Error of u_s and Omega_s of coarse and standard against fine, in per cent, and seconds."""
    count = int(count)
    rows = []
    swimmer().gait(model="bem")
    print("b, N, r_b, L | u_s, Omega_s of fine | errors per cent, unknowns, s: coarse | standard")
    for n, design in enumerate(random_designs(count)):
        one = swimmer(*design)
        try:
            fine = one.gait(model="bem", level="fine").mean_velocity
        except ms.errors.SpecError as reason:
            print("refused:", design.round(3), reason)
            rows.append({"design": design.tolist(), "corner": n >= count - count // 2})
            continue
        row = {"design": design.tolist(), "corner": n >= count - count // 2, "fine": fine.tolist()}
        shown = f"{design.round(3)} | {fine[0]:.5f} {fine[3]:.4f}"
        for level in ("coarse", "standard"):
            seconds, gait = timed(
                lambda one=one, level=level: one.gait(model="bem", level=level), 2
            )
            error = 100 * (gait.mean_velocity[[0, 3]] / fine[[0, 3]] - 1)
            row[level] = {
                "errors": error.tolist(),
                "unknowns": gait.info["unknowns"],
                "seconds": seconds,
                "asymmetry": gait.info["asymmetry"],
                "reciprocity": gait.info["reciprocity"],
            }
            shown += f" | {error[0]:+.3f} {error[1]:+.3f} {gait.info['unknowns']} {seconds:.2f}"
        print(shown, flush=True)
        rows.append(row)
    for level in ("coarse", "standard"):
        for corner in (False, True):
            some = [r[level] for r in rows if "fine" in r and r["corner"] == corner]
            where = "corner" if corner else "range"
            u, o = np.abs([s["errors"] for s in some]).T
            print(
                f"{level}, {where}, {len(some)}: u_s median "
                f"{np.median(u):.3f}, worst {np.sort(u)[-3:].round(3)}; "
                f"Omega_s worst {o.max():.3f}; "
                f"asymmetry {max(s['asymmetry'] for s in some):.0e}; unknowns "
                f"{min(s['unknowns'] for s in some)} to {max(s['unknowns'] for s in some)}; "
                f"s {min(s['seconds'] for s in some):.2f} to {max(s['seconds'] for s in some):.2f}"
            )
    return rows


def levels():
    """Base case by level and order."""
    rows = []
    for name, order in LEVEL_ORDERS:
        seconds, gait = timed(
            lambda n=name, p=order: swimmer().gait(model="bem", level=n, order=p), 1
        )
        u = gait.mean_velocity
        print(
            f"{name} p={order}: {gait.info['unknowns']} unknowns, u_s {u[0]:.6f}, "
            f"Omega_s {u[3]:.5f}, asymmetry {gait.info['asymmetry']:.1e}, {seconds:.2f} s",
            flush=True,
        )
        rows.append([name, order, gait.info["unknowns"], u.tolist(), seconds])
    return rows


def brenner(height):
    """Drag of a sphere across a wall over 6 pi mu a U, centre at height radii [Brenner 1961]."""
    a, n = np.arccosh(height), np.arange(1, 400)
    top = 2 * np.sinh((2 * n + 1) * a) + (2 * n + 1) * np.sinh(2 * a)
    bottom = 4 * np.sinh((n + 0.5) * a) ** 2 - (2 * n + 1) ** 2 * np.sinh(a) ** 2
    terms = n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1)
    return 4 / 3 * np.sinh(a) * np.sum(terms[np.isfinite(terms)])


def wall():
    """A sphere near a wall by level, solved as of a spec; drag and torque by 6, 8 pi."""
    rows = []
    for height in (8.0, 3.7622, 1.5431, 1.1276, 1.05, 1.02):
        near = ms.Wall(distance=height)
        ball, water = ms.Sphere(radius=1.0), ms.Fluid(viscosity=1.0)
        held = ms.Swimmer(body=ball, tail=ms.NoTail(), fluid=water, wall=near)
        across = np.array(near.normal)
        along = np.array([1.0, 0.0, 0.0])
        row = {"height": height, "Brenner": brenner(height)}
        for level in ("coarse", "standard", "fine"):
            R = held.gait("bem", level=level).resistance(0.0)
            row[level] = [
                float(across @ R[:3, :3] @ across / (6 * np.pi)),
                float(along @ R[:3, :3] @ along / (6 * np.pi)),
                float(along @ R[3:, 3:] @ along / (8 * np.pi)),
            ]
        print(row, flush=True)
        rows.append(row)
    return rows


def rodenborn():
    """Thrust, torque, drag of Rodenborn's helix against the measured values.

    And against slender-body theory, written independently for the tests; at the longest pitch also
    with a plane wall at 16 helix radii.
    """
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
    from oracles.slender_body import helix, lighthill_resistance

    radius, length, wire = 6.3, 130.0, 0.397
    level = bem.get_level("standard", 2)
    level = replace(level, resolution=replace(level.resolution, stretch=12.0, bend=0.6, wave=0.7))
    table = load("rodenborn2013-helix")
    rows = []
    for pitch, *measured in zip(
        table["lambda_over_R"].values, *(table[c].values for c in table.data_vars), strict=True
    ):
        tail = ms.HelicalTail(
            length=length / radius,
            amplitude=1.0,
            wavelength=float(pitch),
            radius=wire / radius,
            ramp=0.0,
        )

        def three(R):
            return np.array([abs(R[0, 3]), R[3, 3], R[0, 0]])

        alone = ms.Swimmer(body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0))
        computed = three(bem.solve(alone, level=level).resistance)
        theory = lighthill_resistance(*helix(length / radius, 1.0, pitch), wire / radius)
        above = 100 * (np.array(measured) / computed - 1)
        apart = 100 * (three(theory) / computed - 1)
        row = [float(pitch), computed.tolist(), above.tolist(), apart.tolist()]
        print(
            f"pitch {pitch}: thrust, torque, drag {computed.round(2)}; measured {above.round(1)} %"
        )
        print(f"  above; slender-body theory {apart.round(1)} %", flush=True)
        if pitch > 15:
            beside = replace(alone, wall=ms.Wall(distance=16.0))
            wall = 100 * (three(bem.solve(beside, level=level).resistance) / computed - 1)
            print(f"  a wall at 16 R adds {wall.round(1)} %")
            row.append(wall.tolist())
        rows.append(row)
    return rows


def stokeslets(panel, around):
    """Cortez' regularised Stokeslets on the swimmer's surface: unknowns and twist.

    G = [(r^2 + 2 e^2) I + x x'] / (r^2 + e^2)^(3/2), e half the nearest spacing [Cortez et al.
    2005]. The points are the collocation nodes of ever finer boundary elements.
    """
    r = replace(
        bem.get_level("coarse").resolution,
        panel=panel,
        stretch=panel,
        bend=9.0,
        wave=9.0,
        around=around,
        root=panel / 2,
        growth=1.2,
        body=around // 2,
    )
    s = swimmer_surface(swimmer().body, swimmer().tail, 0.0, r)
    x = s.nodes.reshape(-1, 3)
    d = cdist(x, x)
    spacing = np.sort(d + np.diag(np.full(len(x), np.inf)), axis=1)[:, 0]
    e2 = (0.5 * np.minimum(spacing[:, None], spacing[None, :])) ** 2
    A = np.zeros((len(x), 3, len(x), 3))
    bottom = (d**2 + e2) ** 1.5
    for i in range(3):
        for j in range(3):
            product = (x[:, None, i] - x[None, :, i]) * (x[:, None, j] - x[None, :, j])
            A[:, i, :, j] = ((d**2 + 2 * e2) * (i == j) + product) / bottom
    V = np.concatenate(
        [rigid_modes(x, swimmer().body.centre), s.node_motion.reshape(-1, 3, 1)], axis=-1
    ).reshape(3 * len(x), 7)
    f = np.linalg.solve(A.reshape(3 * len(x), -1), 800 * np.pi * V)
    W = V[:, :6].T @ f
    return 3 * len(x), -2 * np.pi * np.linalg.solve(W[:, :6], W[:, 6])


def peers():
    """Time to 0.5 and to 0.1 per cent of u_s, base case: boundary elements, Stokeslets."""
    exact = swimmer().gait(model="bem", level="fine").mean_velocity
    rows = []

    def note(method, seconds, unknowns, u):
        errors = np.abs(100 * (u / exact - 1))[[0, 3]]
        rows.append([method, unknowns, seconds, *errors.tolist()])
        print(
            f"{method}: {unknowns} unknowns, {seconds:.2f} s, error of u_s {errors[0]:.2f} %, "
            f"of Omega_s {errors[1]:.2f} %",
            flush=True,
        )

    for level in ("coarse", "standard"):
        seconds, gait = timed(lambda n=level: swimmer().gait(model="bem", level=n), 5)
        note(f"boundary elements, {level}", seconds, gait.info["unknowns"], gait.mean_velocity)
    for panel, around in ((1.6, 3), (1.2, 4), (0.8, 6)):
        seconds, (n, u) = timed(lambda p=panel, a=around: stokeslets(p, a), 1)
        note("regularised Stokeslets", seconds, n, u)
    own = [r for r in rows if r[0].startswith("boundary")]
    blobs = [r for r in rows if r[0].startswith("regularised")]
    slope, start = np.polyfit(np.log([r[3] for r in blobs]), np.log([r[2] for r in blobs]), 1)
    ratios = {}
    for goal in (0.5, 0.1):
        mine = min(r[2] for r in own if r[3] <= goal)
        other = float(np.exp(start + slope * np.log(goal)))
        reached = min(r[3] for r in blobs) <= goal
        how = "within the runs" if reached else "extrapolated"
        ratios[str(goal)] = [mine, other, other / mine, how]
        print(f"to {goal} %: {mine:.2f} s against {other:.1f} s ({how}), {other / mine:.0f} times")
    return {"rows": rows, "time to per cent": ratios}


def others(mime, pygrpy):
    """One resistance matrix of the base case, by ours, MIME and PyGRPY."""
    return {"rows": peers_of_bem.rows(swimmer(), mime, pygrpy)}


PARTS = {f.__name__: f for f in (cost, scaling, peers, others, designs, levels, rodenborn, wall)}


def main(arguments):
    wanted = arguments[:1] or ["cost", "scaling", "peers"]
    results = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    for part in wanted:
        results[part] = PARTS[part](*arguments[1:])
        keep("bem", results)


if __name__ == "__main__":
    main(sys.argv[1:])
