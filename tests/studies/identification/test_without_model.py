"""What a track holds without a model: planted motions, stated intervals, what is said."""

import numpy as np
import pytest
from scipy.stats import binom

import microswim as ms
from microswim.studies.identification import spectrum

V, RATE, F, A = 3.0, 0.8, 7.3, 0.1


def circling(t, noise, rng, turn=RATE, wobble=A):
    """A circle to the left with a wobble across, in noise."""
    angle = turn * t
    along = np.stack([np.sin(angle), 1.0 - np.cos(angle)], axis=-1) * V / turn
    across = np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
    x = along + wobble * np.sin(2 * np.pi * F * t)[:, None] * across
    return ms.Track(time=t, position=x + noise * rng.normal(size=x.shape))


def test_the_truth_lies_in_the_stated_intervals_at_the_stated_rate():
    t, trials = np.arange(800) * 0.01, 60
    truth = {"speed": V, "turning_rate": RATE, "wobble_frequency": F, "wobble_amplitude": A}
    hits = dict.fromkeys(truth, 0)
    for seed in range(trials):
        found = ms.describe_track(circling(t, 0.03, np.random.default_rng(seed))).numbers
        for name, value in truth.items():
            hits[name] += found[name].low <= value <= found[name].high
    assert all(hit >= binom.ppf(0.001, trials, 0.95) for hit in hits.values()), hits


@pytest.mark.parametrize(("keep", "jitter"), [(1.0, 0.0), (0.8, 0.0), (1.0, 0.3)])
def test_the_fast_spectrum_is_that_of_least_squares(keep, jitter):
    rng = np.random.default_rng(4)
    t = (np.arange(600) + jitter * rng.uniform(-1, 1, 600)) * 0.01
    t = np.sort(t[rng.random(600) < keep])
    y = np.stack([np.sin(2 * np.pi * 13.7 * t), 0.3 * np.cos(2 * np.pi * 13.7 * t)], axis=-1)
    y += 0.2 * rng.normal(size=y.shape)
    f, share = spectrum.power(t, y)
    slow = spectrum._one_by_one(t - t.mean(), y - y.mean(axis=0), f) / np.sum((y - y.mean(0)) ** 2)
    assert share == pytest.approx(slow, abs=3e-3)  # the constant, which the transforms leave out
    assert f[np.argmax(share)] == pytest.approx(13.7, abs=0.02)


def test_uneven_times_of_a_long_track_are_interpolated():
    rng = np.random.default_rng(5)
    t = (np.arange(4000) + 0.2 * rng.uniform(-1, 1, 4000)) * 0.01
    x = np.stack([t, 0.1 * np.sin(2 * np.pi * F * t)], axis=-1)
    seen = spectrum.line(t, x)
    assert seen.frequency == pytest.approx(F, abs=1e-2)
    assert seen.amplitude == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_a_straight_line_has_a_speed_and_no_wobble(noise):
    t = np.arange(300) * 0.02
    x = np.stack([V * t, 0 * t], axis=-1) + noise * np.random.default_rng(0).normal(size=(300, 2))
    found = ms.describe_track(ms.Track(time=t, position=x))
    assert found.numbers["wobble_amplitude"] is None
    assert found.numbers["speed"].low <= V + 1e-9
    assert found.numbers["speed"].high >= V - 1e-9
    assert any("no wobble stands above the noise" in note for note in found.notes)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_what_stands_still_does_not_swim(noise):
    rng, t = np.random.default_rng(1), np.arange(300) * 0.02
    found = ms.describe_track(ms.Track(time=t, position=noise * rng.normal(size=(300, 2))))
    assert found.numbers["speed"] is None
    assert any("does not swim" in note for note in found.notes)


def test_noise_alone_seldom_has_a_wobble():
    t = np.arange(256) * 0.02
    seen = [
        spectrum.line(t, np.random.default_rng(seed).normal(size=(256, 2))).stands_out
        for seed in range(300)
    ]
    assert sum(seen) <= binom.ppf(0.999, 300, 1e-3)


def test_a_random_walk_diffuses():
    rng = np.random.default_rng(2)
    x = np.cumsum(np.sqrt(2 * 0.25 * 0.02) * rng.normal(size=(4000, 2)), axis=0)
    found = ms.describe_track(ms.Track(time=np.arange(4000) * 0.02, position=x))
    assert found.numbers["speed"] is None
    D = found.numbers["effective_diffusion"]
    assert D.low < 0.25 < D.high
    assert any("diffuses" in note for note in found.notes)


def test_an_active_brownian_particle_forgets_its_heading_in_time():
    """Speed, persistence and diffusion of `v, tau`: ``D = v^2 tau / 2`` in the plane."""
    v, tau, dt, n = 5.0, 1.0, 0.02, 20_000
    rng = np.random.default_rng(3)
    angle = np.cumsum(np.sqrt(2 * dt / tau) * rng.normal(size=n))
    x = np.cumsum(v * dt * np.stack([np.cos(angle), np.sin(angle)], axis=-1), axis=0)
    x += 0.02 * rng.normal(size=x.shape)
    found = ms.describe_track(ms.Track(time=np.arange(n) * dt, position=x))
    for name, value in (("speed", v), ("persistence_time", tau), ("effective_diffusion", 12.5)):
        assert found.numbers[name].low < value < found.numbers[name].high, name
    lag = found.lag[:12]  # v^2 tau^2 2 (t / tau - 1 + exp(-t / tau)) and the noise
    theory = 2 * v**2 * tau**2 * (lag / tau - 1 + np.exp(-lag / tau)) + 4 * 0.02**2
    assert found.displacement[:12, 0] == pytest.approx(theory, rel=0.06)


def test_a_path_of_many_circles_is_no_wobble():
    found = ms.describe_track(circling(np.arange(4000) * 0.01, 0.02, np.random.default_rng(7)))
    for name, value in (("speed", V), ("turning_rate", RATE), ("wobble_frequency", F)):
        assert found.numbers[name].low < value < found.numbers[name].high, name
        assert found.numbers[name].value == pytest.approx(value, rel=0.05)


def test_the_wobble_of_a_screw_in_space_is_taken_off():
    """Seen in 3-D, a helical path has the speed along its axis; the rest is the wobble."""
    t = np.arange(4000) * 0.01
    x = np.stack([2.0 * t, 1.5 * np.cos(1.2 * t), 1.5 * np.sin(1.2 * t)], axis=-1)
    x += 0.01 * np.random.default_rng(6).normal(size=x.shape)
    found = ms.describe_track(ms.Track(time=t, position=x)).numbers
    assert found["speed"].value == pytest.approx(2.0, rel=0.01)
    assert found["wobble_frequency"].value == pytest.approx(1.2 / (2 * np.pi), rel=0.02)
    assert found["wobble_amplitude"].value == pytest.approx(1.5 * np.sqrt(2.0), rel=0.05)
