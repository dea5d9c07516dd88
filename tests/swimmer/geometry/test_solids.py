"""Capsule, cylinder, box, revolution: surfaces, sizes, what is refused."""

import pickle

import numpy as np
import pytest

import microswim as ms
from microswim.swimmer.geometry.solids.facets import sampled_quads

CAPSULE = ms.Capsule(length=3.0, radius=0.5)
CYLINDER = ms.Cylinder(length=3.0, radius=0.5)
BOX = ms.Box(size=(3.0, 1.0, 0.6))
PEAR = ms.Revolution(profile=[[0, 0], [0.2, 0.3], [0.8, 0.5], [1.2, 0.3], [1.3, 0]])
EVERY = [CAPSULE, CYLINDER, BOX, PEAR, ms.Spheroid(semi_axes=(1.0, 0.5))]
NAMES = [body.shape for body in EVERY]


def enclosed(body: ms.Capsule) -> float:
    """Volume by the divergence theorem over quadrilaterals, with Richardson's extrapolation."""

    def of(side: int) -> float:
        points, quads = sampled_quads(body.facets(1), side)
        a, b, c, d = (points[quads[:, k]] for k in range(4))
        split = np.einsum("ij,ij->i", a, np.cross(b, c)) + np.einsum("ij,ij->i", a, np.cross(c, d))
        return float(split.sum() / 6.0)

    return (4.0 * of(24) - of(12)) / 3.0


@pytest.mark.parametrize("body", EVERY, ids=NAMES)
def test_facets_lie_on_the_surface_and_face_outwards(body):
    for facet in body.facets(2):
        u, v = (0.5 * (e[1:] + e[:-1]) for e in (facet.u, facet.v))
        u, v = np.meshgrid(u, v, indexing="ij")
        h = 1e-5
        X = facet.chart(u, v)
        along = facet.chart(u + h, v) - facet.chart(u - h, v)
        across = facet.chart(u, v + h) - facet.chart(u, v - h)
        normal = np.cross(along, across)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        assert np.abs(body.level(X)).max() < 1e-5
        assert (body.level(X + 1e-3 * normal) > 0).all()
        assert (body.level(X - 1e-3 * normal) < 0).all()


@pytest.mark.parametrize("body", EVERY, ids=NAMES)
def test_directions_and_points_of_the_surface_answer_each_other(body):
    rng = np.random.default_rng(1)
    d = rng.normal(size=(40, 3))
    d[:, 0] = np.abs(d[:, 0]) + 0.5
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    X = body.surface_point(d)
    assert np.abs(body.level(X)).max() < 1e-7
    back = np.array([body.direction(x) for x in X])
    assert np.abs(back - d).max() < 1e-7


@pytest.mark.parametrize("body", EVERY, ids=NAMES)
def test_a_body_that_was_used_goes_to_another_process(body):
    """What it remembers of its profile is made of functions, which no other process can load."""
    X = body.surface_point(np.array([0.6, 0.8, 0.0]))
    there = pickle.loads(pickle.dumps(body))
    np.testing.assert_array_equal(there.surface_point(np.array([0.6, 0.8, 0.0])), X)


def test_the_rear_pole_is_the_joint():
    for body in EVERY:
        np.testing.assert_allclose(body.surface_point(np.array([1.0, 0.0, 0.0])), 0.0, atol=1e-12)


def test_volumes_are_those_of_the_books():
    e, h = BOX.fillet, np.array(BOX.semi_axes3) - BOX.fillet
    box = 8 * h.prod() + 8 * e * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0])
    box += 2 * np.pi * e**2 * h.sum() + 4 / 3 * np.pi * e**3  # Steiner's formula
    assert enclosed(BOX) == pytest.approx(box, rel=1e-5)
    capsule = np.pi * 0.25 * 2.0 + 4 / 3 * np.pi * 0.125
    assert enclosed(CAPSULE) == pytest.approx(capsule, rel=1e-5)
    R, e = 0.5, CYLINDER.fillet  # less what the fillet takes off the edge, by Pappus
    off = e**2 * (1 - np.pi / 4)
    centroid = R - e * (10 - 3 * np.pi) / (12 - 3 * np.pi)
    whole = np.pi * R**2 * 3.0 - 2 * (2 * np.pi * centroid * off)
    assert enclosed(CYLINDER) == pytest.approx(whole, rel=1e-5)


def test_a_profile_may_count_its_s_either_way_and_from_anywhere():
    other = ms.Revolution(profile=[(5.0 - s, rho) for s, rho in PEAR.profile])
    x = np.linspace(0.0, 1.5, 20)
    np.testing.assert_allclose(other.outline().point(x), PEAR.outline().point(x), atol=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ms.Capsule(length=0.9, radius=0.5), "body.length = 0.9: must be at least twice"),
        (lambda: ms.Capsule(length=1.0, radius=-0.5), "body.radius = -0.5: must be a positive"),
        (lambda: ms.Cylinder(length=1.0, radius=0.5, edge=0.0), "body.edge = 0.0: must be above"),
        (lambda: ms.Cylinder(length=1.0, radius=0.5, edge=0.6), "at most 0.5"),
        (lambda: ms.Box(size=(1.0, 1.0)), "body.size"),
        (lambda: ms.Box(size=(1.0, 1.0, 0.2), edge=0.2), "at most 0.1"),
        (lambda: ms.Revolution(profile=[[0, 0], [1, 1], [2, 0]]), "at least four points"),
        (lambda: ms.Revolution(profile=[[0, 0.2], [1, 1], [2, 1], [3, 0]]), "on the axis"),
        (lambda: ms.Revolution(profile=[[0, 0], [1, 1], [2, -1], [3, 0]]), "above zero"),
        (lambda: ms.Revolution(profile=[[0, 0], [1, 1], [1.0, 1], [0, 0]]), "same s"),
        (
            lambda: ms.Revolution(profile=[[0, 0], [3, 1], [1, 0.9], [1.1, 0.3], [3, 2], [4, 0]]),
            "crosses itself",
        ),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_in_a_sentence(make, words):
    with pytest.raises(ms.SpecError) as told:
        make()
    assert words in str(told.value)
    assert "\n" not in str(told.value)


SPECS = {
    "capsule": {"length": "3 mm", "radius": "0.5 mm"},
    "cylinder": {"length": "3 mm", "radius": "0.5 mm", "edge": "50 um"},
    "box": {"size": ["3 mm", "1 mm", "0.6 mm"]},
    "revolution": {
        "profile": [[f"{s} mm", f"{rho} mm"] for s, rho in ((0, 0), (1, 1), (2, 1), (3, 0))]
    },
}


@pytest.mark.parametrize("shape", SPECS)
def test_a_spec_says_them_with_units(shape):
    from microswim.spec.file import from_dict

    tail = {"kind": "helix", "length": "4 mm", "amplitude": "0.3 mm", "waves": 2,
            "radius": "0.1 mm", "frequency": "1 Hz"}  # fmt: skip
    tables = {"fluid": {"viscosity": "1 Pa s"}, "body": {"shape": shape, **SPECS[shape]}}
    swimmer = from_dict({**tables, "tail": tail})
    assert swimmer.body.shape == shape
    assert swimmer.body.semi_axes3[0] == pytest.approx(1.5e-3)
    assert f"{shape}, 3 mm x" in str(swimmer)
