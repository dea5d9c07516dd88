"""Runs and tumbles: the heading is forgotten as their angle and their time say."""

import numpy as np
import pytest

import microswim as ms

BALL = {"body": ms.Sphere(radius=0.5), "tail": ms.NoTail(), "fluid": ms.Fluid(viscosity=1.0)}


def headings(quaternion):
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=-1)


@pytest.mark.parametrize("angle", [np.radians(68.0), 2.5])
def test_the_heading_is_forgotten_at_the_rate_of_runs_and_diffusion(angle):
    """``exp(-t ((1 - cos a) / T + 2 D_r))``, ``D_r = kT / 8 pi mu a^3`` (Lovely & Dahlquist)."""
    energy, T, n = 0.1, 0.8, 4000
    noise = ms.Noise(temperature=energy, run_time=T, tumble_angle=angle)
    path = ms.path(ms.Swimmer(**BALL, noise=noise), 1.2, samples=7, paths=n, seed=3)
    u = headings(path.quaternion.values.reshape(n, -1, 4))
    rate = (1.0 - np.cos(angle)) / T + 2.0 * energy / (8.0 * np.pi * 0.5**3)
    seen = np.mean(np.sum(u * u[:, :1], axis=-1), axis=0)
    t = path.time.values - path.time.values[0]
    assert np.abs(seen - np.exp(-rate * t)).max() < 4.0 / np.sqrt(3.0 * n)


def test_the_stepper_tumbles_too():
    noise, n = ms.Noise(temperature=1e-9, run_time=0.5), 6000
    stepper, random = ms.Stepper.of(ms.Swimmer(**BALL, noise=noise)), np.random.default_rng(1)
    state = ms.State.at(position=np.zeros((n, 3)))
    for _ in range(10):
        state = stepper.scattered(state, dt=0.05, random=random)
    u = headings(state.quaternion)
    wanted = np.exp(-(1.0 - np.cos(np.radians(68.0))) * 0.5 / 0.5)
    assert u[:, 0].mean() == pytest.approx(wanted, abs=4.0 / np.sqrt(n))
    assert np.abs(u[:, 1:].mean(axis=0)).max() < 4.0 / np.sqrt(n)


def test_without_runs_the_chances_are_as_before():
    cold = ms.Swimmer(**BALL, noise=ms.Noise(temperature=0.1))
    one = ms.path(cold, 0.3, samples=4, paths=2, seed=5).position.values
    rare = ms.Swimmer(**BALL, noise=ms.Noise(temperature=0.1, run_time=1e12))
    assert np.abs(one - ms.path(rare, 0.3, samples=4, paths=2, seed=5).position.values).max() == 0.0


def test_a_spec_says_it_in_units(tmp_path):
    swimmer = ms.Swimmer.preset(
        "goto/C", {"noise.temperature": "298 K", "noise.run_time": "900 ms",
                   "noise.tumble_angle": "68 deg"},
    )  # fmt: skip
    assert swimmer.noise.run_time == pytest.approx(0.9)
    assert swimmer.noise.tumbles[1] == pytest.approx(np.radians(68.0))
    file = tmp_path / "cell.toml"
    file.write_text(swimmer.to_toml())
    assert ms.Swimmer.from_toml(file).noise == swimmer.noise


@pytest.mark.parametrize(
    ("given", "word"),
    [({"run_time": 0.0}, "run_time"), ({"tumble_angle": 1.0}, "run_time: missing"),
     ({"run_time": 1.0, "tumble_angle": 4.0}, "tumble_angle")],
)  # fmt: skip
def test_tumbles_that_make_no_sense(given, word):
    with pytest.raises(ms.SpecError, match=word):
        ms.Noise(temperature=1.0, **given)
