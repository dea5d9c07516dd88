"""Many designs at once: each is its own gait, to rounding, or there is no answer."""

import os
import subprocess
import sys

import numpy as np
import pytest

import microswim as ms
from microswim.models.rft.gait import rules
from microswim.models.rft.segment import MOST_NODES, STEEPEST

LENGTH = 2.0


def drawn(kind, count, steepest, seed):
    """A swimmer and designs of all steepnesses, ramps and parts of a wave; filaments thin."""
    rng = np.random.default_rng(seed)
    waves = rng.uniform(0.3, 6.0, count)
    bk = np.exp(rng.uniform(np.log(0.05), np.log(steepest), count))
    values = {
        "tail.amplitude": bk * LENGTH / (2.0 * np.pi * waves),
        "tail.waves": waves,
        "tail.ramp": rng.choice([0.0, 0.1, 0.5, 1.0], count),
        "tail.radius": np.full(count, 1e-4),
    }
    law = {"coefficients.law": "gray_hancock", "coefficients.tip": True}
    return ms.Swimmer.preset(f"tabak/{kind}", law), values


@pytest.mark.parametrize(
    ("kind", "count", "steepest"), [("helix", 40, 24.0), ("plane_wave", 14, 12.0)]
)
def test_every_number_of_a_batch_is_that_of_the_gait(kind, count, steepest):
    """Velocities on the scale of the largest, linear and angular apart; all else of itself."""
    swimmer, values = drawn(kind, count, steepest, seed=5)
    batch = ms.evaluate(swimmer, values)
    for i in range(count):
        alone = ms.summary(swimmer.with_({k: float(v[i]) for k, v in values.items()}).gait())
        both = np.concatenate([alone["mean_velocity"], alone["velocity_amplitude"]])
        scale = np.repeat(np.abs(both).reshape(2, 2, 3).max(axis=(0, 2)), 3)
        for name, found in batch.items():
            size = scale if "velocity" in name else abs(alone[name])
            assert np.abs((found[i] - alone[name]) / size).max() < 1e-8, (name, i)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        (
            {"tail.amplitude": 2.0 * STEEPEST * LENGTH / (2.0 * np.pi), "tail.waves": 1.0},
            "amplitude",
        ),
        ({"tail.amplitude": 1e-9, "tail.waves": 1.0 * MOST_NODES}, "waves"),
    ],
)
def test_a_wave_that_cannot_be_resolved_is_refused_by_both(changes, field):
    swimmer, _ = drawn("plane_wave", 1, 1.0, seed=0)
    swimmer = swimmer.with_({"tail.radius": 1e-12})
    batch = ms.evaluate(swimmer, {k: np.array([v]) for k, v in changes.items()})
    assert all(np.isnan(found).all() for found in batch.values())
    with pytest.raises(ms.SpecError, match=f"tail.{field} = .* at most"):
        swimmer.with_(changes).gait()


def test_a_wave_of_a_hundred_turns_costs_a_hundred_times_one():
    """Its nodes; and the drag along it is that of a fine trapezoidal rule [Tabak Eqs. 5, 13]."""
    swimmer, _ = drawn("plane_wave", 1, 1.0, seed=0)
    law = {"tail.ramp": 0.0, "tail.length": 100.0, "coefficients.tip": False, "tail.radius": 1e-3}
    few, long = (
        swimmer.with_(law | {"tail.waves": n, "tail.amplitude": 10.0 / n}) for n in (1.0, 100.0)
    )
    nodes = [rules(s)[1][0].size for s in (few, long)]
    assert nodes[1] <= 100.0 * nodes[0]
    gait = long.gait()
    s = np.linspace(0.0, 100.0, 200 * 100 + 1)
    k = 2.0 * np.pi
    slope = -0.1 * k * np.sin(k * s)
    speed = np.sqrt(1.0 + slope**2)
    c_t, c_n, _ = long.coefficients.local(long.tail, long.fluid.viscosity)
    along = np.trapezoid(c_n * speed + (c_t - c_n) / speed, s)
    body = gait.body_resistance_series[0, 0, 0]
    assert gait.resistance(0.0)[0, 0] - body == pytest.approx(along, rel=1e-9)


@pytest.mark.parametrize("tolerance", [0.0, 0.05, np.nan])
def test_a_tolerance_that_is_none_is_refused(tolerance):
    with pytest.raises(ms.SpecError, match="from 1e-12 to 1e-3"):
        ms.evaluate(ms.Swimmer.preset("tabak/helix"), {}, tolerance=tolerance)


THREADS = """
from concurrent.futures import ThreadPoolExecutor
import multiprocessing as mp
import numpy as np, microswim as ms
swimmer = ms.Swimmer.preset("tabak/helix")
def speed(i=0):
    b = np.linspace(0.05, 0.15, 5000)
    return float(ms.evaluate(swimmer, {"tail.amplitude": b})["swimming_speed"][i])
with ThreadPoolExecutor(4) as pool:
    print(len(set(pool.map(lambda i: speed(7), range(12)))))
with mp.get_context("fork").Pool(1) as pool:
    print(pool.apply_async(speed).get(timeout=100) == speed())
"""


def test_threads_take_turns_and_a_forked_process_works_alone():
    """Numba's plainest threads abort when two loops run at once, and do not outlive a fork."""
    done = subprocess.run(
        [sys.executable, "-c", THREADS],
        env=os.environ | {"NUMBA_THREADING_LAYER": "workqueue"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.stdout.split() == ["1", "True"], done.stderr[-500:]


def test_a_motor_that_stands_still_swims_at_no_speed():
    """A magnetic robot's motor is at rest: NaN shut its designs out of every search."""
    still = ms.Swimmer.preset("tabak/helix").with_({"tail.frequency": 0.0})
    found = ms.evaluate(still, {"tail.amplitude": [0.1, 0.12]})
    assert found["swimming_speed"].tolist() == [0.0, 0.0]
    assert ms.summary(still.gait())["swimming_speed"] == 0.0
