"""Volumes of bodies against what geometry says."""

import numpy as np
import pytest

import microswim as ms
from microswim.swimmer.geometry.solids.volume import volume_and_middle

KNOWN = {
    "sphere": (ms.Sphere(radius=0.5), np.pi / 6.0),
    "spheroid": (ms.Spheroid(semi_axes=(1.5, 0.5)), np.pi / 2.0),
    "ellipsoid": (ms.Ellipsoid(semi_axes=(1.0, 0.5, 0.25)), np.pi / 6.0),
    "capsule": (ms.Capsule(length=3.0, radius=0.5), np.pi / 2.0 + np.pi / 6.0),
    "none": (ms.NoBody(), 0.0),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_volumes(name):
    body, volume = KNOWN[name]
    found, middle = volume_and_middle(body)
    assert found == pytest.approx(volume, rel=1e-6)
    assert np.allclose(middle, body.centre, atol=1e-6)


def test_a_box_lacks_what_its_rounded_edges_lack():
    """Along every edge ``(1 - pi/4) r^2``, less at the corners, where three of them meet."""
    r, (a, b, c) = 0.1, (1.0, 2.0, 3.0)
    inner = (a - 2 * r, b - 2 * r, c - 2 * r)
    core = np.prod(inner) + 2 * r * (
        inner[0] * inner[1] + inner[1] * inner[2] + inner[0] * inner[2]
    )
    round_ = np.pi * r**2 * sum(inner) + 4.0 / 3.0 * np.pi * r**3
    assert volume_and_middle(ms.Box(size=(a, b, c), edge=r))[0] == pytest.approx(core + round_)


def test_a_drop_has_its_middle_where_it_is_wide():
    """Its profile is a spline, which has no formula."""
    drop = ms.Revolution(profile=[[0, 0.0], [-0.2, 0.1], [-0.6, 0.3], [-0.9, 0.25], [-1.0, 0.0]])
    volume, middle = volume_and_middle(drop)
    assert middle[0] < -0.5
    assert 0.0 < volume < np.pi * 0.3**2
    assert np.allclose(middle[1:], 0.0, atol=1e-9)
