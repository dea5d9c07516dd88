"""Tails that stand anywhere, one or several, by boundary elements."""

import numpy as np
import pytest

import microswim as ms
from microswim.models.bem.levels import get_level, named
from microswim.models.bem.patches.cells import cells_about
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.solution import solve

SHORT = {"length": 1.0, "amplitude": 0.08, "waves": 1.5, "radius": 0.05}


def swimmer(tail, body=None, **more):
    return ms.Swimmer(
        body=body or ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0), **more
    )


def turned(solution, A):
    Q = np.kron(np.eye(2), A)
    return Q @ solution.resistance @ Q.T, Q @ solution.propulsion


@pytest.mark.parametrize("kind", [ms.HelicalTail, ms.PlaneWaveTail])
def test_a_tail_turned_round_a_sphere_gives_the_turned_solution(kind):
    """The same surface, turned: to rounding."""
    here = solve(swimmer(kind(**SHORT)), 0.5, level="coarse")
    A = kind(**SHORT, direction=(-0.3, 0.8, -0.5)).placement.rotation
    root = np.array([-0.5, 0.0, 0.0]) + A @ [0.5, 0.0, 0.0]
    tail = kind(**SHORT, direction=(-0.3, 0.8, -0.5), position=tuple(root), phase=0.3)
    there = solve(swimmer(tail), 0.2, level="coarse")
    R, F = turned(here, A)
    assert np.abs(there.resistance - R).max() < 1e-9 * np.abs(R).max()
    assert np.abs(there.propulsion - F).max() < 1e-9 * np.abs(F).max()
    assert there.activity == pytest.approx(here.activity, rel=1e-9)


def test_a_tail_that_leaves_a_spheroid_aslant_is_resolved():
    """Levels apart share no patch; the joint is traced in the tail's frame."""
    body = ms.Spheroid(semi_axes=(0.6, 0.4))
    tail = ms.HelicalTail(**SHORT, position=(-0.3, 0.3, 0.1), direction=(1.0, 1.0, 0.3))
    coarse, fine = (solve(swimmer(tail, body), 0.4, level=n) for n in ("coarse", "standard"))
    assert np.abs(coarse.resistance - fine.resistance).max() < 2e-3 * np.abs(fine.resistance).max()
    assert np.abs(coarse.propulsion - fine.propulsion).max() < 4e-3 * np.abs(fine.propulsion).max()
    assert fine.asymmetry < 1e-3
    assert fine.reciprocity < 1e-3


@pytest.mark.parametrize("count", [2, 4, 7])
def test_cells_cover_the_sphere_once(count):
    """Their areas by the excess of their angles [Girard] add up to 4 pi."""
    rng = np.random.default_rng(count)
    poles = rng.normal(size=(count, 3)) + [1.5, 0.0, 0.0]
    poles /= np.linalg.norm(poles, axis=-1, keepdims=True)
    cells, area = cells_about(poles), 0.0
    for cell in cells:
        n = len(cell.corners)
        normals = np.array([cell.normal(k) for k in range(n)])
        assert (normals @ cell.middle > 0.0).all()
        between = np.sum(normals * np.roll(normals, 1, axis=0), axis=-1)
        area += np.sum(np.pi - np.arccos(np.clip(between, -1, 1))) - (n - 2) * np.pi
    assert area == pytest.approx(4.0 * np.pi, rel=1e-9)
    assert np.array_equal([cell.middle for cell in cells[:count]], poles)


def pair(hand="left", **more):
    other = {"handedness": hand, "position": (-0.1, -0.3, 0.0), "direction": (1.0, -0.6, 0.0)}
    return [
        ms.HelicalTail(**SHORT, position=(-0.1, 0.3, 0.0), direction=(1.0, 0.6, 0.0)),
        ms.HelicalTail(**SHORT, **other, **more),
    ]


PEAR = [[0, 0], [0.2, 0.3], [0.8, 0.5], [1.2, 0.3], [1.3, 0]]
BODIES = [
    (ms.Capsule(length=2.0, radius=0.5), (-0.15, 0.3)),
    (ms.Cylinder(length=1.5, radius=0.5), (0.0, 0.25)),
    (ms.Box(size=(1.2, 1.6, 1.4)), (0.0, 0.2)),
    (ms.Revolution(profile=PEAR), (-0.1, 0.15)),
    (ms.Ellipsoid(semi_axes=(0.8, 0.5, 0.4)), (-0.1, 0.2)),
]


