"""Magnets and fields that do not depend on place: laws and limits."""

import numpy as np
import pytest

import microswim as ms
from microswim.swimmer.magnetism.applied_field import across

AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, -3), (-1, 0, 0), (0.95, 0.2, 0.1)]


@pytest.mark.parametrize("axis", AXES)
def test_across_makes_a_right_handed_set(axis):
    e1, e2 = across(axis)
    a = np.array(axis) / np.linalg.norm(axis)
    assert np.array([e1, e2, a]) @ np.array([e1, e2, a]).T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det([e1, e2, a]) == pytest.approx(1.0)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("cone", [0.0, 0.3, -0.4])
def test_a_rotating_field_turns(axis, cone):
    """Its size stays, it leans as said, and it turns with its angular velocity."""
    field = ms.RotatingField(strength=2.0, frequency=-0.7, axis=axis, cone=cone)
    times, h = np.linspace(0.0, 3.0, 50), 1e-5
    B = field.at(times)
    assert np.linalg.norm(B, axis=1) == pytest.approx(2.0, rel=1e-14)
    assert B @ np.array(axis) / np.linalg.norm(axis) == pytest.approx(2.0 * np.sin(cone))
    slope = (field.at(times + h) - field.at(times - h)) / (2 * h)
    assert slope == pytest.approx(np.cross(field.angular_velocity, B), abs=1e-8)


def test_an_oscillating_field_is_two_that_turn():
    to_and_fro = ms.OscillatingField(strength=2.0, frequency=3.0, direction=(0, 1, 0))
    one = ms.RotatingField(strength=1.0, frequency=3.0)
    other = ms.RotatingField(strength=1.0, frequency=-3.0)
    t = np.linspace(0.0, 1.0, 33)
    assert to_and_fro.at(t) == pytest.approx(one.at(t) + other.at(t), abs=1e-14)


def test_pieces_of_one_material_go_with_their_volume():
    given = {"remanence": 1.3, "direction": (0, 0, 1)}
    ball = ms.Magnet(**given, shape="sphere", size=(2e-3,))
    rod = ms.Magnet(**given, shape="cylinder", size=(2e-3, 2e-3))
    block = ms.Magnet(**given, size=(2e-3, 2e-3, 2e-3))
    by_volume = ms.Magnet(**given, volume=8e-9)
    assert block.vector == pytest.approx(by_volume.vector)
    assert rod.strength / ball.strength == pytest.approx(1.5)  # Archimedes
    assert rod.strength / block.strength == pytest.approx(np.pi / 4)


def test_a_direction_is_a_vector_or_an_angle():
    angle = ms.Magnet(moment=2.0, direction=np.radians(60), azimuth=np.radians(90))
    vector = ms.Magnet(moment=2.0, direction=(1, 0, np.sqrt(3.0)))
    assert angle.vector == pytest.approx([1.0, 0.0, np.sqrt(3.0)], abs=1e-15)
    assert vector.vector == pytest.approx(angle.vector, abs=1e-15)
    turned = ms.Magnet(moment=tuple(angle.vector), azimuth=np.radians(-90))
    assert turned.vector == pytest.approx([1.0, np.sqrt(3.0), 0.0], abs=1e-15)
