"""Thresholds of straight filaments against those of books, and laws of drag."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms

EULER = np.pi**2 / 4.0
GREENHILL = 7.83734744


def swimmer(ratio=0.5, **parts):
    tail = ms.ElasticTail(length=1.0, radius=0.01, bending=1.0, drive="none")
    parts = {"body": ms.NoBody(), "motion": ms.Motion(free="none"), "tail": tail} | parts
    law = ms.Constant(normal=1.0, tangential=ratio, spin=False)
    return ms.Swimmer(fluid=ms.Fluid(viscosity=1.0), coefficients=law, **parts)


@pytest.mark.parametrize("ratio", [0.3, 0.9])
@pytest.mark.parametrize(("load", "size", "rate"), [
    ("tip", 37.695, 191.26), ("along", 76.102, 196.59),
    ("end", EULER, 0.0), ("weight", GREENHILL, 0.0),
])  # fmt: skip
def test_thresholds_are_those_of_theory_whatever_the_drag_along(ratio, load, size, rate):
    """Follower loads: flutter of a clamped filament in a viscous fluid; dead ones: buckling."""
    found = ms.stability(swimmer(ratio), load)
    assert found.load == pytest.approx(size, rel=2e-5)
    assert found.rate == pytest.approx(rate, rel=2e-5)
    assert found.flutters == (rate > 0.0)


def test_thresholds_scale_as_they_must():
    one = swimmer()
    other = one.with_({"tail.bending": 3.0, "tail.length": 2.0, "tail.frequency": 7.0})
    a, b = ms.stability(one, "along"), ms.stability(other, "along")
    assert b.load == pytest.approx(a.load * 3.0 / 2.0**3)
    assert b.rate == pytest.approx(a.rate * 3.0 / 2.0**4, rel=1e-6)


def test_a_free_body_gives_way():
    """A head that may turn and slide holds the filament less than a wall; a huge one as well."""
    small, huge = (
        ms.stability(swimmer(body=ms.Sphere(radius=r), motion=ms.Motion())).load
        for r in (0.2, 300.0)
    )
    assert small < huge
    assert huge == pytest.approx(37.695, rel=1e-3)


def test_a_hook_buckles_under_its_stiffness_over_the_length_of_a_stiff_tail():
    """``F L theta = (B_h / l_h) theta``."""
    one = swimmer().with_({"tail.bending": 1e3})
    hooked = replace(one, hook=ms.Hook(stiffness=0.02, length=0.1))
    assert ms.stability(hooked, "end").load == pytest.approx(0.2 / 1.0, rel=1e-3)


def test_an_unknown_load_is_refused():
    with pytest.raises(ms.SpecError, match="load"):
        ms.stability(swimmer(), "sideways")  # type: ignore[arg-type]
