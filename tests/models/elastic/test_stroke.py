"""Beats in space: tails bent out of their plane at rest, and held ones under loads."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses.wall import start_of
from microswim.models.elastic.beat import settled
from microswim.models.elastic.findings import leaving
from microswim.models.elastic.growth import slowest
from microswim.models.elastic.plane import Loads
from microswim.models.elastic.problem import problem
from microswim.models.elastic.statics import static_shape
from microswim.models.elastic.stroke import by_strains, stroke
from microswim.models.elastic.unsteady.march import at_rest, marched
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.numerics.series.fourier import derivative, evaluate, series_of
from microswim.swimmer.fields import lifted

LAW = ms.Constant(normal=2.0, tangential=1.2, spin=True)
RADIUS, PITCH = 0.1, 0.5
HELIX: dict[str, Any] = {"rest_radius": RADIUS, "rest_pitch": PITCH}


def swimmer(held=False, **tail):
    """A sphere with a filament of length 1, free or held."""
    own: Any = {"length": 1.0, "radius": 0.02, "bending": 0.2} | tail
    return ms.Swimmer(
        body=ms.Sphere(radius=0.2), tail=ms.ElasticTail(**own), coefficients=LAW,
        fluid=ms.Fluid(viscosity=1.0, density=1.0),
        motion=ms.Motion(free="none" if held else "all"),
    )  # fmt: skip


def shaken_helix(drive, size):
    """The rigid helix on a base that moves, written out here."""
    p = PITCH / (2.0 * np.pi)
    turn = np.hypot(RADIUS, p)

    def shape(s, phase):
        s, phase = np.broadcast_arrays(s, phase)
        x, y, z = p * s / turn, RADIUS * np.cos(s / turn), RADIUS * np.sin(s / turn)
        if drive == "heave":
            return np.stack([x, y + size * np.cos(phase), z], axis=-1)
        c, d = np.cos(size * np.cos(phase)), np.sin(size * np.cos(phase))
        return np.stack([c * x - d * y, d * x + c * y, z], axis=-1)

    return shape


@pytest.mark.parametrize(("drive", "name", "size"), [
    ("heave", "amplitude", 0.2), ("pivot", "angle", 0.5),
])  # fmt: skip
def test_a_stiff_helix_is_shaken_as_a_rigid_one(drive, name, size):
    law = ms.Constant(normal=2.0, tangential=1.2, spin=False)
    given: Any = {name: size, **HELIX}
    stiff = swimmer(bending=1e5, drive=drive, **given)
    stiff = replace(stiff, coefficients=law)
    rigid = ms.CustomTail(shape=shaken_helix(drive, size), length=1.0, radius=0.02)
    ours, other = stiff.gait(), replace(stiff, tail=rigid).gait()
    phases = np.linspace(0.0, 6.0, 7)
    u, v = (np.array([g.velocity(x) for x in phases]) for g in (ours, other))
    np.testing.assert_allclose(u, v, atol=1e-5 * np.abs(v).max())
    assert ours.mean_power == pytest.approx(other.mean_power, rel=1e-6)


@pytest.mark.parametrize("tail", [
    {"drive": "heave", "amplitude": 0.2, **HELIX},
    pytest.param({"drive": "moment", "moment": 0.2, "wavelength": 1.0, **HELIX},
                 marks=pytest.mark.slow),
])  # fmt: skip
def test_marched_from_rest_it_settles_to_the_beat(tail):
    """Work, heat and way of the fifth period, whose steps know nothing of a period."""
    one = swimmer(**tail)
    gait, start = one.gait(), at_rest(one, np.zeros(3), [1.0, 0.0, 0.0, 0.0], 0.0)
    before, last = marched(one, start, np.array([0.0, 4.0, 5.0]), 1e-6).shapes[-2:]
    given, took = last.work - before.work
    assert took == pytest.approx(gait.mean_power, rel=2e-4)
    assert given == pytest.approx(took, rel=1e-4)
    path = ms.trajectory(gait, [0.0, 1.0], quaternion=before.quaternion, phase=before.phase)
    moved = path.position.values[-1] - path.position.values[0]
    np.testing.assert_allclose(last.position - before.position, moved, atol=2e-5)


@pytest.mark.parametrize("tail", [
    {"drive": "heave", "amplitude": 0.2}, {"drive": "pivot", "angle": 0.6},
    {"drive": "moment", "moment": 0.6, "wavelength": 0.7},
])  # fmt: skip
def test_drive_and_inner_moments_give_what_the_fluid_takes(tail):
    """At times between the phases that were solved, and as the gait has it; with few unknowns,
    whose cube it costs.
    """
    one = swimmer(**tail, **HELIX)
    beat, gait = stroke(one), one.gait()
    shape, V = series_of(beat.shape), series_of(beat.velocity)
    times = 2.0 * np.pi * np.arange(64) / 64 + 0.01
    w = np.concatenate([evaluate(V, times), evaluate(derivative(shape), times)], axis=1)
    powers = [beat.at(t, evaluate(shape, t)).powers(x, t) for t, x in zip(times, w)]
    given, took = np.mean(powers, axis=0)
    assert given == pytest.approx(took, rel=1e-5)
    assert took * one.tail.bending * one.tail.rate == pytest.approx(gait.mean_power, rel=1e-5)
    assert gait.info["unknowns"] < 800


def test_a_tail_straight_at_rest_beats_in_space_as_in_the_plane():
    one = swimmer(drive="pivot", angle=0.4)
    ours, plane = stroke(one), settled(problem(one))
    np.testing.assert_allclose(ours.velocity[0, [0, 1, 5]], plane.velocity[0], atol=1e-6)
    np.testing.assert_allclose(ours.velocity[:, 2:5], 0.0, atol=1e-9)


def test_the_derivative_by_the_strains_is_exact():
    one = replace(swimmer(held=True, drive="pivot", angle=0.4, **HELIX), hook=ms.Hook(
        stiffness=0.05, length=0.05), flow=ms.ShearFlow(rate=0.7, across=(0.0, 1.0, 0.0)),
        gravity=ms.Gravity(density=9.0, acceleration=10.0))  # fmt: skip
    beat, rng = stroke(one), np.random.default_rng(1)
    q, along = beat.shape[3], rng.normal(size=beat.shape.shape[1])
    w = rng.normal(size=len(q))

    def work(q):
        now = beat.at(1.1, q)
        M, still = now.balance(1.1, np.concatenate([beat.pose, q]))
        return still + M @ w

    slope = (work(q + 1e-6 * along) - work(q - 1e-6 * along)) / 2e-6
    np.testing.assert_allclose(by_strains(beat.at(1.1, q), w) @ along, slope,
                               atol=1e-7 * np.abs(slope).max())  # fmt: skip


@pytest.mark.parametrize("load", ["gravity", "flow"])
def test_hardly_moved_it_hangs_as_statics_say(load):
    one = swimmer(held=True, drive="heave", amplitude=1e-6, bending=0.02)
    if load == "gravity":
        heavy = ms.Gravity(body_density=1.0, tail_density=101.0, acceleration=1.0,
                           direction=(0.0, -1.0, 0.0))  # fmt: skip
        one = replace(one, gravity=heavy)
        _, place = static_shape(Loads(weight=(0.0, -np.pi * 0.02**2 * 100.0 / 0.02)))
    else:
        one = replace(one, flow=ms.UniformFlow(speed=0.02, direction=(0.0, 1.0, 0.0)))
        _, place = static_shape(Loads(flow=(0.0, 2.0)), drag=(0.6, 1.0))
    tip = one.settled.tail.centreline(1.0, 0.3)[0]
    np.testing.assert_allclose(tip[:2], place[-1], atol=2e-5)


@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_stiff_held_swimmer_feels_the_stream(way):
    """Stokes' drag of the sphere and that of a straight rod, whose middle is .7 from its centre."""
    one = swimmer(held=True, bending=1e4, drive="heave", amplitude=1e-6)
    one = replace(one, flow=ms.UniformFlow(speed=0.3, direction=way))
    rod = np.array([1.2, 2.0, 2.0]) * way
    force = 0.3 * (1.2 * np.pi * np.array(way) + rod)
    wrench = [*force, *np.cross([0.7, 0.0, 0.0], 0.3 * rod)]
    np.testing.assert_allclose(ms.summary(one.gait())["held_wrench"], wrench, atol=1e-5)


