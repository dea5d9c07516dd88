"""The model in a loop: steps, exports and environments, against peers in the same run.

    python benchmarks/bench_control.py [--peers PYTHON]

PYTHON is an interpreter with mujoco, gymnasium, pyelastica and softmobility, apart from this one; a
peer that is not there is named in a line and left out. SoftMobility swims the three spheres of its
own example 07, 200 steps a period, its rollout compiled by JAX beforehand. Steps are processor
seconds on one core, the least of several runs, so that other work on the machine counts little;
environment steps are counted by the clock on all cores, and beside it per processor second times
two. Results go to benchmarks/results/control.json and, as a table, to the screen.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import time
from pathlib import Path

import gymnasium
import numpy as np
from clock import keep, least
from numba import njit
from scipy.integrate import solve_ivp

import microswim as ms
from microswim.control import environments, motion, readout
from microswim.control.export import compiler
from microswim.numerics.rigid_motion import rotation_matrix

gymnasium.register_envs(environments)
HERE = Path(__file__).parent
PEER = """
import json, time, warnings
warnings.simplefilter("ignore")
found = {}
def rate(step, n):
    best = 0.0
    for _ in range(5):
        start = time.process_time()
        for _ in range(n):
            step()
        best = max(best, n / (time.process_time() - start))
    return best
try:
    import gymnasium
    env = gymnasium.make("Swimmer-v5").unwrapped
    env.reset(seed=0)
    action = env.action_space.sample()
    found["MuJoCo Swimmer-v5"] = rate(lambda: env.step(action), 2000)
except Exception as error:
    found["MuJoCo: " + str(error)[:80]] = None
try:
    import numpy as np, elastica as ea
    class Simulator(ea.BaseSystemCollection, ea.Forcing, ea.Damping):
        pass
    simulator = Simulator()
    rod = ea.CosseratRod.straight_rod(
        50, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), 1.0, 0.025, 1000.0,
        youngs_modulus=1e6, shear_modulus=1e6 / 1.5)
    simulator.append(rod)
    simulator.add_forcing_to(rod).using(ea.SlenderBodyTheory, dynamic_viscosity=10.0)
    simulator.finalize()
    stepper = ea.PositionVerlet()
    t = [np.float64(0.0)]
    def step():
        t[0] = stepper.step(simulator, t[0], 1e-5)
    step()
    found["PyElastica rod, slender body, 50 elements"] = rate(step, 2000)
except Exception as error:
    found["PyElastica: " + str(error)[:80]] = None
try:
    import jax, numpy as np
    jax.config.update("jax_enable_x64", True)
    import softmobility
    body = softmobility.SoftBody('''
dof_names: [L]
design_names: [k, eps]
defaults: {k: 2.0, eps: 0.3, L0: 0.0, a0: 0.05, a1: 0.05, a2: 0.05}
spheres:
  - {radius: a0, force: [-k * L0, 0, 0]}
  - {radius: a1, position: [-1 - L0, 0, 0], force: [k * L0, 0, 0]}
  - {radius: a2, position: [1 + eps * sin(time), 0, 0]}
''', verbose=False)
    run = softmobility.FlowBodyRollout(soft_body=body, flow=softmobility.no_flow()).rollout
    design = jax.numpy.asarray(body.design_defaults)
    swim = jax.jit(lambda design: run(dt=2 * np.pi / 200, n_steps=1200, design=design)[0])
    def periods():
        swim(design).block_until_ready()
    periods()  # compiles
    found["SoftMobility (JAX), three spheres, compiled rollout"] = 1200 * rate(periods, 3)
except Exception as error:
    found["SoftMobility: " + str(error)[:80]] = None
