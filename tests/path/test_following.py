"""Paths under each load, against closed forms and against the other way to follow a path."""

import inspect
import subprocess
import sys

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.rigid_motion import rotation_matrix

FLUID = {"fluid": ms.Fluid(viscosity=1.0, density=1.0), "units": "dimensionless"}
UP = np.array([np.cos(np.pi / 4), 0.0, -np.sin(np.pi / 4), 0.0])  # s along z


def alone(body, **parts):
    return ms.Swimmer(body=body, tail=ms.NoTail(), **FLUID, **parts)


def axis_of(found):
    """The s axis in the lab, (n, 3)."""
    return rotation_matrix(found.quaternion.values)[:, :, 0]


def robot(**parts):
    helix = ms.Swimmer.preset("tabak/helix")
    body = ms.Spheroid(semi_axes=(0.8, 0.5))
    return ms.Swimmer(body=body, tail=helix.tail, fluid=helix.fluid, **parts)


def weighed(**gravity):
    tail = ms.Swimmer.preset("tabak/helix").tail
    fluid = ms.Fluid(viscosity=1.0, density=1.0)
    parts = {"acceleration": 9.0} | gravity
    body = ms.Spheroid(semi_axes=(0.8, 0.5))
    return ms.Swimmer(body=body, tail=tail, fluid=fluid, gravity=ms.Gravity(**parts))


@pytest.mark.parametrize("ratio", [3.0, 0.4])
def test_a_spheroid_in_shear_goes_round_jefferys_orbit(ratio):
    """``tan phi = r tan(g t / (r + 1/r))``, phi from the gradient towards the flow [Jeffery]."""
    shear = 2.0
    swimmer = alone(ms.Spheroid(semi_axes=(0.5 * ratio, 0.5)), flow=ms.ShearFlow(rate=shear))
    period = 2.0 * np.pi / shear * (ratio + 1.0 / ratio)
    found = ms.path(swimmer, period, model="rft", quaternion=UP, samples=201)
    p = axis_of(found)
    turned = np.unwrap(np.arctan2(p[:, 0], p[:, 2]))
    t = found.time.values
    swept = 2.0 * np.pi * t / period
    exact = np.unwrap(np.arctan2(ratio * np.sin(swept), np.cos(swept)))
    assert np.abs(turned - exact).max() < 1e-4
    assert abs(turned[-1] - 2.0 * np.pi) < 1e-4


def test_jefferys_orbit_out_of_the_plane_keeps_its_constant():
    """``C = tan(theta) sqrt(r^2 cos^2 phi + sin^2 phi) / r``."""
    swimmer = alone(ms.Spheroid(semi_axes=(1.5, 0.5)), flow=ms.ShearFlow(rate=1.0))
    half = 0.35
    q = np.array([np.cos(half), 0.0, -np.sin(half), 0.0])
    lean = np.array([np.cos(0.3), 0.0, 0.0, np.sin(0.3)])  # about z, out of the plane
    from microswim.numerics.rigid_motion import multiply

    found = ms.path(swimmer, 25.0, model="rft", quaternion=multiply(lean, q))
    x, y, z = axis_of(found).T
    orbit = np.sqrt(9.0 * z**2 + x**2) / (3.0 * y)
    assert np.ptp(orbit) / np.abs(orbit).mean() < 1e-4


def test_an_extension_draws_a_spheroid_along():
    """``tan theta = tan theta_0 exp(-3/2 B e t)``, B = (r^2 - 1)/(r^2 + 1)."""
    swimmer = alone(
        ms.Spheroid(semi_axes=(1.0, 0.5)), flow=ms.StrainFlow(rate=0.7, direction=(0, 0, 1))
    )
    found = ms.path(swimmer, 3.0, model="rft", tilt=0.3)
    p = axis_of(found)
    theta = np.arctan2(np.hypot(p[:, 0], p[:, 1]), p[:, 2])
    exact = np.tan(theta[0]) * np.exp(-1.5 * 0.6 * 0.7 * found.time.values)
    assert np.allclose(np.tan(theta), exact, rtol=1e-5)


