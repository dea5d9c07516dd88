"""Paths beside a wall: contact, noise in equilibrium, energy; by a wall that is made up.

The wall adds to R what grows towards contact; nothing is solved, for the laws hold whatever it is.
"""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from boundaries import beside
from microswim.gait.poses import beside_wall
from microswim.gait.poses.lubricated import kept_off_wall
from microswim.gait.poses.table import WORK, resist
from microswim.path.brownian import NORMALS, scatter
from microswim.path.loads import loads_of

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
STILL = ROBOT.with_({"tail.frequency": 0.0, "motion.free": ("us", "uq", "ur")})
POSES, HELD = beside(ROBOT), beside(STILL)


def height(poses):
    """Height of the centre where the surface touches the wall, at the lab's axes."""
    return 2.0 - poses.gap((0, 0, 2.0), (1, 0, 0, 0), 0.0)


def test_what_is_pressed_on_rests_where_the_contact_bears_it():
    """``F e^-d / (1 - e^-d) = f`` at the gap ``range log(1 + F / f)``."""
    found = ms.path(STILL, 40_000.0, poses=HELD, force=(0, 0, -3.0), contact=0.02)
    # there is no thrust, so it is the force that presses, F = f
    assert found.gap[-1] == pytest.approx(0.02 * np.log(2.0), rel=1e-3)
    assert float(found.gap.min()) > 0.0
    assert found.attrs["outcome"] == "touched"


@pytest.mark.parametrize("tilt", [0.3, 1.2])
def test_nothing_gets_through_the_wall(tilt):
    found = ms.path(
        ROBOT, 30.0, poses=POSES, position=(0, 0, 3.0), tilt=tilt, force=(0, 0, -2000.0)
    )
    assert float(found.gap.min()) > 0.0
    assert found.attrs["outcome"] == "touched"


def test_a_start_within_the_wall_is_refused():
    with pytest.raises(ms.SpecError, match="into the boundary"):
        ms.path(ROBOT, 1.0, poses=POSES, position=(0, 0, 0.3))


def test_work_of_motor_and_weight_is_what_the_fluid_takes_up_beside_a_wall():
    found = ms.path(
        ROBOT, 5.0, poses=POSES, position=(0, 0, 0.9), force=(0, 0, -1.0), tolerance=1e-9
    )
    fell = float(found.position[0, 2] - found.position[-1, 2])
    given = float(found.motor_work[-1]) + fell
    assert abs(fell) > 1e-3
    assert given == pytest.approx(float(found.dissipated[-1]), rel=1e-6, abs=1e-6)


def test_the_start_is_that_of_the_wall_and_far_away_is_free():
    near = ms.path(ROBOT, 0.1, poses=POSES)
    assert np.allclose(near.position[0], [0.0, 0.0, 1.0])
    far = ms.path(ROBOT, 3.0, poses=POSES, position=(0, 0, 1e5), quaternion=(1, 0, 0, 0))
    free = ms.path(ROBOT, 3.0, gait=POSES.gait, position=(0, 0, 1e5))
    assert far.attrs["outcome"] == "free"
    assert np.allclose(far.position, free.position, atol=1e-4)


@pytest.mark.parametrize(("rate", "tilt"), [(2.0, -0.5), (2.0, 0.5), (50.0, 0.0)])
def test_a_shear_presses_nothing_through_the_wall(rate, tilt):
    """It turns the robot over, tail onto the wall, again and again."""
    swimmer = replace(ROBOT, flow=ms.ShearFlow(rate=rate))
    found = ms.path(swimmer, 30.0, poses=POSES, position=(0, 0, 2.1), tilt=tilt, samples=400)
    assert 0.0 < float(found.gap.min()) < 0.015  # three ranges of the contact


def test_a_flow_onto_the_wall_presses_as_in_free_fluid():
    """Across a closing gap ``R (U + D)`` has the force of free fluid; far off D is nothing."""
    rng, q = np.random.default_rng(5), np.array([1.0, 0.0, 0.0, 0.0])
    numbers, free = POSES.table.numbers, POSES.gait.resistance(0.0)
    for height in (0.50001, 0.51, 0.6, 1.0):
        R, F, touch = np.empty((6, 6)), np.empty(6), np.empty(14)
        resist(POSES.table, np.array([0, 0, height]), q, 0.0, R, F, touch, np.empty(WORK))
        U, D, turned = rng.normal(size=6), np.zeros(6), np.zeros(6)
        kept_off_wall(numbers, touch, R, free, U, D, np.empty(90))
        kept_off_wall(numbers, np.roll(touch, 7), R, free, U, turned, np.empty(90))
        assert pytest.approx(turned, rel=1e-9) == D  # whichever part is nearer
        N = np.concatenate([touch[4:7], touch[1:4]])
        held, alone = (N @ (U + D), N @ U) / (N @ np.linalg.solve(R, N))
        there = N @ U / (N @ np.linalg.solve(free, N))
        assert min(abs(there), abs(alone)) * 0.999 <= abs(held) <= abs(alone)
        if height < 0.501:
            assert abs(held) < 2.0 * abs(there) < 0.1 * abs(alone)
        if height == 1.0:
            assert not D.any()


def test_the_motor_spends_more_where_the_wall_holds_the_tail():
    """``G = F_p . R^-1 F_p + P`` with P as the table has it."""
    numbers = POSES.table.numbers.copy()
    numbers[beside_wall.POWER] = 0.3
    factors = POSES.table.factors.copy()
    factors[..., 27] = 0.0
    table = POSES.table._replace(numbers=numbers, factors=factors)
    R, F, touch, q = np.empty((6, 6)), np.empty(6), np.empty(14), np.array([1.0, 0, 0, 0])
    spent = []
    for height in (1.0, 0.5007):  # and below the smallest gap solved
        G = resist(table, np.array([0, 0, height]), q, 0.4, R, F, touch, np.empty(WORK))
        spent.append(G - F @ np.linalg.solve(R, F))
    assert spent[0] == pytest.approx(0.3)
    assert spent[1] > 0.3  # lubrication holds it back


def test_noise_beside_a_wall_keeps_boltzmanns_distribution():
    """Gaps that start as ``exp(-f gap / k_B T)`` stay so, though the mobility falls to nothing.

    Without the drift k_B T div M their mean would fall by 0.024, eight sigma.
    """
    energy, force, n, steps, time = 1.0, 2.0, 3000, 60, 200.0
    loads = loads_of(STILL, HELD.gait, (0, 0, -force), (0, 0, 0), 0.005)
    random = np.random.default_rng(0)
    gap = random.exponential(energy / force, n) + 0.01
    X, Q = np.zeros((n, 3)), np.tile([1.0, 0, 0, 0], (n, 1))
    X[:, 2] = height(HELD) + gap
    least = np.full(n, np.inf)
    for _ in range(steps):
        normals = random.standard_normal((1, n, NORMALS))
        scatter.over(n)(
            HELD.table, loads, energy, 1.0, 0.0, time / steps, X, Q, 0.0, normals, least
        )
    change = X[:, 2] - height(HELD) - gap
    assert change.std() > 0.1  # they have moved
    assert abs(change.mean()) < 4.0 * change.std() / np.sqrt(n)
    assert least.min() > 0.0
