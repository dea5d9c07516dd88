"""Resistances in balance with the propulsion of a turning tail."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microswim as ms
from microswim.models.bem.balance import balanced, turning_of
from microswim.models.bem.patches.surface import Surface
from microswim.models.bem.solution import solve


def robot(semi_axis: float = 0.8) -> ms.Swimmer:
    """A spheroid of a fifth of the amplitude on a steep helix."""
    return ms.Swimmer(
        body=ms.Spheroid(semi_axes=(semi_axis, 0.35)),
        tail=ms.HelicalTail(length=3.7, amplitude=2.5, waves=0.6, radius=0.15, ramp=0.17),
        fluid=ms.Fluid(viscosity=1.0),
    )


def u_s(swimmer: ms.Swimmer, level: str) -> float:
    """Mean forward velocity by boundary elements."""
    return float(swimmer.gait("bem", level=level).mean_velocity[0])


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**31), count=st.integers(0, 3), number=st.integers(1, 2))
def test_products_with_twists_are_the_computed_ones(seed, count, number):
    rng = np.random.default_rng(seed)
    n = 6 * number
    root = rng.normal(size=(n, n))
    skew = rng.normal(size=(n, n))
    raw = root @ root.T + np.eye(n) + 0.1 * (skew - skew.T)
    W = rng.normal(size=(n, count))
    R = balanced(raw, W)
    np.testing.assert_allclose(R, R.T, atol=1e-10 * np.abs(R).max())
    if count == 1:
        np.testing.assert_allclose(R @ W, raw.T @ W, atol=1e-9 * np.abs(raw @ W).max())
    if count == 0:
        np.testing.assert_allclose(R, (raw + raw.T) / 2.0, rtol=1e-12)
    # of no account where nothing is amiss
    fair = (raw + raw.T) / 2.0
    np.testing.assert_allclose(balanced(fair, W), fair, atol=1e-11 * np.abs(fair).max())


def test_turning_the_body_alone_takes_what_the_body_bears():
    found = solve(robot(), level="coarse")
    alone = found.resistance[:, 3] - found.propulsion
    bears = found.body_resistance[3]
    scale = np.sqrt(found.resistance.diagonal() * found.resistance[3, 3])
    np.testing.assert_allclose(alone / scale, bears / scale, atol=1e-12)


def test_speed_with_a_small_body_depends_smoothly_on_its_size():
    # the patches about the joint are others for each: u_s had jumped by 5 %, up and down
    lengths = 0.8 * np.array([0.94, 0.96, 0.98, 1.0, 1.02, 1.04, 1.06])
    speeds = np.array([u_s(robot(a), "coarse") for a in lengths])
    line = np.polyval(np.polyfit(lengths, speeds, 2), lengths)
    assert np.abs(speeds / line - 1.0).max() < 0.02
    assert speeds[3] == pytest.approx(u_s(robot(lengths[3]), "standard"), rel=0.01)


def test_only_a_single_tail_that_turns_rigidly_has_a_twist():
    helix = solve(robot(), level="coarse")
    np.testing.assert_allclose(
        turning_of(helix.surface, helix.centre).T, [np.eye(6)[3]], atol=1e-12
    )
    wave = ms.Swimmer.preset("tabak/plane_wave")
    found = solve(wave, level="coarse")
    assert turning_of(found.surface, found.centre).shape == (6, 0)
    two = [replace(robot().tail, position=(0.0, y, 0.0)) for y in (3.0, -3.0)]
    both = solve(replace(robot(), tail=tuple(two), body=ms.NoBody()), level="coarse")
    assert turning_of(both.surface, both.centre).shape == (6, 0)


def test_tail_off_the_axis_turns_about_its_own():
    tail = replace(robot().tail, direction=(1.0, 0.5, 0.0))
    found = solve(replace(robot(), tail=tail, body=ms.Sphere(radius=0.8)), level="coarse")
    surface: Surface = found.surface
    (twist,) = turning_of(surface, found.centre).T
    np.testing.assert_allclose(
        twist[3:] / np.linalg.norm(twist[3:]), [2 / 5**0.5, 5**-0.5, 0.0], atol=1e-12
    )
    assert abs(twist[:3] @ twist[3:]) < 1e-9 * np.linalg.norm(twist)