def test_every_swimmer_turns_with_a_fluid_that_turns():
    """In a fluid that turns rigidly its path is that at rest, carried round with the fluid."""
    still = ms.path(robot(), 4.0, model="rft", samples=50)
    turning = ms.path(
        robot(flow=ms.RotationFlow(rate=0.3, axis=(0, 1, 2))), 4.0, model="rft", samples=50
    )
    axis = np.array([0.0, 1.0, 2.0]) / np.sqrt(5.0)
    half = 0.15 * still.time.values
    carry = rotation_matrix(
        np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * axis], axis=1)
    )
    carried = np.einsum("nij,nj->ni", carry, still.position.values)
    assert np.allclose(turning.position, carried, atol=1e-6)
    ahead = np.einsum("nij,njk->nik", carry, rotation_matrix(still.quaternion.values))
    assert np.allclose(rotation_matrix(turning.quaternion.values), ahead, atol=1e-6)


def test_a_uniform_flow_carries_every_swimmer_along():
    still = ms.path(robot(), 3.0, model="rft", samples=20)
    carried = ms.path(
        robot(flow=ms.UniformFlow(speed=2.0, direction=(0, 3, 4))), 3.0, model="rft", samples=20
    )
    along = np.outer(still.time, [0.0, 1.2, 1.6])
    assert np.allclose(carried.position - still.position, along, atol=1e-6)


def test_a_ball_in_a_tube_lags_by_faxens_law():
    """``U = u + a^2/6 lap u`` and ``w = curl u / 2``: it keeps its place across."""
    flow = ms.PoiseuilleFlow(speed=3.0, diameter=8.0, axis=(0, 0, 1))
    found = ms.path(
        alone(ms.Sphere(radius=0.5), flow=flow), 2.0, model="rft", position=(1.0, 2.0, 0.0),
        samples=5,
    )  # fmt: skip
    u = 3.0 * (1.0 - 5.0 / 16.0) - 0.25 / 6.0 * 4.0 * 3.0 / 16.0
    assert np.allclose(found.position[-1], [1.0, 2.0, 2.0 * u], atol=1e-4)
    spin = 3.0 * np.sqrt(5.0) / 16.0  # half of the vorticity
    assert 2.0 * np.arccos(abs(float(found.quaternion[-1, 0]))) == pytest.approx(2.0 * spin, 1e-4)


def test_a_tail_in_a_curved_flow_is_that_in_its_tangent_plus_its_curvature():
    """Close to uniform over the swimmer, Poiseuille's flow is its tangent shear."""
    speed, wide, off = 4.0, 4000.0, 1000.0
    tube = ms.PoiseuilleFlow(speed=speed, diameter=wide, centre=(0.0, 0.0, -off))
    rate = -2.0 * speed * off / (wide / 2.0) ** 2
    u0 = speed * (1.0 - (2.0 * off / wide) ** 2)
    there = ms.path(robot(flow=tube), 2.0, model="rft", samples=9)
    here = ms.path(robot(flow=ms.ShearFlow(rate=rate)), 2.0, model="rft", samples=9)
    moved = there.position - here.position
    assert np.allclose(moved[:, 0], u0 * here.time, rtol=1e-5)
    assert np.allclose(there.quaternion, here.quaternion, atol=1e-5)


def test_a_magnet_turns_as_trajectory_says():
    field = ms.RotatingField(strength=200.0, frequency=0.2, axis=(1, 0, 0), cone=0.2)
    swimmer = robot(magnet=ms.Magnet(moment=(0.0, 1.0, 0.0)), field=field)
    found = ms.path(swimmer, 4.0, model="rft", samples=41)
    other = ms.trajectory(
        swimmer.gait(), found.time.values, moment=swimmer.magnet, field=swimmer.field, max_step=5e-3
    )
    assert np.allclose(found.position, other.position, atol=1e-6)
    assert np.allclose(found.quaternion, other.quaternion, atol=1e-6)


