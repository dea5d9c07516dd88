"""Noise in fields that depend on place or follow a table: limits and order."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.rigid_motion import rotation_matrix

BEAD = ms.Swimmer(
    body=ms.Spheroid(semi_axes=(2e-6, 1e-6)), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1e-3),
    magnet=ms.Magnet(moment=(2e-17, 3e-17, 0)), noise=ms.Noise(temperature=300.0), units="SI",
)  # fmt: skip
GAIT = BEAD.gait()
NEAR = ms.DipoleField(moment=(0, 0, 1e-8), position=(0, 0, -1e-4), axis=(1, 0, 0), frequency=0.5)


def table(tmp_path, times, fields):
    file = tmp_path / "field.csv"
    rows = [",".join(map(repr, map(float, (t, *B)))) for t, B in zip(times, fields)]
    file.write_text("\n".join(["t (s),Bx (T),By (T),Bz (T)", *rows]) + "\n")
    return ms.SequenceField(file=str(file))


def end(field, seed=7, gait=GAIT, robot=BEAD, **more):
    return ms.path(replace(robot, field=field), 0.2, gait=gait, seed=seed, samples=3, **more)


def test_a_table_of_one_row_twice_is_a_uniform_field(tmp_path):
    told = end(ms.UniformField(strength=1e-3, direction=(0, 3, 4)), paths=4, step=0.01)
    B = (0.0, 0.6e-3, 0.8e-3)
    by_table = end(table(tmp_path, (0, 1), (B, B)), paths=4, step=0.01)
    assert by_table.position.values == pytest.approx(told.position.values, rel=1e-9, abs=1e-18)
    assert by_table.quaternion.values == pytest.approx(told.quaternion.values, abs=1e-9)


def test_a_field_that_turns_is_followed_to_high_order_by_a_table(tmp_path):
    turning = ms.RotatingField(strength=1e-3, frequency=2.0)
    times = np.linspace(0.0, 0.2, 2001)
    told = end(turning, step=0.01)
    by_table = end(table(tmp_path, times, turning.at(times)), step=0.01)
    assert by_table.quaternion.values == pytest.approx(told.quaternion.values, abs=2e-5)


def test_without_heat_it_goes_where_the_path_goes_at_order_two():
    strong = replace(BEAD, magnet=ms.Magnet(moment=(2e-15, 3e-15, 0)))
    cold, still = replace(strong, noise=ms.Noise(temperature=1e-16)), replace(strong, noise=None)
    exact = end(NEAR, robot=still, tolerance=1e-10).position.values[-1]
    moved = np.linalg.norm(exact)
    off = [
        np.linalg.norm(end(NEAR, robot=cold, step=h).position.values[-1] - exact)
        for h in (0.004, 0.002)
    ]
    assert moved > 1e-6  # it is pulled by more than its radius
    assert off[1] < 0.01 * moved
    assert 3.0 < off[0] / off[1] < 5.5


def test_a_magnet_far_away_makes_a_uniform_field():
    """The same seed, the same path, where the gradient counts for nothing."""
    far = ms.DipoleField(moment=(0, 0, 5e9), position=(0, 0, -100.0))
    B = float(far.at(0.0)[2])
    told = end(ms.UniformField(strength=B, direction=(0, 0, 1)), paths=3, step=0.01)
    found = end(far, paths=3, step=0.01)
    assert found.position.values == pytest.approx(told.position.values, rel=1e-5, abs=1e-12)
    assert found.quaternion.values == pytest.approx(told.quaternion.values, abs=1e-6)


def test_a_strong_magnet_takes_short_steps_with_noise():
    """``m B`` is two hundred thousand times ``k_B T``: the moment ends along the field."""
    strong = replace(BEAD, magnet=ms.Magnet(moment=(3e-13, 0, 0)))
    field = ms.UniformField(strength=3e-3, direction=(1, 1, 0))
    found = end(field, robot=replace(strong, fluid=ms.Fluid(viscosity=1.0)))
    along = rotation_matrix(found.quaternion.values[-1])[:, 0]
    assert along @ np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0) > 0.999
