"""Soft magnets: they turn their easy axis into the field, and are drawn to where it is strong."""

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.spec.file import from_dict
from microswim.spec.readers.text import toml
from microswim.swimmer.magnetism.magnet import MU_0

SIZE = (1e-3, 4e-4, 4e-4)
CHI = (3.0, 1.0, 1.0)


def rod(**changes):
    given = {"magnet": ms.Magnet(susceptibility=CHI, size=SIZE), **changes}
    return ms.Swimmer(
        body=ms.Spheroid(semi_axes=(6e-4, 3e-4)),
        tail=ms.NoTail(),
        fluid=ms.Fluid(viscosity=0.34),
        units="SI",
        **given,
    )


def tilted(angle):
    return [np.cos(angle / 2.0), 0.0, 0.0, np.sin(angle / 2.0)]


def test_the_tangent_of_the_tilt_decays_at_a_constant_rate():
    """``theta' = - B^2 V (chi_s - chi_q) / (mu_0 R) sin(theta) cos(theta)``."""
    B, start = 4e-3, 1.2
    robot = rod(field=ms.UniformField(strength=B, direction=(1, 0, 0)))
    R = robot.gait("rft").resistance(0.0)[5, 5]
    rate = B**2 * np.prod(SIZE) * (CHI[0] - CHI[1]) / (MU_0 * R)
    found = ms.path(robot, 2.0 / rate, model="rft", quaternion=tilted(start), samples=5)
    q = found.quaternion.values
    angle = 2.0 * np.arctan2(q[:, 3], q[:, 0])
    wanted = np.tan(start) * np.exp(-rate * found.time.values)
    assert np.tan(angle) == pytest.approx(wanted, rel=1e-4)
    other = ms.trajectory(
        robot.gait("rft"), found.time.values, rate=0.0, moment=robot.magnet, field=robot.field,
        quaternion=tilted(start),
    )  # fmt: skip
    assert other.quaternion.values == pytest.approx(q, abs=1e-5)


def test_the_pull_is_the_slope_of_the_energy():
    """Energy ``-m . B / 2``, turned as well: chi of three different values, any attitude."""
    from microswim.path.in_space import magnetic_wrench

    tensor = ((3.0, 0.4, -0.2), (0.4, 1.5, 0.3), (-0.2, 0.3, 0.8))
    magnet = ms.Magnet(susceptibility=tensor, volume=1e-10)
    field = ms.DipoleField(moment=(3.0, -7.0, 5.0), position=(0.1, 0.02, -0.06))
    q = np.array([0.5, -0.4, 0.6, 0.3])
    Q, x = rotation_matrix(q / np.linalg.norm(q)), np.array([0.01, -0.02, 0.005])

    def energy(place, turn=Q):
        B = turn.T @ field.at(0.0, place)
        return -B @ magnet.softness @ B / 2.0

    force, torque = magnetic_wrench(magnet.magnetic, field.at(0.0, x), field.gradient(0.0, x), Q)
    h = 1e-5
    slope = [(energy(x + h * e) - energy(x - h * e)) / (2 * h) for e in np.eye(3)]
    assert force == pytest.approx(-np.array(slope), rel=1e-5)

    def turned(axis, angle):
        c = np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])
        return Q @ rotation_matrix(c)

    turns = [(energy(x, turned(e, 1e-4)) - energy(x, turned(e, -1e-4))) / 2e-4 for e in np.eye(3)]
    assert torque == pytest.approx(-np.array(turns), rel=1e-6)


def test_a_soft_sphere_drifts_to_a_magnet_at_mobility_times_force():
    pull = ms.DipoleField(moment=(10.0, 0.0, 0.0), position=(0.05, 0.0, 0.0))
    chi, volume = 2.0, 1e-10
    robot = ms.Swimmer(
        body=ms.Sphere(radius=5e-4),
        tail=ms.NoTail(),
        fluid=ms.Fluid(viscosity=0.34),
        units="SI",
        magnet=ms.Magnet(susceptibility=(chi,) * 3, volume=volume),
        field=pull,
    )
    found = ms.path(robot, 0.01, model="rft", samples=2)
    B = pull.at(0.0)
    # m = chi V B / mu_0, and on the axis B falls with the cube of the distance
    force = chi * volume * B[0] ** 2 / MU_0 * 3.0 / 0.05
    speed = force / (6.0 * np.pi * 0.34 * 5e-4)
    assert found.attrs["drift"][0] == pytest.approx(speed, rel=1e-3)


def test_a_spec_says_a_soft_head():
    text = """
    [fluid]
    viscosity = "0.34 Pa s"
    [body]
    shape = "ellipsoid"
    semi_axes = ["0.6 mm", "0.3 mm", "0.3 mm"]
    [tail]
    kind = "none"
    [magnet]
    susceptibility = [3, 1, 1]
    size = ["1 mm", "0.4 mm", "0.4 mm"]
    """
    robot = from_dict(toml(text, "soft"))
    assert robot.magnet is not None
    assert robot.magnet.softness == pytest.approx(np.diag(CHI) * np.prod(SIZE) / MU_0, rel=1e-12)
    assert not robot.magnet.vector.any()


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"susceptibility": (1.0, 2.0)}, "susceptibility"),
        ({"susceptibility": ((1, 2, 0), (0, 1, 0), (0, 0, 1))}, "symmetric"),
        ({"susceptibility": (-2.0, 1.0, 1.0)}, "above -1"),
        ({"susceptibility": (1.0, 1.0, 1.0), "remanence": 1.2}, "one of the three"),
        ({"susceptibility": (1.0, 1.0, 1.0), "direction": 0.3}, "direction"),
        ({"susceptibility": (1.0, 1.0, 1.0), "volume": None}, "size or volume"),
    ],
)
def test_what_is_no_soft_magnet_is_refused(given, word):
    with pytest.raises(ms.SpecError, match=word):
        ms.Magnet(**{"volume": 1e-10, **given})


def test_a_swimmer_prints_its_soft_magnet_and_the_frequency_of_its_field_alone():
    still = ms.UniformField(strength=4e-3, direction=(1, 0, 0))
    assert "soft, susceptibility 3, 1, 1 along s, q, r" in str(rod(field=still))
    assert "uniform, 4 mT\n" in str(rod(field=still)) + "\n"
