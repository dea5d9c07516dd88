"""Tails whose tilted base turns about s: closed forms, limits and laws."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.models.elastic.rod import rod
from microswim.models.elastic.space import DragInSpace, balance_in_space, pose
from microswim.models.elastic.whirl import Whirl, whirl
from oracles.elastic_filament import thrust

RATE = 2.0 * np.pi


def swimmer(sperm_number, tilt, *, ratio=0.5, spin=False, frequency=1.0, **parts):
    """A swimmer whose tail has c_n = 1 and length 1, held unless said otherwise."""
    tail = ms.ElasticTail(
        length=1.0, radius=0.02, bending=RATE / sperm_number**4, drive="rotate", angle=tilt,
        frequency=frequency,
    )  # fmt: skip
    parts = {"body": ms.NoBody(), "motion": ms.Motion(free="none")} | parts
    law = ms.Constant(normal=1.0, tangential=ratio, spin=spin)
    return ms.Swimmer(tail=tail, fluid=ms.Fluid(viscosity=1.0), coefficients=law, **parts)


FREE = {"body": ms.Sphere(radius=0.2), "motion": ms.Motion()}


@pytest.mark.parametrize("sperm_number", [1.0, 2.0, 4.0])
def test_thrust_of_a_small_tilt_is_that_of_two_pivots(sperm_number):
    """Two pivots a quarter period apart make a turn, and their thrusts add."""
    tilt = 0.01
    force = -ms.summary(swimmer(sperm_number, tilt).gait())["held_wrench"][0]
    truth = 2.0 * thrust(sperm_number, "clamped", "pivot") * 0.5 * RATE * tilt**2
    assert force == pytest.approx(truth, rel=5e-4)


def test_a_stiff_tail_turns_as_one():
    stiff = swimmer(0.02, 0.5, spin=True, **FREE)
    tail: Any = stiff.tail
    rigid = ms.CustomTail(
        shape=lambda s, phase: tail.stiff(s, phase)[0],
        length=1.0, radius=0.02, surface_motion="rigid",
    )  # fmt: skip
    phases = np.linspace(0.0, RATE, 7)
    one, other = stiff.gait(), replace(stiff, tail=rigid).gait("rft")
    np.testing.assert_allclose(one.velocity(phases), other.velocity(phases), atol=1e-5)
    assert one.mean_torque == pytest.approx(other.mean_torque, rel=1e-5)


def test_the_gait_is_that_of_the_settled_tail():
    one = swimmer(3.0, 0.5, spin=True, **FREE)
    ours, other = one.gait(), one.settled.gait("rft")
    phases = np.linspace(0.0, RATE, 7)
    np.testing.assert_allclose(ours.velocity(phases), other.velocity(phases), atol=1e-8)
    found = whirl(one)
    np.testing.assert_allclose(found.velocity, ours.velocity(0.0) / ours.rate, atol=1e-8)


def test_the_motor_gives_what_the_fluid_takes():
    """Torque about s on the held base, times the rate."""
    gait = swimmer(3.0, 0.6, spin=True).gait()
    torque = ms.summary(gait)["held_wrench"][3]
    assert -torque * gait.rate == pytest.approx(gait.mean_power, rel=1e-8)


def test_backwards_is_the_mirror_image():
    one, other = (swimmer(3.0, 0.5, spin=True, frequency=f, **FREE).gait() for f in (1.0, -1.0))
    signs = np.array([1, 1, 1, -1, -1, -1])
    np.testing.assert_allclose(
        one.mean_velocity[[0, 3]], (signs * other.mean_velocity)[[0, 3]], atol=1e-9
    )
    assert one.mean_velocity[0] < 0.0  # it pushes its body ahead, whichever way it turns


def test_a_twirling_rod_whirls_beyond_its_critical_rate():
    """A straight rod turned about its own axis whirls at ``w c_r L^2 / B = 8.9``, whatever its
    twisting stiffness."""

    def grows(rate, twisting):
        drag = DragInSpace(5e5 * rate, 1e6 * rate, rate, 0.0, np.zeros((6, 6)), 0.0, (), twisting)
        n, q = 10, np.zeros((3, 10))
        at = Whirl(drag, rod(n), 0.0, 1.0, q, np.zeros(6), 0)
        # twist of the straight rod, -w c_r (1 - s), makes K q balance the torque of spin
        q[2] = -at.balance.residual[2 * n :] / twisting
        return np.real(replace(at, shape=q).rates).max() > 0.0

    for twisting in (0.67, 2.0):
        assert not grows(8.8, twisting)
        assert grows(8.95, twisting)


def test_derivatives_of_the_balance():
    """Against differences, at a crooked shape with all that moves moving."""
    shapes, rng = rod(6), np.random.default_rng(0)
    A = rng.normal(size=(6, 6))
    drag = DragInSpace(1.0, 2.0, 0.3, 0.1, A @ A.T, 0.2, (0, 1, 2, 3, 4, 5), 0.7)
    q, V, h = 0.3 * rng.normal(size=(3, 6)), rng.normal(size=6), 1e-6
    at = balance_in_space(shapes, drag, pose(shapes, q, 0.4), q, V, 1.3)
    for k in range(18):
        ends = []
        for step in (h, -h):
            other = q.ravel().copy()
            other[k] += step
            other = other.reshape(3, 6)
            ends.append(balance_in_space(shapes, drag, pose(shapes, other, 0.4), other, V, 1.3))
        slope = (ends[0].residual - ends[1].residual) / (2.0 * h)
        np.testing.assert_allclose(at.stiffness[:, k], slope, atol=1e-7)


def test_derivatives_by_the_spec_are_exact():
    one = swimmer(2.0, 0.5, spin=True, **FREE)
    for name in ("tail.bending", "body.radius", "tail.angle"):
        slope, value, h = one.gradient("mean_power", name)[name], one.numbers[name], 1e-4
        ends = [one.with_({name: value * (1.0 + d)}).gait().mean_power for d in (-h, h)]
        assert slope == pytest.approx((ends[1] - ends[0]) / (2.0 * h * value), rel=1e-4)


def test_a_body_unlike_across_s_is_refused():
    body = ms.Ellipsoid(semi_axes=(0.3, 0.2, 0.1))
    with pytest.raises(ms.SpecError, match="alike in all directions"):
        swimmer(2.0, 0.5, body=body, motion=ms.Motion()).gait()


def test_directors_stay_unit_and_at_right_angles():
    D = whirl(swimmer(4.0, 0.5, spin=True)).pose.directors
    np.testing.assert_allclose(
        D @ np.swapaxes(D, 1, 2), np.eye(3)[None].repeat(len(D), 0), atol=1e-8
    )
