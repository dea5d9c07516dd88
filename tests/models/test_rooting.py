"""Where a tail cannot leave its body, the refusal names the nearest ramp with which it can."""

import re

import numpy as np
import pytest

import microswim as ms
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.joint import trace_joint
from microswim.models.rooting import check

WAVE = {"length": 2.0, "radius": 0.05}
STUCK = [
    (ms.Sphere(radius=0.5), {"amplitude": 0.6, "waves": 2, "ramp": 0.0}),  # winds around the body
    (ms.Cylinder(length=1.0, radius=0.5), {"amplitude": 0.3, "waves": 1, "ramp": 0.02}),  # folds
    (ms.Ellipsoid(semi_axes=(0.2, 0.5, 0.5)), {"amplitude": 0.3, "waves": 2, "ramp": 0.02}),
]


def built(body, tail):
    check(body, tail, 0.0)
    return swimmer_surface(body, tail, 0.0, get_level("standard").resolution)


@pytest.mark.parametrize(("body", "wave"), STUCK)
def test_what_the_refusal_offers_works(body, wave):
    tail = ms.HelicalTail(**WAVE, **wave)
    with pytest.raises(ms.SpecError, match="nearest that works here") as refused:
        built(body, tail)
    ramp = float(re.search(r"tail\.ramp = ([\d.]+)$", str(refused.value))[1])
    other = ms.HelicalTail(**WAVE, **(wave | {"ramp": ramp}))
    surface = built(body, other)
    assert abs(surface.moments[2].sum(axis=(0, 1))).max() < 1e-2 * surface.extent[0]  # closed


def test_a_tail_without_a_ramp_is_offered_none():
    def beside(s, phase):
        return np.stack(np.broadcast_arrays(s, 0.7 + 0.0 * phase, 0.0 * s), axis=-1)

    tail = ms.CustomTail(shape=beside, length=2.0, radius=0.05)
    with pytest.raises(ms.SpecError) as refused:
        built(ms.Sphere(radius=0.5), tail)
    assert "nearest" not in str(refused.value)


@pytest.mark.parametrize(("long", "slope"), [(1.0, 1.0), (3.0, 0.6), (5.0, 1.5)])
def test_a_root_is_closed_unless_the_end_of_the_body_has_no_room_for_it(long, slope):
    """Slope m, body R by a: room where sqrt(a^2 + m^2 R^2) - m R > r sqrt(1 + m^2)."""
    widest = (np.hypot(1.0, slope * long) - slope * long) / np.hypot(1.0, slope)

    def closed(radius):
        tail = ms.HelicalTail(length=8.0, waves=0.5, amplitude=0.8 * slope, ramp=0.1, radius=radius)
        body = ms.Ellipsoid(semi_axes=(long, 1.0, 1.0))
        try:
            joint = trace_joint(body, tail)
        except ms.SpecError:  # the tube lies along the body
            return False
        surface = swimmer_surface(body, tail, 0.0, get_level("coarse").resolution)
        assert surface.is_open == joint.is_open
        return not joint.is_open

    kinds = [closed(share * widest) for share in (0.7, 0.95, 1.05, 1.5)]
    assert kinds == [True, True, False, False]
