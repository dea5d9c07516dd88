"""Boundary elements: cost, accuracy over designs, Rodenborn's helix, and peers.

    python benchmarks/bench_bem.py cost          # split of one design, per cent of the machine's
    peak python benchmarks/bench_bem.py designs 24    # standard against fine over the design range
    python benchmarks/bench_bem.py levels        # base case by level and order python
    benchmarks/bench_bem.py rodenborn     # measured helix, five pitches python
    benchmarks/bench_bem.py stokeslets    # dense regularised Stokeslets at equal accuracy

Set OMP_NUM_THREADS=1 and NUMBA_NUM_THREADS=1 for one core. Seconds are processor seconds, the least
of three runs, so that other work on the machine counts little. The numbers in docs/accuracy-bem.md
come from here.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import numpy as np
from scipy.linalg import lu_factor
from scipy.spatial.distance import cdist

import microswim as ms
from microswim.data import load
from microswim.reference import bem


def swimmer(amplitude=0.1, waves=3.0, body=0.5, length=2.0):
    tail = ms.HelicalTail(length=length, amplitude=amplitude, waves=waves, radius=0.05)
    return ms.Swimmer(body=ms.Sphere(radius=body), tail=tail, fluid=ms.Fluid(viscosity=100.0))


def least(function, repeats=3):
    """Least processor time and last result of a function."""
    best = np.inf
    for _ in range(repeats):
        start = time.process_time()
        result = function()
        best = min(best, time.process_time() - start)
    return best, result


def peak_flops(n=1500):
    """Floating point operations per second of a matrix product: what LAPACK could reach here."""
    a = np.random.default_rng(0).normal(size=(n, n))
    seconds, _ = least(lambda: a @ a, 5)
    return 2 * n**3 / seconds


def cost():
    """One design at standard: unknowns, geometry, assembly, solve, per cent of peak of the
    solve."""
    peak = peak_flops()
    print(f"matrix product: {peak / 1e9:.1f} Gflop/s on one thread")
    for design in (
        {},
        {"amplitude": 0.2, "waves": 4.5, "length": 3.0},
        {"waves": 0.8, "length": 1.2},
    ):
        one = swimmer(**design)
        one.gait(model="bem")
        total, gait = least(lambda one=one: one.gait(model="bem"))
        n = gait.info["unknowns"]
        A = np.asfortranarray(np.random.default_rng(0).normal(size=(n, n)) + n * np.eye(n))
        factor, _ = least(lambda A=A: lu_factor(A, check_finite=False))
        share = 2 / 3 * n**3 / factor / peak
        wall = gait.info["seconds"]
        split = ", ".join(f"{k} {v:.2f}" for k, v in wall.items())
        print(
            f"{design or 'base case'}: {n} unknowns, {total:.2f} s; wall: {split}; "
            f"LU {factor:.2f} s, {share:.0%} of peak"
        )


def designs(count):
    """Random designs of the range: error of u_s and Omega_s of standard against fine, and
    seconds."""
    rng = np.random.default_rng(20)
    worst = []
    print("b, N, r_b, L | u_s fine | error of u_s, Omega_s in per cent | seconds of standard")
    for _ in range(count):
        design = {
            "amplitude": rng.uniform(0.03, 0.2),
            "waves": rng.uniform(0.8, 4.5),
            "body": rng.uniform(0.3, 0.7),
            "length": rng.uniform(1.2, 3.0),
        }
        one = swimmer(**design)
        try:
            fine = one.gait(model="bem", level="fine").mean_velocity
        except ms.errors.SpecError as reason:
            print("refused:", reason)
            continue
        seconds, gait = least(lambda one=one: one.gait(model="bem"), 1)
        error = 100 * (gait.mean_velocity / fine - 1)
        worst.append(abs(error[0]))
        shown = " ".join(f"{v:.3f}" for v in design.values())
        print(
            f"{shown} | {fine[0]:.5f} | {error[0]:+.2f} {error[3]:+.2f} | "
            f"{gait.info['unknowns']} {seconds:.2f}",
            flush=True,
        )
    print(
        f"u_s, per cent: median {np.median(worst):.2f}, worst three {np.sort(worst)[-3:].round(2)}"
    )


def levels():
    """Base case by level and order."""
    for name in bem.LEVELS:
        for order in (2, 3, 4) if name != "fine" else (2, 3):
            seconds, gait = least(
                lambda n=name, p=order: swimmer().gait(model="bem", level=n, order=p), 1
            )
            u = gait.mean_velocity
            print(
                f"{name} p={order}: {gait.info['unknowns']} unknowns, u_s {u[0]:.6f}, "
                f"Omega_s {u[3]:.5f}, asymmetry {gait.info['asymmetry']:.1e}, {seconds:.2f} s",
                flush=True,
            )


def rodenborn(order=3):
    """Thrust, torque, drag of Rodenborn's helix against the measured values."""
    radius, length, wire = 6.3, 130.0, 0.397
    level = bem.get_level("standard", order)
    level = replace(level, resolution=replace(level.resolution, stretch=12.0, bend=0.6, wave=0.7))
    table = load("rodenborn2013-helix")
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
        alone = ms.Swimmer(body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0))
        R = bem.solve(alone, level=level).resistance
        computed = abs(R[0, 3]), R[3, 3], R[0, 0]
        pairs = ", ".join(
            f"{c:.2f} ({m:.2f}, {100 * (c / m - 1):+.1f} %)"
            for c, m in zip(computed, measured, strict=True)
        )
        print(f"pitch {pitch}: thrust, torque, drag {pairs}", flush=True)