def test_a_magnet_pulls_as_trajectory_says():
    """In the field of a dipole the robot is drawn along as well."""
    robot_ = ms.Swimmer.preset("goto/C").with_({"tail.frequency": 0.0})
    dipole = ms.DipoleField(moment=(0.0, 1e-9, 0.0), position=(4e-5, 0.0, 0.0))
    swimmer = ms.Swimmer(
        body=robot_.body, tail=robot_.tail, fluid=robot_.fluid, units="SI",
        magnet=ms.Magnet(moment=(0.0, 1e-16, 0.0)), field=dipole,
    )  # fmt: skip
    found = ms.path(swimmer, 0.1, model="rft", samples=11)
    other = ms.trajectory(
        swimmer.gait(), found.time.values, moment=swimmer.magnet, field=dipole, rate=0.0
    )
    assert np.linalg.norm(other.position[-1]) > 1e-8
    assert np.allclose(found.position, other.position, atol=1e-11)
    assert np.allclose(found.quaternion, other.quaternion, atol=1e-6)


def test_a_ball_sinks_by_stokes_law():
    gravity = ms.Gravity(density=1.5, acceleration=9.0)
    found = ms.path(alone(ms.Sphere(radius=0.5), gravity=gravity), 2.0, model="rft")
    fall = 2.0 / 9.0 * 0.5 * 9.0 * 0.25  # of a ball: 2/9 (rho - rho_f) g a^2 / mu
    assert found.position[-1, 2] == pytest.approx(-2.0 * fall, rel=1e-4)
    assert found.attrs["drift"][2] == pytest.approx(-fall, rel=1e-4)


def test_a_ball_heavy_on_one_side_turns_like_a_pendulum_in_honey():
    """``tan(a/2) = tan(a_0/2) exp(-m g c t / K)``, K = 8 pi mu a^3."""
    gravity = ms.Gravity(density=1.5, acceleration=9.0, centre_of_mass=(0.1, 0.0, 0.0))
    found = ms.path(alone(ms.Sphere(radius=0.5), gravity=gravity), 2.0, model="rft", tilt=0.5)
    down = np.arccos(-axis_of(found)[:, 2])
    mass = 1.5 * np.pi / 6.0
    rate = mass * 9.0 * 0.1 / (np.pi)
    exact = np.tan(down[0] / 2.0) * np.exp(-rate * found.time.values)
    assert np.allclose(np.tan(down / 2.0), exact, rtol=1e-5)


def test_a_swimmer_as_dense_as_the_fluid_does_not_sink():
    found = ms.path(weighed(density=1.0), 3.0, model="rft", samples=9)
    free = ms.path(weighed(density=1.0).with_({"gravity.acceleration": 1e-3}), 3.0, model="rft",
                   samples=9)  # fmt: skip
    assert np.allclose(found.position, free.position, atol=1e-9)


def potential(swimmer, found):
    """Energy of the weight along a path, from the parts' middles: an independent sum."""
    gravity, rho = swimmer.gravity, swimmer.fluid.density
    g = -9.0 * np.array([0.0, 0.0, 1.0])
    a, b, c = swimmer.body.semi_axes3
    body = (gravity.densities[0] - rho) * 4.0 / 3.0 * np.pi * a * b * c
    tail = swimmer.tail
    s = (np.arange(4000) + 0.5) / 4000 * tail.length
    energy = []
    for x, q, phase in zip(found.position.values, found.quaternion.values, found.phase.values):
        P, slope, _ = tail.centreline(s, phase)
        piece = np.pi * tail.radius**2 * np.linalg.norm(slope, axis=1) * tail.length / 4000
        at = x + (P + [a, 0, 0]) @ rotation_matrix(q).T
        weight = (gravity.densities[1] - rho) * piece
        energy.append(-body * g @ x - weight @ (at @ g))
    return np.array(energy)


def test_the_works_of_motor_and_weight_are_what_the_fluid_takes_up():
    """To 1e-6 along the path; the tail is far heavier than the body, so its lifting is felt."""
    swimmer = weighed(body_density=1.1, tail_density=40.0)
    found = ms.path(swimmer, 6.0, model="rft", samples=25, tilt=0.4, tolerance=1e-9)
    lost = -np.diff(potential(swimmer, found))
    given = np.diff(found.motor_work.values) + lost
    taken = np.diff(found.dissipated.values)
    assert np.abs(lost).max() > 1e-2 * np.abs(taken).max()  # it matters
    assert np.allclose(given, taken, rtol=1e-6)


