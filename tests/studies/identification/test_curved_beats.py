"""Beats with a mean curvature, whose swimmers circle: found from their tracks."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.calibration.unknowns import resolve
from microswim.cli import main
from microswim.studies.identification.fitting.branches import branch_of
from microswim.studies.identification.fitting.descent import least
from microswim.studies.identification.fitting.first_guesses import initial_poses, seen_in
from microswim.studies.identification.fitting.fit import asked
from microswim.studies.identification.fitting.problem import PathProblem, quick_gait
from microswim.studies.identification.paths import path_of

TRUE = {
    "tail.amplitude": 0.14, "tail.waves": 1.6, "tail.frequency": 1.3, "tail.mean_curvature": 0.35,
}  # fmt: skip
FILM = Path(__file__).with_name("circling-sperm.csv")
BULL = """
[fluid]
viscosity = "0.7 mPa s"
[body]
shape = "ellipsoid"
semi_axes = ["5 um", "2.5 um", "0.5 um"]
[tail]
kind = "plane_wave"
length = "58.3 um"
length_measure = "arc"
amplitude = "8 um"
wavelength = "60 um"
radius = "0.2 um"
frequency = "31 Hz"
ramp = 1.0
[coefficients]
law = "cox"
"""


BENT = ("--set", "tail.mean_curvature=19.1rad/mm")


def test_run_tells_how_much_more_the_path_bends_than_the_flagellum(tmp_path):
    (tmp_path / "bull.toml").write_text(BULL)
    asked = ["run", str(tmp_path / "bull.toml"), *BENT]
    run = CliRunner().invoke(main, [*asked, "--json"])
    found = json.loads(run.stdout)
    assert found["curvature_ratio"] == pytest.approx(found["path_curvature"] / 19.1e3)
    assert 0.1 < found["expected_error"]["path_curvature"] < 0.2
    told = CliRunner().invoke(main, asked).stdout
    assert re.search(r"curvature ratio +[\d.]+ ± 0\.\d+ +of the path over the flagellum", told)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["lighthill", "cox"])
def test_the_curvature_of_the_path_is_as_wrong_as_is_said(law, tmp_path):
    """Of a beat that is none of those whose errors were counted, beside boundary elements."""
    bent = BULL.replace("cox", law).replace("ramp", 'mean_curvature = "19.1 rad/mm"\nramp')
    (tmp_path / "bull.toml").write_text(bent)
    swimmer = ms.Swimmer.from_toml(tmp_path / "bull.toml")
    ours, truth = swimmer.gait("rft"), swimmer.gait("bem", level="coarse")
    error = ms.expected_error(swimmer, ours)["path_curvature"]
    a, b = (ms.summary(gait)["path_curvature"] for gait in (ours, truth))
    assert abs(b / a - 1.0) < error


def test_the_closed_path_of_a_swimmer_that_circles_is_the_integrated_one():
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_(TRUE)
    gait, t = swimmer.gait(), np.linspace(0.0, 3.0, 20)
    x, q = path_of(swimmer, gait, t, 0.7)
    path = ms.trajectory(gait, t, phase=0.7)
    np.testing.assert_allclose(x, path.position.values, atol=1e-6)
    np.testing.assert_allclose(np.abs(np.sum(q * path.quaternion.values, axis=1)), 1.0, atol=1e-9)


def test_few_phases_tell_a_path_as_well_as_many():
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_(TRUE)
    t = np.linspace(0.0, 3.0, 20)
    few, many = (
        path_of(swimmer, gait, t, 0.7)[0] for gait in (quick_gait(swimmer), swimmer.gait())
    )
    np.testing.assert_allclose(few, many, atol=1e-6)


def test_a_planted_curvature_is_found():
    known = ms.Swimmer.preset("tabak/plane_wave")
    swimmer = known.with_(TRUE)
    t = np.linspace(0.0, 9.0, 150)
    x, _ = path_of(swimmer, swimmer.gait(), t, 0.7)
    noisy = x[:, :2] + 0.002 * np.random.default_rng(0).normal(size=(150, 2))
    start = {name: value * 1.03 for name, value in TRUE.items() if "curvature" not in name}
    start["tail.frequency"] = TRUE["tail.frequency"] * 1.001
    found = ms.identify_swimmer(
        known, ms.Track(time=t, position=noisy), tuple(TRUE), start=start, model_error=False
    )
    off = (found.values - np.array(list(TRUE.values()))) / found.uncertainty
    assert np.abs(off).max() < 4.0
    assert found.uncertainty[3] < 0.02
    low, high = found.interval().T  # four deviations wide, or wider where the misfit is no parabola
    assert np.all(high - low > 3.5 * found.uncertainty)


def test_what_a_circling_track_shows_guides_the_first_guesses():
    """Frequency, speed along the circle and wobble of a planted circle in closed form."""
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_({"tail.mean_curvature": 0.1})
    t = np.arange(400) / 25.0
    z = 5.0 * np.exp(1j * (0.9 * t)) * (1.0 + 0.02 * np.sin(2 * np.pi * 1.3 * t))
    track = ms.Track(time=t, position=np.stack([z.real, z.imag], -1))
    problem = PathProblem(swimmer, track, resolve(swimmer, tuple(TRUE)), 0.02, None)
    frequency, speed, wobble = seen_in(problem)
    assert abs(abs(frequency - 1.3) - 0.9 / (2 * np.pi)) < 0.01  # a line that turning splits
    assert speed == pytest.approx(4.5, rel=0.01)
    assert wobble == pytest.approx(0.1, rel=0.05)


@pytest.mark.slow
def test_a_circling_sperm_has_its_curvature_found_and_nothing_is_left_over(tmp_path):
    """250 frames a second, 50 nm of noise; as a symmetric beat it left 23 times the noise. The law
    of the spec has made it, so the intervals are those of noise alone.
    """
    swimmer = bull(tmp_path)
    track = next(iter(ms.read_tracks(FILM).values()))
    straight = ms.identify_swimmer(swimmer, track)
    assert "mean curvature" in straight.withheld
    assert np.isinf(straight.interval()).all()
    bent = ms.identify_swimmer(swimmer, track, tuple(TRUE), model_error=False)
    assert bent.withheld == ""
    assert bent.residual == pytest.approx(50e-9, rel=0.05)
    low, high = bent.interval().T
    assert np.all((high - low)[1:] < 0.02 * np.abs(bent.values)[1:])


def bull(tmp_path, unit=1e-6):
    """Return the swimmer of a spec in micrometres, or bare numbers in micrometres over a unit."""
    text = BULL
    if unit != 1e-6:
        text = re.sub(r'"([\d.]+) um"', lambda m: str(float(m[1]) * unit), BULL)
        text = text.replace('"0.7 mPa s"', "1.0").replace('"31 Hz"', "31.0")
    spec = tmp_path / "bull.toml"
    spec.write_text(text)
    return ms.Swimmer.from_toml(spec)


def circled(swimmer, made_by, um=1e-6):
    """Return what a swimmer's track is of, and 150 frames of it with 50 nm of noise."""
    truth = dict(zip(TRUE, (10.5 * um, 0.79, 31.0, 0.01 / um)))
    known, _ = asked(swimmer, truth)
    t = np.arange(150) / 250.0
    x, _ = path_of(known, made_by(known.with_(truth)), t, 0.3)
    noise = 0.05 * um * np.random.default_rng(0).normal(size=(t.size, 2))
    return known, ms.Track(time=t, position=x[:, :2] + noise), truth