@pytest.mark.parametrize(
    ("body", "place"), BODIES[:1] + BODIES[2:], ids=lambda x: getattr(x, "shape", "")
)
def test_bodies_with_edges_are_shared_out_without_a_gap(body, place):
    """Cells know no edges, their patches are halved there: the volume is that of finer patches."""
    tails = [
        ms.HelicalTail(
            **SHORT, position=(place[0], y * place[1], 0.0), direction=(1.0, 0.4 * y, 0.0)
        )
        for y in (1.0, -1.0)
    ]
    tail = swimmer(tails, body).tail
    found = [
        swimmer_surface(body, tail, 0.3, get_level(name).resolution)
        for name in ("coarse", "standard")
    ]
    (area, volume), (fine_area, fine_volume) = (s.extent for s in found)
    assert volume == pytest.approx(fine_volume, rel=1e-4)
    assert area == pytest.approx(fine_area, rel=1e-4)


@pytest.mark.slow
def test_two_tails_on_a_cylinder_are_passive_and_reciprocal():
    body, place = BODIES[1]
    tails = [
        ms.HelicalTail(**SHORT, position=(0.0, y * place[1], 0.0), direction=(1.0, 0.4 * y, 0.0))
        for y in (1.0, -1.0)
    ]
    found = solve(swimmer(tails, body), 0.3, level="coarse")
    assert found.asymmetry < 2e-3
    assert found.reciprocity < 2e-3
    assert np.linalg.eigvalsh(found.resistance).min() > 0.0
    closed = np.einsum("en,enc->c", found.surface.areas, found.surface.normals)
    assert np.abs(closed).max() < 2e-3 * found.surface.extent[0]


def test_a_body_with_two_holes_is_closed():
    """Volume of a sphere with two tubes: of both alone, less what of each tube lies within."""
    two = swimmer_surface(
        ms.Sphere(radius=0.5), swimmer(pair()).tail, 0.3, get_level("standard").resolution
    )
    ball = 4.0 / 3.0 * np.pi * 0.5**3
    each = [
        swimmer_surface(ms.Sphere(radius=0.5), t, 0.3, get_level("standard").resolution).extent[1]
        - ball
        for t in pair()
    ]
    assert two.extent[1] == pytest.approx(ball + sum(each), rel=1e-5)
    flux = np.einsum("en,enc->c", two.areas, two.normals)
    assert np.abs(flux).max() < 1e-4 * two.extent[0]


def test_two_equal_tails_across_push_along_the_axis_alone():
    """Half a turn about s carries the pair into itself; the patches know nothing of it."""
    found = solve(swimmer(pair(phase=np.pi)), 0.4, level="coarse")
    R, F = found.resistance, found.propulsion
    signs = np.array([1, -1, -1, 1, -1, -1])
    assert np.abs(R - signs[:, None] * R * signs).max() < 2e-3 * np.abs(R).max()
    assert np.abs(F - signs * F).max() < 5e-3 * np.abs(F).max()
    assert found.asymmetry < 5e-3


def test_a_mirrored_pair_of_opposite_hands_turns_nothing():
    found = solve(swimmer(pair("right", phase=np.pi)), 0.4, level="coarse")
    signs = np.array([1, -1, 1, -1, 1, -1])
    F = found.propulsion
    assert np.abs(F - signs * F).max() < 5e-3 * np.abs(F).max()
    assert abs(found.twist[3]) < 5e-3 * abs(found.twist[4])


def test_far_apart_two_tails_feel_one_another_as_oseen_says():
    """Alone they add up; together the drag along the line falls by ``R / (4 pi mu d)`` each."""

    def at(d):
        return ms.HelicalTail(**SHORT, position=(0.0, d, 0.0))

    alone = solve(swimmer(at(0.0), ms.NoBody()), level="coarse").resistance[1, 1]
    missing = []
    for d in (20.0, 40.0):
        both = solve(swimmer([at(0.0), at(d)], ms.NoBody()), level="coarse").resistance[1, 1]
        missing.append(1.0 - both / (2.0 * alone))
        assert missing[-1] == pytest.approx(alone / (4.0 * np.pi * d), rel=0.1)
    assert missing[1] == pytest.approx(0.5 * missing[0], rel=0.05)


def test_two_tails_on_one_axis_approach_one_long_tail_as_their_gap_closes():
    """In phase, behind one another: R about the middle and F tend to those of one tail."""
    each = {"amplitude": 0.1, "radius": 0.05, "ramp": 0.0}

    def about_middle(tail, middle):
        found = solve(swimmer(tail, ms.NoBody()), level="coarse")
        moved = np.eye(6)
        moved[:3, 3:] = [[0, 0, 0], [0, 0, middle], [0, -middle, 0]]
        return (moved.T @ found.resistance @ moved).diagonal(), found.propulsion[[0, 3]]

    R, F = about_middle(ms.HelicalTail(**each, length=2.0, waves=2), 1.0)
    off = []
    for gap in (0.4, 0.2, 0.1):
        row = [
            ms.HelicalTail(**each, length=1.0, waves=1, position=(x, 0.0, 0.0))
            for x in (0.0, 1.0 + gap)
        ]
        found, thrust = about_middle(row, 1.0 + 0.5 * gap)
        off.append(np.abs(np.concatenate([(found / R - 1.0)[:4], thrust / F - 1.0])))
    assert (off[0] > 1.2 * off[1]).all()
    assert (off[1] > 1.3 * off[2]).all()
    assert off[2].max() < 0.035


