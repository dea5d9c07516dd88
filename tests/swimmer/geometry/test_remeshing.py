"""Closed surfaces with sides of about one length, and nearest points on curved triangles."""

import numpy as np
import pytest

from microswim.swimmer.geometry.solids.nearest import Nearest
from microswim.swimmer.geometry.solids.remeshing import remeshed
from microswim.swimmer.geometry.solids.splitting import shortened
from microswim.swimmer.geometry.solids.triangles import Triangles

trimesh = pytest.importorskip("trimesh")


def surface(mesh):
    return Triangles(np.array(mesh.vertices, float), np.array(mesh.faces, np.int64))


def lengths(triangles):
    ends = triangles.points[triangles.edges[0]]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


CAPSULE = surface(trimesh.creation.capsule(height=1.0, radius=0.4, count=[24, 40]))
DRUM = surface(trimesh.creation.cylinder(radius=0.5, height=0.8, sections=64))


def test_nearest_points_of_a_box_are_as_far_as_its_formula_says():
    half = np.array([0.5, 0.6, 0.45])
    X = np.random.default_rng(1).uniform(-1.0, 1.0, (400, 3))
    beyond = np.abs(X) - half
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    away = np.where((beyond < 0.0).all(axis=1), -beyond.max(axis=1), outside)
    at = Nearest(surface(trimesh.creation.box(2 * half)))(X)
    assert np.linalg.norm(at - X, axis=1) == pytest.approx(away, abs=1e-12)


def test_nearest_points_of_a_ball_lie_on_the_curved_triangles():
    """Three times as near to the sphere as the flat ones, and below the points they are of."""
    ball = surface(trimesh.creation.icosphere(3))
    flat = np.linalg.norm(ball.points[ball.faces].mean(axis=1), axis=1)
    d = np.random.default_rng(2).normal(size=(500, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    at = Nearest(ball)(1.01 * d)
    assert np.abs(np.linalg.norm(at, axis=1) - 1).max() < np.abs(flat - 1).max() / 3
    assert np.linalg.norm(at - d, axis=1).max() < 2e-3


def test_long_triangles_become_even_ones():
    """A capsule whose side is one row of triangles 16 times as long as wide."""
    assert lengths(CAPSULE).max() > 0.99
    made = remeshed(CAPSULE, 0.25)
    assert made is not None
    assert made.is_closed
    assert 100 < len(made.faces) < 200
    assert np.degrees(made.angles().min()) > 25.0
    assert lengths(made).max() < 0.4
    assert not made.is_sharp.any()
    assert made.curved_volume == pytest.approx(CAPSULE.curved_volume, rel=0.02)


def test_sharp_rims_stay_where_they_are():
    made = remeshed(DRUM, 0.2)
    assert made is not None
    assert made.is_closed
    assert len(made.faces) < 0.8 * len(DRUM.faces)
    rims = made.points[np.unique(made.edges[0][made.is_sharp])]
    assert np.linalg.norm(rims[:, :2], axis=1) == pytest.approx(0.5, abs=1e-6)
    assert np.abs(rims[:, 2]) == pytest.approx(0.4, abs=1e-6)
    assert 30 < made.is_sharp.sum() < 64
    assert made.curved_volume == pytest.approx(DRUM.curved_volume, rel=5e-3)


def test_corners_of_a_cube_stay():
    cube = surface(trimesh.creation.box((1.0, 1.0, 1.0)).subdivide().subdivide())
    made = remeshed(cube, 0.4)
    assert made is not None
    assert made.volume == pytest.approx(1.0, rel=1e-9)
    assert (made.kinds == 2).sum() == 8


def test_long_sides_are_halved_where_the_surface_bends_alone():
    dense = shortened(DRUM, 0.2)
    bent = DRUM.is_bent
    assert bent.sum() == 128  # the side's; the lids are flat
    assert dense.is_closed
    area = np.linalg.norm(dense.area_vectors, axis=1)
    on_side = np.abs(dense.area_vectors[:, 2]) < 0.5 * area
    ends = dense.points[dense.faces[on_side]]
    assert np.linalg.norm(ends - np.roll(ends, 1, axis=1), axis=2).max() <= 0.2
    assert lengths(dense).max() == pytest.approx(0.5)  # the spokes of the lids