@pytest.mark.slow
def test_a_sperm_by_boundary_elements_lies_in_the_intervals_of_a_law(tmp_path):
    """Cox's law says a seventh less of the curvature: noise alone would leave a third of a per
    cent.
    """
    known, track, truth = circled(bull(tmp_path), lambda one: one.gait("bem", level="coarse"))
    found = ms.identify_swimmer(known, track, tuple(truth))
    low, high = found.interval().T
    wanted = np.array(list(truth.values()))
    assert np.all((low < wanted) & (wanted < high)), found.interval()
    assert np.abs(found.values / wanted - 1.0).max() > 0.1
    assert low.min() > 0.0


def test_the_error_of_the_model_widens_alike_in_all_units(tmp_path):
    """A micrometre's amplitude beside a curvature of ten thousand per metre, or all near one."""
    wide = []
    for um in (1e-6, 0.1):
        known, track, truth = circled(bull(tmp_path, um), lambda one: one.gait("rft"), um)
        chosen = resolve(known, tuple(truth))
        problem = PathProblem(known, track, chosen, 0.02, 0.05 * um)
        done = least(problem, initial_poses(problem, np.array(list(truth.values())))[0])
        errors = np.array([0.2, 0.1, 0.0, 0.0, 0.0, 0.1])
        wide.append(branch_of(problem, done, 1.0, 0.0, errors, tried=False).uncertainty)
        wide[-1] = wide[-1] / np.array(list(truth.values()))
    np.testing.assert_allclose(wide[0], wide[1], rtol=1e-3)
    assert wide[0][3] > 0.05  # of the curvature, as the rate of turning is off
