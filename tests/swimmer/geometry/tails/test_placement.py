"""A tail placed in the body frame by a rigid motion, and ahead by its phase."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import microswim as ms
from microswim.swimmer.geometry.tails.placement import Placement

WAVE = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}
numbers = st.floats(-1.0, 1.0)
axes = st.tuples(numbers, numbers, numbers).filter(lambda d: sum(x * x for x in d) > 1e-4)


@given(axes)
def test_the_rotation_takes_s_to_the_axis_by_the_shortest_turn(axis):
    A = Placement(axis=axis).rotation
    d = np.array(axis) / np.linalg.norm(axis)
    assert np.allclose(A @ A.T, np.eye(3), atol=1e-7)
    assert np.linalg.det(A) == pytest.approx(1.0, abs=1e-7)
    assert np.allclose(A[:, 0], d, atol=1e-7)
    angle = np.arccos(np.clip(0.5 * (np.trace(A) - 1.0), -1.0, 1.0))
    assert angle == pytest.approx(np.arccos(np.clip(d[0], -1.0, 1.0)), abs=1e-3)


def test_straight_back_is_half_a_turn_about_r():
    assert np.array_equal(Placement(axis=(-2.0, 0.0, 0.0)).rotation, np.diag([-1.0, -1.0, 1.0]))


def test_a_placed_tail_is_its_own_moved_and_ahead():
    place = {"position": (0.1, 0.2, -0.3), "direction": (1.0, 2.0, -0.5)}
    tail = ms.HelicalTail(**WAVE, **place, phase=0.7)
    own, s = ms.HelicalTail(**WAVE), np.linspace(0.0, 2.0, 7)
    assert tail.own == own
    assert own.own is own
    A = tail.placement.rotation
    P, slope, velocity = tail.centreline(s, 0.2)
    P0, slope0, velocity0 = own.centreline(s, 0.9)
    assert np.allclose(P, np.array(place["position"]) + P0 @ A.T)
    assert np.allclose(slope, slope0 @ A.T)
    assert np.allclose(velocity, velocity0 @ A.T)
    step = 1e-6
    ahead, behind = tail.centreline(s, 0.2 + step)[0], tail.centreline(s, 0.2 - step)[0]
    assert np.allclose(velocity, (ahead - behind) / (2.0 * step), atol=1e-8)
    assert np.allclose(tail.placement.seen(tail.placement.placed(P0)), P0)


@pytest.mark.parametrize(
    ("place", "rigid", "placed"),
    [
        ({}, True, False),
        ({"position": (0, 0, 0), "direction": (2, 0, 0), "phase": 0}, True, False),
        ({"position": (0.1, 0, 0), "phase": 1.0}, True, True),
        ({"position": (0, 0.1, 0)}, False, True),
        ({"direction": (1, 0, 0.1)}, False, True),
        ({"direction": (-1, 0, 0)}, False, True),
    ],
)
def test_only_a_tail_on_the_axis_turns_as_a_whole_about_s(place, rigid, placed):
    tail = ms.HelicalTail(**WAVE, **place)
    assert (tail.is_rigid, tail.is_placed, tail.in_batches) == (rigid, placed, not placed)
    assert ms.PlaneWaveTail(**WAVE, **place).is_planar is rigid


def test_how_far_along_s_a_tail_reaches():
    assert ms.HelicalTail(**WAVE).reach == 2.0
    assert ms.HelicalTail(**WAVE, position=(0.5, 0, 0), direction=(3, 4, 0)).reach == pytest.approx(
        0.5 + 2.0 * 0.6
    )
    assert ms.HelicalTail(**WAVE, position=(0.5, 0, 0), direction=(-1, 0, 0)).reach == 0.5


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("position", (0, 1)),
        ("position", "here"),
        ("position", (0, np.nan, 0)),
        ("direction", (0, 0, 0)),
        ("direction", 1.0),
        ("phase", np.inf),
        ("phase", (1, 2)),
    ],
)
@pytest.mark.parametrize("kind", [ms.HelicalTail, ms.PlaneWaveTail])
def test_what_is_no_place_is_refused_in_a_sentence(field, value, kind):
    with pytest.raises(ms.SpecError, match=rf"^tail\.{field}.*must be"):
        kind(**WAVE, **{field: value})


def test_a_ribbon_s_normal_turns_with_the_tail():
    ribbon = {k: v for k, v in WAVE.items() if k != "radius"} | {"section": (0.05, 0.02)}
    tail = ms.HelicalTail(**ribbon, direction=(1, 1, 0), phase=0.4)
    A, s = tail.placement.rotation, np.linspace(0, 2, 5)
    assert np.allclose(tail.radial(s, 0.1), ms.HelicalTail(**ribbon).radial(s, 0.5) @ A.T)


def test_tails_that_make_no_set_are_refused():
    one = ms.HelicalTail(**WAVE)
    for tails, match in (
        ((one,), "two to 100"),
        ((one, "helix"), r"tail\[1\]"),
        ((one, ms.NoTail()), r"tail\[1\]\.kind"),
        ((one, ms.HelicalTail(**WAVE, frequency=2.01)), r"tail\[1\]\.frequency"),
        ((one,) * 101, "two to 100"),
    ):
        with pytest.raises(ms.SpecError, match=match):
            ms.SeveralTails(tails=tails)
