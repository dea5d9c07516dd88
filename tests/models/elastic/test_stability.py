"""Thresholds of straight filaments against those of books, and laws of drag."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from oracles.elastic_filament import turning_torque

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


def test_a_bent_tail_has_no_threshold_of_a_straight_one():
    tail = ms.ElasticTail(length=1.0, radius=0.01, bending=1.0, drive="none", rest_radius=0.5)
    one = ms.Swimmer(body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0))
    with pytest.raises(ms.SpecError, match="straight for the load"):
        ms.stability(one, "end")


def test_an_unknown_load_is_refused():
    with pytest.raises(ms.SpecError, match="load"):
        ms.stability(swimmer(), "sideways")  # type: ignore[arg-type]


def turned(radius, **tail):
    """A filament of length 1 on a held base that turns, c_n = 1."""
    own = {"length": 1.0, "radius": radius, "bending": 1.0, "drive": "rotate"} | tail
    return ms.Swimmer(
        body=ms.NoBody(), tail=ms.ElasticTail(**own), fluid=ms.Fluid(viscosity=1.0),
        coefficients=ms.Constant(normal=1.0, tangential=0.5, spin=True),
        motion=ms.Motion(free="none"),
    )  # fmt: skip


@pytest.mark.parametrize("twisting", [0.4, 1.5])
def test_a_motor_makes_a_straight_rod_whirl(twisting):
    """At ``w c_r L^2 / B = 8.9``, under the torque ``c_r w L``."""
    one = turned(0.02, angle=0.0, twisting=twisting)
    found = ms.stability(one, "motor")
    spin = one.coefficients.local(one.tail, 1.0)[2]
    assert found.motor_rate is not None
    assert found.motor_rate * spin == pytest.approx(8.9, rel=0.01)
    assert found.load == pytest.approx(found.motor_rate * spin, rel=1e-6)
    assert found.flutters


def test_a_tilted_rod_jumps_where_the_torque_no_longer_rises():
    """The closed form of small tilt has its first maximum there."""
    tilt = 0.02
    found = ms.stability(turned(1e-4, angle=tilt), "motor")
    numbers = np.geomspace(1.0, 3.0, 2001)
    torques = np.array([turning_torque(n) for n in numbers])
    top = int(np.argmax(np.diff(torques) < 0.0))
    assert found.load == pytest.approx(torques[top] * tilt**2, rel=2e-3)
    assert found.motor_rate is not None
    assert found.motor_rate**0.25 == pytest.approx(numbers[top], rel=0.02)
    assert found.rate == 0.0


@pytest.mark.slow  # the gallery's hook_flick asks the same of a cell
def test_a_hook_buckles_when_the_helix_pushes_and_stands_more_when_it_pulls():
    helix = ms.ElasticTail(length=1.0, radius=0.01, bending=1.0, drive="rotate",
                           rest_radius=0.05, rest_pitch=-0.4)  # fmt: skip
    law = ms.Constant(normal=1.0, tangential=0.5)
    one = ms.Swimmer(body=ms.Sphere(radius=0.2), tail=helix, fluid=ms.Fluid(viscosity=1.0),
                     hook=ms.Hook(stiffness=5e-4, length=0.02), coefficients=law)  # fmt: skip
    pushed = ms.stability(one, "motor")
    pulled = ms.stability(one.with_({"tail.frequency": -1.0}), "motor")
    assert pushed.load < 0.7 * pulled.load
    softer = replace(one, hook=ms.Hook(stiffness=2.5e-4, length=0.02))
    ratio = ms.stability(softer, "motor").load / pushed.load
    assert 0.45 < ratio < 0.55  # a rigid helix: nothing but the hook bends
    with pytest.raises(ms.SpecError, match="rotate"):
        ms.stability(swimmer(), "motor")