def test_the_error_that_is_stated_holds():
    swimmer = weighed(body_density=1.1, tail_density=4.0)
    exact = ms.path(swimmer, 5.0, model="rft", tolerance=1e-11, samples=5)
    for tolerance in (1e-5, 1e-7):
        found = ms.path(swimmer, 5.0, model="rft", tolerance=tolerance, samples=5)
        off = float(np.linalg.norm(found.position[-1] - exact.position[-1]))
        assert off <= found.attrs["position_error"] + 1e-9


def test_a_path_that_was_killed_goes_on_to_the_same_numbers(tmp_path):
    keep = tmp_path / "path.npz"
    swimmer = weighed(body_density=1.1, tail_density=4.0)

    class Killed(Exception):
        pass

    def kill(done, of):
        if done == 20:
            raise Killed

    with pytest.raises(Killed):
        ms.path(swimmer, 9.0, model="rft", keep=keep, progress=kill)
    told = []
    rest = ms.path(
        swimmer, 9.0, model="rft", keep=keep, progress=lambda done, of: told.append(done)
    )
    whole = ms.path(swimmer, 9.0, model="rft")
    assert told[0] == 21
    assert rest.equals(whole)
    with pytest.raises(ms.SpecError, match="holds another path"):
        ms.path(swimmer, 8.0, model="rft", keep=keep)


def test_the_circle_and_its_sense():
    """A motor that stands still, a force and a torque that turn a ball: a circle that is known."""
    swimmer = alone(ms.Sphere(radius=0.5))
    pulled = ms.path(swimmer, 5.0, model="rft", force=(1.0, 0, 0), torque=(0, 0, 1.0))
    assert pulled.attrs["circle_sense"] == ""  # the force does not turn with it
    from microswim.path.outcome import circling

    angle = np.linspace(0.0, 1.5, 40)
    round_it = np.stack([2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.1 * angle], axis=1)
    up = np.array([0.0, 0.0, 1.0])
    assert circling(round_it, up) == pytest.approx((2.0, 1.5))
    assert circling(round_it[::-1], up) == pytest.approx((2.0, -1.5))
    assert circling(round_it, -up) == pytest.approx((2.0, -1.5))
    assert circling(np.outer(angle, [1.0, 1.0, 0.0]), up) == (None, None)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"time": 0.0}, "time"),
        ({"paths": 3}, "paths"),
        ({"position": (0.0, 1.0)}, "position"),
        ({"quaternion": (1, 1, 0, 0)}, "quaternion"),
        ({"tilt": 0.1, "quaternion": (1, 0, 0, 0)}, "tilt"),
        ({"samples": 1}, "samples"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_sentence(options, said):
    with pytest.raises(ms.SpecError, match=said) as caught:
        ms.path(robot(), **({"time": 1.0} | options))
    assert "\n" not in str(caught.value)


def test_how_a_path_ends_is_told_by_its_gaps():
    from microswim.path.outcome import ended

    stays, leaves = np.array([1.0, 0.5, 0.6]), np.array([0.5, 1.0, 2.5])
    told = {"length": 1.0, "reach": 0.01}
    assert ended(np.full(3, np.inf), np.inf, turn=None, **told) == "free"
    assert ended(np.array([3.0, 2.0, 1.5]), 1.5, turn=None, **told) == "free"
    assert ended(stays, 0.5, turn=-3.0, **told) == "orbits"
    assert ended(stays, 0.5, turn=0.4, **told) == "trapped"
    assert ended(leaves, 0.5, turn=None, **told) == "escaped"
    assert ended(stays, 0.005, turn=-3.0, **told) == "touched"


@pytest.mark.parametrize("first", ["import microswim as ms; ms.path", "import microswim.path"])
def test_the_package_is_called_and_imported_from_in_any_order(first):
    code = f"""
{first}
import inspect
import microswim as ms
import microswim.path.trajectory as t
from microswim.path import regimes, trajectory
import microswim.path.course
assert ms.path is microswim.path and t is trajectory and ms.trajectory is t.trajectory
assert "time" in inspect.signature(ms.path).parameters
print(ms.path(ms.Swimmer.preset("tabak/helix"), time=0.1, model="rft").attrs["outcome"])
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout.strip() == "free", run.stderr


def test_the_signature_is_that_of_the_function():
    from microswim.path.following import path

    assert inspect.signature(ms.path) == inspect.signature(path)
