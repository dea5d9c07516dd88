"""Balls and spheroids without a tail beside a wall: they sink, slide and roll as they should."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import microswim as ms
from microswim.calibration.poses import layout, wall
from microswim.calibration.poses.around import around
from microswim.models.bem import solution
from oracles.ball_by_a_wall import resistance

BALL = ms.Swimmer(
    body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0), wall=ms.Wall(2.5)
)
#: Heights from which on a fit of so many terms, at so many places, is exact to 1e-3.
FITS = (1.2, 16, 60), (1.05, 32, 80), (1.0, 48, 120)
FEW = wall.Grid(tilts=5, phases=4, left_out=0)


def exact(height):
    """Resistance beside the wall z = 0, by a fit that is exact enough."""
    return resistance(height, *next(n for least, *n in FITS if height > least))


@pytest.fixture(scope="module")
def poses(tmp_path_factory):
    return wall.beside_wall(BALL, grid=FEW, folder=tmp_path_factory.mktemp("solves"), workers=0)


def test_what_has_no_tail_has_a_place_where_it_touches_and_one_turn():
    shape = layout.shape_of(BALL, 0.01)
    assert shape.touch(0.3, 1.0) == pytest.approx(1.0, abs=1e-4)
    assert wall._solved_of(shape, FEW).sum() == (FEW.gaps - 1) * (2 * FEW.tilts - 1)


@pytest.mark.slow
def test_a_ball_sinks_as_the_exact_series_say(poses):
    """When it is at a gap, down to a fiftieth of its radius: ``t = int R_zz dz / f``."""
    force = 6.0 * np.pi
    found = ms.path(BALL, 6.0, poses=poses, force=(0, 0, -force), samples=13, contact=1e-4)
    gap = found.gap.values
    assert 0.02 < gap[-1] < 0.03
    at = np.geomspace(gap[-1], 1.5, 16)
    drag = CubicSpline(np.log(at), np.log([exact(1.0 + g)[2, 2] for g in at]))
    for time, reached in zip(found.time.values[1:], gap[1:], strict=True):
        finely = np.geomspace(reached, 1.5, 2001)
        needed = np.trapezoid(np.exp(drag(np.log(finely))) / force, finely)
        assert time == pytest.approx(needed, rel=0.01)
    sideways = np.abs(found.position[:, :2].values).max()
    assert sideways < 1e-3  # patches are not the same all round


@pytest.mark.slow
@pytest.mark.parametrize("gap", [1.0, 0.3, 0.1, 0.05, 0.02])
def test_a_ball_slides_and_rolls_as_the_exact_series_say(poses, gap):
    """Drawn along the wall, and turned about an axis along it: both velocities of each."""
    height = 1.0 + gap
    M = np.linalg.inv(exact(height))
    R, _ = poses.at((0.0, 0.0, height), (1.0, 0.0, 0.0, 0.0), 0.0)
    found = np.linalg.inv(R)
    for i in (0, 2, 4, 5):
        assert found[i, i] == pytest.approx(M[i, i], rel=0.01)
    coupling = np.sqrt(M[0, 0] * M[4, 4])
    assert found[0, 4] / coupling == pytest.approx(M[0, 4] / coupling, abs=0.01)
    time = 1e-3
    start = {"position": (0, 0, height), "quaternion": (1, 0, 0, 0)}
    drawn = ms.path(
        BALL, time, poses=poses, force=(1.0, 0.0, 0.0), contact=1e-4, samples=2, **start
    )
    assert drawn.position[-1, 0] / time == pytest.approx(M[0, 0], rel=0.01)
    turn = 2.0 * drawn.quaternion.values[-1, 2] / time
    assert turn == pytest.approx(M[4, 0], abs=0.01 * coupling)


@pytest.mark.slow
def test_a_spheroid_sinks_slides_and_rolls_as_solved_anew(tmp_path):
    egg = replace(BALL, body=ms.Spheroid(semi_axes=(2.0, 1.0)))
    poses = around(egg, folder=tmp_path, workers=0)
    assert 0.0 < max(v for v in poses.expected_error.values() if not isinstance(v, str)) < 0.02
    rng = np.random.default_rng(7)
    for _ in range(6):
        tilt, gap = rng.uniform(-0.5, 0.5), np.exp(rng.uniform(np.log(0.05), np.log(2.0)))
        high = gap + np.hypot(2.0 * np.sin(tilt), np.cos(tilt))
        near = replace(egg, wall=ms.Wall(high, tilt=tilt, azimuth=rng.uniform(-3.0, 3.0)))
        M = np.linalg.inv(solution.solve(near, level="standard").resistance)
        R, _ = poses.at(*wall.start_of(near.wall), 0.0)
        own = np.sqrt(np.diag(M))
        off = np.abs(np.linalg.inv(R) - M) / np.outer(own, own)
        assert off.max() < 0.01, (tilt, gap)
