"""Swimmers that no fluid would let be: refused, or said in words, by every model and command."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import microswim as ms
from microswim.cli import main
from microswim.models.joint import piercing
from microswim.swimmer import physical_sense
from microswim.swimmer.geometry import attachment

HELIX = ms.Swimmer.preset("tabak/helix")
ALONE = ms.Swimmer(body=ms.NoBody(), tail=HELIX.tail, fluid=HELIX.fluid)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"interaction.translation": (-1.0, 1.0, 1.0)}, "interaction.translation[0]"),
        ({"interaction.translation[2]": -1e-3}, "interaction.translation[2]"),
        ({"interaction.rotation": (-50.0, 1.0, 1.0)}, "interaction.rotation[0]"),
        ({"interaction.rotation": (1.0, 1.0, -500.0)}, "interaction.rotation[2]"),
        ({"interaction.coupling": ((0, 0, 0), (0, 0, 9.0), (0, 0, 0))}, "interaction.coupling"),
        ({"interaction.coupling": ((1.01, 0, 0), (0, 0, 0), (0, 0, 0))}, "interaction.coupling"),
    ],
)
def test_a_body_that_its_own_drag_would_drive_is_refused(changes, field):
    swimmer = HELIX.with_(changes)
    with pytest.raises(ms.SpecError) as refused:
        swimmer.gait()
    assert refused.value.field == field
    result = ms.evaluate(swimmer, {"tail.amplitude": np.array([0.1, 0.11])})
    assert np.isnan(result["mean_velocity"]).all()


def test_in_a_batch_only_the_designs_that_gain_power_are_left_out():
    gamma = np.array([-50.0, -0.001, 1.0])
    found = ms.evaluate(HELIX, {"interaction.rotation[0]": gamma})["mean_velocity"][:, 0]
    assert np.isfinite(found).tolist() == [False, True, True]
    found = ms.evaluate(HELIX, {"interaction.translation[0]": np.array([-1.0, 0.0, 1.0])})
    assert np.isfinite(found["mean_velocity"][:, 0]).tolist() == [False, True, True]


@pytest.mark.parametrize("coupling", [0.0, 0.9])
def test_whatever_is_answered_costs_power_in_every_motion(coupling):
    swimmer = HELIX.with_({"interaction.coupling[0][0]": coupling})
    R = swimmer.gait().resistance(np.linspace(0.0, 6.0, 7))
    assert np.linalg.eigvalsh(R).min() > 0.0


def test_the_papers_negative_coefficient_is_a_remark():
    (said,) = [
        r
        for r in ms.Swimmer.preset("tabak/plane_wave-constant").gait().info["remarks"]
        if "rotation" in r
    ]
    assert "turned by its own drag" in said


REMARKS = {
    "larger than c_n": ("tabak/plane_wave-constant", {"coefficients.normal": 500.0}),
    "as thick as the body": ("tabak/helix", {"body.radius": 0.05}),
    "half of the tail's length": ("tabak/helix", {"tail.amplitude": 1.0, "tail.waves": 1.0}),
    "does not touch": ("tabak/helix", {"tail.ramp": 0.0, "body.radius": 0.1}),
}


@pytest.mark.parametrize("words", REMARKS)
def test_odd_swimmers_are_said_in_words_in_every_command(words):
    preset, changes = REMARKS[words]
    swimmer = ms.Swimmer.preset(preset).with_(changes)
    assert any(words in r for r in swimmer.gait().info["remarks"])
    pairs = [x for name, value in changes.items() for x in ("--set", f"{name}={value}")]
    run = CliRunner().invoke(main, ["run", "--preset", preset, *pairs, "--json", "--model", "rft"])
    assert any(words in r for r in json.loads(run.stdout)["info"]["remarks"])
    other = ["calibrate", "--preset", preset, *pairs, "--measured", "swimming_speed=0.05"]
    said = " ".join(CliRunner().invoke(main, other).stderr.split())
    assert words in said


def test_remarks_stay_away_from_usual_swimmers():
    for name in ("tabak/helix", "tabak/plane_wave", "goto/C"):
        assert ms.Swimmer.preset(name).gait().info["remarks"] == []


@pytest.mark.parametrize("hand", ["left", "right"])
def test_a_rigid_helix_without_body_stands_still_by_a_law(hand):
    swimmer = ALONE.with_({"tail.handedness": hand})
    found = ms.io.numbers(swimmer, swimmer.gait())
    turning = -swimmer.tail.sign * swimmer.tail.rate
    assert found["mean_velocity"].pop(3) == pytest.approx(turning, rel=1e-14)
    assert found["mean_velocity"] == [0.0] * 5
    assert found["swimming_speed"] == 0.0
    # The law itself, without the shortcut of the printed numbers.
    assert np.abs(swimmer.gait().mean_velocity[:3]).max() < 1e-15
    assert any("zero by a law" in r for r in swimmer.gait().info["remarks"])


def test_held_about_s_a_helix_without_body_swims():
    held = ALONE.with_({"motion.free": ("us", "uq", "ur", "oq", "or")})
    assert ms.io.numbers(held, held.gait())["mean_velocity"][0] < -1e-3
    assert not any("zero by a law" in r for r in held.gait().info["remarks"])


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    kind=st.sampled_from(["tabak/helix", "tabak/plane_wave"]),
    ramp=st.sampled_from([0.0, 0.0, 0.1, 1.0]),
    amplitude=st.floats(0.02, 0.4),
    waves=st.floats(0.6, 2.0),
    body=st.floats(0.06, 0.5),
    phase=st.floats(0.0, 6.0),
)
def test_one_rule_says_whether_a_tail_touches_its_body(kind, ramp, amplitude, waves, body, phase):
    """The rule that rft remarks upon is the one by which the reference finds its joint."""
    numbers = {"tail.ramp": ramp, "tail.amplitude": amplitude, "tail.waves": waves}
    swimmer = ms.Swimmer.preset(kind).with_({**numbers, "tail.radius": 0.01, "body.radius": body})
    misses = attachment.misses(swimmer.body, swimmer.tail, phase)
    try:
        piercing(swimmer.body, swimmer.tail, phase)
        found = True
    except ms.SpecError as refused:
        found = "half width" not in str(refused)
    assert misses != found


def test_a_ramp_mends_a_tail_that_misses_its_head():
    swimmer = HELIX.with_({"tail.ramp": 0.0, "body.radius": 0.1})
    assert attachment.misses(swimmer.body, swimmer.tail)
    with pytest.raises(ms.SpecError, match="ramp"):
        swimmer.gait("bem", level="coarse")
    mended = swimmer.with_({"tail.ramp": 0.1})
    assert not attachment.misses(mended.body, mended.tail)


def test_a_flow_with_inertia_is_said_by_every_model():
    """At 1 kHz a robot of a millimetre in water is no Stokes flow; ten nanometres are."""
    fast = HELIX.with_({"tail.frequency": 1e3, "fluid.density": 1.0})
    (said,) = [r for r in physical_sense.remarks(fast) if "Reynolds" in r]
    assert f"{physical_sense.reynolds(fast):.2g}" in said
    assert said in fast.gait().info["remarks"]
    assert physical_sense.reynolds(HELIX) == pytest.approx(0.01)  # Table 1
    assert not any("Reynolds" in r for r in physical_sense.remarks(HELIX))