print(json.dumps(found))
"""


@njit
def twists(n, table, wrench, work, out):
    """Phase in, twist out, n times."""
    total = 0.0
    for i in range(n):
        readout.body_twist(table, 0.01 * i, 6.0, wrench, work, out)
        total += out[0]
    return total


@njit
def steps(n, twist, strain, moment, limits, y, u, h, work):
    """n steps of order 4 under a force."""
    for _ in range(n):
        motion.advance(twist, strain, moment, limits, y, u, h, 1, work)


def latency():
    """Microseconds of a twist and of a step, in a compiled loop, in C, from Python, by SciPy."""
    swimmer = ms.Swimmer.preset("tabak/helix")
    gait, n = swimmer.gait(), 20_000
    one = ms.Stepper.of(swimmer, steps=1)
    state, wrench = ms.State.at(), np.arange(6.0)
    y, u = state.values.copy(), one.held(1, {"force": [1.0, 2.0, 3.0]})[0]
    work, out = np.empty(motion.WORK), np.empty(6)
    model = (*one._model, y, u, 0.01, work)
    twists(1, one.response.twist, wrench, work, out)
    steps(1, *model)
    free = ms.Stepper.of(swimmer)
    found = {
        "twist, compiled loop": least(lambda: twists(n, one.response.twist, wrench, work, out)) / n,
        "step, compiled loop": least(lambda: steps(n, *model)) / n,
        "twist, from Python": least(lambda: one.velocity(0.3, 6.0, wrench), calls=2000),
        "step, from Python": least(lambda: one.step(state, dt=0.01, force=(1, 2, 3)), calls=2000),
        "step, exported C": compiler.measured(ms.c_model(free, "robot"))["seconds_per_step"],
    }

    def rates(t, z):
        V = gait.velocity(gait.rate * t, wrench=np.zeros(6))
        w, x, y, s = z[3:]
        turn = np.array([[-x, -y, -s], [w, -s, y], [s, w, -x], [-y, x, w]]) @ V[3:] / 2
        return np.concatenate([rotation_matrix(z[3:]) @ V[:3], turn])

    def scipy():
        return solve_ivp(rates, (0.0, 1.0), [0, 0, 0, 1, 0, 0, 0], rtol=1e-6, atol=1e-9).nfev

    found["step of SciPy's RK45 around the gait in NumPy"] = least(scipy, 3) / (scipy() / 6)
    many = ms.State.at(np.zeros((10_000, 3)))
    one.step(many, dt=0.01)
    found["step, each of 10,000 together"] = least(lambda: one.step(many, dt=0.01)) / 10_000
    found["trajectory of 1e6 steps"] = least(lambda: steps(1_000_000, *model), 3)
    return {k: 1e6 * v if v else None for k, v in found.items()}


def worlds(n=8192):
    """Environment steps per second: by the clock on all cores, per processor second times two."""
    found = {}
    for name in ("Steer", "Reach"):
        envs = gymnasium.make_vec(f"microswim/{name}-v0", num_envs=n)
        envs.reset(seed=0)
        moves = np.random.default_rng(0).uniform(-1, 1, envs.action_space.shape)
        envs.step(moves)
        clock, spent = np.inf, np.inf
        for _ in range(40):
            a, b = time.perf_counter(), time.process_time()
            envs.step(moves)
            clock = min(clock, time.perf_counter() - a)
            spent = min(spent, time.process_time() - b)
        single = gymnasium.make(f"microswim/{name}-v0", max_steps=10**8, disturbance=0.0).unwrapped
        single.reset(seed=0)
        alone = 1.0 / least(lambda e=single, m=moves[0] * 0: e.step(m), 5, 500)
        found[name] = {"clock": n / clock, "two cores": 2 * n / spent, "single": alone}
    return found


def peers(python):
    """Steps per processor second of other environments and rods."""
    if python is None:
        return {}
    one = os.environ | {"OMP_NUM_THREADS": "1", "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false"}
    run = subprocess.run([python, "-c", PEER], capture_output=True, text=True, check=False, env=one)
    if run.returncode:
        raise SystemExit(run.stderr)
    return json.loads(run.stdout.splitlines()[-1])


def beside(others, steps, environment_steps):
    """Peers that are there, each beside our steps of a swimmer or of an environment."""
    ours = {name: environment_steps if "MuJoCo" in name else steps for name in others}
    return {
        name: {"steps per processor second": rate, "ours meanwhile": ours[name] / rate}
        for name, rate in others.items()
        if rate is not None
    }


def kept():
    """Peers of an earlier run, each with the ratio measured then."""
    page = HERE.parent / "docs" / "performance.json"
    return json.loads(page.read_text(encoding="utf-8")).get("control", {}).get("peers", {})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", metavar="PYTHON")
    others = peers(parser.parse_args().peers)
    micro, envs = latency(), worlds()
    results = {
        "microseconds": micro,
        "environments": envs,
        "peers": beside(others, 1e6 / micro["step, compiled loop"], envs["Steer"]["two cores"] / 2),
        "cores": os.cpu_count(),
    }
    if not others:
        print("no peers without --peers PYTHON; those of the last run with it are kept\n")
        results["peers"] = kept()
    keep("control", results)
    print(f"{'one core, processor time':<50} {'µs':>10} {'ratio':>9}")
    base = micro["step, compiled loop"]
    for name, value in micro.items():
        if value is not None:
            print(f"{name:<50} {value:>10.3g} {value / base:>9.3g}")
    print(f"\n{'environment steps per second':<50} {'million':>10} {'ratio':>9}")
    base = envs["Steer"]["clock"]
    for name, kinds in envs.items():
        for kind, value in kinds.items():
            print(f"{f'microswim/{name}-v0, {kind}':<50} {value / 1e6:>10.3g} {value / base:>9.3g}")
    for name, value in others.items():
        if value is not None:
            print(f"{name:<50} {value / 1e6:>10.3g} {value / base:>9.3g}")
        else:
            print(name)


if __name__ == "__main__":
    main()
