"""A body alone that is drawn along another axis than s is told as what it does."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import microswim as ms
from microswim.path.regime_remarks import of_inertia


def rod(axis):
    """A long ellipsoid along an axis of its frame, its moment tilted out of it."""
    semi_axes, moment = [1.6, 0.5, 0.5], [0.5, np.sqrt(0.75), 0.0]
    return ms.Swimmer(
        body=ms.Ellipsoid(semi_axes=tuple(np.roll(semi_axes, axis))),
        tail=ms.NoTail(),
        fluid=ms.Fluid(viscosity=1.0),
        magnet=ms.Magnet(moment=tuple(np.roll(moment, axis))),
        field=ms.RotatingField(strength=1.0, frequency=0.02),
    )


@pytest.mark.parametrize("axis", [1, 2])
def test_angles_and_regimes_are_those_of_its_long_axis(axis):
    frequency = [0.001, 0.006, 0.012]
    told, along = ms.regimes(rod(axis), frequency), ms.regimes(rod(0), frequency)
    assert told.regime == along.regime
    assert told.precession_angle == pytest.approx(along.precession_angle, abs=1e-6)
    assert told.reynolds == pytest.approx(along.reynolds)
    assert told.closed_form.step_out == pytest.approx(along.closed_form.step_out)
    assert any(f"long along {'sqr'[axis]}" in remark for remark in told.remarks)
    assert not any("long along" in remark for remark in along.remarks)


def test_a_path_in_time_ends_at_the_angle_that_is_told():
    """Stepping knows of no long axis; the body starts with it along the field's axis."""
    swimmer = rod(2)
    gait, field = swimmer.gait(), swimmer.with_({"field.frequency": 0.012}).field
    told = ms.regimes(swimmer, [0.012], gait=gait)
    start = Rotation.from_euler("y", 90, degrees=True)
    path = ms.trajectory(
        gait, np.linspace(0.0, 4000.0, 801), rate=0.0, moment=swimmer.magnet.vector, field=field.at,
        quaternion=start.as_quat(scalar_first=True), max_step=5.0,
    )  # fmt: skip
    r = Rotation.from_quat(path.quaternion.values[-1], scalar_first=True).apply([0, 0, 1])
    assert np.arccos(abs(r[0])) == pytest.approx(told.precession_angle[0], abs=1e-3)


def test_a_wall_that_would_turn_with_the_robot_is_said():
    """The numbers are of one side: what is printed is not called left out."""
    robot = replace(rod(0), wall=ms.Wall(2.0))
    beside = ms.regimes(robot, [0.012]).remarks
    assert any("as if the wall turned with the robot" in remark for remark in beside)
    assert not any("left out; microswim path and" in remark for remark in beside)


def test_inertia_is_told_in_the_units_of_the_spec():
    frequencies, reynolds = np.array([10.0, 1250.0]), np.array([0.1, 302.0])
    (said,) = of_inertia(frequencies, reynolds, "SI")
    assert said.startswith("from 1.250 kHz on")
    assert "largest 302)" in said
    (said,) = of_inertia(frequencies, reynolds, "dimensionless")
    assert said.startswith("from 1250 turns per time on")
