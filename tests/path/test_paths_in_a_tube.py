"""Paths in a tube: contact, energy, Poiseuille's flow; by a tube that is made up.

The tube adds to R what grows towards contact; nothing is solved, for the laws hold whatever it is.
"""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from boundaries import RADIUS, inside

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
ROBOT = replace(ROBOT, channel=ms.Channel(diameter=2 * RADIUS, length=30.0))
STILL = ROBOT.with_({"tail.frequency": 0.0})


POSES = inside(ROBOT)


def test_nothing_gets_through_the_tube():
    found = ms.path(ROBOT, 20.0, poses=POSES, position=(0, 0, 0.3), force=(0, 0, -1000.0))
    assert float(found.gap.min()) > 0.0
    assert found.attrs["outcome"] == "touched"
    assert found.attrs["boundary"] == "tube"


def test_a_start_outside_the_tube_is_refused():
    with pytest.raises(ms.SpecError, match="into the boundary"):
        ms.path(ROBOT, 1.0, poses=POSES, position=(0, 0, 1.2))


def test_work_of_motor_and_weight_is_what_the_fluid_takes_up_in_a_tube():
    found = ms.path(
        ROBOT, 5.0, poses=POSES, position=(0, 0, 0.2), force=(0, 0, -1.0), tolerance=1e-9
    )
    fell = float(found.position[0, 2] - found.position[-1, 2])
    given = float(found.motor_work[-1]) + fell
    assert abs(fell) > 1e-3
    assert given == pytest.approx(float(found.dissipated[-1]), rel=1e-6, abs=1e-6)
    assert float(found.dissipated[-1]) > 0.0


def test_a_swimmer_that_goes_with_the_flow_has_its_velocity_and_rotation():
    """The made-up tube adds nothing to what carries it: ``x' = u(x)``, ``w = curl u / 2``."""
    swimmer = replace(STILL, flow=ms.PoiseuilleFlow(speed=0.5, diameter=2 * RADIUS))
    start = np.array([0.0, 0.3, 0.4])
    found = ms.path(swimmer, 0.2, poses=inside(STILL), position=start, samples=2)
    r2 = 0.25
    moved = found.position.values[-1] - start
    assert moved == pytest.approx([0.2 * 0.5 * (1 - r2 / RADIUS**2), 0.0, 0.0], abs=1e-9)
    turn = 2.0 * found.quaternion.values[-1, 1:] / 0.2
    assert turn == pytest.approx(0.5 * np.array([0.0, -0.4, 0.3]) / RADIUS**2, rel=1e-3)


def test_a_start_on_the_other_side_has_the_path_on_the_other_side():
    """All turned by half a turn about the tube."""
    found = ms.path(ROBOT, 3.0, poses=POSES, position=(0, 0.1, 0.2), samples=4)
    turned = ms.path(
        ROBOT, 3.0, poses=POSES, position=(0, -0.1, -0.2), quaternion=(0, 1, 0, 0), samples=4
    )
    half = np.array([1.0, -1.0, -1.0])
    assert turned.position.values == pytest.approx(half * found.position.values, abs=1e-5)


def test_a_path_that_winds_round_the_axis_is_told():
    found = ms.path(STILL, 30.0, poses=inside(STILL), position=(0, 0.3, 0.3), force=(0.5, 0, 0))
    assert found.attrs["circle_sense"] == ""
    assert found.attrs["outcome"] in ("trapped", "touched")


def test_the_picture_of_a_path_in_a_tube_shows_its_wall():
    found = ms.path(ROBOT, 1.0, poses=POSES, samples=5)
    side, along, _ = ms.plots.path(found).axes
    assert (side.get_ylabel(), along.get_xlabel()) == ("z", "y")
    walls = [line.get_ydata()[0] for line in side.get_lines()[-2:]]
    assert walls == pytest.approx([-RADIUS, RADIUS])
    ring = np.hypot(*along.get_lines()[-1].get_data())
    assert ring == pytest.approx(np.full(ring.size, RADIUS))


@pytest.mark.parametrize(
    ("flow", "said"),
    [
        (ms.ShearFlow(rate=1.0), "flow.kind"),
        (ms.PoiseuilleFlow(speed=1.0, diameter=2.0), "flow.diameter"),
        (ms.PoiseuilleFlow(speed=1.0, diameter=3.0, axis=(0, 1, 0)), "flow.axis"),
        (ms.PoiseuilleFlow(speed=1.0, diameter=3.0, centre=(0, 1, 0)), "flow.centre"),
    ],
)
def test_a_flow_that_slips_on_the_tube_is_refused_before_any_solve(flow, said):
    with pytest.raises(ms.SpecError, match=said):
        ms.path(replace(ROBOT, flow=flow), 1.0)


def test_a_wall_and_a_tube_at_once_are_refused():
    with pytest.raises(ms.SpecError, match="remove the other"):
        ms.path(replace(ROBOT, wall=ms.Wall(1.0)), 1.0)


def test_a_flow_presses_nothing_through_the_tube():
    """What it does to a swimmer held stays bounded as the gap closes, though R grows."""
    sliding = STILL.with_({"motion.free": ("us", "uq", "ur")})
    poses = inside(sliding)
    carried = poses.table.carried.copy()
    carried[3, 0] = 1.0  # along q, outwards
    poses = replace(poses, table=poses.table._replace(carried=carried))
    swimmer = replace(sliding, flow=ms.PoiseuilleFlow(speed=1.0, diameter=2 * RADIUS))
    found = ms.path(swimmer, 30.0, poses=poses, position=(0, 0.5, 0), quaternion=(1, 0, 0, 0))
    assert float(found.gap.min()) > -1e-6 * 3.0  # between steps, as far as they are to be trusted
    assert 0.0 < float(found.gap[-1]) < 0.05
    assert found.attrs["outcome"] == "touched"


def test_a_block_is_told_which_boundary_has_no_path_for_it():
    """The sentence names the table that the spec has."""
    block = ms.Swimmer.preset(
        "shapes/magnet", {"channel.diameter": "9 mm", "channel.length": "20 mm"}
    )
    with pytest.raises(ms.SpecError, match=r"^channel: a path in it .* leave \[channel\] out"):
        ms.path(block, 1.0)
