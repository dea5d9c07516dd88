"""A calibrated spec says by what, where and when; what it promises holds, loads included."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.calibration.atlas.expected import expected_error
from microswim.cli import main
from microswim.spec.describe import to_tables
from microswim.spec.file import from_dict, read
from microswim.spec.readers.text import toml
from microswim.spec.toml import to_toml

ROBOT = ms.Swimmer.preset("tabak/helix")
CELL = ms.Swimmer(
    body=ms.Spheroid(semi_axes=(1.0, 0.5)),
    tail=ms.HelicalTail(length=6.0, amplitude=0.2, wavelength=2.3, radius=0.03, ramp=0.2),
    fluid=ms.Fluid(viscosity=1.0),
)
WAVE = ms.Swimmer.preset("tabak/plane_wave")


@pytest.fixture(scope="module")
def solved():
    return {s: s.gait("bem", level="coarse") for s in (ROBOT, CELL, WAVE)}


def record(swimmer):
    """Return where a swimmer comes from; it must say so."""
    assert swimmer.calibration is not None
    return swimmer.calibration


def drift(gait, force, time):
    """Return how far a constant force carries the body beyond where it swims, by stepping."""
    stepper = ms.Stepper(gait)
    ends = [
        stepper.step(ms.State.at(), dt=time, motor_rate=gait.rate, force=f).position
        for f in (force, np.zeros(3))
    ]
    return float((ends[0] - ends[1]) @ force / np.linalg.norm(force))


@pytest.mark.parametrize("swimmer", [ROBOT, CELL, WAVE], ids=["robot", "cell", "plane wave"])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], ids=["along", "across"])
def test_calibrated_at_a_design_it_answers_a_load_better_than_before(solved, swimmer, direction):
    """A push over three periods, stepped in time: nothing of the fit's own path."""
    truth = solved[swimmer]
    force = 1e-2 * swimmer.fluid.viscosity * np.array(direction)
    plain, fitted = swimmer.gait("rft"), ms.calibrate(swimmer, truth).swimmer.gait()
    wanted, before, after = (drift(g, force, 3.0) for g in (truth, plain, fitted))
    assert abs(after / wanted - 1.0) < 0.5 * abs(before / wanted - 1.0)
    assert abs(after / wanted - 1.0) < 0.1


def test_velocities_agree_as_before(solved):
    for swimmer, truth in solved.items():
        fitted = ms.calibrate(swimmer, truth).swimmer.gait()
        assert fitted.mean_velocity[0] == pytest.approx(truth.mean_velocity[0], rel=1e-6)
        lateral = truth.velocity_amplitude[1]
        assert fitted.velocity_amplitude[1] == pytest.approx(lateral, rel=1e-6)


def test_what_is_not_matched_is_what_is_not_matched(solved):
    truth = solved[ROBOT]
    fit = ms.calibrate(ROBOT, truth)
    made, gait = record(fit.swimmer), fit.swimmer.gait()
    assert made.unmatched["efficiency"] == pytest.approx(
        gait.efficiency / truth.efficiency - 1.0, rel=1e-2
    )
    assert "efficiency" in " ".join(made.lines(fit.swimmer))
    assert "mean_power" not in made.unmatched
    assert gait.mean_power == pytest.approx(truth.mean_power, rel=1e-6)


def test_the_table_comes_back_from_a_file_and_an_old_file_still_loads(solved, tmp_path):
    fitted = ms.calibrate(ROBOT, solved[ROBOT]).swimmer
    tables = to_tables(fitted)
    path = tmp_path / "calibrated.toml"
    path.write_text(to_toml(tables, "calibrated"), "utf-8")
    again = read(path)
    assert again.calibration == fitted.calibration
    assert again == fitted
    del tables["calibration"]
    old = from_dict(tables)
    assert old.calibration is None
    assert np.array_equal(old.gait().velocity(0.3), fitted.gait().velocity(0.3))


def test_how_far_a_design_lies_and_what_changed_since(solved):
    fitted = ms.calibrate(ROBOT, solved[ROBOT]).swimmer
    made = record(fitted)
    assert (made.away(fitted), made.changed(fitted)) == ({}, [])
    other = fitted.with_({"tail.amplitude": 0.12, "fluid.viscosity": 7.0, "tail.frequency": 2.0})
    assert made.away(other) == {"tail.amplitude": pytest.approx(0.2)}
    assert "tail.amplitude +20 %" in made.lines(other)[0]
    assert made.changed(fitted.with_({"interaction.tail[1]": 1.0})) == ["interaction.tail[1]"]
    assert made.changed(replace(fitted, coefficients=ms.Cox())) == ["law"]


def test_the_promise_holds_at_the_design_and_is_not_made_elsewhere(solved):
    fitted = ms.calibrate(ROBOT, solved[ROBOT]).swimmer
    here = expected_error(fitted, fitted.gait())
    assert here["us"] == pytest.approx(0.0035, abs=1e-4)  # the level's own
    other = fitted.with_({"tail.amplitude": 0.05})
    gait, truth = other.gait(), other.gait("bem", level="coarse")
    off = abs(gait.mean_velocity[0] / truth.mean_velocity[0] - 1.0)
    there = expected_error(other, gait)
    assert off > 0.05
    assert off < there["us"] < 2.0 * off


