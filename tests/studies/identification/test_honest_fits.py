"""Fits that say when they know nothing, and intervals that hold the model's own error."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.stats import binom

import microswim as ms
from microswim.calibration.unknowns import resolve
from microswim.cli import identify as cli_identify
from microswim.cli import main
from microswim.numerics.rigid_motion import multiply
from microswim.studies.identification.fitting import honesty, outcome, within_errors
from microswim.studies.identification.fitting.descent import least
from microswim.studies.identification.fitting.first_guesses import initial_poses, shown
from microswim.studies.identification.fitting.problem import PathProblem
from microswim.studies.identification.paths import path_of
from microswim.swimmer.drag.coefficients import Unchosen

TRUE_WAVE = {"tail.amplitude": 0.14, "tail.waves": 1.6, "tail.frequency": 1.3}
START = {"tail.amplitude": 0.147, "tail.waves": 1.55, "tail.frequency": 1.302}


def wave_track(
    seed, *, gait=None, values=TRUE_WAVE, noise=0.002, n=120, duration=9.0, bend=0.0, phase=0.7,
    turn=0.8,
):  # fmt: skip
    """A planar beat in the image, turned by an angle that nobody tells the fit."""
    rng = np.random.default_rng(seed)
    t = np.linspace(1.0, 1.0 + duration, n)
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_(values)
    x, _ = path_of(swimmer, swimmer.gait() if gait is None else gait, t, phase)
    z = (x[:, 0] + 1j * x[:, 1]) * np.exp(1j * turn)
    z = z + bend * (t - t[0]) ** 2 * 1j
    return ms.Track(
        time=t, position=np.stack([z.real, z.imag], -1) + noise * rng.normal(size=(n, 2))
    )


def test_a_straight_line_in_noise_has_no_wave_shape():
    t = np.arange(400) * 0.02
    x = np.stack([0.05 * t, 0 * t], -1) + 0.01 * np.random.default_rng(0).normal(size=(400, 2))
    with pytest.raises(ms.MicroswimError, match="no wobble stands above the noise"):
        ms.identify_swimmer(ms.Swimmer.preset("tabak/plane_wave"), ms.Track(time=t, position=x))


def test_a_beat_above_half_the_frame_rate_is_not_looked_for():
    track = wave_track(0, n=40, duration=40.0)
    with pytest.raises(ms.MicroswimError, match="above half the frame rate"):
        ms.identify_swimmer(ms.Swimmer.preset("tabak/plane_wave"), track)
    cell = ms.Swimmer.preset("goto/C")
    slow = ms.Track(time=track.time, position=1e-6 * track.position)
    with pytest.raises(ms.MicroswimError, match=r"beat of the spec, [\d.]+ Hz, is .*, 487\.5 mHz"):
        ms.identify_swimmer(cell, slow)


def test_a_swimmer_held_sideways_is_told_so_by_a_track_that_wobbles():
    held = {"motion.free": ["us", "os"]}
    with pytest.raises(ms.MicroswimError, match=r"us, os: all is held .*motion.free=all"):
        ms.identify_swimmer(ms.Swimmer.preset("tabak/plane_wave").with_(held), wave_track(0))


def test_what_is_left_is_told_in_the_units_of_the_spec():
    """Some 90 nm are left, a few between frames; an attitude in rad."""
    noise = np.random.default_rng(0).normal(size=(400, 2))
    time, memory = np.arange(400.0), 90e-9 * np.sqrt(2) * np.sin(np.arange(400)[:, None] / 30)
    said = honesty._memory(time, memory + 1e-12 * noise, 0.0, None, "m")
    assert re.match(r"[89]\d\.\d nm, is no noise \(that is [\d.]+ nm from frame to frame\)", said)
    assert re.match(r"0\.\d+ rad, is no noise", honesty._memory(time, 1e6 * memory, 0, None, "rad"))


def test_what_is_left_and_is_no_noise_withholds_the_interval():
    track = wave_track(1, bend=0.004)  # the path bends, as that of a curved beat does
    found = ms.identify_swimmer(ms.Swimmer.preset("tabak/plane_wave"), track, start=START)
    assert "is no noise" in found.withheld
    assert np.isinf(found.interval()).all()
    assert found.as_dict()["interval_95"]["tail.waves"] == [None, None]


def test_what_cancels_keeps_the_value_of_the_spec():
    track = wave_track(2, n=100)
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_(TRUE_WAVE)
    names = ("tail.amplitude", "fluid.viscosity")
    found = ms.identify_swimmer(swimmer, track, names, start={"tail.amplitude": 0.142})
    assert found.values[1] == swimmer.fluid.viscosity
    assert np.isinf(found.uncertainty[1])
    assert np.isfinite(found.uncertainty[0])


def test_the_command_tells_the_speed_where_there_is_no_wave(tmp_path):
    t = np.arange(300) * 0.02
    x = np.stack([0.5 * t, 0 * t], -1) + 0.01 * np.random.default_rng(0).normal(size=(300, 2))
    file = tmp_path / "line.csv"
    rows = "".join(f"{a},{b},{c}\n" for a, (b, c) in zip(t, x))
    file.write_text("time,x,y\n" + rows)
    run = CliRunner().invoke(
        main, ["identify", str(file), "--preset", "tabak/plane_wave", "--json"]
    )
    assert run.exit_code == 0, run.stderr
    result = json.loads(run.stdout)
    assert result["values"] == {}
    assert result["speed"] == pytest.approx(0.5, rel=0.01)
    assert "no wobble stands above the noise" in result["warnings"][0]


@pytest.mark.parametrize(("name", "value"), [("sigma", -1.0), ("sigma", np.nan), ("starts", 0)])
def test_options_that_make_no_sense(name, value):
    with pytest.raises(ms.SpecError, match=name):
        ms.identify_swimmer(ms.Swimmer.preset("tabak/plane_wave"), wave_track(0), **{name: value})


def test_a_spec_with_a_wavelength_is_fitted_by_its_number_of_waves():
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_({"tail.wavelength": 1.3})
    found = ms.identify_swimmer(swimmer, wave_track(3), start=START)
    assert found.values == pytest.approx(list(TRUE_WAVE.values()), rel=0.05)


def test_a_scaled_gait_has_the_one_velocity_larger():
    gait = ms.Swimmer.preset("tabak/plane_wave").gait()
    larger = honesty.scaled(gait, 1, 0.1)
    phase = np.linspace(0, 6, 7)
    expected = gait.velocity(phase) * [1, 1.1, 1, 1, 1, 1]
    assert larger.velocity(phase) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("counted", [True, False])
def test_the_error_of_the_model_is_in_the_intervals(monkeypatch, counted):
    """Truth by gaits whose velocities are off as the model's error says; without it they miss."""
    errors = np.array([0.1, 0.1, 0.0, 0.0, 0.0, 0.1])
    monkeypatch.setattr(outcome, "model_errors", lambda own: errors)
    swimmer, trials = ms.Swimmer.preset("tabak/plane_wave"), 16 if counted else 8
    truth, hits = np.array(list(TRUE_WAVE.values())), np.zeros(3)
    for seed in range(trials):
        rng = np.random.default_rng(100 + seed)
        gait = swimmer.with_(TRUE_WAVE).gait()
        for k in (0, 1, 5):
            gait = honesty.scaled(gait, k, 0.05 * rng.normal())
        track = wave_track(seed, gait=gait, noise=5e-4)
        found = ms.identify_swimmer(swimmer, track, start=START, model_error=counted)
        low, high = found.interval().T
        hits += (low <= truth) & (truth <= high)
    if counted:
        assert (hits >= binom.ppf(0.001, trials, 0.95)).all()
    else:
        assert hits.min() < binom.ppf(0.001, trials, 0.95)


