"""Mirror symmetry: the systems of both parities together are the whole one."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.models.bem import system
from microswim.models.bem.levels import get_level
from microswim.models.bem.mirrors import Mirrors
from microswim.models.bem.patches.mesh import body_surface
from microswim.models.bem.patches.surface import ellipsoid
from microswim.models.bem.solution import solve

BODIES = {
    "sphere": ms.Sphere(radius=0.4),
    "ellipsoid": ms.Ellipsoid(semi_axes=(0.5, 0.4, 0.3)),
    "capsule": ms.Capsule(length=1.0, radius=0.3),
    "box": ms.Box(size=(0.8, 0.6, 0.6), edge=0.1),
    "none": ms.NoBody(),
}


#: Level coarse, its cells halved at a distance at which none lies exactly: there rounding decides,
#: on either side of the mirror for itself, and forces differ by the quadrature's error of 1e-6.
COARSE = get_level("coarse")
LEVEL = replace(COARSE, rule=replace(COARSE.rule, near=2.0371, far=8.0371))

#: What the conditioning of the whole system leaves of rounding.
ROUNDING = 1e-11

WALL = {"wall": ms.Wall(distance=0.9, azimuth=np.pi)}
SLANTING = {"wall": ms.Wall(distance=0.9, tilt=0.2)}


def beat(body, tail=None, **more):
    tail = tail or ms.PlaneWaveTail(length=4.0, amplitude=0.25, waves=1.5, radius=0.08, ramp=0.2)
    return ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.3), **more)


def number_of_mirrors(swimmer, phase=0.7):
    return int(np.log2(len(solve(swimmer, phase, level=LEVEL).layer.mirrors.signs)))


def unsplit(surface, wall=None):
    """What the system takes for a surface without any mirror."""
    return Mirrors(np.ones((1, 3)), np.arange(surface.nodes[..., 0].size)[None])


def both(monkeypatch, swimmer, phase, level=LEVEL):
    split = solve(swimmer, phase, level=level)
    monkeypatch.setattr(system, "mirrors", unsplit)
    whole = solve(swimmer, phase, level=level)
    assert len(split.layer.mirrors.signs) > 1 == len(whole.layer.mirrors.signs)
    return split, whole


def assert_same_forces(split, whole, most=ROUNDING):
    """All forces agree; densities may differ by pressures of the fluid inside, which have none."""
    R = whole.raw_resistance
    scale = np.sqrt(np.outer(R.diagonal(), R.diagonal()))
    assert np.abs((split.raw_resistance - R) / scale).max() < most
    assert np.abs(split.propulsion - whole.propulsion).max() < most * np.abs(whole.propulsion).max()
    assert split.activity == pytest.approx(whole.activity, rel=most)
    for own, other in (
        (split.body_resistance, whole.body_resistance),
        (split.raw_propulsion, whole.raw_propulsion),
    ):
        assert np.abs(own - other).max() <= most * max(np.abs(other).max(), 1e-9)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("phase", [0.7, 2.9])
def test_both_parities_together_are_the_whole(name, phase, monkeypatch):
    assert_same_forces(*both(monkeypatch, beat(BODIES[name]), phase))


@pytest.mark.parametrize(
    ("tail", "more"),
    [
        ({"sections": "sheared"}, {}),
        ({"surface_motion": "bending"}, {}),
        ({"amplitude_end": 0.4}, {}),
        ({}, WALL),
        ({}, SLANTING),
    ],
    ids=["sheared", "bending", "conical", "wall", "slanting wall"],
)
def test_what_keeps_the_mirror_is_split(tail, more, monkeypatch):
    wave = ms.PlaneWaveTail(length=4.0, amplitude=0.25, waves=1.5, radius=0.08, ramp=0.2, **tail)
    assert_same_forces(*both(monkeypatch, beat(BODIES["sphere"], wave, **more), 0.7))


def test_a_tube_around_a_plane_wave_keeps_its_mirror(monkeypatch):
    channel = ms.Channel(shape="cylinder", diameter=3.0, length=10.0)
    assert_same_forces(*both(monkeypatch, beat(BODIES["sphere"], channel=channel), 0.7))


def test_what_breaks_the_mirror_is_solved_whole():
    """A wall across r, and a helix."""
    across = ms.Wall(distance=0.9, azimuth=0.5 * np.pi)
    assert number_of_mirrors(beat(BODIES["sphere"], wall=across)) == 0
    helix = ms.HelicalTail(length=4.0, amplitude=0.25, waves=1.5, radius=0.08, ramp=0.2)
    assert number_of_mirrors(beat(BODIES["sphere"], helix)) == 0
    assert number_of_mirrors(beat(BODIES["sphere"])) == 1


def test_an_ellipsoid_falls_into_eight(monkeypatch):
    surface = ellipsoid((1.0, 0.8, 0.5), 2)
    split = system.resistance(surface, 1.0)
    assert len(system.Layer(surface, 1.0).mirrors.parities) == 8
    monkeypatch.setattr(system, "mirrors", unsplit)
    whole = system.resistance(surface, 1.0)
    assert np.abs(split - whole).max() < 1e-11 * whole.max()


def test_parities_share_out_every_field():
    """Parts of all parities add up to the field, and none is seen by another."""
    mirrors = solve(beat(BODIES["ellipsoid"]), 0.7, level=LEVEL).layer.mirrors
    field = np.random.default_rng(5).normal(size=(mirrors.images.shape[1], 3, 2))
    parts = [p.spread(p.part(field)) for p in mirrors.parities]
    assert np.abs(sum(parts) - field).max() < 1e-14
    for n, parity in enumerate(mirrors.parities):
        for m, part in enumerate(parts):
            assert np.abs(parity.part(part)).max() < 1e-14 or n == m
    assert sum(np.count_nonzero(p.own) for p in mirrors.parities) == field[..., 0].size


def test_the_pressure_inside_belongs_to_the_even_half():
    """Constant and along the tail: pressures border the even system alone."""
    wave = ms.PlaneWaveTail(length=6.0, amplitude=0.25, waves=1.5, radius=0.04, ramp=0.2)
    layer = solve(beat(BODIES["sphere"], wave), 0.7, level=LEVEL).layer
    sizes = [len(lu[0]) for _, lu in system.factorised(layer).parts]
    own = [np.count_nonzero(p.own) for p in layer.mirrors.parities]
    assert len(layer.surface.node_pressures) > 1
    assert [a - b for a, b in zip(sizes, own, strict=True)] == [
        len(layer.surface.node_pressures),
        0,
    ]


def test_a_mirrored_swimmer_has_no_force_across_its_plane():
    """R couples none of s, q, turning about r with r and turning about s, q; exactly."""
    R = solve(beat(BODIES["ellipsoid"]), 0.7, level=LEVEL).raw_resistance
    even, odd = [0, 1, 5], [2, 3, 4]
    assert np.abs(R[np.ix_(even, odd)]).max() < 1e-13 * np.abs(R).max()
    assert np.abs(R[np.ix_(odd, even)]).max() < 1e-13 * np.abs(R).max()


def test_a_body_alone_is_split_too(monkeypatch):
    surface = body_surface(ms.Box(size=(0.8, 0.6, 0.5), edge=0.2), LEVEL.resolution)
    split = system.resistance(surface, 1.0, rule=LEVEL.rule)
    monkeypatch.setattr(system, "mirrors", unsplit)
    whole = system.resistance(surface, 1.0, rule=LEVEL.rule)
    assert np.abs(split - whole).max() < ROUNDING * whole.max()
