"""Which end of a swimmer leads, by its motion over a period."""

import numpy as np
import pytest

import microswim as ms
from microswim.gait.screw import leading_end


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