def test_first_guesses_are_those_of_the_swimmers_own_model():
    """A design that the atlas covers by the atlas, one beyond it by the law; as gait by gait."""
    swimmer = replace(ms.Swimmer.preset("tabak/helix"), coefficients=Unchosen())
    waves = np.array([2.6, 4.9])
    speed, swing, turn, spin, _ = shown(swimmer, {"tail.waves": waves})
    for i, model in enumerate(("atlas", "rft")):
        gait = swimmer.with_({"tail.waves": waves[i]}).gait("auto")
        assert gait.model == model
        assert speed[i] == pytest.approx(ms.screw(gait).speed, rel=1e-3)
        assert swing[i] == pytest.approx(gait.velocity_amplitude[1], rel=1e-2)
        assert turn[i] == pytest.approx(gait.velocity_amplitude[5], rel=1e-2)
        assert spin[i] == pytest.approx(gait.mean_velocity[3], rel=1e-3)


def test_what_the_error_of_the_model_explains_is_not_held_against_a_design():
    """A fit held at the truth: chi-squared is that of the noise, and one for each deviation."""
    known = ms.Swimmer.preset("tabak/helix")
    errors, t = np.array([0.1, 0.0, 0.0, 0.06, 0.0, 0.0]), np.linspace(0.0, 9.0, 90)
    gait, rng = known.gait("rft"), np.random.default_rng(0)
    for k in (0, 3):
        gait = honesty.scaled(gait, k, errors[k] / 2.0)
    x, q = path_of(known, gait, t, 0.3)
    track = ms.Track(time=t, position=x + 1e-4 * rng.normal(size=x.shape), quaternion=q)
    names = ("tail.amplitude", "tail.frequency")
    problem = PathProblem(known, track, resolve(known, names), 1e-2, 1e-4)
    design = np.array([0.1, 1.0])
    design[1] *= problem.wobble_ratio(design)  # a fit's frequency is that of the wobble
    done = least(problem, initial_poses(problem, design, count=1)[0])
    n = x.size  # the attitudes have no noise here
    assert done.fun @ done.fun > 2.0 * n
    left, _ = honesty.unexplained(problem, done, 1.0, errors)
    assert n - 5.0 * np.sqrt(2.0 * n) < left < n + 5.0 * np.sqrt(2.0 * n)


