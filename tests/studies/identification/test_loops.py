"""Paths that run in loops, planted in closed form: what is found of them, and what cannot be."""

import numpy as np
import pytest

import microswim as ms

V, BEAT, AMPLITUDE, NOISE = 20.0, 12.0, 0.5, 0.03
LIKE = "seen along its axis"


def track(rate, drift=0.0, amplitude=AMPLITUDE, fps=100.0, duration=10.0, seed=0, noise=NOISE):
    """Return a cell on an exact circle whose centre drifts along x, and that beats across its
    heading.
    """
    t = np.arange(int(duration * fps)) / fps
    z = V / (1j * rate) * np.exp(1j * rate * t) + drift * t
    z = z + 1j * np.exp(1j * rate * t) * amplitude * np.sin(2 * np.pi * BEAT * t)
    off = noise * np.random.default_rng(seed).normal(size=(t.size, 2))
    return ms.Track(time=t, position=np.stack([z.real, z.imag], -1) + off)


def held(found, name, truth, most):
    """Whether an interval holds the truth and is no wider than a share of it."""
    e = found.numbers[name]
    assert e.low <= truth <= e.high, (name, e)
    assert e.high - e.low < most * abs(truth), (name, e)


@pytest.mark.parametrize("rate", [1.0, 4.0, -6.3, 10.0, -20.0])
def test_a_path_that_winds_keeps_its_speed_and_its_turning(rate):
    found = ms.describe_track(track(rate))
    held(found, "speed", V, 0.05)
    held(found, "turning_rate", rate, 0.01)
    held(found, "loop_radius", V / abs(rate), 0.02)
    assert found.numbers["drift"].low == 0.0
    assert found.numbers["drift"].high < 0.02
    assert found.numbers["wobble_frequency"].value == pytest.approx(BEAT, rel=1e-3)
    assert found.numbers["wobble_amplitude"].value == pytest.approx(AMPLITUDE, rel=0.02)
    assert sum(LIKE in note for note in found.notes) == 1


@pytest.mark.parametrize("rate", [1.4, -3.3])
def test_a_beat_much_faster_than_the_cell_is_no_circle_that_it_runs(rate):
    """Turning splits the line of a beat in two circles; each may be taken for the path."""
    found = ms.describe_track(track(rate, amplitude=2.5))
    assert 2 * np.pi * BEAT * 2.5 > 9 * V
    held(found, "speed", V, 0.1)
    held(found, "turning_rate", rate, 0.05)
    assert found.numbers["wobble_frequency"].value == pytest.approx(BEAT, rel=1e-3)
    assert found.numbers["wobble_amplitude"].value == pytest.approx(2.5, rel=0.02)


def test_a_slow_turn_cuts_no_corner():
    """A third of a radian in five averages: parabolas alone say 1.6 % too little."""
    held(ms.describe_track(track(1.4 * BEAT / 8.2, noise=0.005)), "speed", V, 0.01)


@pytest.mark.parametrize("drift", [3.0, 15.0, 30.0])
def test_loops_that_drift_say_how_fast(drift):
    found = ms.describe_track(track(4.0, drift))
    held(found, "drift", drift, 0.01)
    held(found, "loop_radius", V / 4.0, 0.01)
    x = V * np.exp(1j * np.linspace(0, 2 * np.pi, 2001)[:-1]) + drift
    held(found, "speed", np.abs(x).mean(), 0.5)
    assert found.numbers["wobble_frequency"].value == pytest.approx(BEAT, rel=1e-3)
    assert found.numbers["wobble_amplitude"].value == pytest.approx(AMPLITUDE, rel=0.02)
    assert any("whose centre moves at drift" in note for note in found.notes)


def test_a_turn_that_quickens_keeps_its_speed():
    t = np.arange(1000) / 100.0
    angle = 2.0 * t + 0.2 * t**2  # 2 to 6 rad/s
    fine = np.linspace(0, 10, 200_001)
    steps = V * np.exp(1j * (2.0 * fine + 0.2 * fine**2)) * (fine[1] - fine[0])
    z = np.interp(t, fine, np.cumsum(steps.real)) + 1j * np.interp(t, fine, np.cumsum(steps.imag))
    z = z + 1j * np.exp(1j * angle) * AMPLITUDE * np.sin(2 * np.pi * BEAT * t)
    noise = NOISE * np.random.default_rng(1).normal(size=(t.size, 2))
    found = ms.describe_track(ms.Track(time=t, position=np.stack([z.real, z.imag], -1) + noise))
    held(found, "speed", V, 0.05)
    held(found, "turning_rate", 4.0, 0.5)


@pytest.mark.parametrize("advance", [2.0, 5.0, 20.0])
def test_a_helix_seen_along_its_axis_is_named_beside_a_cell_that_circles(advance):
    t, radius, f = np.arange(1000) / 100.0, 0.5, 8.0
    z = advance * t + radius * np.exp(2j * np.pi * f * t)
    noise = 0.02 * np.random.default_rng(3).normal(size=(t.size, 2))
    found = ms.describe_track(ms.Track(time=t, position=np.stack([z.real, z.imag], -1) + noise))
    assert any(LIKE in note for note in found.notes), found.notes
    e = found.numbers["drift"] or found.numbers["speed"]
    assert e.value == pytest.approx(advance, rel=2e-3)


def test_straight_and_spatial_tracks_have_no_loops():
    t = np.arange(1000) / 100.0
    noise = NOISE * np.random.default_rng(2).normal(size=(t.size, 3))
    swing = AMPLITUDE * np.sin(2 * np.pi * BEAT * t)
    line = np.stack([V * t, swing, 0 * t], -1) + noise
    helix = np.stack([V * t, np.cos(8 * t), np.sin(8 * t)], -1) + noise
    for x in (line[:, :2], helix):
        found = ms.describe_track(ms.Track(time=t, position=x))
        assert found.numbers["loop_radius"] is None
        assert not any(LIKE in note for note in found.notes)
