"""Step-out and the like as quantities: equal to the states, exact derivatives, every door."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.gait.readable import significant
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.gait.turning.step_out import Drive, fastest, onset, steady
from microswim.swimmer.fields import lifted
from microswim.swimmer.magnetism.drive import drive_of


def robot(**changes):
    magnet = {"moment": 1.0, "direction": 1.1, "azimuth": 0.3}
    field = {
        "kind": "rotating",
        "strength": 60.0,
        "frequency": 0.1,
        "cone": changes.pop("cone", 0.0),
    }
    tables = {"motion.free": "all", "magnet": magnet, "field": field}
    return ms.Swimmer.preset("tabak/helix-constant", tables | changes)


class Still:
    """A gait that is nothing but a resistance."""

    free = (True,) * 6

    def __init__(self, R):
        self.R = R

    def resistance(self, phase):
        return self.R


@pytest.mark.parametrize("cone", [0.0, 0.2])
@pytest.mark.parametrize("seed", range(8))
def test_the_largest_rate_is_that_of_the_states_that_are_held(seed, cone):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((6, 6))
    R = A @ A.T + np.diag([1.0, 1.0, 1.0, 6.0, 2.0, 2.0])
    moment = rng.standard_normal(3)
    states = SteadyTurning(np.linalg.inv(R)[:, 3:], moment, 0.8, cone)
    rate, velocity = fastest(Still(R), Drive(moment, 0.8, cone))
    assert rate == pytest.approx(states.step_out, rel=1e-9)
    assert velocity == pytest.approx(states.at_step_out.velocity, rel=1e-4, abs=1e-9)
    if not cone:
        assert onset(Still(R), Drive(moment, 0.8)) == pytest.approx(states.wobbling_onset)


@pytest.mark.parametrize(
    "name", ["magnet.moment", "magnet.direction", "tail.amplitude", "field.strength", "tail.length"]
)
@pytest.mark.parametrize("cone", [0.0, 0.3])
def test_derivatives_are_exact(name, cone):
    """By the complex step through Newton's method, against differences."""
    swimmer = robot(cone=cone).with_({"field.frequency": 0.01})  # which it follows
    value, h = swimmer.numbers[name], 1e-5 * swimmer.numbers[name]
    for quantity in DRIVEN:
        if cone and quantity == "wobbling_onset":
            continue

        def at(x, quantity=quantity):
            one = lifted(swimmer, {name: x})
            return float(ms.observed(one.gait(), quantity, drive=drive_of(one)))

        told = swimmer.gradient(quantity, name)[name]
        found = (at(value + h) - at(value - h)) / (2 * h)
        assert told == pytest.approx(found, rel=1e-6, abs=1e-9 * abs(at(value) / value)), quantity


def test_step_out_is_told_as_by_the_regimes():
    swimmer = robot()
    told = ms.regimes(swimmer, [0.01], model="rft")
    gait, drive = swimmer.gait(), drive_of(swimmer)
    assert ms.observed(gait, "step_out", drive=drive) == pytest.approx(told.step_out)
    assert ms.observed(gait, "wobbling_onset", drive=drive) == pytest.approx(told.wobbling_onset)
    speed = ms.observed(gait, "speed_at_step_out", drive=drive)
    assert speed == pytest.approx(abs(told.velocity_at_step_out), rel=1e-5)
    per_turn = ms.observed(gait, "speed_per_turn", drive=drive)
    assert per_turn == pytest.approx(speed / told.step_out, rel=1e-9)
    numbers = ms.io.numbers(swimmer, gait)
    assert {n: numbers[n] for n in DRIVEN} == pytest.approx(
        {n: float(ms.observed(gait, n, drive=drive)) for n in DRIVEN}
    )


def test_without_magnet_or_with_held_rotations_nothing_is_told():
    bare = ms.Swimmer.preset("tabak/helix")
    assert not set(DRIVEN) & set(ms.io.numbers(bare, bare.gait()))
    with pytest.raises(ms.SpecError, match=r"needs a swimmer with \[magnet\]"):
        ms.observed(bare.gait(), "step_out")
    held = robot(**{"motion.free": ["us", "os"]})
    assert not set(DRIVEN) & set(ms.io.numbers(held, held.gait()))
    with pytest.raises(ms.SpecError, match="free its rotations"):
        ms.observed(held.gait(), "step_out", drive=drive_of(held))
    with pytest.raises(ms.SpecError, match="step_out"):
        ms.design(bare, {"tail.amplitude": (0.05, 0.2)}, maximize="step_out")