def stokeslets():
    """Cortez' regularised Stokeslets on the same surface: one blob per point, dense.

    G = [(r^2 + 2 e^2) I + x x'] / (r^2 + e^2)^(3/2), e a fraction of the spacing [Cortez et al.
    2005]. The points are the collocation nodes of ever finer boundary elements.
    """
    exact = -0.03070
    for panel, around in ((1.2, 4), (0.8, 6), (0.6, 8), (0.45, 10)):
        r = bem.get_level("coarse").resolution
        r = replace(
            r,
            panel=panel,
            stretch=panel,
            bend=9.0,
            wave=9.0,
            around=around,
            root=panel / 2,
            growth=1.2,
            body=around // 2,
        )
        start = time.process_time()
        from microswim.reference.bem.mesh import swimmer_surface
        from microswim.reference.bem.system import rigid_modes

        s = swimmer_surface(swimmer().body, swimmer().tail, 0.0, r)
        x = s.nodes.reshape(-1, 3)
        if 3 * len(x) > 10_000:
            break
        d = cdist(x, x)
        spacing = np.sort(d + np.diag(np.full(len(x), np.inf)), axis=1)[:, 0]
        e2 = (0.5 * np.minimum(spacing[:, None], spacing[None, :])) ** 2
        A = np.zeros((len(x), 3, len(x), 3))
        diff = x[:, None] - x[None]
        bottom = (d**2 + e2) ** 1.5
        for i in range(3):
            for j in range(3):
                A[:, i, :, j] = ((d**2 + 2 * e2) * (i == j) + diff[..., i] * diff[..., j]) / bottom
        centre = swimmer().body.centre
        V = np.concatenate([rigid_modes(x, centre), s.node_motion.reshape(-1, 3, 1)], axis=-1)
        f = np.linalg.solve(A.reshape(3 * len(x), -1), 800 * np.pi * V.reshape(3 * len(x), -1))
        W = V[..., :6].reshape(3 * len(x), 6).T @ f
        u = -2 * np.pi * np.linalg.solve(W[:, :6], W[:, 6])
        print(
            f"{3 * len(x)} unknowns: u_s {u[0]:.5f} ({100 * (u[0] / exact - 1):+.1f} %), "
            f"Omega_s {u[3]:.4f}, {time.process_time() - start:.1f} s",
            flush=True,
        )


if __name__ == "__main__":
    name, *arguments = sys.argv[1:] or ["cost"]
    {
        "cost": cost,
        "designs": designs,
        "levels": levels,
        "rodenborn": rodenborn,
        "stokeslets": stokeslets,
    }[name](*(int(a) for a in arguments))
