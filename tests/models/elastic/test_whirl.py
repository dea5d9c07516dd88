"""Tails whose tilted base turns about s: closed forms, limits and laws."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.models.elastic.filament import filament
from microswim.models.elastic.space import DragInSpace, balance_in_space, pose
from microswim.models.elastic.whirl import Whirl, whirl
from microswim.swimmer.geometry.tails.elastic.rest_shape import drawn_at_rest, helix_at_rest
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


@pytest.mark.parametrize("turning", [0.3, 30.0])
def test_a_hook_gives_way_in_space_as_in_two_planes(turning):
    tilt, one = 0.01, swimmer(3.0, 0.01)
    hook = ms.Hook(stiffness=turning * one.numbers["tail.bending"] * 0.05, length=0.05)
    force = -ms.summary(replace(one, hook=hook).gait())["held_wrench"][0]
    truth = 2.0 * thrust(3.0, "clamped", "pivot", turning) * 0.5 * RATE * tilt**2
    assert force == pytest.approx(truth, rel=1e-3)
    settled = replace(one, hook=hook).settled  # a tail like any other, without a hook
    assert settled.hook is None
    found = -ms.summary(settled.gait("rft"))["held_wrench"][0]
    assert found == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize(("hand", "pitch"), [("left", -0.4), ("right", 0.4)])
def test_a_stiff_helix_is_the_helix(hand, pitch):
    radius = 0.05
    arc = np.hypot(2.0 * np.pi * radius, pitch)
    stiff = swimmer(0.02, 0.0, spin=True, **FREE)
    bent: Any = replace(stiff.tail, rest_radius=radius, rest_pitch=pitch)  # type: ignore[call-arg]
    stiff = replace(stiff, tail=bent)
    helix = ms.HelicalTail(
        length=abs(pitch) / arc, amplitude=radius, wavelength=abs(pitch), radius=0.02,
        ramp=0.0, handedness=hand, frequency=1.0 if hand == "left" else -1.0,
    )  # fmt: skip
    sense = 1.0 if hand == "left" else -1.0  # a motor turns a right-handed helix the other way
    ours, other = stiff.with_({"tail.frequency": sense}).gait(), replace(stiff, tail=helix).gait()
    np.testing.assert_allclose(np.abs(ours.mean_velocity), np.abs(other.mean_velocity), atol=1e-6)
    assert np.sign(ours.mean_velocity[0]) == -1.0
    unchosen = ms.Lighthill()  # of the pitch at rest, where no wavelength is given
    pair = [unchosen.pair(t, 1.0) for t in (replace(bent, bending=1.0), helix)]
    np.testing.assert_allclose(pair[0], pair[1])
    x = np.linspace(0.0, 2.0, 300)
    angle = 2.0 * np.pi * x / pitch
    points = np.stack([x, radius * np.cos(angle), radius * np.sin(angle)], axis=1)[
        x <= abs(pitch) / arc
    ]
    drawn = replace(bent, rest_radius=None, rest_pitch=None, rest=points, frequency=sense)
    found = replace(stiff, tail=drawn).gait()
    np.testing.assert_allclose(found.mean_velocity, ours.mean_velocity, rtol=0.02, atol=1e-6)


def test_an_arc_begins_along_s_and_a_drawn_shape_comes_back():
    arc = helix_at_rest(0.5, 0.0)
    made = pose(filament(8, twisting=0.7, rest=arc), filament(8, twisting=0.7, rest=arc).rest)
    np.testing.assert_allclose(made.place[-1], [0.5 * np.sin(2.0), 0.5 * (1 - np.cos(2.0)), 0.0],
                               atol=1e-12)  # fmt: skip
    x = np.linspace(0.0, 1.0, 60)
    points = np.stack([x, 0.1 * np.sin(3.0 * x), 0.2 * x**2], axis=1)
    drawn = drawn_at_rest(points)
    rod = filament(16, twisting=0.7, rest=drawn)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    np.testing.assert_allclose(pose(rod, rod.rest).place[-1] * length, points[-1], atol=1e-3)


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
        drag = DragInSpace(5e5 * rate, 1e6 * rate, rate, 0.0, np.zeros((6, 6)), 0.0, ())
        n, q = 10, np.zeros((3, 10))
        at = Whirl(drag, filament(n, twisting=twisting), 1.0, q, np.zeros(6), 0)
        # twist of the straight rod, -w c_r (1 - s), makes K q balance the torque of spin
        q[2] = -at.balance.residual[2 * n :] / twisting
        return np.real(replace(at, shape=q).rates).max() > 0.0

    for twisting in (0.67, 2.0):
        assert not grows(8.8, twisting)
        assert grows(8.95, twisting)


@pytest.mark.parametrize("crooked", [False, True])
def test_derivatives_of_the_balance(crooked):
    """Against differences, at a crooked shape with all that moves moving."""
    rng = np.random.default_rng(0)
    hook, rest = (0.8, helix_at_rest(0.1, -0.7)) if crooked else (None, None)
    shapes = filament(6, twisting=0.7, tilt=0.4, hook=hook, rest=rest)
    A = rng.normal(size=(6, 6))
    drag = DragInSpace(1.0, 2.0, 0.3, 0.1, A @ A.T, 0.2, (0, 1, 2, 3, 4, 5))
    q, V, h = 0.3 * rng.normal(size=(3, shapes.count)), rng.normal(size=6), 1e-6
    at = balance_in_space(shapes, drag, pose(shapes, q), q, V, 1.3)
    for k in range(q.size):
        ends = []
        for step in (h, -h):
            other = q.ravel().copy()
            other[k] += step
            other = other.reshape(3, -1)
            ends.append(balance_in_space(shapes, drag, pose(shapes, other), other, V, 1.3))
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
