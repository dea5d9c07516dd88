"""What the scene is given to draw is the swimmer that is computed: its surface, its tail."""

import math
import tomllib

import matplotlib
import numpy as np
import pytest

import microswim as ms
from microswim.errors import SpecError
from microswim.gait import palette
from microswim.numerics.series.fourier import evaluate
from microswim.spec import presets
from microswim.studio import answers, exchange
from microswim.studio.drawing import ALONG, shape
from microswim.studio.spec_tables import swimmer_of

FLUID = ms.Fluid(viscosity=1.0)
WAVE = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}
BODIES = [  # with their volumes by closed forms
    (ms.Capsule(length=1.5, radius=0.4), math.pi * 0.4**2 * 0.7 + 4 / 3 * math.pi * 0.4**3),
    (ms.Cylinder(length=1.0, radius=0.4, edge=0.01), math.pi * 0.4**2),
    (ms.Box(size=(1.0, 0.8, 0.6), edge=0.01), 0.48),
]
NEW = [n for n in presets.names() if n.split("/")[0] not in ("tabak", "goto")]


def volume(mesh):
    """By the divergence theorem over triangles of the quadrilaterals."""
    points = np.reshape(mesh["points"], (-1, 3))
    quads = np.reshape(mesh["faces"], (-1, 4))
    corners = points[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]
    return float(np.sum(np.linalg.det(corners)) / 6.0)


def of(body=None, tail=None):
    tail = ms.HelicalTail(**WAVE) if tail is None else tail
    return ms.Swimmer(body=ms.Sphere(radius=0.5) if body is None else body, tail=tail, fluid=FLUID)


@pytest.mark.parametrize(("body", "known"), BODIES, ids=lambda x: getattr(x, "shape", ""))
def test_a_body_that_is_no_ellipsoid_is_drawn_by_its_own_surface(body, known):
    made = shape(of(body))
    assert volume(made["mesh"]) == pytest.approx(known, rel=0.03)
    size = np.ptp(np.reshape(made["mesh"]["points"], (-1, 3)), axis=0)
    assert size == pytest.approx([2 * a for a in body.semi_axes3], rel=1e-3)


def test_several_tails_stand_where_the_package_has_them():
    spec = {
        "fluid": {"viscosity": 1.0},
        "body": {"shape": "sphere", "radius": 0.5},
        "tail": [
            {"kind": "helix", **WAVE, "position": [-0.3, 0.35, 0.0], "direction": [1, 0.5, 0]},
            {"kind": "helix", **WAVE, "position": [-0.3, -0.35, 0.0], "phase": 1.5},
        ],
    }
    made = answers.solve(spec)
    assert answers.solve(made["tables"])["readings"] == pytest.approx(made["readings"])
    swimmer = swimmer_of(spec)
    phase, s = 0.7, np.linspace(0.0, 2.0, 9)
    for tail, drawn in zip(swimmer.tail.each, made["shape"]["tails"], strict=True):
        own = tail.own.centreline(s, phase + drawn["ahead"])[0]
        there = own @ np.reshape(drawn["rotation"], (3, 3)).T + drawn["root"]
        assert np.abs(there - tail.centreline(s, phase)[0]).max() < 1e-12


def test_an_ellipsoid_travels_as_three_numbers():
    made = shape(of(ms.Ellipsoid(semi_axes=(0.5, 0.4, 0.3))))
    assert made["mesh"] is None
    assert made["semi_axes"] == [0.5, 0.4, 0.3]


@pytest.mark.parametrize("name", ["cells/sperm", "soft/heaving"])
def test_the_line_of_a_tail_follows_it_between_the_phases_it_was_made_from(name):
    swimmer = ms.Swimmer.preset(name)
    made = shape(swimmer)
    length = made["length"]
    tail = swimmer.settled.tail
    for phase in (0.1, 2.345, 5.0):
        line = evaluate(np.array(made["tails"][0]["line"]), phase).reshape(ALONG, 3)
        true = tail.centreline(np.linspace(0.0, length, ALONG), phase)[0]
        assert np.abs(line - true).max() < 1e-3 * length
        assert np.linalg.norm(true[:, 1:], axis=1).max() < 1.01 * made["reach"]


@pytest.mark.parametrize("name", NEW)
def test_each_new_preset_is_answered_and_comes_back_whole(name):
    made = answers.solve(tomllib.loads(presets.read(name)), name)
    again = answers.solve(tomllib.loads(made["toml"]), name)
    known = {k: v for k, v in made["readings"].items() if v is not None}
    assert {k: again["readings"][k] for k in known} == pytest.approx(known, rel=1e-9)
    tails = made["tables"]["tail"]
    kinds = [one["kind"] for one in (tails if isinstance(tails, list) else [tails])]
    drawn = [one["kind"] for one in made["shape"]["tails"]] or ["none"]
    assert drawn == kinds or made["gait"]["model"] == "elastic"


@pytest.mark.parametrize("shape_", sorted(exchange.BODIES))
def test_another_body_is_about_as_large(shape_):
    tables = answers.solve({"fluid": {"viscosity": 1.0}, "body": {"shape": "sphere", "radius": 0.5},
                            "tail": {"kind": "helix", **WAVE}})["tables"]  # fmt: skip
    made = exchange.exchanged(tables, "body.shape", shape_)
    assert {k: v for k, v in made.items() if k != "body"} == {
        k: v for k, v in tables.items() if k != "body"
    }
    axes = swimmer_of(made).body.semi_axes3
    assert shape_ == "none" or all(0.35 < a < 0.8 for a in axes)


@pytest.mark.parametrize("kind", sorted(exchange.TAILS))
@pytest.mark.parametrize("start", ["tabak/helix", "shapes/rod", "soft/heaving", "cells/sperm"])
def test_another_tail_is_a_swimmer_at_once(kind, start):
    tables = tomllib.loads(presets.read(start))
    tables.pop("motion", None)
    made = answers.solve(exchange.exchanged(tables, "tail.kind", kind))
    assert made["shape"]["kind"] == kind
    assert (made["readings"]["mean_power"] > 0) == (kind != "none")


def test_what_cannot_be_exchanged_is_a_sentence():
    tables = tomllib.loads(presets.read("tabak/helix"))
    for field, word in (("tail.kind", "custom"), ("body.shape", "mesh"), ("fluid.viscosity", "2")):
        with pytest.raises(SpecError):
            exchange.exchanged(tables, field, word)


def test_the_colours_of_a_map_are_those_of_the_figures():
    viridis = matplotlib.colormaps["viridis"]
    steps = len(palette.MAP) - 1
    assert [matplotlib.colors.to_hex(viridis(i / steps)) for i in range(steps + 1)] == [
        *palette.MAP
    ]
