"""What a tube adds to a tail that all but touches it: laws, and how it grows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses import layout, tube

ROBOT = ms.Swimmer.preset("tabak/helix")
RADIUS = 1.5
SHAPE = layout.shape_of(ROBOT, 1e-6)
NUMBERS = tube.numbers_of(SHAPE, 1e-6)


def at(line: Any) -> tuple[Any, Any]:
    return tube.of_tail(SHAPE, NUMBERS, RADIUS, np.asarray(line, float))


def leaning(gap: float, tilt: float = 0.0) -> Any:
    """A line at which the tail's nearest point is at a gap."""
    t = np.array([np.cos(tilt), np.sin(tilt), 0.0])
    b = np.array([0.0, 0.0, 0.0])
    for _ in range(60):
        y = SHAPE.tail + b
        out = y - np.outer(y @ t, t)
        far = np.linalg.norm(out, axis=1)
        k = int(np.argmax(far))
        b = b + (RADIUS - far[k] - float(ROBOT.tail.radius) - gap) * out[k] / far[k]
    return np.concatenate([t, b])


@pytest.mark.parametrize("tilt", [0.0, 0.3, 1.0])
def test_it_is_a_drag_and_the_thrust_is_that_of_the_turning_tail(tilt: float) -> None:
    """Symmetric, never negative; turned about s by the motor or with the body, the tail is one."""
    R, F = at(leaning(0.01, tilt))
    assert pytest.approx(R.T, rel=1e-9, abs=1e-9) == R
    assert np.linalg.eigvalsh(R).min() > -1e-12 * np.abs(R).max()
    assert pytest.approx(ROBOT.tail.sign * R[:, 3]) == F


def test_far_from_the_tube_it_is_all_but_nothing() -> None:
    """Beyond two half axes of the body: what is left is of the tip's ball."""
    R, _ = tube.of_tail(SHAPE, NUMBERS, 50.0, np.array([1.0, 0, 0, 0, 0, 0]))
    free = ROBOT.gait().resistance(0.0)
    assert np.abs(R).max() < 1e-4 * np.abs(free).max()


@pytest.mark.parametrize(("tilt", "slope"), [(0.0, -1.0), (1.2, -1.0)])
def test_a_turn_and_the_tip_are_points_that_yield_like_the_gap(tilt: float, slope: float) -> None:
    """A helix touches with the side of a turn or, where it leans, with its tip: like 1/gap."""
    gaps = np.array([2e-3, 1e-3])
    force = [np.linalg.eigvalsh(at(leaning(g, tilt))[0][:3, :3]).max() for g in gaps]
    assert np.diff(np.log(force)) / np.diff(np.log(gaps)) == pytest.approx(slope, abs=0.15)


def test_the_tip_is_a_ball_where_the_tail_stands_on_it() -> None:
    """Head on to the side, 6 pi mu r^2/g [Brenner 1961], beyond what the tail's own side has."""
    gap, r = 1e-4, float(ROBOT.tail.radius)
    line = leaning(gap, 0.5 * np.pi)
    R, _ = at(line)
    y = SHAPE.tail[-1] + line[3:]
    n = -(y - (y @ line[:3]) * line[:3])
    n /= np.linalg.norm(n)
    ball = 6.0 * np.pi * float(ROBOT.fluid.viscosity) * r**2 / gap
    assert n @ R[:3, :3] @ n == pytest.approx(ball, rel=0.03)