@pytest.mark.slow
def test_a_heavy_held_tail_marches_to_its_beat():
    gravity = ms.Gravity(body_density=1.0, tail_density=301.0, acceleration=10.0)
    one = replace(swimmer(held=True, drive="pivot", angle=0.5), gravity=gravity)
    start = at_rest(one, np.zeros(3), [1.0, 0.0, 0.0, 0.0], 0.0)
    found = marched(one, start, np.array([0.0, 4.0, 4.4]), 1e-6)
    tail = one.settled.tail
    tip = tail.centreline(1.0, 2.0 * np.pi * 0.4)[0] + np.array([0.2, 0.0, 0.0])
    np.testing.assert_allclose(found.places[-1, -1], tip, atol=5e-5)
    assert abs(tip[2]) > 0.1
    streaming = replace(one, flow=ms.UniformFlow(speed=0.3, direction=(0.6, 0.8, 0.0)))
    work = [x.work[0] for x in marched(streaming, start, np.arange(7.0), 1e-6).shapes[-2:]]
    assert streaming.gait().mean_power == pytest.approx(work[1] - work[0], rel=2e-3)
    assert "settles under its gravity" in " ".join(one.gait().info["remarks"])


@pytest.mark.slow
def test_a_held_tail_beats_beside_its_wall_and_not_through_it():
    """Tilted to the wall it would reach through it; the wall bends it away."""
    wall = ms.Wall(distance=0.3, tilt=-0.35)
    one = replace(swimmer(held=True, drive="pivot", angle=0.5), wall=wall)
    found, free = one.gait(), replace(one, wall=None).gait()
    assert found.info["settles"]
    assert found.mean_power == pytest.approx(0.185, rel=0.02) != free.mean_power
    shape, Q = one.settled.tail, rotation_matrix(start_of(wall)[1])
    s, phase = np.linspace(0.0, 1.0, 40)[:, None], np.linspace(0.0, 6.0, 12)
    places = shape.centreline(s, phase)[0] + np.array([0.2, 0.0, 0.0])
    height = (places @ Q.T)[..., 2] + start_of(wall)[0][2] - 0.02
    assert 0.0 < height.min() < 0.05


