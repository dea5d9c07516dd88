"""The long axis of a body alone, and frames that begin with it."""

import numpy as np
import pytest

from microswim.gait.turning.long_axis import long_axis, seen_along
from microswim.gait.turning.steady_turning import SteadyTurning


def any_mobility(seed):
    A = np.random.default_rng(seed).standard_normal((6, 6))
    return (A @ A.T + np.diag([1.0, 1.0, 1.0, 40.0, 2.0, 2.0]))[:, 3:]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_frame_that_begins_with_another_axis_has_the_same_states(axis):
    mobility, moment = any_mobility(3), np.array([0.4, 1.0, -0.3])
    here = SteadyTurning(mobility, moment, 0.8)
    there = SteadyTurning(seen_along(axis, mobility), seen_along(axis, moment), 0.8)
    assert there.step_out == pytest.approx(here.step_out, rel=1e-6)
    rate = 0.6 * here.step_out
    velocity = sorted(float(s.velocity) for s in here.states(rate))  # with its sign: its sense
    assert sorted(float(s.velocity) for s in there.states(rate)) == pytest.approx(velocity)
    back = seen_along((3 - axis) % 3, seen_along(axis, mobility))
    assert (back == mobility).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_long_axis_is_the_one_about_which_it_turns_easily(axis):
    assert long_axis(seen_along((3 - axis) % 3, any_mobility(3))) == axis


def test_of_a_disc_or_a_ball_none_stands_out():
    M = np.zeros((6, 3))
    for turning in ((1.0, 1.0, 1.0), (1.0, 2.0, 2.0), (2.0, 1.0, 2.0)):
        M[3:] = np.diag(turning)
        assert long_axis(M) == 0
