"""One name, one number: every public door is asked for every quantity of one gait."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.errors import RenamedWarning
from microswim.gait.quantities import NUMBERS, OF_SHAPE, OLD, QUANTITIES, numbers
from microswim.gait.units import UNITS
from microswim.output.io.run import dataset
from microswim.studies.optimisation import merits
from microswim.studio.answers import readings

PRESETS = ["tabak/helix", "tabak/plane_wave"]


def swimmer_of(preset):
    return ms.Swimmer.preset(preset)


@pytest.fixture(scope="module", params=PRESETS)
def told(request):
    """What ``microswim run --json`` prints."""
    run = CliRunner().invoke(main, ["run", "--preset", request.param, "--json"])
    assert run.exit_code == 0, run.output
    return request.param, json.loads(run.stdout)


def same(value, truth, rel=1e-12):
    if truth is None:  # infinite, which JSON has no word for
        assert not np.isfinite(value)
    else:
        assert value == pytest.approx(truth, rel=rel, abs=1e-14)


def test_run_prints_every_quantity(told):
    _, printed = told
    assert set(QUANTITIES) <= set(printed)


@pytest.mark.parametrize("door", ["summary", "observed", "design", "studio", "dataset"])
def test_doors_agree(told, door):
    preset, printed = told
    swimmer = swimmer_of(preset)
    gait, length = swimmer.gait(), swimmer.body_length
    match door:
        case "summary":
            found = ms.summary(gait)
            assert set(found) == set(QUANTITIES) - set(OF_SHAPE)
        case "observed":
            found = {n: ms.observed(gait, n, body_length=length) for n in QUANTITIES}
        case "design":
            found = merits.of_gait(swimmer, gait)
            found = {n: found[n] for n in NUMBERS if QUANTITIES[n].of_many}
        case "studio":
            found = {n: v for n, v in readings(swimmer, gait).items() if v is not None}
            assert set(found) >= {n for n in NUMBERS if printed[n] is not None}
        case "dataset":
            run = dataset(swimmer, gait, periods=1)
            found = {n: run[n].values for n in QUANTITIES}
            for name, quantity in QUANTITIES.items():
                assert run[name].attrs["units"] == UNITS[quantity.dimension][1], name
    for name, value in found.items():
        same(value, printed[name])


@pytest.mark.parametrize("name", [n for n in NUMBERS if n not in OF_SHAPE])
def test_every_quantity_has_a_derivative(name):
    """All but those that count turns go with the frequency, or with its square, or not at all."""
    swimmer = swimmer_of("tabak/helix")
    slope = swimmer.gradient(name, "tail.frequency")["tail.frequency"] * swimmer.tail.frequency
    value = ms.summary(swimmer.gait())[name]
    power = float(slope) / value
    assert power == pytest.approx(round(power), abs=1e-8)
    assert -1 <= round(power) <= 2


def test_some_numbers_are_those_of_all():
    gait = ms.Swimmer.preset("tabak/helix").gait()
    some = ("mean_velocity", "efficiency")
    assert numbers(gait, names=some) == {name: ms.summary(gait)[name] for name in some}


def test_many_designs_agree_with_one(told):
    """Amplitudes of plane waves are read off samples by the batched kernel."""
    preset, printed = told
    swimmer = swimmer_of(preset)
    name = "tail.amplitude"
    many = merits.of_many(swimmer, {name: np.array([swimmer.numbers[name]])})
    for quantity in merits.MERITS:
        same(many[quantity][0], printed[quantity], rel=1e-5 if "amplitude" in quantity else 1e-7)
    swept = ms.sweep(swimmer, {name: [swimmer.numbers[name]]})
    for quantity in ("mean_velocity", "swimming_speed", "mean_power", "mean_torque", "efficiency"):
        same(swept[quantity].values[0], printed[quantity], rel=1e-7)
        assert swept[quantity].attrs["units"] == UNITS[QUANTITIES[quantity].dimension][1]


def test_many_designs_know_the_motors_rate_in_the_lab_frame():
    swimmer = ms.Swimmer.preset("tabak/helix", {"motion.frequency_frame": "lab"})
    one = swimmer.with_({"tail.amplitude": 0.08})
    truth = merits.of_gait(one, one.gait())
    many = merits.of_many(swimmer, {"tail.amplitude": np.array([0.08])})
    for name in ("frequency", "body_turns_per_period", "distance_per_cycle"):
        same(many[name][0], truth[name], rel=1e-9)


def test_a_measured_rate_is_met_in_the_unit_it_was_measured_in():
    """Who measures revolutions and designs in radians gets the same robot."""
    swimmer = swimmer_of("tabak/helix")
    hertz = float(ms.observed(swimmer.gait(), "body_rate_hz"))
    fit = ms.calibrate(swimmer, {"body_rate_hz": 1.1 * hertz}, ["rotation.s"])
    met = merits.of_gait(fit.swimmer, fit.swimmer.gait(), ["body_rate"])["body_rate"]
    assert met == pytest.approx(2 * np.pi * 1.1 * hertz)
    with pytest.warns(RenamedWarning, match="body_rate_hz"):
        ms.Observation(swimmer=swimmer, quantity="body_rate", value=0.4)


@pytest.mark.parametrize("old", OLD)
def test_old_names_work_and_name_the_new_one(old):
    swimmer = swimmer_of("tabak/helix")
    gait = swimmer.gait()
    with pytest.warns(RenamedWarning, match=OLD[old]):
        assert ms.observed(gait, old) == ms.observed(gait, OLD[old])
    over = {"tail.handedness": ["left"]}
    with pytest.warns(RenamedWarning, match=OLD[old]):
        best = ms.design(swimmer, over, maximize=old)
    assert best.value == pytest.approx(best.quantities[OLD[old]])
    with pytest.warns(RenamedWarning, match=OLD[old]):
        assert best.quantities[old] == best.quantities[OLD[old]]
    assert best.as_dict()["quantities"][old] == best.quantities[OLD[old]]


def test_a_measurement_is_one_number():
    swimmer = swimmer_of("tabak/helix")
    with pytest.raises(ms.SpecError, match=r"mean\.us"):
        ms.Observation(swimmer=swimmer, quantity="mean_velocity", value=0.4)
    with pytest.raises(ms.SpecError, match="swimming_speed"):
        ms.Observation(swimmer=swimmer, quantity="colour", value=0.4)


def test_the_documentation_lists_every_quantity():
    page = (Path(__file__).parents[2] / "docs" / "quantities.md").read_text(encoding="utf-8")
    for quantity in QUANTITIES.values():
        row = f"| `{quantity.name}` | {UNITS[quantity.dimension][0]} | {quantity.meaning} |"
        assert row in page
    for old, new in OLD.items():
        assert f"| `{old}` | `{new}` |" in page


def test_on_a_circle_the_speed_along_the_path_is_that_of_the_circle():
    """A beat in a plane that turns as it goes: the path in time is followed for many periods."""
    gait = ms.Swimmer.preset("tabak/plane_wave").gait()
    turning = replace(gait, free=(True, True, False, False, False, True))
    push = np.zeros_like(turning.propulsion_series)
    push[0, 5] = 0.02 * np.abs(turning.resistance_series[0, 5, 5])  # as a mean curvature does
    turning = replace(turning, propulsion_series=turning.propulsion_series + push)
    told = ms.summary(turning)
    times = np.linspace(0.0, 40.0, 41) * turning.period
    x = ms.trajectory(turning, times).position.values
    chord = np.linalg.norm(np.diff(x, axis=0), axis=1).mean()
    half = 0.5 * told["rotation_per_period"]
    arc = chord * half / np.sin(half)
    assert told["path_speed"] == pytest.approx(arc / turning.period, rel=1e-6)
    assert told["swimming_speed"] < 1e-9 < told["path_speed"]
    times = np.linspace(0.0, 40.0, 40 * 64 + 1) * turning.period
    x = ms.trajectory(turning, times).position.values[:, :2]
    beat = np.stack([np.convolve(c, np.full(64, 1 / 64), "valid") for c in x.T], axis=-1)
    step = np.linalg.norm(beat[64:] - beat[:-64], axis=1).mean()  # of averages: both are shorter
    radius = step / (2.0 * np.sin(half)) * half / np.sin(half)
    assert told["path_curvature"] == pytest.approx(1.0 / radius, rel=1e-4)


@pytest.mark.parametrize("handedness", ["left", "right"])
def test_curvature_and_torsion_of_the_path_are_those_of_its_helix(handedness):
    """Frenet's formulas on the helix itself: ``|x' x x''| / |x'|^3`` and the triple product."""
    swimmer = ms.Swimmer.preset("tabak/helix", {"tail.handedness": handedness})
    found = ms.screw(swimmer.gait())
    e, a, t = found.axis, found.arm, found.angle
    b = np.cross(e, a)
    d1, d2, d3 = t * b + found.advance * e, -(t**2) * a, -(t**3) * b
    across = np.cross(d1, d2)
    told = ms.summary(swimmer.gait())
    bent = np.linalg.norm(across) / np.linalg.norm(d1) ** 3
    assert told["path_curvature"] == pytest.approx(bent, rel=1e-9)
    assert told["path_torsion"] == pytest.approx(across @ d3 / (across @ across), rel=1e-9)


