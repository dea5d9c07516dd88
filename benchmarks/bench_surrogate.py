"""The surrogate: one gait, a design map, and the kernel against NumPy and C.

    python benchmarks/bench_surrogate.py

Figures are processor seconds on one core, the least of several runs, so that other work on the
machine counts little; the ratios are taken in this one run. A processor with AVX-512 runs the
kernels a second time as one with AVX2 alone would (NUMBA_CPU_NAME=haswell, and C with
-march=haswell). Results go to benchmarks/results/surrogate.json and, as a table, to the screen. C
needs gcc.
"""

from __future__ import annotations

import os

for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import ctypes
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from clock import keep, least, processor
from numba import njit

import microswim as ms
from microswim.models.rft import gait as rft
from microswim.models.rft import helix as rigidhelix
from microswim.models.rft import loops_compiled as manydesigns
from microswim.models.rft import segment as kernels
from microswim.numerics.quadrature import gauss
from microswim.numerics.solve6 import solve
from microswim.swimmer.fields import lifted

HERE = Path(__file__).parent
DESIGNS = 20_000
NODES = (8, 24)  # 32 nodes: on the ramp, behind it
HALF = 6  # phases of half a beat: twelve of a whole one, the other half mirrored
NARROW = "haswell"  # the first processors with AVX2


