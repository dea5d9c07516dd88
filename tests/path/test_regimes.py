"""Regimes of robots in rotating fields: against paths in time, laws, and what is refused."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.gait.held import HeldWarning
from microswim.gait.turning.slipping import drift
from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.gait.turning.step_out import mobility_of

TILTED = [0.5, float(np.sqrt(0.75)), 0.0]


def robot(**changes):
    return ms.Swimmer.preset(
        "tabak/helix-constant",
        {
            "motion.free": "all",
            "magnet": {"moment": TILTED},
            "field": {"kind": "rotating", "strength": 60.0, "frequency": 0.1},
            **changes,
        },
    )


def in_time(swimmer, gait, frequency, turns):
    """Precession angle and velocity along x of a path that begins with the robot along x."""
    field = swimmer.with_({"field.frequency": frequency}).field
    times = np.linspace(0.0, turns / abs(frequency), 16 * turns + 1)
    path = ms.trajectory(
        gait, times, rate=0.0, moment=swimmer.magnet.vector, field=field.at, max_step=times[1] / 8
    )
    _, _, y, z = path.quaternion.values[-1]
    along = 1.0 - 2.0 * (y * y + z * z)
    last = path.position.values[-17 * 4 :: 16, 0]
    return np.arccos(abs(along)), np.polyfit(times[-17 * 4 :: 16], last, 1)[0]


@pytest.mark.parametrize("frequency", [0.0008, 0.0025, 0.004, 0.013])
def test_a_path_in_time_ends_in_a_state_that_is_told(frequency):
    """Stepping knows nothing of steady states. Tumbling, wobbling, and close to synchronous."""
    swimmer = robot()
    gait = swimmer.gait()
    told = ms.regimes(swimmer, [frequency], gait=gait)
    angle, velocity = in_time(swimmer, gait, frequency, 60)
    states = [(told.precession_angle[0], told.velocity[0]), *told.others[0]]
    nearest = min(states, key=lambda s: abs(s[0] - angle))
    assert angle == pytest.approx(nearest[0], abs=1e-4)
    assert velocity == pytest.approx(nearest[1], rel=1e-3, abs=1e-9)


def test_regimes_follow_one_another():
    told = ms.regimes(robot(), np.linspace(0.0005, 0.03, 30), model="rft")
    order = list(dict.fromkeys(told.regime))
    assert order == ["tumbling", "wobbling", "synchronous", "stepped out"]
    tumbles = told.frequency < told.wobbling_onset
    assert tumbles.tolist() == [r == "tumbling" for r in told.regime]
    lost = told.frequency > told.step_out
    assert lost.tolist() == [r == "stepped out" for r in told.regime]
    assert np.isnan(told.precession_angle).tolist() == lost.tolist()
    assert told.velocity_error[lost].max() < 0.02 * np.abs(told.velocity).max()  # slow to settle


def test_what_the_field_never_holds_has_not_stepped_out():
    """Magnetised along its axis in a field with a cone it has no torque about itself."""
    field = ms.RotatingField(strength=10.0, frequency=0.1, cone=0.7)
    body = ms.Spheroid(semi_axes=(0.8, 0.3))
    one = ms.Swimmer(
        body=body, tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0), field=field,
        magnet=ms.Magnet(moment=(1.0, 0.0, 0.0)),
    )  # fmt: skip
    assert ms.regimes(one, [0.05, 2.0]).regime == ("not held", "not held")


def test_the_velocity_is_zero_where_it_changes_sign():
    told = ms.regimes(robot(), np.linspace(0.0005, 0.01, 9), model="rft")
    (reversal,) = told.reversals
    there = ms.regimes(robot(), [reversal], model="rft")
    assert abs(there.velocity[0]) < 1e-9 * np.abs(told.velocity).max()


def test_turned_the_other_way_the_robot_swims_the_other_way():
    frequencies = [0.001, 0.01]
    one = ms.regimes(robot(), frequencies, model="rft")
    other = ms.regimes(robot(**{"field.frequency": -0.1}), frequencies, model="rft")
    assert other.velocity == pytest.approx(-one.velocity)
    mirrored = ms.regimes(robot(**{"tail.handedness": "right"}), frequencies, model="rft")
    assert mirrored.velocity == pytest.approx(-one.velocity)  # moment in the mirror's plane
    assert mirrored.step_out == pytest.approx(one.step_out)


def test_units_do_not_matter():
    """The same robot in SI, lengths in micrometres and times in milliseconds."""
    um, ms_, mu = 1e-6, 1e-3, 1e-3
    bare = robot(**{"fluid.viscosity": 1.0})
    preset = bare.tail
    si = ms.Swimmer(
        body=ms.Sphere(radius=0.5 * um),
        tail=ms.HelicalTail(
            length=preset.length * um,
            amplitude=preset.amplitude * um,
            waves=preset.waves,
            radius=preset.radius * um,
            ramp=preset.ramp,
        ),
        fluid=ms.Fluid(viscosity=mu),
        coefficients=ms.Lighthill(),
        units="SI",
        magnet=ms.Magnet(moment=tuple(m * mu * um**3 / ms_ for m in TILTED)),
        field=ms.RotatingField(strength=60.0, frequency=1.0),
    )
    same = bare.with_({"magnet.moment": tuple(TILTED)})
    same = ms.Swimmer(
        body=same.body, tail=same.tail, fluid=same.fluid, magnet=same.magnet, field=same.field
    )
    a = ms.regimes(same, [1e-4, 0.5], model="rft")
    b = ms.regimes(si, [1e-4 / ms_, 0.5 / ms_], model="rft")
    assert b.step_out * ms_ == pytest.approx(a.step_out, rel=1e-9)
    assert b.velocity[0] * ms_ / um == pytest.approx(a.velocity[0], rel=1e-9)
    assert b.velocity[1] * ms_ / um == pytest.approx(a.velocity[1], rel=1e-6)


def test_on_a_rail_a_robot_slips_as_adler_says():
    """Turning about s alone: the mean rate is ``w - sqrt(w^2 - w_c^2)`` beyond step-out w_c."""
    gait = robot(**{"motion.free": ["us", "os"]}).gait()
    M = mobility_of(gait)
    steady = SteadyTurning(M, np.array([0.0, 1.0, 0.0]), 60.0)
    critical = 60.0 * M[3, 0]
    for ratio in (1.05, 1.5, 3.0):
        rate = ratio * critical
        mean, spread = drift(steady, rate)
        slips = critical * (ratio - np.sqrt(ratio**2 - 1.0))
        assert mean == pytest.approx(M[0, 0] / M[3, 0] * slips, rel=2e-4)
        assert spread < 1e-3 * abs(mean)


@pytest.mark.parametrize(
    ("changes", "frequency", "words"),
    [
        ({"magnet": None}, [1.0], "magnet: missing"),
        ({"field": None}, [1.0], "field.kind = 'missing': must be \"rotating\""),
        ({"field": {"kind": "uniform", "strength": 1.0}}, [1.0], "field.kind = 'uniform'"),
        ({"motion.free": ["us", "uq", "ur", "os"]}, [1.0], r"motion.free = .*\(oq, or held\)"),
        ({}, [], "a list of frequencies"),
        ({}, [0.0], r"frequency\[0\] = 0.0: must be a positive"),
        ({}, ["fast"], "frequency = .*finite numbers"),
    ],
)
def test_one_sentence_says_what_is_wrong(changes, frequency, words):
    tables = {k: v for k, v in changes.items() if v is not None}
    swimmer = robot(**tables)
    for name in ("magnet", "field"):
        if name in changes and changes[name] is None:
            swimmer = ms.Swimmer(
                **{
                    f: getattr(swimmer, f)
                    for f in ("body", "tail", "fluid", "motion", "magnet", "field")
                    if f != name
                }
            )
    with pytest.raises(ms.SpecError, match=words) as caught:
        ms.regimes(swimmer, frequency, model="rft")
    assert "\n" not in str(caught.value)


SPEC = """
[fluid]
viscosity = "0.34 Pa s"
density = "970 kg/m^3"
[body]
shape = "sphere"
radius = "0.5 mm"
[tail]
kind = "helix"
length = "2 mm"
amplitude = "0.2 mm"
waves = 2
radius = "0.1 mm"
[magnet]
moment = "1e-6 A m^2"
direction = "70 deg"
[field]
kind = "rotating"
strength = "5 mT"
frequency = "1 Hz"
"""


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(SPEC, encoding="utf-8")
    return str(path)


def run(*args):
    return CliRunner().invoke(main, ["regimes", *args])


def test_the_command_prints_one_object(spec):
    done = run(spec, "--frequency", "0.1Hz:2Hz:4", "--strength", "3 mT", "--json")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    swimmer = ms.Swimmer.from_toml(spec, {"field.strength": "3 mT"})
    same = ms.regimes(swimmer, np.linspace(0.1, 2.0, 4))
    for name in ("frequency", "velocity", "step_out", "wobbling_onset"):
        assert told[name] == pytest.approx(getattr(same, name)), name
    assert told["regime"] == list(same.regime)
    assert told["units"] == "SI"
    assert set(told["expected_error"]) == {"step_out", "velocity", "how"}
    assert set(told["closed_form"]) >= {"wobbling_onset", "step_out", "precession_angle"}


def test_the_command_writes_a_table_and_a_picture(spec, tmp_path):
    out = tmp_path / "out"
    done = run(spec, "--out", str(out))
    assert done.exit_code == 0, done.output
    assert "step-out" in done.output
    assert "Hz" in done.output
    assert {p.name for p in out.iterdir()} == {"regimes.csv", "regimes.json", "regimes.png"}
    assert (out / "regimes.csv").read_text().startswith("frequency (Hz),regime,precession_angle")
    again = run(spec, "--out", str(out))
    assert again.exit_code == 2
    assert "--force" in again.output


def test_over_one_more_number(spec, tmp_path):
    out = tmp_path / "map"
    over = ["--over", "magnet.direction=30deg:90deg:3", "--frequency", "1Hz,2Hz"]
    done = run(spec, *over, "--out", str(out), "--json")
    assert done.exit_code == 0, done.output
    rows = json.loads(done.stdout)["results"]
    assert [row["magnet.direction"] for row in rows] == pytest.approx(np.radians([30, 60, 90]))
    assert rows[0]["step_out"] < rows[1]["step_out"] < rows[2]["step_out"]
    assert (out / "regimes.png").exists()


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--frequency", "1:2:3"], "--frequency = 1.0: must have a unit"),
        (["--frequency", "1Hz:2Hz"], "FIRST:LAST:COUNT"),
        (["--frequency", "1Hz", "--strength", "5"], "--strength = 5.0: must have a unit"),
        (["--over", "magnet.colour=1:2:3"], "magnet.colour"),
        (["--set", 'field.kind="uniform"'], "field.frequency"),
    ],
)
def test_the_command_refuses_in_a_sentence(spec, args, words):
    done = run(spec, *args)
    assert done.exit_code == 2, done.output
    assert words in done.output
    assert done.output.count("\n") == 1


def test_fast_turning_is_said_to_be_beyond_stokes(spec):
    fast = ms.Swimmer.from_toml(spec).with_({"magnet.moment": "5e-4 A m^2"})
    told = ms.regimes(fast, [10.0, 3000.0])
    assert told.reynolds[1] > 0.5
    assert any("Reynolds" in remark for remark in told.remarks)
    slow = ms.regimes(ms.Swimmer.from_toml(spec), [0.1])
    assert not any("Reynolds" in remark for remark in slow.remarks)


def test_the_spec_s_magnet_and_field_drive_path_and_stepper():
    """Both take them from the swimmer, and agree with numbers given by hand."""
    swimmer = robot()
    gait, times = swimmer.gait(), np.linspace(0.0, 30.0, 31)
    by_hand = ms.trajectory(
        gait, times, rate=0.0, moment=TILTED, field=lambda t: swimmer.field.at(t)
    )
    told = ms.trajectory(gait, times, rate=0.0, moment=swimmer.magnet, field=swimmer.field)
    assert told.position.values.tolist() == by_hand.position.values.tolist()
    stepper, state = ms.Stepper.of(swimmer, locked=True), ms.State.at()
    for t in times[:-1]:
        turning = swimmer.field.angular_velocity
        state = stepper.step(state, dt=1.0, field=swimmer.field.at(t), field_rate=turning)
    assert state.position == pytest.approx(told.position.values[-1], rel=1e-6, abs=1e-9)
    other = ms.Stepper(gait, swimmer, moment=(0.0, 0.0, 3.0), locked=True)
    assert other.moment == (0.0, 0.0, 3.0)


def test_the_export_takes_the_spec_s_magnet(spec, tmp_path):
    args = ["export", spec, "--format", "c", "--name", "robot", "--out", str(tmp_path)]
    assert CliRunner().invoke(main, args).exit_code == 0
    m = ms.Swimmer.from_toml(spec).magnet.vector
    assert f"{float(m[0])!r}"[:8] in (tmp_path / "robot.c").read_text()


def test_held_rotations_are_said():
    held = robot(**{"motion.free": ["us", "uq", "ur", "os"]})
    with pytest.warns(HeldWarning, match='motion.free holds oq, or.*motion.free = "all"'):
        ms.Stepper.of(held, locked=True)
    with pytest.warns(HeldWarning):
        ms.trajectory(held.gait(), [0.0, 1.0], rate=0.0, moment=held.magnet, field=held.field)
    with pytest.warns(HeldWarning):
        ms.path(held, 0.1)
    ms.Stepper(held.gait())  # no magnet: nothing to say


def test_a_swimmer_prints_its_magnet_and_its_field(spec):
    text = str(ms.Swimmer.from_toml(spec))
    assert "magnet" in text
    assert "rotating, 5 mT, 1 Hz" in text
