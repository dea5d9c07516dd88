"""Identification from tracks: planted truth, stated intervals, what cannot be determined."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.stats import binom, chi2

import microswim as ms
from microswim.cli import main
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.paths import path_of

TRUE_HELIX = {"tail.amplitude": 0.13, "tail.waves": 2.3, "tail.frequency": 1.4}
TRUE_WAVE = {"tail.amplitude": 0.14, "tail.waves": 1.6, "tail.frequency": 1.3}
TILTED = np.array([0.8, 0.2, -0.4, 0.4]) / np.linalg.norm([0.8, 0.2, -0.4, 0.4])
IN_PLANE = np.array([np.cos(0.4), 0.0, 0.0, np.sin(0.4)])


def planted(swimmer, quaternion, *, n=160, duration=12.0, phase=0.7):
    """Times, positions and attitudes of a swimmer with a pose nobody tells the fit."""
    t = np.linspace(2.0, 2.0 + duration, n)
    path = ms.trajectory(
        swimmer.gait(), t, position=[1.0, 2.0, 3.0], quaternion=quaternion, phase=phase
    )
    return t, path.position.values, path.quaternion.values


def shaken(q, sigma, rng):
    """Attitudes turned by small random angles."""
    from microswim.numerics.rigid_motion import multiply

    half = 0.5 * sigma * rng.normal(size=(len(q), 3))
    small = np.concatenate([np.ones((len(q), 1)), half], axis=1)
    return multiply(q, small / np.linalg.norm(small, axis=1, keepdims=True))


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave", "tabak/helix-constant"])
def test_closed_paths_are_the_integrated_ones(preset):
    swimmer = ms.Swimmer.preset(preset)
    gait, t = swimmer.gait(), np.linspace(0.3, 7.0, 40)
    x, q = path_of(swimmer, gait, t, 0.7)
    path = ms.trajectory(gait, t, phase=0.7)
    assert x == pytest.approx(path.position.values, abs=1e-8)
    overlap = np.abs(np.sum(q * path.quaternion.values, axis=1))
    assert overlap == pytest.approx(np.ones(40), abs=1e-9)


def test_paths_without_the_symmetry_are_integrated():
    swimmer = ms.Swimmer.preset("tabak/helix").with_({"interaction.translation": (1.0, 2.0, 1.0)})
    gait, t = swimmer.gait(), np.linspace(0.0, 2.0, 9)
    x, _ = path_of(swimmer, gait, t, 0.0)
    assert x == pytest.approx(ms.trajectory(gait, t).position.values, abs=1e-12)


def test_the_spectrum_finds_the_wobble_in_noise():
    rng = np.random.default_rng(5)
    t = np.sort(rng.uniform(0.0, 20.0, 300))
    beat = 0.3 * np.sin(2 * np.pi * 1.37 * t)
    track = Track(time=t, position=np.stack([0.5 * t, beat], -1) + 0.05 * rng.normal(size=(300, 2)))
    frequency, amplitude, share = track.wobble()
    assert frequency == pytest.approx(1.37, abs=0.005)  # a fortieth of a cycle in the track
    assert amplitude == pytest.approx(0.3, abs=0.02)
    assert 0.8 < share < 1.0


def test_a_helix_with_attitude_is_found_from_nothing():
    swimmer = ms.Swimmer.preset("tabak/helix")
    t, x, q = planted(swimmer.with_(TRUE_HELIX), TILTED)
    rng = np.random.default_rng(1)
    track = Track(
        time=t, position=x + 0.002 * rng.normal(size=x.shape), quaternion=shaken(q, 0.02, rng)
    )
    found = ms.identify_swimmer(swimmer, track, sigma=0.002, sigma_attitude=0.02, model_error=False)
    assert found.names == tuple(TRUE_HELIX)
    off = (found.values - np.array(list(TRUE_HELIX.values()))) / found.uncertainty
    assert np.sum(off**2) < chi2.ppf(0.999, 3)
    assert np.all(found.uncertainty / found.values < 0.03)
    assert found.alternatives == ()
    assert found.swimmer.tail.amplitude == found.values[0]


def test_a_path_alone_leaves_several_helices():
    """A helical path has three numbers, pitch, radius and rate; several designs share them."""
    swimmer = ms.Swimmer.preset("tabak/helix")
    t, x, _ = planted(swimmer.with_(TRUE_HELIX), TILTED)
    track = Track(time=t, position=x)
    found = ms.identify_swimmer(swimmer, track, sigma=0.002)
    designs = [branch.values for branch in found.branches]
    truth = np.array(list(TRUE_HELIX.values()))
    own = np.array([swimmer.numbers[name] for name in found.names])
    away = [np.sum(np.log(values / own) ** 2) for values in designs]
    assert away == sorted(away)  # those nearest to the spec first
    assert np.isinf(found.interval()).all()
    assert all(np.isfinite(branch.interval()).all() for branch in found.branches)
    assert len(designs) > 1
    assert min(np.abs(d / truth - 1.0).max() for d in designs) < 0.01
    assert any("fit as well" in w for w in found.warnings)
    speed = ms.screw(swimmer.with_(TRUE_HELIX).gait()).speed
    for values in designs:
        gait = swimmer.with_(dict(zip(found.names, map(float, values)))).gait()
        assert ms.screw(gait).speed == pytest.approx(speed, rel=0.01)


@pytest.mark.parametrize(
    ("preset", "truth", "attitude", "dimensions"),
    [
        ("tabak/helix", TRUE_HELIX, TILTED, 3),
        ("tabak/plane_wave", TRUE_WAVE, IN_PLANE, 2),  # a sperm-like beat in the image plane
    ],
    ids=["helix-3d-attitude", "planar-beat-2d"],
)
def test_the_truth_lies_in_the_stated_intervals_at_the_stated_rate(
    preset, truth, attitude, dimensions
):
    """Forty noisy tracks of one swimmer: 95 % intervals must hold the truth in 95 % of them."""
    trials, sigma = 40, 0.002
    swimmer = ms.Swimmer.preset(preset)
    t, x, q = planted(swimmer.with_(truth), attitude, n=120, duration=9.0)
    wanted = np.array(list(truth.values()))
    hits, squares = np.zeros(3), np.zeros(3)
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        noisy = x[:, :dimensions] + sigma * rng.normal(size=(len(t), dimensions))
        turned = shaken(q, 0.02, rng) if dimensions == 3 else None
        track = Track(time=t, position=noisy, quaternion=turned)
        start = {k: v * f for (k, v), f in zip(truth.items(), (1.05, 0.97, 1.002))}
        given = {"sigma": sigma, "sigma_attitude": 0.02} if dimensions == 3 else {}
        found = ms.identify_swimmer(swimmer, track, start=start, model_error=False, **given)
        low, high = found.interval(0.95).T
        hits += (low <= wanted) & (wanted <= high)
        squares += ((found.values - wanted) / found.uncertainty) ** 2
    # One in a thousand for each of three values either way: neither too narrow nor too wide.
    assert np.all(hits >= binom.ppf(0.001, trials, 0.95))
    assert np.all(squares < chi2.ppf(0.999, trials))
    assert np.all(squares > chi2.ppf(0.001, trials))


def test_what_the_track_does_not_tell_is_said():
    """No track tells the viscosity: at a given motion of the tail it cancels."""
    swimmer = ms.Swimmer.preset("tabak/plane_wave")
    t, x, _ = planted(swimmer, IN_PLANE, n=100, duration=6.0)
    names = ("tail.amplitude", "fluid.viscosity")
    found = ms.identify_swimmer(
        swimmer, Track(time=t, position=x[:, :2]), names, sigma=1e-3,
        start={"tail.amplitude": 0.105},
    )  # fmt: skip
    assert np.isfinite(found.uncertainty[0])
    assert np.isinf(found.uncertainty[1])
    assert any("fluid.viscosity" in w and "cannot be determined" in w for w in found.warnings)
    assert found.values[0] == pytest.approx(0.1, rel=1e-4)


def test_noise_larger_than_stated_is_said():
    swimmer = ms.Swimmer.preset("tabak/helix")
    t, x, _ = planted(swimmer, TILTED, n=100, duration=6.0)
    track = Track(time=t, position=x + 0.01 * np.random.default_rng(2).normal(size=x.shape))
    start = {"tail.amplitude": 0.1}
    found = ms.identify_swimmer(swimmer, track, ["tail.amplitude"], sigma=1e-3, start=start)
    assert any("larger than sigma" in w for w in found.warnings)


def test_the_command_reads_units_and_prints_what_it_found(tmp_path):
    swimmer = ms.Swimmer.preset("goto/C", {"motion.free": "all", "motion.frequency_frame": "body"})
    t, x, _ = planted(swimmer, TILTED, n=150, duration=0.2)
    rows = [
        f"{1e3 * a:.6f},{1e6 * b:.6f},{1e6 * c:.6f},{1e6 * d:.6f}" for a, (b, c, d) in zip(t, x)
    ]
    file = tmp_path / "track.csv"
    file.write_text("\n".join(["time (ms),x (um),y (um),z (um)", *rows]) + "\n")
    arguments = ["identify", str(file), "--preset", "goto/C", "--json", "--out", str(tmp_path)]
    arguments += ["--set", 'motion.free="all"', "--set", 'motion.frequency_frame="body"']
    arguments += ["--unknown", "tail.amplitude", "--unknown", "tail.frequency"]
    run = CliRunner().invoke(main, arguments)
    assert run.exit_code == 0, run.output
    result = json.loads(run.stdout)
    assert result["units"] == "SI"
    assert result["values"]["tail.frequency"] == pytest.approx(73.95, rel=1e-3)
    assert result["values"]["tail.amplitude"] == pytest.approx(0.1487e-6, rel=1e-3)
    assert (tmp_path / "track.png").stat().st_size > 1000


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,x\n0,1\n1,2\n", "no column y"),
        ("time,x,y\n0,1,a\n", "number is missing"),
        ("time,x (um),y\n0,1,2\n", "has a unit and the swimmer has none"),
        ("time,x,y\n0,1,2\n1,2,3\n", "at least 12"),
        ("", "no rows"),
    ],
)
def test_bad_tracks_are_refused_in_one_sentence(tmp_path, text, words):
    file = tmp_path / "track.csv"
    file.write_text(text)
    run = CliRunner().invoke(main, ["identify", str(file), "--preset", "tabak/helix"])
    assert run.exit_code == 2
    assert words in " ".join(run.stderr.split())
    assert "Traceback" not in run.output


def test_bad_arrays_are_refused():
    t = np.arange(20.0)
    with pytest.raises(ms.SpecError, match="increasing"):
        Track(time=t[::-1], position=np.zeros((20, 2)))
    with pytest.raises(ms.SpecError, match="finite"):
        Track(time=t, position=np.full((20, 2), np.nan))
    with pytest.raises(ms.SpecError, match="quaternion"):
        Track(time=t, position=np.zeros((20, 3)), quaternion=np.zeros((20, 4)))
    with pytest.raises(ms.SpecError, match="shape"):
        Track(time=t, position=np.zeros((20, 4)))