@pytest.mark.parametrize("drift", [0.0, 0.1])
def test_what_a_fit_leaves_of_the_attitude_must_be_noise_too(drift):
    """Positions as they should be; the body turns a little faster about its axis than the fit's."""
    known = ms.Swimmer.preset("tabak/helix")
    t, rng = np.linspace(0.0, 9.0, 90), np.random.default_rng(1)
    x, q = path_of(known, known.gait("rft"), t, 0.3)
    turn = 0.01 * rng.normal(size=(t.size, 3)) + drift * np.outer(t / t[-1] - 0.5, [1.0, 0.0, 0.0])
    q = multiply(q, np.concatenate([np.ones((t.size, 1)), 0.5 * turn], axis=1))
    track = ms.Track(time=t, position=x + 1e-4 * rng.normal(size=x.shape), quaternion=q)
    names = ("tail.amplitude", "tail.waves", "tail.frequency")
    problem = PathProblem(known, track, resolve(known, names), 1e-2, 1e-4)
    design = np.array([0.1, 3.0, 1.0])
    design[2] *= problem.wobble_ratio(design)
    fit = least(problem, initial_poses(problem, design, count=1)[0])
    said = honesty.left_over(problem, fit.fun)
    assert ("of the attitude" in said) == (drift > 0)


def test_large_errors_of_the_model_reach_over_designs_that_move_alike(monkeypatch):
    """A track by another law of drag: its number of waves lies far from the fit's, and within."""
    known = ms.Swimmer.preset("tabak/plane_wave")
    truth = {"tail.amplitude": 0.0822, "tail.waves": 2.863, "tail.frequency": 1.379}
    made = replace(known.with_(truth), coefficients=ms.Cox())
    track = wave_track(3, gait=made.gait("rft"), noise=0.001)
    errors = np.array([0.36, 0.65, 0.0, 0.0, 0.0, 0.38])
    monkeypatch.setattr(outcome, "model_errors", lambda own: errors)
    found = ms.identify_swimmer(known, track)
    waves = found.values[1]
    assert abs(waves - truth["tail.waves"]) > 0.3
    low, high = found.interval()[1]
    assert low <= truth["tail.waves"] <= high
    low, high = found.interval()[0]
    assert low <= truth["tail.amplitude"] <= high


@pytest.mark.slow
def test_a_model_that_is_off_leaves_the_true_design_in_the_list(monkeypatch):
    """By a model that is off as its error says, a design of other waves draws the path as well, and
    the grid of what moves exactly alike does not lead to the true one.
    """
    truth = {"tail.amplitude": 0.1222, "tail.waves": 1.925, "tail.frequency": 1.4135}
    track = off_track(truth, (-0.0765, 0.0931, -0.0353), seed=3, noise=0.001, n=198, duration=10.1)
    assert is_listed(truth, track, monkeypatch)


@pytest.mark.slow
def test_a_design_that_explains_the_track_better_is_looked_for_from_the_best(monkeypatch):
    """Two designs lie closer to the track than the true one, which explains it better once the
    velocities are off as they are; seen from the closest it is 10 of chi-squared behind.
    """
    truth = {"tail.amplitude": 0.2306, "tail.waves": 3.0654, "tail.frequency": 0.8077}
    how = {"seed": 1, "noise": 0.0002, "n": 88, "duration": 11.02, "phase": 1.0, "turn": 0.0}
    assert is_listed(truth, off_track(truth, (-0.038, 0.0208, 0.0113), **how), monkeypatch)


def off_track(truth, off, **how):
    """A planar beat by a model whose u_s, u_q and w_r are off."""
    gait = ms.Swimmer.preset("tabak/plane_wave").with_(truth).gait()
    for k, share in zip((0, 1, 5), off):
        gait = honesty.scaled(gait, k, share)
    return wave_track(gait=gait, values=truth, **how)


def is_listed(truth, track, monkeypatch):
    """Whether a design of the list holds the truth, the errors of the model told to be 10 %."""
    known = ms.Swimmer.preset("tabak/plane_wave")
    for part in (outcome, within_errors):
        monkeypatch.setattr(part, "model_errors", lambda own: np.array([0.1, 0.1, 0, 0, 0, 0.1]))
    within_errors.finely.cache_clear()
    found = ms.identify_swimmer(known, track)
    within_errors.finely.cache_clear()
    wanted = np.array(list(truth.values()))
    inside = [np.all((low < wanted) & (wanted < high)) for low, high in
              (branch.interval(0.99).T for branch in found.branches)]  # fmt: skip
    return any(inside)


def test_the_command_says_a_fit_in_the_units_of_the_spec():
    """An interval has the unit of its value; what noise hides is told by its bound."""
    text, ends = cli_identify._with_ends("tail.amplitude", 1.735e-7, (1.7e-7, 2.1e-6), "SI", 4)
    assert (text, ends) == ("173.5 nm", "170 to 2100 nm")
    text, ends = cli_identify._with_ends("tail.waves", 3.0351, (None, None), "SI", 4)
    assert (text, ends) == ("3.035", "")
    assert cli_identify._estimated(0.0, [0.0, 0.0878], "rad/s") == "below 0.088 rad/s"
    assert cli_identify._estimated(0.246, [0.169, 0.323], "rad/s") == "0.246 ± 0.077 rad/s"
