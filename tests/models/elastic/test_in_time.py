"""Elastic tails followed in time: what they settle to, laws, limits, shapes under loads."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.models.elastic.plane import Loads
from microswim.models.elastic.space import pose
from microswim.models.elastic.statics import static_shape
from microswim.models.elastic.unsteady.loads import pull
from microswim.models.elastic.unsteady.march import at_rest, marched
from microswim.models.elastic.unsteady.numbers import in_time
from microswim.models.elastic.unsteady.swimmer_in_time import derivative, rates

HEADING = [1.0, 0.0, 0.0, 0.0]
LAW = ms.Constant(normal=2.0, tangential=1.2, spin=True)


def swimmer(body=0.2, **tail):
    """A sphere with a filament of length 1; without a body it is held."""
    own = {"length": 1.0, "radius": 0.02, "bending": 0.2} | tail
    held = {"body": ms.NoBody(), "motion": ms.Motion(free="none")}
    parts = {"body": ms.Sphere(radius=body)} if body else held
    return ms.Swimmer(
        tail=ms.ElasticTail(**own), fluid=ms.Fluid(viscosity=1.0), coefficients=LAW, **parts
    )


def march(one, times, tolerance=1e-6, **more):
    return marched(one, at_rest(one, np.zeros(3), HEADING, 0.0), times, tolerance, **more)


AWRY = [(s, 0.1 + 0.1 * np.sin(4.0 * s), 0.0) for s in np.linspace(0.0, 1.0, 21)]
DRIVES = [
    {"drive": "heave", "amplitude": 0.2, "rest": AWRY},
    {"drive": "moment", "moment": 0.5, "wavelength": 1.0, "rest_radius": 0.8},
    {"drive": "rotate", "angle": 0.4, "twisting": 0.3},
    {"drive": "rotate", "rest_radius": 0.05, "rest_pitch": -0.5},
]


@pytest.mark.parametrize("tail", DRIVES)
def test_it_settles_to_the_gait(tail):
    """Work, heat and way of the fifth period are those of the gait, which is found otherwise."""
    one = swimmer(**tail)
    if tail["drive"] == "rotate":
        one = replace(one, hook=ms.Hook(stiffness=0.05, length=0.05))
    gait = one.gait()
    assert gait.info["settling_periods"] < 5.0
    found = march(one, np.linspace(0.0, 5.0, 6)).shapes
    before, last = found[-2:]
    given, took = last.work - before.work
    assert took == pytest.approx(gait.mean_power, rel=2e-4)
    assert given == pytest.approx(took, rel=1e-4)  # elastic energy comes back
    path = ms.trajectory(gait, [0.0, 1.0], quaternion=before.quaternion, phase=before.phase)
    moved = path.position.values[-1] - path.position.values[0]
    np.testing.assert_allclose(last.position - before.position, moved, atol=2e-5)


def test_a_step_in_two_is_the_step():
    """The state holds all that the tail remembers."""
    one = swimmer(drive="pivot", angle=0.5)
    whole = march(one, np.array([0.0, 0.7])).shapes[-1]
    half = march(one, np.array([0.0, 0.3])).shapes[-1]
    rest = marched(one, half, np.array([0.3, 0.7]), 1e-6).shapes[-1]
    np.testing.assert_allclose(rest.position, whole.position, atol=5e-6)
    np.testing.assert_allclose(rest.strains, whole.strains, atol=2e-4)
    assert rest.phase == pytest.approx(whole.phase)


def test_heavy_and_in_a_stream_it_comes_to_rest_as_statics_say():
    tail = {"drive": "none", "bending": 0.02}
    gravity = ms.Gravity(density=1.0, acceleration=100.0, direction=(0.0, -1.0, 0.0))
    heavy = march(replace(swimmer(0, **tail), gravity=gravity), np.array([0.0, 200.0]))
    weight = np.pi * 0.02**2 * 100.0 / 0.02
    _, place = static_shape(Loads(weight=(0.0, -weight)))
    np.testing.assert_allclose(heavy.places[-1, -1, :2], place[-1], atol=2e-5)
    flow = ms.UniformFlow(speed=0.5, direction=(0.0, 1.0, 0.0))
    one = replace(swimmer(0, drive="none", bending=1.0), flow=flow)
    _, place = static_shape(Loads(flow=(0.0, 1.0)), drag=(0.6, 1.0))
    stream = march(one, np.array([0.0, 30.0]))
    np.testing.assert_allclose(stream.places[-1, -1, :2], place[-1], atol=2e-5)


def test_a_stiff_magnetic_filament_turns_as_a_rigid_magnet():
    """Against the path of the same straight tail as a rigid one, its moment in the body."""
    field = ms.RotatingField(strength=1.0, frequency=0.2, axis=(0.0, 0.0, 1.0))
    stiff = replace(swimmer(drive="none", bending=500.0, magnet=(0.6, 0.3, 0.0)), field=field)
    tail: Any = stiff.tail
    rigid = ms.CustomTail(shape=lambda s, phase: tail.stiff(s, phase)[0], length=1.0, radius=0.02,
                          frequency=0.0)  # fmt: skip
    body = replace(stiff, tail=rigid, magnet=ms.Magnet(moment=(0.6, 0.3, 0.0)))
    ours, other = ms.path(stiff, 2.0, samples=3), ms.path(body, 2.0, samples=3, model="rft")
    np.testing.assert_allclose(ours.position, other.position, atol=2e-3)
    q, p = ours.quaternion.values, other.quaternion.values
    np.testing.assert_allclose(np.abs((q * p).sum(axis=1)), 1.0, atol=1e-4)


def test_a_magnetic_part_has_its_share_of_the_moment():
    one = replace(
        swimmer(drive="none", magnet=(1.0, 0.0, 0.0), magnet_span=(0.2, 0.55)),
        field=ms.UniformField(strength=1.0),
    )
    made = in_time(one, 12)
    assert made.loads.moments is not None
    share, s = made.loads.moments[:, 0] * 0.2, made.rod.s  # over bending / length
    assert share.sum() == pytest.approx(1.0, abs=1e-12)
    assert share @ s == pytest.approx(0.375, abs=1e-12)
    assert share @ s**3 == pytest.approx((0.55**4 - 0.2**4) / 4 / 0.35, abs=1e-12)


def test_many_short_links_are_one_that_is_spread_evenly():
    """To second order in their length; a moment for each that is its share is that of them all."""
    starts = np.arange(32) / 32 + 1 / 128
    links = tuple((float(a), float(a) + 1 / 64) for a in starts)
    field = ms.UniformField(strength=1.0, direction=(0.0, 1.0, 0.3))

    def held(**magnet):
        return replace(swimmer(0, drive="none", bending=0.5, **magnet), field=field)

    whole = (1.0, 0.0, 0.0)
    even, linked = held(magnet=whole), held(magnet=whole, magnet_span=links)
    shared = held(magnet=((1 / 32, 0.0, 0.0),) * 32, magnet_span=links)

    def work(one):
        of = in_time(one, 8)
        y = np.concatenate([np.zeros(3), HEADING, of.rod.rest.ravel(), np.zeros(2)])
        return of.moment(0.0, y).balance(0.0, y)[1]

    assert np.abs(work(even)).max() > 0.5
    np.testing.assert_allclose(work(linked), work(even), atol=1e-3)
    np.testing.assert_allclose(work(shared), work(linked), atol=1e-12)


def test_a_stiff_chain_that_the_field_magnetises_turns_as_a_soft_magnet():
    field = ms.RotatingField(strength=1.0, frequency=0.1, axis=(0.0, 0.0, 1.0))
    chain = {"bending": 500.0, "drive": "none", "magnet_span": ((0.0, 0.5), (0.5, 1.0))}
    soft = swimmer(**chain, magnet_susceptibility=(3e-3, 1e-3))
    with pytest.raises(ms.SpecError, match="for a swimmer in SI"):
        ms.path(replace(soft, field=field), 1.0)
    stiff = replace(soft, field=field, units="SI")
    tail: Any = stiff.tail
    rigid = ms.CustomTail(shape=lambda s, phase: tail.stiff(s, phase)[0], length=1.0, radius=0.02,
                          frequency=0.0)  # fmt: skip
    magnet = ms.Magnet(susceptibility=(3e-3, 1e-3, 1e-3), volume=np.pi * 0.02**2)
    body = replace(stiff, tail=rigid, magnet=magnet)
    start = {"samples": 2, "quaternion": [np.cos(0.4), 0.0, 0.0, np.sin(0.4)]}
    ours, other = ms.path(stiff, 0.6, **start), ms.path(body, 0.6, model="rft", **start)
    q, p = ours.quaternion.values, other.quaternion.values
    assert abs(q[-1] @ q[0]) < 0.9995  # it turns by some degrees
    np.testing.assert_allclose(np.abs((q * p).sum(axis=1)), 1.0, atol=1e-4)
    np.testing.assert_allclose(ours.position, other.position, atol=2e-3)


def test_nothing_falls_through_a_wall():
    heavy = replace(
        swimmer(0.1, drive="pivot", angle=0.4), wall=ms.Wall(distance=0.3),
        gravity=ms.Gravity(density=2.0, acceleration=100.0),
    )  # fmt: skip
    found = ms.path(heavy, 3.0, memory=True, samples=31)
    assert found.gap.min() > 0.0
    assert found.gap[-1] < 0.1
    assert found.attrs["outcome"] in ("touched", "trapped")


def test_a_fibre_turns_over_in_a_shear_as_a_slender_rod():
    """A stiff rod without a body, beside the axis of a shear, turns at ``rate sin^2``."""
    tail = ms.ElasticTail(length=1.0, radius=0.02, bending=100.0, drive="none")
    one = ms.Swimmer(
        body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0), coefficients=LAW,
        flow=ms.ShearFlow(rate=1.0, direction=(1, 0, 0), across=(0, 1, 0)),
    )  # fmt: skip
    found = ms.path(one, 1.0, samples=3, quaternion=[np.cos(0.4), 0.0, 0.0, np.sin(0.4)])
    ends = found.filament.values[:, -1] - found.filament.values[:, 0]
    angle = np.arctan2(ends[:, 1], ends[:, 0])
    np.testing.assert_allclose(1.0 / np.tan(angle), 1.0 / np.tan(0.8) + found.time, rtol=5e-3)


def test_the_derivative_that_the_steps_use():
    """Against differences at rest, where what it leaves out is nothing."""
    one = replace(
        swimmer(drive="none", magnet=(0.2, 0.1, 0.0)), field=ms.UniformField(strength=1.0),
        gravity=ms.Gravity(density=2.0, acceleration=1.0), magnet=ms.Magnet(moment=(0.1, 0.0, 0.2)),
        hook=ms.Hook(stiffness=0.02, length=0.05),
    )  # fmt: skip
    of, rng = in_time(one, 5), np.random.default_rng(3)
    q = rng.normal(size=4)
    y = np.concatenate([rng.normal(size=3), q / np.linalg.norm(q), np.zeros(18 + 2)])
    for along in np.eye(18):
        step = 1e-6 * np.concatenate([np.zeros(7), along, np.zeros(2)])
        slope = (rates(of, 0.0, y + step) - rates(of, 0.0, y - step)) / 2e-6
        ours = derivative(of, 0.0, y) @ step / 1e-6
        assert np.linalg.norm((slope - ours)[:-2]) < 0.05 * np.linalg.norm(slope[:-2])


def test_a_field_lets_go_of_a_piece_that_turns_as_foretold():
    magnetic = {"magnet": (0.2, 0.1, 0.0), "magnet_susceptibility": (3e-4, 1e-4)}
    field = ms.UniformField(strength=1.0, direction=(1.0, -2.0, 0.5))
    of = in_time(replace(swimmer(drive="none", **magnetic), field=field, units="SI"), 5)
    rng, nought = np.random.default_rng(4), (0.0, np.zeros(3), np.eye(3))
    at = pose(of.rod, rng.normal(size=(3, 5)))
    turn, now = rng.normal(size=3), pull(of.loads, of.rod, at, at.place, *nought)
    turned = 1e-6 * np.cross(turn, at.directors)
    after, before = (
        pull(of.loads, of.rod, replace(at, directors=d), at.place, *nought).torque
        for d in (at.directors + turned, at.directors - turned)
    )
    np.testing.assert_allclose((before - after) / 2e-6, now.turning @ turn, atol=1e-8)


@pytest.mark.parametrize(("part", "value", "sentence"), [
    ("noise", ms.Noise(temperature=1.0), "noise"),
    ("channel", ms.Channel(diameter=3.0, length=9.0), "channel"),
])  # fmt: skip
def test_what_is_not_followed_is_refused(part, value, sentence):
    with pytest.raises(ms.SpecError, match=sentence):
        ms.path(replace(swimmer(drive="none"), **{part: value}), 1.0)


def test_a_path_that_was_killed_goes_on_to_the_same_numbers(tmp_path):
    one = swimmer(drive="pivot", angle=0.5)

    class Killed(Exception):
        pass

    def kill(done, of):
        if done == 1:
            raise Killed

    keep = tmp_path / "path.npz"
    with pytest.raises(Killed):
        ms.path(one, 4.0, memory=True, samples=17, keep=keep, progress=kill)
    again = ms.path(one, 4.0, memory=True, samples=17, keep=keep)
    once = ms.path(one, 4.0, memory=True, samples=17)
    np.testing.assert_array_equal(again.position, once.position)
    np.testing.assert_array_equal(again.motor_work, once.motor_work)
    with pytest.raises(ms.SpecError, match="another path"):
        ms.path(one, 5.0, memory=True, samples=17, keep=keep)


def test_a_heavy_push_does_not_press_a_tail_into_a_wall():
    """A force of a hundred times what drag and bending make of it."""
    one = replace(swimmer(0.1, drive="pivot", angle=0.4), wall=ms.Wall(distance=0.3))
    found = ms.path(one, 0.3, samples=7, force=(0.0, 0.0, -300.0))
    assert 0.0 < found.gap[-1] < 0.02


def test_a_filament_that_is_heavy_all_along_sinks_straight_whatever_its_stiffness():
    """Weight and local drag are both even along it, so nothing bends it: across it falls at
    ``w / c_n``, and tilted it glides.
    """
    tail = ms.ElasticTail(length=1.0, radius=0.02, bending=1e-3, drive="none")
    gravity = ms.Gravity(density=2.0, acceleration=100.0, direction=(0.0, -1.0, 0.0))
    one = ms.Swimmer(
        body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0, density=1.0), coefficients=LAW,
        gravity=gravity,
    )  # fmt: skip
    weight, angle = np.pi * 0.02**2 * 100.0, 0.6
    start = [np.cos(angle / 2.0), 0.0, 0.0, np.sin(angle / 2.0)]
    found = ms.path(one, 2.0, samples=3, quaternion=start)
    t, n = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    falls = -weight * (t * t[1] / 1.2 + n * n[1] / 2.0)
    np.testing.assert_allclose(found.attrs["drift"][:2], falls, rtol=1e-5)
    ends = found.filament.values[-1, -1] - found.filament.values[-1, 0]
    np.testing.assert_allclose(np.linalg.norm(ends), 1.0, atol=1e-8)


def test_a_heavy_head_draws_its_tail_down_behind_it():
    """Begun near upright it ends upright: all weight over all drag, the filament straight."""
    gravity = ms.Gravity(body_density=3.0, tail_density=2.0, acceleration=50.0,
                         direction=(-1.0, 0.0, 0.0))  # fmt: skip
    one = swimmer(0.15, drive="none", bending=0.02)
    one = replace(one, fluid=ms.Fluid(viscosity=1.0, density=1.0), gravity=gravity)
    found = ms.path(one, 12.0, samples=25, quaternion=[np.cos(0.1), 0.0, 0.0, np.sin(0.1)])
    body, tail = 4.0 / 3.0 * np.pi * 0.15**3 * 2.0 * 50.0, np.pi * 0.02**2 * 50.0
    drag = 6.0 * np.pi * 0.15 + 1.2
    speed = (found.position.values[-1] - found.position.values[-2]) / 0.5
    np.testing.assert_allclose(speed, [-(body + tail) / drag, 0.0, 0.0], rtol=1e-3, atol=2e-3)
