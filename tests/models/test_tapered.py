"""Filaments that taper: rft and boundary elements."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import microswim as ms
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.solution import solve

WAVE: dict[str, Any] = {"length": 1.5, "amplitude": 0.1, "waves": 1.5, "radius": 0.05}
KINDS: Any = [ms.HelicalTail, ms.PlaneWaveTail]


def swimmer(tail, **more):
    return ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=2.0), **more)


@pytest.mark.parametrize("kind", KINDS)
def test_a_tip_as_thick_as_the_root_changes_nothing(kind):
    plain, same = (kind(**WAVE, **more) for more in ({}, {"radius_end": 0.05}))
    a, b = (swimmer(tail).gait() for tail in (plain, same))
    assert b.mean_velocity == pytest.approx(a.mean_velocity, rel=1e-9, abs=1e-12)
    assert b.mean_power == pytest.approx(a.mean_power, rel=1e-9)
    R, S = (solve(swimmer(tail), 0.3, level="coarse").resistance for tail in (plain, same))
    assert np.abs(R - S).max() < 1e-12 * np.abs(R).max()


def test_a_straight_one_drags_as_its_pieces_do():
    """Cox's law at each radius, integrated by another rule."""
    tail = ms.HelicalTail(length=2.0, amplitude=0.0, waves=1, radius=0.06, radius_end=0.02)
    law = ms.Cox(spin=True)
    made = ms.Swimmer(
        body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=2.0), coefficients=law
    ).gait()

    def of(which):
        def at(s):
            thin = 0.06 - 0.02 * s
            return law.local(ms.HelicalTail(length=2.0, amplitude=0.0, waves=1, radius=thin), 2.0)[
                which
            ]

        return quad(at, 0.0, 2.0)[0]

    R = made.resistance_series[0]
    assert [R[0, 0], R[1, 1], R[3, 3]] == pytest.approx([of(0), of(1), of(2)], rel=1e-8)


@pytest.mark.parametrize("kind", KINDS)
def test_the_tube_holds_what_its_sections_hold(kind):
    """Volume pi r^2 dl, of sheared sections pi r^2 ds, and half a sphere at each end."""
    tail = kind(**WAVE, radius_end=0.02, ramp=0.0)
    resolution = get_level("standard").resolution
    volume = swimmer_surface(ms.NoBody(), tail, 0.4, resolution).extent[1]
    s = np.linspace(0.0, 1.5, 4001)
    speed = np.linalg.norm(tail.centreline(s, 0.4)[1], axis=-1) if tail.is_rigid else 1.0
    inside = np.trapezoid(np.pi * (0.05 - 0.02 * s) ** 2 * speed, s)
    ends = 2.0 * np.pi / 3.0 * (0.05**3 + 0.02**3)
    assert volume == pytest.approx(inside + ends, rel=1e-4)
    coarse, fine = (solve(swimmer(tail), 0.4, level=n) for n in ("coarse", "standard"))
    scale = np.sqrt(np.diag(fine.resistance))
    off = np.abs(coarse.resistance - fine.resistance) / np.outer(scale, scale)
    assert off.max() < 4e-3
    assert fine.reciprocity < 1e-3
    thick, thin = (
        solve(swimmer(kind(**(WAVE | {"radius": r}), ramp=0.0)), 0.4, level="coarse").activity
        for r in (0.05, 0.02)
    )
    assert thin < coarse.activity < thick


def test_a_tip_that_does_not_fit_is_refused_and_it_is_a_field():
    with pytest.raises(ms.SpecError, match="radius_end"):
        ms.HelicalTail(**WAVE, radius_end=-0.1)
    with pytest.raises(ms.SpecError, match="radius_end"):
        ms.HelicalTail(**WAVE, radius_end=2.0)
    with pytest.raises(ms.SpecError, match="radius_end"):
        swimmer(ms.HelicalTail(**WAVE, radius_end=0.02)).gait("fem")
    made = swimmer(ms.HelicalTail(**WAVE)).with_({"tail.radius_end": 0.02})
    assert made.tail.radius_end == 0.02


def test_gravity_weighs_what_is_there():
    """Of a cone: a third of (1 + q + q^2) of the cylinder's volume."""
    from microswim.swimmer.surroundings.weight import _of_one

    volume = [
        float(_of_one(ms.HelicalTail(**WAVE, ramp=0.0, **more), np.zeros(1))[0][0])
        for more in ({}, {"radius_end": 0.025})
    ]
    assert volume[1] / volume[0] == pytest.approx((1 + 0.5 + 0.25) / 3, rel=1e-9)