@pytest.mark.parametrize(("load", "name"), [
    (None, "tail.bending"),
    pytest.param("gravity", "tail.radius", marks=pytest.mark.slow),
    pytest.param("flow", "tail.frequency", marks=pytest.mark.slow),
    pytest.param("wall", "tail.bending", marks=pytest.mark.slow),
])  # fmt: skip
def test_complex_numbers_give_derivatives(load, name):
    given: dict[str, Any] = {
        "gravity": ms.Gravity(body_density=1.0, tail_density=200.0, acceleration=10.0),
        "flow": ms.UniformFlow(speed=0.5, direction=(0.0, 1.0, 0.0)),
        "wall": ms.Wall(distance=0.25),
    }
    bent: dict[str, Any] = {} if load else HELIX
    one = swimmer(held=load is not None, drive="pivot", angle=0.3, **bent)
    one = replace(one, **({} if load is None else {load: given[load]}))
    x = one.numbers[name]

    def power(value):
        return one.with_({name: value}).gait().mean_power

    slope = (power(1.001 * x) - power(0.999 * x)) / (0.002 * x)
    ours = np.imag(lifted(one, {name: x + 1e-30j}).gait().mean_power) / 1e-30
    assert ours == pytest.approx(slope, rel=1e-3)


def test_how_a_motion_is_left_is_told_by_its_slowest_disturbance():
    assert leaving(1.3 + 0j) == "to one side"
    assert leaving(-1.3 + 0j) == "period-doubles"
    assert leaving(1.1j) == "turns once in 4 periods"


def test_a_disturbance_that_changes_its_side_each_period_is_found_so():
    """Rates whose solution is known: a turn by half a circle in a period, growing by 1.2."""
    T, grown = 17, np.log(1.2) / (2.0 * np.pi)
    A = np.tile([[grown, -0.5], [0.5, grown]], (T, 1, 1))
    assert slowest(A, 1) == pytest.approx(-1.2, rel=1e-6)
    assert leaving(slowest(A, 1)) == "period-doubles"