def test_two_tails_side_by_side_drag_between_one_and_the_tube_about_both():
    """What encloses a body drags more, whatever the rigid motion [Hill Power 1956]."""
    tail = {"length": 1.0, "amplitude": 0.15, "waves": 1, "ramp": 0.2}

    def R(*places, radius=0.04):
        each = [ms.HelicalTail(**tail, radius=radius, position=(0.0, y, 0.0)) for y in places]
        found = swimmer(each if len(each) > 1 else each[0], ms.NoBody())
        return solve(found, 0.3, level="coarse").resistance

    one, tube, before = R(0.0), R(0.0, radius=0.1), np.inf
    root = np.sqrt(tube.diagonal())
    for d in (0.16, 0.12):
        both, around = R(d / 2, -d / 2), R(0.0, radius=0.04 + d / 2)
        for more, less in ((both, one), (around, both)):
            assert np.linalg.eigvalsh((more - less) / np.outer(root, root)).min() > 0.01
        assert (both.diagonal() < before).all()
        before = both.diagonal()


def test_motors_add_up_whatever_way_they_turn():
    """The same shape with motors at (1, 0), (0, 1) and (1, -1): F is linear in the rates."""

    def at(first, second):
        place = {"position": (0.0, 0.6, 0.0), "direction": (1.0, 0.3, 0.0)}
        tails = [
            ms.HelicalTail(**SHORT, frequency=first, phase=0.4 - 0.3 * first),
            ms.HelicalTail(**SHORT, **place, frequency=second, phase=1.0 - 0.3 * second),
        ]
        return solve(swimmer(tails, ms.NoBody()), 0.3, level="coarse")

    one, other, both = at(1.0, 0.0), at(0.0, 1.0), at(1.0, -1.0)
    assert np.allclose(one.resistance, both.resistance, rtol=1e-9, atol=1e-9)
    F = one.propulsion - other.propulsion
    assert np.allclose(both.propulsion, F, atol=1e-9 * np.abs(F).max())
    assert both.activity > 0.0


def test_tails_that_touch_or_have_no_room_are_refused():
    near = [ms.HelicalTail(**SHORT, position=(0.0, y, 0.0)) for y in (0.0, 0.08)]
    with pytest.raises(ms.SpecError, match=r"tail\[1\]\.position.*clear of tail\[0\]"):
        solve(swimmer(near), level="coarse")
    straight = {"length": 1.0, "amplitude": 0.0, "waves": 1.0, "radius": 0.05}
    close = [
        ms.HelicalTail(**straight, position=(0.0, y, 0.0), direction=(1.0, y, 0.0))
        for y in (0.053, -0.053)
    ]
    with pytest.raises(ms.SpecError, match=r"tail\[0\]\.position.*no room"):
        solve(swimmer(close), level="coarse")


def test_tails_without_room_at_a_later_phase_are_refused_before_the_first_solve():
    two, told = ms.Swimmer.preset("several/two-tails", {"body.radius": 0.4}), []
    with pytest.raises(ms.SpecError, match="no room"):
        two.gait("bem", level="coarse", progress=lambda *done: told.append(done))
    assert not told


def test_coarse_is_no_finer_than_standard_for_several_slender_tails():
    cell = ms.Swimmer.preset("several/four-flagella")
    rough, standard = (
        swimmer_surface(cell.body, cell.tail, 0.0, named(level, cell).resolution).unknowns
        for level in ("coarse", "standard")
    )
    assert rough < 0.7 * standard


def test_a_refusal_names_the_tail():
    tails = [
        ms.HelicalTail(**SHORT),
        ms.HelicalTail(**SHORT, position=(-1.0, 0.5, 0.0), direction=(0, 1, 0)),
    ]
    with pytest.raises(ms.SpecError, match=r"^tail\[1\]: its root"):
        solve(swimmer(tails, BODIES[0][0]), level="coarse")


def test_a_tail_beside_the_body_is_refused():
    off = ms.HelicalTail(**SHORT, position=(0.5, 0.8, 0.0))
    with pytest.raises(ms.SpecError, match=r"tail\.position.*meets the body"):
        solve(swimmer(off), level="coarse")
    assert any("does not touch" in r for r in swimmer(off).gait().info["remarks"])