def test_the_fastest_design_is_found():
    """Speed at step-out over the amplitude: no design of a fine line is faster."""
    swimmer = robot(magnet={"moment": 1.0, "direction": 1.5707})
    best = ms.design(
        swimmer, {"tail.amplitude": (0.03, 0.3)}, maximize="speed_at_step_out", samples=32
    )

    def speed(amplitude):
        one = swimmer.with_({"tail.amplitude": amplitude})
        return ms.observed(one.gait(), "speed_at_step_out", drive=drive_of(one))

    line = [speed(a) for a in np.linspace(0.03, 0.3, 60)]
    assert speed(best.values["tail.amplitude"]) >= max(line) * (1 - 1e-6)


def test_the_best_direction_of_a_magnet_is_found():
    best = ms.design(
        robot(), {"magnet.direction": (0.2, 1.57)}, maximize="speed_at_step_out", samples=32
    )
    limited = ms.design(
        robot(), {"magnet.direction": (0.2, 1.57)}, maximize="speed_at_step_out",
        subject_to="wobbling_onset >= 0.001", samples=32,
    )  # fmt: skip
    assert best.values["magnet.direction"] > limited.values["magnet.direction"]
    one = robot().with_({"magnet.direction": limited.values["magnet.direction"]})
    assert onset(one.gait(), drive_of(one)) / (2 * np.pi) == pytest.approx(0.001, rel=1e-4)


def test_run_prints_them(tmp_path):
    spec = tmp_path / "robot.toml"
    spec.write_text(robot().to_toml(), encoding="utf-8")
    done = CliRunner().invoke(main, ["run", str(spec), "--json"])
    assert done.exit_code == 0, done.output
    assert set(DRIVEN) <= set(json.loads(done.stdout))


#: Resistance of a printed helix with a box for a head (SI, boundary elements), nearly of
#: revolution, its magnet straight across: the maximum is flat, and Newton's method left it.
BOXED = np.array(
    [
        [4.283e-3, -3.371e-5, -3.181e-5, 2.877e-8, 9.980e-8, -1.053e-7],
        [-3.371e-5, 4.621e-3, 8.860e-6, -6.382e-8, -3.382e-8, 2.282e-6],
        [-3.181e-5, 8.860e-6, 4.630e-3, 4.068e-8, -2.293e-6, 1.058e-8],
        [2.877e-8, -6.382e-8, 4.068e-8, 2.078e-9, -1.104e-10, -1.253e-10],
        [9.980e-8, -3.382e-8, -2.293e-6, -1.104e-10, 5.785e-9, -5.892e-11],
        [-1.053e-7, 2.282e-6, 1.058e-8, -1.253e-10, -5.892e-11, 5.796e-9],
    ]
)


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("across", [0.0, 1e-6, 0.02, 0.4])
def test_a_flat_maximum_is_not_left(across, scale):
    moment = 4.77e-4 * np.array([np.sin(across), np.cos(across), 0.0])
    drive = Drive(moment, 5e-3 * scale)
    states = steady(Still(BOXED), drive)
    rate, velocity = fastest(Still(BOXED), drive)
    assert rate == pytest.approx(states.step_out, rel=1e-6)
    assert velocity == pytest.approx(float(states.at_step_out.velocity), rel=1e-3)
    exact = fastest(Still(BOXED), drive._replace(strength=drive.strength * (1 + 1e-20j)))[0]
    assert np.imag(exact) == pytest.approx(1e-20 * rate, rel=1e-9)  # it goes with the field


def test_a_run_tells_them_and_warns_of_inertia():
    """At the rate at which the field turns it, not that of a motor that stands still."""
    one = ms.Swimmer(
        body=ms.Sphere(radius=5e-4),
        tail=ms.HelicalTail(length=2e-3, amplitude=2e-4, waves=2, radius=1e-4, frequency=0.0),
        fluid=ms.Fluid(viscosity=0.34, density=970.0),
        magnet=ms.Magnet(moment=(0.0, 3e-4, 0.0)),
        field=ms.RotatingField(strength=5e-3, frequency=10.0),
        units="SI",
    )
    rows = dict(r[:2] for r in ms.report.numbers_table(ms.io.numbers(one, one.gait()), "r").rows)
    assert rows["step out"].endswith("Hz")
    assert rows["driven speed"].endswith("m/s")
    assert not any("turns at a Reynolds number" in line for line in one.remarks)
    fast = one.with_({"field.frequency": 200.0})
    Re = 970.0 * 2 * np.pi * 200.0 * 5e-4**2 / 0.34
    said = f"turns at a Reynolds number of {significant(Re, 2)}"
    assert any(said in line for line in fast.remarks)
