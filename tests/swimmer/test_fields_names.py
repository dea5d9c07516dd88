"""Fields that say one thing in two ways."""

from dataclasses import replace

import pytest

import microswim as ms
from microswim.swimmer.fields import in_terms_of


def test_a_field_that_begins_alike_clears_nothing():
    """`tail.sections` is how sections stand, `tail.section` their half axes."""
    swimmer = ms.Swimmer.preset("tabak/helix-constant")
    sheared = swimmer.with_({"tail.sections": "sheared"})
    assert sheared.tail.radius == swimmer.tail.radius
    ribbon = swimmer.with_({"tail.section": (0.05, 0.02)})
    assert ribbon.tail.section == (0.05, 0.02)


def test_a_vector_and_an_angle_say_the_same_direction_of_a_magnet():
    """``--over magnet.direction`` asks for the angle of a spec that has the vector."""
    magnet = ms.Magnet(moment=2.0, direction=(0.2, 1.0, 0.3))
    robot = replace(ms.Swimmer.preset("tabak/helix"), magnet=magnet)
    by_angle = in_terms_of(robot, ["magnet.direction"])
    assert by_angle.magnet.vector == pytest.approx(magnet.vector, rel=1e-12)
    assert "magnet.direction" in by_angle.numbers