def test_the_turn_of_a_period_has_an_exact_derivative():
    swimmer, h = ms.Swimmer.preset("tabak/helix"), 1e-5
    at = [ms.summary(swimmer.with_({"tail.amplitude": 0.1 + x}).gait()) for x in (h, -h)]
    for name in ("rotation_per_period", "path_pitch", "path_curvature", "path_torsion"):
        slope = (at[0][name] - at[1][name]) / (2 * h)
        exact = swimmer.gradient(name, "tail.amplitude")["tail.amplitude"]
        assert exact == pytest.approx(slope, rel=1e-6), name


def test_on_a_straight_path_both_speeds_are_one():
    told = ms.summary(ms.Swimmer.preset("tabak/plane_wave").gait())
    assert told["path_speed"] == pytest.approx(told["swimming_speed"], rel=1e-9)
    assert told["path_curvature"] == told["path_torsion"] == 0.0


def test_what_is_rounding_reads_zero():
    """Two tails of opposite hands are their own mirror image: the path is a plane circle."""
    told = ms.summary(ms.Swimmer.preset("several/two-tails").gait())
    assert [told["mean_velocity"][i] for i in (1, 3, 5)] == [0.0, 0.0, 0.0]
    assert told["swimming_speed"] == told["path_pitch"] == told["lateral_amplitude"] == 0.0
    assert told["path_speed"] > 0.05
