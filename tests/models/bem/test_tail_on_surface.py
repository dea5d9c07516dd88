"""Tails that grow out of a body from a surface file, by boundary elements."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.models.bem import gait as of_phases
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.patches.triangles import for_a_tail
from microswim.models.bem.solution import solve
from microswim.models.rooting import root
from microswim.swimmer.geometry.bodies import EllipsoidalBody
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.coarsening import coarsened
from microswim.swimmer.geometry.solids.paired import patches
from microswim.swimmer.geometry.solids.triangles import Triangles

trimesh = pytest.importorskip("trimesh")


class Lumpy(Body):
    """A ball with lumps by a formula, on structured patches: what the file is of."""

    shape = "lumpy"
    is_balanced = is_mirrored = of_revolution = False
    opening, facets = EllipsoidalBody.opening, EllipsoidalBody.facets
    lumps = np.array([[0.3, 0.9, 0.3], [-0.5, -0.2, 0.84], [-0.6, 0.2, -0.77], [0.1, -0.9, 0.4]])

    def __init__(self, semi_axes=(0.5, 0.5, 0.5)):
        self.semi_axes = semi_axes
        self.middle = np.array([-self.radius(np.array([1.0, 0.0, 0.0])), 0.0, 0.0])

    def radius(self, d):
        return 0.5 * (1.0 + np.exp(3.0 * (d @ self.lumps.T - 1.0)) @ [0.25, -0.2, 0.2, 0.15])

    @property
    def semi_axes3(self):
        return self.semi_axes

    @property
    def stretch(self):
        return 0.7

    def diagonal(self, viscosity):
        return (1.0,) * 6  # not asked for

    def level(self, X):
        distance = np.linalg.norm(X - self.middle, axis=-1)
        return distance / self.radius((X - self.middle) / distance[..., None]) - 1.0

    def surface_point(self, direction):
        return self.middle + self.radius(direction)[..., None] * direction

    def direction(self, X):
        return (X - self.middle) / np.linalg.norm(X - self.middle)


SHORT: dict[str, Any] = {"length": 0.8, "amplitude": 0.06, "waves": 1, "radius": 0.06}


def from_file(folder, mesh, **more):
    file = folder / "body.stl"
    mesh.export(file)
    return ms.SurfaceFile(file=str(file), scale=1.0, **more)


def swimmer(body, tail):
    return ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0))


def misfits(one, other):
    scale = np.sqrt(np.diag(other.resistance))
    R = np.abs(one.resistance - other.resistance) / np.outer(scale, scale)
    F = np.abs(one.propulsion - other.propulsion) / (scale * np.sqrt(other.activity))
    return R.max(), F.max()


def test_a_triangulated_sphere_with_a_tail_is_the_sphere_with_it(tmp_path):
    """The structured patches share nothing with it but the tube; the rest is the triangles'."""
    body = from_file(tmp_path, trimesh.creation.icosphere(2, radius=0.5))
    tail = ms.HelicalTail(**SHORT)
    one, other = (
        solve(swimmer(b, tail), 0.7, level="coarse") for b in (body, ms.Sphere(radius=0.5))
    )
    R, F = misfits(one, other)
    assert R < 4e-3
    assert F < 1e-3
    assert one.reciprocity < 1e-3


def test_a_thinned_lumpy_head_is_the_lumpy_head(tmp_path):
    """The patches of few triangles lie on the surface of many; left on the few R is .4 % off."""
    ball = trimesh.creation.icosphere(3)
    directions = np.array(ball.vertices) / np.linalg.norm(ball.vertices, axis=1)[:, None]
    ball.vertices = directions * Lumpy().radius(directions)[:, None]
    body = from_file(tmp_path, ball, position=tuple(Lumpy().middle))
    assert for_a_tail(body.triangles, "coarse").count < 70
    tail = ms.HelicalTail(**SHORT)
    there = solve(swimmer(Lumpy(body.semi_axes3), tail), 0.7, level="standard")
    R, F = misfits(solve(swimmer(body, tail), 0.7, level="coarse"), there)
    assert R < 1.5e-3
    assert F < 1.5e-3


def test_levels_that_agree_do_not_make_a_thinned_head_exact(tmp_path, monkeypatch):
    """Where the coarser level is the same one, heads from files alone keep their least error."""
    monkeypatch.setattr(of_phases, "coarser", lambda name: name)
    tail, level = ms.HelicalTail(**SHORT), replace(get_level("coarse"), phases=2)
    ball = trimesh.creation.icosphere(2, radius=0.5)
    for body, least in (
        (from_file(tmp_path, ball), of_phases.OF_A_FILE),
        (ms.Sphere(radius=0.5), 0.0),
    ):
        made = of_phases.gait(swimmer(body, tail), level=level, estimate_error=True)
        told = made.info["error"]
        assert told["velocities"] == pytest.approx(least, abs=2e-4)
        assert told["relative_forward"] == pytest.approx(least, abs=2e-4)


def test_long_triangles_are_as_good_as_even_ones(tmp_path):
    """A capsule whose side is one row of triangles 16 times as long as wide."""
    mesh = trimesh.creation.capsule(height=1.0, radius=0.4, count=[24, 40])
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [0, 1, 0]))
    body, tail = from_file(tmp_path, mesh), ms.HelicalTail(**SHORT)
    one = solve(swimmer(body, tail), 0.7, level="coarse")
    there = solve(swimmer(ms.Capsule(length=1.8, radius=0.4), tail), 0.7, level="coarse")
    R, F = misfits(one, there)
    assert one.surface.patches < 150
    assert R < 4e-3
    assert F < 1e-3