def compiled():
    """The C kernel, compiled here and now; None where there is no gcc."""
    folder = Path(tempfile.mkdtemp())
    machine = os.environ.get("NUMBA_CPU_NAME", "native")
    flags = ["-O3", f"-march={machine}", "-ffast-math", "-fopenmp-simd", "-shared", "-fPIC"]
    command = ["gcc", *flags, str(HERE / "helix.c"), "-o", str(folder / "helix.so"), "-lm"]
    try:
        subprocess.run(command, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return ctypes.CDLL(str(folder / "helix.so")).designs


def diagonal(body):
    return np.ascontiguousarray(np.einsum("nii->ni", body))


def plain_numpy(p, body, x, weight, on_ramp):
    """The same in vectorised NumPy: arrays (designs, nodes), LAPACK for the solve."""
    L, b, k, ramp, sign, c_t, c_n, c_r, offset, spin, _ = p.T[:, :, None]
    x = np.where(on_ramp, ramp * x, ramp + (1 - ramp) * x)
    weight = np.where(on_ramp, ramp, 1 - ramp) * weight
    s = x * L
    a, da = np.where(on_ramp, b * x / ramp, b), np.where(on_ramp, b / (ramp * L), 0.0)
    c, e = np.cos(k * s), np.sin(k * s)
    P = np.stack([s + offset, a * c, -sign * a * e], -1)
    T = np.stack([1 + 0 * s, da * c - a * k * e, -sign * (da * e + a * k * c)], -1)
    U = np.stack([0 * s, a * e, sign * a * c], -1)
    speed = np.linalg.norm(T, axis=-1)
    dl = weight * L * speed
    T /= speed[..., None]
    C = dl[..., None, None] * (
        c_n[..., None, None] * np.eye(3)
        + (c_t - c_n)[..., None, None] * T[..., :, None] * T[..., None, :]
    )
    X = np.zeros((*s.shape, 3, 3))
    X[..., 0, 1], X[..., 0, 2], X[..., 1, 2] = -P[..., 2], P[..., 1], -P[..., 0]
    X[..., 1, 0], X[..., 2, 0], X[..., 2, 1] = P[..., 2], -P[..., 1], P[..., 0]
    moves = np.concatenate([np.broadcast_to(np.eye(3), X.shape), -X], axis=-1)
    R = np.einsum("dnij,dnik,dnkl->djl", moves, C, moves, optimize=True)
    F = np.einsum("dnij,dnik,dnk->dj", moves, C, U, optimize=True)
    about = dl * c_r
    R[:, 3:, 3:] += np.einsum("dn,dni,dnj->dij", about, T, T, optimize=True)
    F[:, 3:] += np.einsum("dn,dn,dni->di", about * spin, T[..., 0], T, optimize=True)
    return -np.linalg.solve(R + body, F[..., None])[..., 0]


@njit(fastmath=kernels.FAST)
def plain_numba(p, body, free, ramp_rule, rule):
    """The plain quadrature, one design after the other."""
    V = np.empty((len(p), 6))
    for d in range(len(p)):
        R, F, _ = kernels.wave_tail(0, True, p[d], 0.0, ramp_rule, rule)
        V[d] = -F
        solve(R + body[d], V[d], free)
    return V


def drawn(count):
    """Amplitudes and numbers of waves of random designs."""
    rng = np.random.default_rng(0)
    return {
        "tail.amplitude": rng.uniform(0.03, 0.2, count),
        "tail.waves": rng.uniform(0.8, 4.5, count),
    }


def designs(count):
    """Parameters, body resistances, free motions and nodes on the ramp for 8 and 12 digits."""
    swimmer = ms.Swimmer.preset("tabak/helix", {"coefficients.law": "gray_hancock"})
    values = drawn(count)
    many = lifted(swimmer, values)
    p = np.ascontiguousarray(rft.parameters(many))
    body = np.ascontiguousarray(np.broadcast_to(rft.body_resistance(many), (count, 6, 6)))
    turns = 0.1 * values["tail.waves"]
    counts = {
        digits: rigidhelix.ramp_nodes.written(turns, p[:, 1] * p[:, 2], digits).astype(int)
        for digits in (8.0, 12.0)
    }
    return p, body, np.ones(6, bool), counts


def by_the_clock():
    """Designs per second on all cores, the most of several runs."""
    p, body, free, counts = designs(20 * DESIGNS)
    drag = diagonal(body)
    seconds = []
    for _ in range(12):
        start = time.perf_counter()
        manydesigns.solve_helices(True, p, drag, free, counts[8.0])
        seconds.append(time.perf_counter() - start)
    return len(p) / min(seconds)


def on_all_cores():
    """`by_the_clock` in a process of its own, whose loops take every core."""
    threads = {"NUMBA_NUM_THREADS": str(os.cpu_count())}
    command = [sys.executable, __file__, "clock"]
    run = subprocess.run(
        command, env=os.environ | threads, capture_output=True, text=True, check=True
    )
    return float(run.stdout)


def in_c(function, p, body, V, rules, phases):
    """A call of the C kernel, which writes the twists V (n, m, 6) at m phases."""
    double = ctypes.POINTER(ctypes.c_double)
    kept = [np.ascontiguousarray(p[:, :10]), body, *rules[0], *rules[1], phases, V]
    head, body_, x0, w0, x1, w1, at, out = (a.ctypes.data_as(double) for a in kept)
    n, m0, m1, m = (ctypes.c_int(k) for k in (len(p), *NODES, len(phases)))

    def run(kept=kept):
        function(n, head, body_, m0, x0, w0, m1, x1, w1, m, at, out)

    return run


def throughput():
    """Microseconds per design: ours, and 32 nodes in plain Numba, NumPy and C."""
    p, body, free, counts = designs(DESIGNS)
    drag = diagonal(body)
    rules = [gauss(n) for n in NODES]
    V = {}

    def closed(digits):
        return manydesigns.solve_helices(True, p, drag, free, counts[digits])[0]

    def ours():
        V["microswim"] = closed(8.0)

    def ours12():
        V["microswim, 12 digits"] = closed(12.0)

    def numba():
        V["Numba"] = plain_numba(p, body, free, *rules)

    x, w = (np.concatenate(part) for part in zip(*rules))
    on_ramp = np.arange(x.size) < NODES[0]

    def numpy():
        parts = [
            plain_numpy(p[i : i + 1000], body[i : i + 1000], x, w, on_ramp)
            for i in range(0, DESIGNS, 1000)
        ]
        V["NumPy"] = np.concatenate(parts)

    runs = {"microswim": ours, "microswim, 12 digits": ours12, "Numba": numba, "NumPy": numpy}
    function = compiled()
    if function is not None:
        V["C"] = np.empty((DESIGNS, 6))
        runs["C"] = in_c(function, p, body, V["C"], rules, np.zeros(1))
    for run in runs.values():
        run()
    micro = {name: 1e6 * least(run, 15) / DESIGNS for name, run in runs.items()}
    scale = np.abs(V["NumPy"]).max(axis=0)
    for name, values in V.items():
        other, most = ("NumPy", 1e-10) if name in ("C", "Numba") else ("microswim, 12 digits", 1e-8)
        error = (np.abs(values - V[other]) / scale).max()
        assert error < most, (name, error)
    return micro


def through_evaluate():
    """Microseconds per design, with the law, checks, powers and efficiency; the designs of C."""
    count = 20 * DESIGNS
    values = drawn(count)
    micro = {}
    for name, law in (("Gray and Hancock's law", "gray_hancock"), ("Lighthill's", "lighthill")):
        helix = ms.Swimmer.preset("tabak/helix", {"coefficients.law": law})
        ms.evaluate(helix, values)
        micro[name] = 1e6 * least(lambda: ms.evaluate(helix, values), 7) / count  # noqa: B023
    return micro


def of_waves():
    """Microseconds per plane wave, six phases of 32 nodes: our table of sines, and plain C."""
    wave = ms.Swimmer.preset("tabak/plane_wave", {"coefficients.law": "gray_hancock"})
    count = DESIGNS // 5
    many = lifted(wave, {"tail.amplitude": np.random.default_rng(0).uniform(0.03, 0.2, count)})
    p = np.ascontiguousarray(rft.parameters(many))
    body = np.ascontiguousarray(np.broadcast_to(rft.body_resistance(many), (count, 6, 6)))
    drag = diagonal(body)
    phases, rules = np.pi * np.arange(HALF) / HALF, [gauss(n) for n in NODES]
    in_plane = [0, 1, 5]

    def ours():
        return manydesigns.solve_waves(True, p, drag, phases, np.ones(6, bool), *rules)[0]

    micro = {"microswim": 1e6 * least(ours, 15) / count}
    if (function := compiled()) is not None:
        flat, V = p.copy(), np.empty((count, HALF, 6))
        flat[:, [4, 9]] = 0.0  # hand and spin
        run = in_c(function, flat, body, V, rules, phases)
        micro["C"] = 1e6 * least(run, 15) / count
        error = np.abs(V - ours())[..., in_plane].max() / np.abs(V).max()
        assert error < 1e-10, error
    return micro


def kernels_alone():
    """What depends on the lanes of the machine: ratios to C of a helix and of a plane wave."""
    micro, waves = throughput(), of_waves()
    return {
        "microseconds per design, 32 nodes": micro,
        "NumPy over microswim": micro["NumPy"] / micro["microswim"],
        "C over microswim": micro.get("C", np.nan) / micro["microswim"],
        "microseconds per plane wave, 6 phases x 32 nodes": waves,
        "C over microswim, plane wave": waves.get("C", np.nan) / waves["microswim"],
    }


def with_avx2_alone():
    """`kernels_alone` of a process that compiles for AVX2 alone; None where that is all."""
    if "AVX-512" not in processor():
        return None
    env = os.environ | {"NUMBA_CPU_NAME": NARROW}
    command = [sys.executable, __file__, "kernels"]
    run = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    return json.loads(run.stdout.splitlines()[-1])


def main():
    """Run all and print the table."""
    ms.warm_up()
    helix = ms.Swimmer.preset("tabak/helix")
    helix.gait()
    b, N = np.meshgrid(np.linspace(0.01, 0.5, 200), np.linspace(0.5, 5.0, 200))
    grid = {"tail.amplitude": b.ravel(), "tail.waves": N.ravel()}
    ms.evaluate(helix, {k: v[:10] for k, v in grid.items()})
    mapped = least(lambda: ms.evaluate(helix, grid), 5)
    results = {
        **kernels_alone(),
        "million designs per second, all cores, by the clock": 1e-6 * on_all_cores(),
        "microseconds per gait from Python": 1e6 * least(helix.gait, 9, 300),
        "microseconds with mean velocity": 1e6 * least(lambda: helix.gait().mean_velocity, 9, 300),
        "milliseconds with summary": 1e3 * least(lambda: ms.summary(helix.gait()), 5, 20),
        "seconds per 200 x 200 map": mapped,
        "microseconds per design of a map": 1e6 * mapped / b.size,
        "microseconds per design through evaluate": through_evaluate(),
    }
    if (narrow := with_avx2_alone()) is not None:
        results["AVX2 alone"] = narrow
    keep("surrogate", results)
    print(json.dumps(results, indent=1))


if __name__ == "__main__":
    if sys.argv[1:] == ["clock"]:
        print(by_the_clock())
    elif sys.argv[1:] == ["kernels"]:
        print(json.dumps(kernels_alone()))
    else:
        main()
