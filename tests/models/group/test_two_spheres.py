"""Two spheres against the exact series, near and far."""

import numpy as np
import pytest

import microswim as ms
from microswim.errors import SpecError
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.surface import ellipsoid
from microswim.models.bem.system import Layer, factorised, rigid_modes, wrench_rows
from microswim.models.group.coupled import Block, Placed, solve_coupled
from microswim.models.group.nearness import refined
from oracles import two_spheres

RULE = get_level("standard").rule


def placed(surface, centre):
    layer = Layer(surface, 1.0, RULE)
    return Placed(Block(layer, factorised(layer), centre), np.eye(3), centre)


def resistance(gap):
    """R (12, 12), the second sphere above the first along z."""
    centres = np.zeros(3), np.array([0.0, 0.0, 2.0 + gap])
    sphere = ellipsoid((1.0, 1.0, 1.0), 1, 3)
    there = [
        type(sphere)(sphere.controls + c, sphere.motion, sphere.on_tail, sphere.order)
        for c in centres
    ]
    both = [placed(s, c) for s, c in zip(refined(there)[0], centres, strict=True)]
    velocities = []
    for i, p in enumerate(both):
        u = np.zeros((p.unknowns, 12))
        u[:, 6 * i : 6 * i + 6] = rigid_modes(p.surface.nodes, p.position).reshape(-1, 6)
        velocities.append(u)
    density, _ = solve_coupled(both, velocities)
    parts = np.split(density, [both[0].unknowns])
    return np.concatenate([
        wrench_rows(p.surface, p.position) @ f for p, f in zip(both, parts, strict=True)
    ])  # fmt: skip


@pytest.mark.parametrize("gap", [3.0, 1.0, 0.1])
def test_two_spheres_resist_as_the_exact_series_say(gap):
    exact, found = two_spheres.resistance(gap), resistance(gap)
    scale = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
    assert np.abs((found - exact) / scale).max() < 0.002  # 0.5 % is promised
    for opposed in (False, True):  # along the line of centres, by another series
        force = found[2, 2] + (-1 if opposed else 1) * found[2, 8]
        assert force / (6 * np.pi) == pytest.approx(two_spheres.along(gap, opposed), rel=2e-3)
    assert np.linalg.eigvalsh(0.5 * (found + found.T)).min() > 0


def test_two_balls_of_a_scene_are_the_same_spheres():
    """A swimmer without a tail, by the whole way of a scene; pushed at, both move as they must."""
    ball = ms.Swimmer(body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0))
    pushed = ms.Member(swimmer=ball, position=(0.0, 0.0, 2.3), force=(0.0, 0.4, 1.0))
    found = ms.Group((ms.Member(swimmer=ball), pushed)).swim()
    exact = two_spheres.resistance(0.3)
    scale = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
    assert np.abs((found.resistance - exact) / scale).max() < 0.002
    V = np.linalg.solve(exact, np.array([0.0] * 6 + [0.0, 0.4, 1.0, 0.0, 0.0, 0.0]))
    assert found.mean_velocity.reshape(-1) == pytest.approx(V, abs=2e-3 * np.abs(V).max())
    assert found.phases == 1


def test_both_series_agree_with_each_other():
    """The oracle itself: Lamb's solution and bispherical coordinates share nothing."""
    for gap in (1.0, 0.1):
        R = two_spheres.resistance(gap, 50)
        for opposed in (False, True):
            force = R[2, 2] + (-1 if opposed else 1) * R[2, 8]
            along = two_spheres.along(gap, opposed)
            assert force / (6 * np.pi) == pytest.approx(along, rel=1e-7)


def test_spheres_that_overlap_or_nearly_touch_are_refused():
    sphere = ellipsoid((1.0, 1.0, 1.0), 1, 3)
    small = ellipsoid((0.3, 0.3, 0.3), 1, 3)

    def beside(one, x):
        shifted = one.controls + np.array([x, 0.0, 0.0])
        return type(one)(shifted, one.motion, one.on_tail, one.order)

    for inner, x in ((sphere, 1.5), (sphere, 1.995), (small, 0.1), (small, 1.1)):
        with pytest.raises(SpecError, match="overlaps or touches"):
            refined([sphere, beside(inner, x)])
    with pytest.raises(SpecError, match="nearer than its patches can resolve"):
        refined([sphere, beside(sphere, 2.0005)])
    far = [sphere, beside(sphere, 6.0)]
    same, gap = refined(far)
    assert all(a is b for a, b in zip(same, far, strict=True))
    assert gap == pytest.approx(4.0, rel=1e-2)


@pytest.mark.parametrize("gap", [1.0, 3.0])
def test_the_estimate_knows_balls(gap):
    """Each has six patches at `coarse`, at which x y is zero: their forces must not be lost."""
    ball = ms.Swimmer(body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0))
    there = ms.Member(swimmer=ball, position=(0.0, 0.0, 2.0 + gap))
    found = ms.Group((ms.Member(swimmer=ball), there)).estimate(level="coarse")
    exact, M = (np.linalg.inv(R) for R in (two_spheres.resistance(gap), found.resistance))
    scale = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
    off = np.abs((M - exact) / scale)[6:, :6]  # what one does to the other; R of one is the level's
    assert off.max() < found.expected_error < 0.03
