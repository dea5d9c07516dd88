"""The Navier-Stokes step on a moving mesh: order in time, and Stokes' oscillating sphere."""

from __future__ import annotations

import numpy as np
import pytest

from microswim.swimmer.geometry.surroundings import Channel

ngs = pytest.importorskip("ngsolve", reason="needs the extra fem")

from microswim.models.fem.mesh import Level, Outline, straight_mesh  # noqa: E402
from microswim.models.fem.navier_stokes import Past, Step  # noqa: E402
from microswim.models.fem.stokes import Stokes  # noqa: E402

pytestmark = pytest.mark.fem

TINY = Level(order=2, tail=1.6, body=1.0, far=0.5, grading=0.9, curvature=1.5)
A = np.array([[1.0, 2.0, 0.0], [0.0, -1.0, 1.0], [1.0, 0.0, 0.0]])  # no trace: A x has no sources


@pytest.fixture(scope="module")
def sphere_in_box() -> Stokes:
    outline = Outline((0.5, 0.5, 0.5), 0.0, 0.0)
    mesh = straight_mesh(outline, Channel(diameter=3.0, length=3.0, shape="box"), TINY)
    return Stokes(mesh, TINY.order)


def manufactured_error(flow: Stokes, steps: int, density: float = 3.0) -> float:
    """Error at t = 1 of u = g(t) A x on a mesh that swings; the space represents A x exactly."""
    dt, X = 1.0 / steps, flow.nodes.points
    on = flow.nodes.on("body|wall")

    def places(t):
        swing = np.stack([np.sin(X[:, 1] + 2 * t), np.cos(X[:, 0]) * np.sin(3 * t), 0 * X[:, 0]])
        return X + 0.1 * swing.T

    def exact(t):
        flow.move(places(t))
        coefficients = np.exp(np.sin(2 * t)) * flow.position @ A.T
        return coefficients.T.ravel(), flow.position.copy()

    (now, here), (before, there) = exact(0.0), exact(-dt)
    past = Past((now, before), (here, there))
    x = ngs.CF((ngs.x, ngs.y, ngs.z))
    matrix = ngs.CF(tuple(A.ravel()), dims=(3, 3))
    for n in range(1, steps + 1):
        t = n * dt
        g, dg = np.exp(np.sin(2 * t)), 2 * np.cos(2 * t) * np.exp(np.sin(2 * t))
        flow.move(places(t))
        force = density * (dg * matrix * x + g**2 * matrix * (matrix * x))
        step = Step(flow, past, dt, density=density, force=force)
        data = flow.given(g * flow.places @ A.T, on)
        solution, _ = step.solve(data)
        past = past.then(solution[: flow.size], flow.position.copy())
    return float(np.abs(past.velocity[0] - exact(1.0)[0]).max())


def test_second_order_in_time_on_a_moving_mesh(sphere_in_box):
    errors = np.array([manufactured_error(sphere_in_box, n) for n in (8, 16, 32)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert errors[-1] > 1e-9  # the error is that of time, not rounding
    assert np.all(orders > 1.7), (errors, orders)
    assert orders[-1] < 2.4, orders


def test_uniform_flow_is_not_disturbed_by_the_mesh(sphere_in_box):
    """Body and walls move together at a constant velocity: u = 1 everywhere, no force."""
    flow, dt = sphere_in_box, 0.1
    X, on = flow.nodes.points, flow.nodes.on("body|wall")
    flow.move(X)
    one = np.concatenate([flow.nodes.coefficients(np.ones(len(X))), np.zeros(2 * len(X))])
    past = Past((one, one), (flow.position.copy(), flow.position.copy()))
    wiggle = 0.1 * np.stack([np.sin(X[:, 1]), np.cos(X[:, 2]), np.sin(X[:, 0])], axis=1)
    flow.move(X + wiggle)
    step = Step(flow, past, dt, density=5.0)
    solution, reaction = step.solve(flow.given(np.tile([1.0, 0.0, 0.0], (len(X), 1)), on))
    assert np.abs(solution[: flow.size] - one).max() < 1e-8
    assert np.abs(flow.forces(reaction, flow.rigid_modes(np.zeros(3)), "body")).max() < 1e-7


def test_factors_of_a_place_before_give_the_flow_of_new_ones(sphere_in_box):
    """A free sphere that squirms in a box, the mesh moved a little: flow, twist and no force."""
    flow, dt, free = sphere_in_box, 0.1, (True, True, True, True, True, False)
    X, on = flow.nodes.points, flow.nodes.on("body")
    flow.move(X)
    still = np.zeros(flow.size)
    past = Past((still,), (flow.position.copy(),))

    def swim(former):
        step = Step(flow, past, dt, density=5.0)
        normal = flow.given(flow.places, on)
        squirm = np.stack([X[:, 0] ** 2, X[:, 1] * X[:, 0], X[:, 2] * (1.0 - X[:, 1])], axis=1)
        data = flow.without_flux(flow.given(squirm, on), normal)
        return step.swim(data, flow.rigid_modes(np.zeros(3)), free, former)

    before = swim(None)
    former = before[-1]
    flow.move(X + 0.02 * np.stack([np.sin(X[:, 1]), np.cos(X[:, 2]), np.sin(X[:, 0])], axis=1))
    kept, new = swim(former), swim(None)
    assert kept[-1] is former  # they served
    assert new[-1] is not former
    for one, other, moved in zip(kept[:2], new[:2], before[:2]):  # flow, twist
        size = np.abs(other).max()
        assert np.abs(one - other).max() < 1e-8 * size
        assert np.abs(moved - other).max() > 1e-4 * size
    wrench = np.abs(kept[2]["body"])
    assert wrench[:5].max() < 1e-7 * wrench.max()
