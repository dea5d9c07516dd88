"""Thermal displacements in the loop: their covariance, and the group that they live on."""

import numpy as np
import pytest

import microswim as ms
from microswim.control.thermal import moved

HELIX = ms.Swimmer.preset("tabak/helix")
COLD = ms.Stepper.of(HELIX)


def test_their_covariance_is_that_of_the_mobility():
    n, dt, energy = 60_000, 0.01, 0.02
    phase = 0.7
    state = ms.State.at(position=np.zeros((n, 3)), phase=phase)
    after = COLD.scattered(state, dt=dt, random=np.random.default_rng(1), energy=energy)
    q = after.quaternion
    z = np.concatenate([after.position, 2.0 * q[:, 1:] * np.sign(q[:, :1])], axis=1)
    M = np.linalg.inv(HELIX.gait().resistance(phase))
    measured = z.T @ z / n / (2.0 * energy * dt)
    size = np.sqrt(np.outer(np.diag(M), np.diag(M)))
    assert np.abs((measured - M) / size).max() < 4.5 / np.sqrt(n)  # 4 sigma and more


def test_two_half_exponentials_are_a_whole_one():
    z = np.array([[0.3, -0.2, 0.5, 0.7, 0.4, -0.9]])
    start = np.array([[1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.5, 0.1]])
    assert np.allclose(moved(moved(start, z / 2.0), z / 2.0), moved(start, z), atol=1e-13)
    small = 1e-5 * z
    assert np.allclose(moved(moved(start, small), -small), start, atol=1e-14)
    assert np.allclose(moved(moved(start, z), -z), start, atol=1e-13)


def test_the_exponential_is_the_screw_of_its_twist():
    """A quarter turn about r while moving along s and r: a helix."""
    turn = np.pi / 2.0
    z = np.array([[1.0, 0.0, 0.3, 0.0, 0.0, turn]])
    start = np.array([[0.0, 0, 0, 1.0, 0, 0, 0, 0]])
    radius = 1.0 / turn
    assert np.allclose(moved(start, z)[0, :3], [radius, radius, 0.3], atol=1e-14)


def test_steps_with_noise_diffuse_as_paths_do():
    """A ball, in twenty steps: ``6 D t`` within 2 %."""
    ball = ms.Swimmer(
        body=ms.Sphere(radius=0.5), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0),
        noise=ms.Noise(temperature=0.02),
    )  # fmt: skip
    stepper, random = ms.Stepper.of(ball), np.random.default_rng(2)
    state = ms.State.at(position=np.zeros((20_000, 3)))
    for _ in range(20):
        state = stepper.step(state, dt=0.05, flow=(1.0, 0.0, 0.0))
        state = stepper.scattered(state, dt=0.05, random=random)
    x = state.position - [1.0, 0.0, 0.0]
    D = 0.02 / (6.0 * np.pi * 0.5)
    assert (x**2).sum(axis=1).mean() == pytest.approx(6.0 * D, rel=0.02)


def test_what_is_held_does_not_diffuse():
    held = ms.Stepper.of(HELIX.with_({"motion.free": ("us", "os")}))
    state = ms.State.at(position=np.zeros((100, 3)))
    after = held.scattered(state, dt=0.1, random=np.random.default_rng(0), energy=1.0)
    assert np.allclose(after.position[:, 1:], 0.0)
    assert np.ptp(after.position[:, 0]) > 0


def test_the_temperature_is_asked_for():
    state, random = ms.State.at(), np.random.default_rng(0)
    with pytest.raises(ms.SpecError, match="energy: missing"):
        COLD.scattered(state, dt=0.1, random=random)
    with pytest.raises(ms.SpecError, match="random"):
        COLD.scattered(state, dt=0.1, random=3, energy=1.0)
