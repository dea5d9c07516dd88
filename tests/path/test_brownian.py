"""Thermal noise: the fluctuation-dissipation theorem, Perrin's spheroid, an active particle."""

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.rigid_motion import rotation_matrix

BARE, KT = ms.NoTail(), 0.02


def warm(body, tail=BARE, energy=KT, **parts):
    fluid = ms.Fluid(viscosity=1.0)
    return ms.Swimmer(
        body=body, tail=tail, fluid=fluid, noise=ms.Noise(temperature=energy), **parts
    )


def test_displacements_have_the_covariance_of_the_mobility():
    """``<z z'> = 2 k_B T M t`` for place and turn together, by 1e5 paths: 0.45 % is one sigma.

    The swimmer has a still helical tail, so that turning and moving are coupled.
    """
    helix = ms.Swimmer.preset("tabak/helix").with_({"tail.frequency": 0.0})
    swimmer = warm(helix.body, helix.tail)
    t = 0.01
    found = ms.path(swimmer, t, model="rft", paths=100_000, samples=2, step=t / 2.0, seed=3)
    q = found.quaternion.values[:, -1]
    z = np.concatenate([found.position.values[:, -1], 2.0 * q[:, 1:] * np.sign(q[:, :1])], axis=1)
    M = np.linalg.inv(swimmer.gait().resistance(0.0))
    measured = z.T @ z / len(z) / (2.0 * KT * t)
    size = np.sqrt(np.outer(np.diag(M), np.diag(M)))
    assert np.abs((measured - M) / size).max() < 4 * 0.0045
    assert np.abs(np.diag(measured) / np.diag(M) - 1.0).max() < 0.012


def test_a_ball_diffuses_as_stokes_and_einstein_say():
    swimmer = warm(ms.Sphere(radius=0.5))
    found = ms.path(swimmer, 1.0, model="rft", paths=100_000, samples=3, step=0.25, seed=5)
    D = KT / (6.0 * np.pi * 0.5)
    for i in (1, 2):
        square = (found.position.values[:, i] ** 2).sum(axis=-1).mean()
        assert square == pytest.approx(6.0 * D * float(found.time[i]), rel=0.01)


def test_a_spheroid_diffuses_along_and_across_until_it_has_turned_away():
    """``<z^2>`` of Perrin's prolate spheroid that starts along z (Han et al. 2006, in space).

    <x_i^2> = 2 D t + 2 dD (3 n_i^2 - 1) (1 - e^(-6 D_r t)) / (18 D_r),  dD = D_along - D_across.
    """
    swimmer = warm(ms.Spheroid(semi_axes=(1.5, 0.5)), energy=0.1)
    K = np.diag(swimmer.body.resistance(1.0))
    along, across, turn = 0.1 / K[0], 0.1 / K[1], 0.1 / K[4]
    t = 0.7 / turn
    found = ms.path(
        swimmer, t, model="rft", paths=10_000, samples=2, step=0.02 / turn, seed=7,
        quaternion=(np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0),
    )  # fmt: skip
    mean = (along + 2.0 * across) / 3.0
    bent = (along - across) * (1.0 - np.exp(-6.0 * turn * t)) / (9.0 * turn)
    square = (found.position.values[:, -1] ** 2).mean(axis=0)
    sigma = np.sqrt(2.0 / 10_000)
    assert square[2] == pytest.approx(2.0 * mean * t + 2.0 * bent, rel=4 * sigma)
    assert square[0] == pytest.approx(2.0 * mean * t - bent, rel=4 * sigma)
    s = rotation_matrix(found.quaternion.values[:, -1])[:, 2, 0]
    assert s.mean() == pytest.approx(np.exp(-2.0 * turn * t), abs=4 * np.sqrt(1 / 3 / 10_000))


def test_an_active_particle_persists_and_then_diffuses():
    """``<r^2> = 6 D t + 2 v^2 tau^2 (t/tau - 1 + e^(-t/tau))``, tau = 1/(2 D_r).

    The force that drives it is fixed in the lab for `path`, so a swimmer's own motor drives it: a
    helix with a body far larger than the wobble, by the mean speed of its screw without noise.
    """
    helix = ms.Swimmer.preset("tabak/helix").with_({"body.radius": 0.5})
    swimmer = ms.Swimmer(
        body=helix.body, tail=helix.tail, fluid=ms.Fluid(viscosity=1.0),
        noise=ms.Noise(temperature=0.05),
    )  # fmt: skip
    gait = swimmer.gait()
    speed = ms.screw(gait).speed
    M = np.linalg.inv(gait.resistance(0.0))
    turn = 0.05 * (M[4, 4] + M[5, 5]) / 2.0
    tau = 1.0 / (2.0 * turn)
    t = 2.0 * tau
    found = ms.path(swimmer, t, model="rft", paths=800, samples=3, step=1.0 / 8.0, seed=2)
    # diffusion of the point that wobbles least, the centre of hydrodynamic reaction, near enough
    D = 0.05 * np.trace(M[:3, :3]) / 3.0
    for i in (1, 2):
        x = float(found.time[i]) / tau
        active = 2.0 * (speed * tau) ** 2 * (x - 1.0 + np.exp(-x))
        square = (found.position.values[:, i] ** 2).sum(axis=-1).mean()
        assert square == pytest.approx(active + 6.0 * D * x * tau, rel=0.12)


def test_the_same_seed_gives_the_same_path_and_another_one_another():
    swimmer = warm(ms.Sphere(radius=0.5))
    one, same, other = (
        ms.path(swimmer, 1.0, model="rft", samples=9, seed=seed) for seed in (1, 1, 2)
    )
    assert one.equals(same)
    assert not np.allclose(one.position[-1], other.position[-1], atol=1e-3)


def test_a_noisy_path_that_was_killed_goes_on_to_the_same_numbers(tmp_path):
    keep, swimmer = tmp_path / "path.npz", warm(ms.Sphere(radius=0.5))

    def kill(done, of):
        if done == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ms.path(swimmer, 1.0, model="rft", paths=3, keep=keep, progress=kill)
    assert ms.path(swimmer, 1.0, model="rft", paths=3, keep=keep).equals(
        ms.path(swimmer, 1.0, model="rft", paths=3)
    )


@pytest.mark.slow
def test_noise_averages_jefferys_orbit_out():
    """In strong noise a spheroid in shear has lost its orbit: its mean attitude is isotropic."""
    swimmer = warm(
        ms.Spheroid(semi_axes=(1.5, 0.5)), energy=2.0, flow=ms.ShearFlow(rate=0.05)
    )  # fmt: skip
    found = ms.path(swimmer, 20.0, model="rft", paths=2000, samples=2, step=0.1, seed=1)
    s = rotation_matrix(found.quaternion.values[:, -1])[:, :, 0]
    K = swimmer.body.resistance(1.0)[4, 4]
    lean = 0.8 * 0.05 / (30.0 * 2.0 / K)  # <p p> = 1/3 + B E / (15 D_r) to first order in Peclet
    assert np.allclose((s**2).mean(axis=0), 1.0 / 3.0, atol=4 * np.sqrt(4 / 45 / 2000))
    assert (s[:, 0] * s[:, 2]).mean() == pytest.approx(lean, abs=4 * np.sqrt(1 / 15 / 2000))
