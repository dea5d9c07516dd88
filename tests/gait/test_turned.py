"""Gaits that one phase tells are known as such, and no others; both ways give one number."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms

HELIX = ms.Swimmer.preset("tabak/helix")


def by_all_phases(gait):
    """The same gait with a harmonic of nothing: it is no longer seen to be turned."""
    more = np.zeros((2, 6, 6))
    return replace(gait, resistance_series=np.concatenate([gait.resistance_series, more]))


@pytest.mark.parametrize("hand", ["left", "right"])
def test_one_phase_gives_what_all_give(hand):
    gait = HELIX.with_({"tail.handedness": hand}).gait()
    other = by_all_phases(gait)
    assert gait._velocities.shape == (1, 6)
    assert other._velocities.shape == (other.samples, 6)
    for name in ("mean_velocity", "velocity_amplitude", "mean_power", "efficiency"):
        assert getattr(gait, name) == pytest.approx(getattr(other, name), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(("hand", "rate"), [("left", 1.0), ("right", 1.0), ("left", -0.5)])
def test_the_closed_screw_is_the_one_that_steps_find(hand, rate):
    gait = HELIX.with_({"tail.handedness": hand}).gait().at_rate(rate)
    closed, stepped = ms.screw(gait), ms.screw(gait, steps=512)
    assert closed.displacement == pytest.approx(stepped.displacement, abs=1e-9)
    assert closed.quaternion == pytest.approx(stepped.quaternion, abs=1e-9)


@pytest.mark.parametrize(
    "changes",
    [
        {"motion.free": ["us", "uq", "os"]},
        {"interaction.translation": [1.0, 1.0, 1.5]},
        {"body.shape": "ellipsoid", "body.semi_axes": [0.6, 0.5, 0.4]},
    ],
)
def test_what_is_not_alike_in_q_and_r_is_asked_at_every_phase(changes):
    changes = {"motion.free": "all"} | changes
    if "body.shape" in changes:
        swimmer = replace(HELIX, body=ms.Ellipsoid(semi_axes=(0.6, 0.5, 0.4)))
    else:
        swimmer = ms.Swimmer.preset("tabak/helix", changes)
    gait = swimmer.gait("rft")
    assert len(gait._velocities) == gait.samples


def test_a_derivative_that_breaks_the_symmetry_is_kept():
    """The value is turned rigidly, its derivative by one semi-axis across is not."""
    round_ = replace(HELIX, body=ms.Ellipsoid(semi_axes=(0.6, 0.5, 0.5)))
    exact = round_.gradient("mean_velocity", "body.semi_axes[1]")["body.semi_axes[1]"]
    ends = []
    for h in (1e-5, -1e-5):
        moved = replace(HELIX, body=ms.Ellipsoid(semi_axes=(0.6, 0.5 + h, 0.5)))
        ends.append(moved.gait("rft").mean_velocity)
    assert exact == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-4, abs=1e-7)
