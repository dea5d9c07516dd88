"""Swimmers seen from afar: singularities against point forces, velocities against elements."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import microswim as ms
from microswim.models.group import singularities
from microswim.models.group.from_afar import from_afar
from microswim.models.group.swarm import swarm
from microswim.numerics.rigid_motion import along_twist, twist_along

HELIX = ms.Swimmer.preset("tabak/helix")
RNG = np.random.default_rng(5)
VISCOSITY = 0.7


def stokeslets(x, places, forces):
    """Flow at x of point forces, with the factor 1/(8 pi mu)."""
    r = x - places
    far = np.linalg.norm(r, axis=-1, keepdims=True)
    one = forces / far + r * np.sum(r * forces, axis=-1, keepdims=True) / far**3
    return one.sum(axis=0) / (8.0 * np.pi * VISCOSITY)


def off(distance):
    """Errors of velocity and gradient by dipole and by quadrupole of a cloud of forces."""
    rng = np.random.default_rng(1)
    places, forces = 0.1 * rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    F, D = forces.sum(axis=0), forces.T @ places
    Q = np.einsum("ej,ek,el->jkl", forces, places, places)
    there = distance * np.array([0.6, 0.5, -0.4])
    true = stokeslets(there, places, forces)
    h = 1e-4 * distance
    ahead = [stokeslets(there + h * e, places, forces) for e in np.eye(3)]
    behind = [stokeslets(there - h * e, places, forces) for e in np.eye(3)]
    slope = (np.array(ahead) - np.array(behind)).T / (2.0 * h)
    X, none = np.array([np.zeros(3), there]), np.zeros_like
    u, g = singularities.flow(X, np.array([F, none(F)]), np.array([D, none(D)]), VISCOSITY)
    found = [np.abs(u[1] - true).max(), np.abs(g[1] - slope).max()]
    last = np.array([Q, none(Q)]), np.array([[0, 1]]), np.ones(1)
    v, dv = singularities.flow_of_quadrupoles(X, *last, VISCOSITY)
    u, g = u + v, g + dv
    return np.array([*found, np.abs(u[1] - true).max(), np.abs(g[1] - slope).max()])


def test_what_is_left_out_falls_with_the_order_of_the_term():
    near, far = off(4.0), off(8.0)
    assert np.log2(near / far) == pytest.approx([3.0, 4.0, 4.0, 5.0], abs=0.4)


def test_the_fast_sum_is_the_sum_of_all_pairs(monkeypatch):
    pytest.importorskip("fmm3dpy")
    n = 400
    X, F, D = (RNG.normal(size=s) for s in ((n, 3), (n, 3), (n, 3, 3)))
    pairs = singularities.flow(X, F, D, VISCOSITY)
    monkeypatch.setattr(singularities, "MANY", 1)
    for one, other in zip(singularities.flow(X, F, D, VISCOSITY), pairs):
        assert np.linalg.norm(one - other) <= singularities.PRECISION * np.linalg.norm(other)


def test_a_twist_is_found_again_from_its_motion():
    twist = np.array([0.3, -1.0, 2.0, 0.4, 1.1, -0.8])
    assert twist_along(*along_twist(twist)) == pytest.approx(twist, abs=1e-12)
    straight = np.array([0.3, -1.0, 2.0, 0.0, 0.0, 0.0])
    assert twist_along(*along_twist(straight)) == pytest.approx(straight, abs=1e-12)


def test_the_answer_to_a_flow_is_that_of_an_ellipsoid_to_jeffery():
    """Rotation in a shear: omega_r = (1 + B)/2 du_q/dx_s - (1 - B)/2 du_s/dx_q, by its axes."""
    a, b = 2.0, 1.0
    body = ms.Spheroid(semi_axes=(a, b))
    seen = from_afar(ms.Swimmer(body=body, tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0)))
    B = (a * a - b * b) / (a * a + b * b)
    assert seen.response[5, 1, 1] == pytest.approx((1 + B) / 2, rel=0.01)
    assert seen.response[5, 0, 2] == pytest.approx((B - 1) / 2, rel=0.01)
    assert seen.response[:3, :, 0] == pytest.approx(np.eye(3), abs=2e-3)


@pytest.mark.parametrize(
    "kind",
    ["helix", pytest.param("plane_wave", marks=pytest.mark.slow)],  # 24 solves
)
def test_a_swimmer_alone_swims_as_its_gait_says(kind):
    swimmer = ms.Swimmer.preset(f"tabak/{kind}")
    seen = from_afar(swimmer, "coarse")
    screw = ms.screw(swimmer.gait("bem", level="coarse"))
    assert abs(seen.motion[0, 6]) == pytest.approx(screw.speed, rel=2e-3)


def test_far_dipoles_are_those_of_the_far_field():
    seen = from_afar(HELIX)
    told = ms.Group((ms.Member(swimmer=HELIX),)).swim().far_field[0]
    D, Q = seen.dipole[..., 6], seen.quadrupole[..., 6]
    assert D[0, 0] - D[1, 1] == pytest.approx(told.force_dipole, rel=0.02)
    assert Q[2, 1, 0] - Q[1, 2, 0] == pytest.approx(told.rotlet_dipole, rel=0.02)
    assert pytest.approx(np.diag(D.diagonal()), abs=1e-3 * D[0, 0]) == D  # no torque is left


@pytest.fixture(scope="module")
def blocks():
    return ms.Group((ms.Member(swimmer=HELIX),)).prepared("coarse")


def test_what_neighbours_do_is_what_elements_say_within_what_is_stated(blocks):
    """Averaged over both phases, at two lengths: by elements phase by phase."""
    length = 2.0 * 3.0
    rolls = Rotation.random(2, random_state=4).as_matrix()
    directions = [Q[:, 0] for Q in rolls]
    middle = np.array([1.0, 0.0, 0.0])
    first = np.zeros(3) - rolls[0] @ middle
    second = length * np.array([0.36, 0.8, 0.48]) - rolls[1] @ middle
    there = ms.Group((ms.Member(swimmer=HELIX), ms.Member(swimmer=HELIX)))
    there = there.moved(positions=[first, second], directions=directions)
    apart = there.moved(positions=[first, 1e7 * second])
    changed = np.mean([
        there.moved(phases=p).solve(blocks=blocks).velocity_scene
        - apart.moved(phases=p).estimate(blocks=blocks).velocity_scene
        for p in 2 * np.pi * np.array([(i, 5 * i % 6) for i in range(6)]) / 6
    ], axis=0)  # fmt: skip
    many = swarm(there, "coarse")
    X = np.array([first, second])
    Q = np.array([m.rotation for m in there.members])
    V, errors, nearest = many.velocity(X, Q)
    alone, *_ = many.velocity(np.array([first, 1e7 * second]), Q)
    found = np.einsum("nij,nbj->nbi", Q, (V - alone).reshape(2, 2, 3)).reshape(2, 6)
    speed = abs(many.kinds[0].motion[0, 6])
    off = np.abs(found - changed)
    assert nearest == pytest.approx(np.linalg.norm(first - second))
    assert np.abs(changed[:, :3]).max() > 0.01 * speed
    assert (off[:, :3].max(axis=1) < errors * speed).all()
    assert errors.max() < 0.1
    assert (off[:, 3:].max(axis=1) * many.size < errors * speed).all()


def test_swimmers_in_one_place_move_at_a_bounded_speed():
    """Nearer than they are long they are not known: no term grows, and the error says so."""
    there = ms.Group((ms.Member(swimmer=HELIX), ms.Member(swimmer=HELIX)))
    many, Q = swarm(there, "coarse"), np.array([np.eye(3)] * 2)
    size = [
        np.abs(many.velocity(np.array([[0, 0, 0], [0, y, 0]]), Q)[0]).max()
        for y in many.size * np.array([1.001, 0.999, 0.3, 0.01])
    ]
    assert size[0] == pytest.approx(size[1], rel=0.02)
    assert max(size) < 1.5 * size[0]
    assert many.velocity(np.array([[0, 0, 0], [0, 0.9 * many.size, 0]]), Q)[1].min() == 1.0


def test_a_wall_is_refused():
    with pytest.raises(ms.SpecError, match="free fluid alone"):
        swarm(ms.Group((ms.Member(swimmer=HELIX),), wall=((0, -5, 0), (0, 1, 0))))
