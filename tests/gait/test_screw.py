"""Which end of a swimmer leads, by its motion over a period."""

import numpy as np
import pytest

import microswim as ms
from microswim.gait.screw import leading_end, way_of


@pytest.mark.parametrize("bending", [1e-13, 1e-14])
def test_the_end_that_leads_is_that_of_the_path_also_where_the_mean_of_u_s_points_back(bending):
    soft = ms.Swimmer.preset("soft/heaving").with_({"tail.bending": bending})
    gait = soft.gait()
    way = ms.trajectory(gait, np.array([0.0, 20.0]) * gait.period).position[-1]
    assert gait.mean_velocity[0] > 0 > way[0]  # s points from the body to the tail
    assert leading_end(gait) == "body"
    assert leading_end(ms.Swimmer.preset("goto/C", {"tail.frequency": "-70 Hz"}).gait()) == "tail"
    told = ms.report.numbers_table(ms.io.numbers(soft, gait), "soft").rows[1]
    assert "it goes body first" in told[2]


def test_what_the_sign_of_u_s_says_is_said_of_what_is_there():
    """A wave without a body has a joint in front; a helix turned the other way goes tail first."""
    wave = ms.Swimmer.preset("tabak/plane_wave")
    bare = ms.Swimmer(body=ms.NoBody(), tail=wave.tail, fluid=wave.fluid)
    for swimmer, told in (
        (wave, "negative: the body leads"),
        (bare, "negative: the joint leads"),
        (wave.with_({"tail.frequency": -1.0}), "positive: the tail leads"),
    ):
        assert way_of(ms.io.numbers(swimmer, swimmer.gait())) == told