def test_a_tail_anywhere_on_it_gives_the_turned_solution(tmp_path):
    """Of a sphere, whose triangles are not turned: to the accuracy of its patches."""
    body = from_file(tmp_path, trimesh.creation.icosphere(2, radius=0.5))
    here = solve(swimmer(body, ms.HelicalTail(**SHORT)), 0.5, level="coarse")
    A = ms.HelicalTail(**SHORT, direction=(0.1, 0.9, -0.4)).placement.rotation
    place = np.array([-0.5, 0.0, 0.0]) + A @ [0.5, 0.0, 0.0]
    tail = ms.HelicalTail(**SHORT, direction=(0.1, 0.9, -0.4), position=tuple(place))
    there = solve(swimmer(body, tail), 0.5, level="coarse")
    Q = np.kron(np.eye(2), A)
    scale = np.sqrt(np.diag(there.resistance))
    turned = Q @ here.resistance @ Q.T
    assert np.abs((there.resistance - turned) / np.outer(scale, scale)).max() < 4e-3


@pytest.mark.parametrize("count", [1, 2])
def test_its_patches_close_it(tmp_path, count):
    """Area and volume are those of the box and of the tails; no normal faces inwards."""
    body = from_file(tmp_path, trimesh.creation.box((1.0, 1.2, 0.9)))
    at = [(0.0, 0.25, 0.0), (0.0, -0.3, 0.1)][:count]
    tails = [ms.PlaneWaveTail(**SHORT, position=p) for p in at]
    joined = swimmer_surface(body, swimmer(body, tails).tail, 0.3, get_level("coarse").resolution)
    bare = [
        swimmer_surface(ms.NoBody(), ms.PlaneWaveTail(**SHORT), 0.3, get_level("coarse").resolution)
    ]
    half = 2 * np.pi * SHORT["radius"] ** 3 / 3
    volume = 1.08 + count * (bare[0].extent[1] - half)
    assert joined.extent[1] == pytest.approx(volume, rel=2e-3)
    flux = joined.moments[2].sum(axis=(0, 1))
    assert np.abs(flux).max() < 3e-3 * joined.extent[0]


def test_the_joint_lies_on_the_tube_and_on_the_surface(tmp_path):
    body = from_file(tmp_path, trimesh.creation.icosphere(3, radius=0.5))
    joint = root(body, ms.HelicalTail(**SHORT), 1.1)
    psi = np.linspace(0.0, 6.0, 15)
    X = joint.body.surface_point(joint.sphere_point(joint.angle(psi), psi))
    assert np.abs(np.linalg.norm(X - body.centre, axis=-1) - 0.5).max() < 5e-4


@pytest.mark.parametrize(
    ("position", "words"),
    [((0.0, 0.48, 0.0), ("sharp edge", "tail.position")), ((0.0, 0.9, 0.0), ("tail.position",))],
)
def test_a_root_at_an_edge_or_beside_the_body_is_refused(tmp_path, position, words):
    body = from_file(tmp_path, trimesh.creation.box((1.0, 1.0, 1.0)))
    with pytest.raises(ms.SpecError) as told:
        solve(swimmer(body, ms.HelicalTail(**SHORT, position=position)), level="coarse")
    assert all(word in str(told.value) for word in words), str(told.value)
    assert "\n" not in str(told.value)


def test_a_root_that_reaches_an_edge_at_a_later_phase_is_refused_before_the_first_solve(tmp_path):
    body = from_file(tmp_path, trimesh.creation.box((1.0, 1.0, 1.0)))
    wide = {"length": 0.8, "amplitude": 0.1, "waves": 1, "radius": 0.04, "ramp": 0.0}
    robot = swimmer(body, ms.HelicalTail(**wide, position=(0.0, -0.4, 0.0)))
    solved = []
    with pytest.raises(ms.SpecError, match="sharp edge"):
        robot.gait("bem", level="coarse", progress=lambda n, _: solved.append(n))
    assert not solved


def test_two_roots_in_one_place_are_refused(tmp_path):
    body = from_file(tmp_path, trimesh.creation.icosphere(2, radius=0.5))
    tails = [
        ms.HelicalTail(**SHORT, position=(-0.02, y, 0.0), direction=(1.0, y * 9, 0.0))
        for y in (0.11, -0.11)
    ]
    with pytest.raises(ms.SpecError, match="so close on the surface from the file"):
        solve(swimmer(body, tails), level="coarse")


def test_few_triangles_keep_the_normals_and_the_volume_of_many():
    """Of a sphere and of a torus; hardly a triangle is left without another to make a patch."""
    for mesh, volume in (
        (trimesh.creation.icosphere(4), 4 * np.pi / 3),
        (trimesh.creation.torus(2.0, 1.0, major_sections=80, minor_sections=48), 4 * np.pi**2),
    ):
        fine = Triangles(np.array(mesh.vertices, float), np.array(mesh.faces, np.int64))
        coarse = coarsened(fine, 400)
        assert coarse.is_closed
        assert 200 < len(coarse.faces) <= 400
        assert coarse.curved_volume == pytest.approx(volume, rel=3e-3)
        assert len(patches(coarse)[0]) < 0.65 * len(coarse.faces)
        assert not patches(coarse)[2].any()


def test_a_cube_is_not_thinned_to_what_is_no_cube(tmp_path):
    body = from_file(tmp_path, trimesh.creation.box((1.0, 1.0, 1.0)))
    assert body.triangles is not None
    assert coarsened(body.triangles, 6).volume == pytest.approx(1.0, rel=1e-6)
