"""What magnets of several swimmers feel: closed forms, the energy's slope, action and reaction."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.swimmer.magnetism.between import largest_torques, wrenches
from microswim.swimmer.magnetism.magnet import MU_0

UM = 1e-6
MOMENT = 2e-14  # A m^2


def robot(moment, **others):
    return ms.Swimmer(
        body=ms.Sphere(radius=2 * UM),
        tail=ms.HelicalTail(length=8 * UM, amplitude=UM, waves=2, radius=0.2 * UM, frequency=0.0),
        fluid=ms.Fluid(viscosity=1e-3),
        magnet=ms.Magnet(moment=moment) if moment is not None else None,
        units="SI",
        **others,
    )


def two(first, second, apart, **pose):
    return (
        ms.Member(swimmer=robot(first)),
        ms.Member(swimmer=robot(second), position=apart, **pose),
    )


@pytest.mark.parametrize(
    ("apart", "along", "times"),
    [((0, 1, 0), (0, 1, 0), -6.0), ((0, 1, 0), (0, 0, 1), 3.0), ((0, 0, 1), (0, 1, 0), 3.0)],
)
def test_parallel_dipoles_attract_in_line_and_repel_side_by_side(apart, along, times):
    """F = -6 or +3 mu_0 m^2 / (4 pi d^4) on the second, away from the first."""
    d = 20 * UM
    moment = MOMENT * np.array(along, float)
    found = wrenches(two(moment, moment, tuple(d * np.array(apart))), None, 0.0)
    want = times * MU_0 * MOMENT**2 / (4 * np.pi * d**4) * np.array(apart)
    np.testing.assert_allclose(found[1, :3], want, rtol=1e-12, atol=1e-12 * np.abs(want).max())
    np.testing.assert_allclose(found[:, 3:], 0.0, atol=1e-12 * np.abs(want).max() * d)


def random_members(seed):
    rng = np.random.default_rng(seed)
    return tuple(
        ms.Member(
            swimmer=robot(MOMENT * rng.normal(size=3)),
            position=tuple(30 * UM * rng.normal(size=3)),
            direction=tuple(rng.normal(size=3)),
            roll=float(rng.uniform(0, 6)),
        )
        for _ in range(4)
    )


@pytest.mark.parametrize("seed", range(3))
def test_what_magnets_do_to_each_other_adds_up_to_nothing(seed):
    members = random_members(seed)
    found = wrenches(members, None, 0.0)
    F, T = found[:, :3], found[:, 3:]
    x = np.array([m.position for m in members])
    assert np.abs(F.sum(axis=0)).max() < 1e-12 * np.abs(F).max()
    assert np.abs((T + np.cross(x, F)).sum(axis=0)).max() < 1e-12 * np.abs(T).max()


def dipole_energy(members):
    """Of all pairs, from Griffiths' Eq. (6.35), which has no field in it."""
    x = np.array([m.position for m in members])
    p = np.array([m.rotation @ np.array(m.swimmer.magnet.moment) for m in members])
    total = 0.0
    for i in range(len(p)):
        for j in range(i):
            r = x[i] - x[j]
            d = np.linalg.norm(r)
            along = (p[i] @ r) * (p[j] @ r) / d**2
            total += MU_0 / (4 * np.pi * d**3) * (p[i] @ p[j] - 3 * along)
    return total


def test_forces_are_the_slope_of_the_energy():
    members = list(random_members(7))
    found, h = wrenches(members, None, 0.0), 1e-3 * UM
    for axis in range(3):
        ends = []
        for side in (h, -h):
            moved = np.array(members[1].position)
            moved[axis] += side
            one = ms.Member(
                swimmer=members[1].swimmer, position=tuple(moved),
                direction=members[1].direction, roll=members[1].roll,
            )  # fmt: skip
            ends.append(dipole_energy([members[0], one, *members[2:]]))
        slope = (ends[0] - ends[1]) / (2 * h)
        assert found[1, axis] == pytest.approx(-slope, rel=1e-5, abs=1e-7 * np.abs(found).max())


def test_a_field_from_outside_is_that_of_one_swimmer():
    """Torque m x B, force (m . grad) B, B of a dipole; a swimmer without a magnet feels none."""
    field = ms.DipoleField(moment=(0.0, 0.0, 10.0), position=(0.0, 0.0, -0.1))
    members = (
        ms.Member(swimmer=robot((0.0, MOMENT, 0.0)), direction=(0, 1, 0)),
        ms.Member(swimmer=robot(None), position=(0, 20 * UM, 0)),
    )
    found = wrenches(members, field, 0.0)
    moment = members[0].rotation @ np.array([0.0, MOMENT, 0.0])
    np.testing.assert_allclose(found[0, 3:], np.cross(moment, field.at(0.0, (0, 0, 0))))
    np.testing.assert_allclose(found[0, :3], field.gradient(0.0, (0, 0, 0)) @ moment)
    assert not found[1].any()
    strongest = MOMENT * np.linalg.norm(field.at(0.0, (0, 0, 0)))
    np.testing.assert_allclose(largest_torques(members, field, 0.0), [strongest, 0.0], rtol=1e-9)


def test_a_soft_magnet_is_magnetised_by_the_field():
    soft = ms.Magnet(susceptibility=(2.0, 1.0, 1.0), volume=1e-17)
    one = ms.Member(swimmer=replace(robot(None), magnet=soft), direction=(1, 1, 0))
    field = ms.UniformField(strength=5e-3)
    found = wrenches((one,), field, 0.0)[0]
    along, across = (1e-17 / MU_0 * chi * 5e-3 / np.sqrt(2) for chi in (2.0, 1.0))
    # B along x is (1, -1, 0)/sqrt 2 of s, q: the torque about z takes s towards B
    assert found[5] == pytest.approx(-(along - across) * 5e-3 / np.sqrt(2), rel=1e-12)
    assert not found[:5].any()


def test_without_units_magnets_feel_the_field_alone():
    magnet = ms.Magnet(moment=(0.0, 1.0, 0.0))
    helix = replace(ms.Swimmer.preset("tabak/helix"), magnet=magnet)
    pair = (ms.Member(swimmer=helix), ms.Member(swimmer=helix, position=(0.0, 3.0, 0.0)))
    assert not wrenches(pair, None, 0.0).any()
    found = wrenches(pair, ms.UniformField(strength=2.0, direction=(0, 0, 1)), 0.0)
    np.testing.assert_allclose(found, [[0, 0, 0, 2.0, 0, 0]] * 2)
