"""Paths beside a wall: contact, noise in equilibrium, energy; by a wall that is made up.

The wall adds to R what grows towards contact; nothing is solved, for the laws hold whatever it is.
"""

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses import fit, layout
from microswim.calibration.poses.solved import SolvedPoses
from microswim.calibration.poses.wall import start_of
from microswim.gait.poses import beside_wall
from microswim.gait.poses.table import WALL, PoseTable
from microswim.gait.stepping import pack
from microswim.path.brownian import NORMALS, scatter
from microswim.path.loads import loads_of

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
STILL = ROBOT.with_({"tail.frequency": 0.0, "motion.free": ("us", "uq", "ur")})
ADDED = np.zeros(27)
ADDED[:6] = -0.9, -0.3, -0.3, -0.3, -0.3, -0.3  # to log D, times xi, which is negative
ADDED[[6, 12]] = 0.05, -0.05


def beside(swimmer, distance=1.0):
    """A gait at every pose beside the made-up wall."""
    shape = layout.shape_of(swimmer, 0.01)
    lowest = float(shape.numbers[beside_wall.LOWEST])
    values = np.empty((2, 9, 7, 9, 27))
    for i in range(9):
        values[:, i] = lowest * (1 - i / 8) * ADDED
    gait = swimmer.gait()
    table = PoseTable(
        WALL, pack(gait), np.array([0.0, 0, 0, 0, 0, 1]), shape.numbers, shape.body, shape.tail,
        shape.kinks, fit.coefficients(values),
    )  # fmt: skip
    return SolvedPoses(gait, table, start_of(ms.Wall(distance)), {})


POSES, HELD = beside(ROBOT), beside(STILL)


def height(poses):
    """Height of the centre where the surface touches the wall, at the lab's axes."""
    return 2.0 - poses.gap((0, 0, 2.0), (1, 0, 0, 0), 0.0)


def test_what_is_pressed_on_rests_where_the_contact_bears_it():
    """``F e^-d / (1 - e^-d) = f`` at the gap ``range log(1 + F / f)``."""
    size = loads_of(STILL, HELD.gait, (0, 0, -3.0)).contact[0]
    found = ms.path(STILL, 40_000.0, poses=HELD, force=(0, 0, -3.0), contact=0.02)
    assert size == pytest.approx(3.0)  # there is no thrust, so it is the force that presses
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