def test_data_of_several_swimmers_say_over_which():
    cells = [ms.Swimmer.preset(f"goto/{c}") for c in "AC"]
    data = [ms.Observation(swimmer=s, quantity="swimming_speed", value=2e-5) for s in cells]
    made = record(ms.calibrate(cells[0], data, ["translation.s"]).swimmer)
    assert made.reference == "measurements"
    low, high = made.region["tail.length"]
    assert low == min(c.tail.length for c in cells) < high == max(c.tail.length for c in cells)
    assert "nothing was compared but swimming_speed" in made.lines(cells[0])


def test_a_region_says_its_ranges():
    region = {"tail.amplitude": (0.08, 0.12)}
    fitted = ms.calibrate_region(ROBOT, region, "rft", solves=8, workers=0).swimmer
    made = record(fitted)
    assert made.region == region
    assert made.away(fitted) == {}
    far = fitted.with_({"tail.amplitude": 0.15, "body.radius": 0.6})
    assert made.away(far) == {
        "tail.amplitude": pytest.approx(0.25),
        "body.radius": pytest.approx(0.2),
    }


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"reference": "hearsay"}, "calibration.reference"),
        ({"design": {"body.radius": "wide"}}, "calibration.design"),
        ({"region": {"body.radius": [2.0, 1.0]}}, "calibration.region"),
        ({"who": "me"}, "calibration.who"),
    ],
)
def test_a_wrong_table_is_refused_by_name(change, words):
    tables = to_tables(ROBOT) | {"calibration": {"reference": "bem"} | change}
    with pytest.raises(ms.SpecError, match=words):
        from_dict(tables)


def test_commands_exports_and_stepper_say_it(tmp_path, monkeypatch, solved):
    monkeypatch.chdir(tmp_path)
    tables = to_tables(ms.calibrate(ROBOT, solved[ROBOT]).swimmer)
    tables["calibration"]["date"] = "2026-01-01 */ int main(void);"
    Path("calibrated.toml").write_text(to_toml(tables, "calibrated"), "utf-8")

    def said(*arguments):
        result = CliRunner().invoke(main, list(arguments))
        assert result.exit_code == 0, result.output
        return " ".join(result.output.split())

    away = ("--set", "tail.amplitude=0.12")
    for command in ("run", "show"):
        text = said(command, "calibrated.toml", *away)
        assert "calibrated by boundary elements (coarse)" in text
        assert "tail.amplitude +20 %" in text
        assert "not matched" in text
        assert "efficiency" in text
    found = json.loads(said("run", "calibrated.toml", *away, "--json"))
    assert found["calibration"]["away"] == {"tail.amplitude": pytest.approx(0.2)}
    assert found["calibration"]["reference"] == "bem"
    said("export", "calibrated.toml", "--format", "c")
    head = Path("calibrated.h").read_text("utf-8").partition("*/")[0]
    assert "calibrated by boundary elements (coarse)" in head
    assert "int main(void)" in head  # a table from elsewhere does not end the comment
    assert "calibrated by" in repr(ms.Stepper.of(read("calibrated.toml")))


def test_calibrate_writes_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("robot.toml").write_text(to_toml(to_tables(ROBOT), "robot"), "utf-8")
    arguments = ["calibrate", "robot.toml", "--reference", "bem", "--option", 'level="coarse"']
    result = CliRunner().invoke(main, [*arguments, "-o", "calibrated.toml"])
    assert result.exit_code == 0, result.output
    assert "not matched where it was calibrated: efficiency" in result.output
    made = toml(Path("calibrated.toml").read_text("utf-8"), "calibrated")["calibration"]
    assert (made["reference"], made["level"]) == ("bem", "coarse")
    assert made["design"]["body.radius"] == 0.5
    assert set(made["matched"]) >= {"mean.us", "mobility.us.us", "mobility.uq.uq"}


def test_outside_a_region_no_error_is_stated():
    low, high = 0.08, 0.12
    fit = ms.calibrate_region(ROBOT, {"tail.amplitude": (low, high)}, "rft", solves=8, workers=0)
    inside = fit.swimmer.with_({"tail.amplitude": 0.1})
    assert expected_error(inside, inside.gait())["us"] < 0.01
    beyond = fit.swimmer.with_({"tail.amplitude": 1.25 * high})
    with pytest.warns(UserWarning, match="outside the calibrated region"):
        gait = beyond.gait()
    told = expected_error(beyond, gait)
    assert told["us"] is None
    assert "outside" in told["how"]
    numbers = {**ms.io.numbers(beyond, gait), "expected_error": told}
    rows = {row[0]: row for row in ms.report.numbers_table(numbers, "").rows}
    assert rows["expected error of u_s"][1] == "not known"
