"""A swimmer in its wall or outside of its channel is refused by every model, the quick ones too."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses.layout import shape_of
from microswim.calibration.poses.solved import FEW

WALLED = {"wall.distance": 1.0}


@pytest.mark.parametrize("model", ["rft", "auto", "bem"])
def test_no_model_answers_within_a_wall(model):
    robot = ms.Swimmer.preset("tabak/helix", {"wall.distance": 0.3})
    with pytest.raises(ms.SpecError, match=r"wall.distance = 0.3: must be more than 0.5"):
        robot.gait(model)


def test_each_of_several_tails_counts():
    """Left on its own, the tail that leans to the wall is as near as the pair is."""
    pair = ms.Swimmer.preset("several/two-tails", WALLED)
    with pytest.raises(ms.SpecError, match="more than") as both:
        pair.with_({"wall.distance": 0.6}).gait()
    least = float(str(both.value).partition("more than ")[2].partition(",")[0])
    tip = ms.Swimmer.preset("several/two-tails").tail.each[1]  # the one towards -q
    s, phase = np.meshgrid(np.linspace(0, 2.0, 400), np.linspace(0, 2 * np.pi, 200))
    line = tip.own.centreline(s, phase)[0] @ np.asarray(tip.placement.rotation).T
    q = (line + tip.placement.root)[..., 1]
    assert least == pytest.approx(0.05 - q.min(), rel=2e-3)
    assert pair.with_({"wall.distance": 1.05 * least}).gait().mean_velocity[0] < 0


def test_a_tail_that_bends_is_looked_at_by_its_body_alone():
    heaving = ms.Swimmer.preset("soft/heaving")
    far = 20.0 * float(heaving.tail.apparent_length)
    assert np.isfinite(replace(heaving, wall=ms.Wall(far)).gait().mean_velocity).all()
    with pytest.raises(ms.SpecError, match=r"wall\.distance"):
        replace(heaving, wall=ms.Wall(1e-6 * far)).gait()


def test_a_channel_that_is_too_narrow_is_refused():
    narrow = {"channel.diameter": 0.9, "channel.length": 10.0}
    with pytest.raises(ms.SpecError, match=r"channel\.diameter"):
        ms.Swimmer.preset("tabak/helix", narrow).gait()


def test_a_pose_is_solved_at_its_own_phase_though_others_would_reach_into_the_wall():
    """A path asks for poses of one phase each, with the tail close to the wall."""
    robot = ms.Swimmer.preset("tabak/helix")
    shape = shape_of(robot, 0.01)
    heights = [(shape.touch(-0.5, psi), psi) for psi in np.linspace(0.0, 6.0, 25)]
    (low, psi), (high, _) = min(heights), max(heights)
    assert high > low + 0.05
    azimuth = -robot.tail.sign * psi
    walled = replace(robot, wall=ms.Wall(0.5 * (low + high), tilt=-0.5, azimuth=azimuth))
    with pytest.raises(ms.SpecError, match=r"wall\.distance"):
        walled.gait("rft")
    assert np.isfinite(walled.gait("bem", level=FEW).resistance(0.0)).all()
