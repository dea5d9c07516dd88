"""Boundary elements in a tube: series on the axis, limits off it, mirrors, finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.errors import SpecError
from microswim.models import bem
from oracles.ball_in_a_tube import drag

BALL = ms.Swimmer(body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0))
ROBOT = ms.Swimmer.preset("tabak/helix")


def ball_in(ratio: float, **where: object) -> ms.Swimmer:
    tube = ms.Channel(diameter=2 / ratio, length=max(6 / ratio, 8.0), **where)  # type: ignore[arg-type]
    return replace(BALL, channel=tube)


@pytest.mark.parametrize(("ratio", "off"), [(0.1, 1e-4), (0.4, 1e-4), (0.6, 1e-3), (0.8, 3e-3)])
def test_drag_on_the_axis_is_that_of_the_series(ratio: float, off: float) -> None:
    R = bem.solve(ball_in(ratio)).resistance
    assert R[0, 0] / (6 * np.pi) == pytest.approx(drag(ratio), rel=off)
    assert R[1, 1] == pytest.approx(R[2, 2], rel=1e-3)
    assert np.abs(R[:3, 3:]).max() < 1e-3 * R[0, 0]


def test_of_a_long_tube_only_what_is_around_the_swimmer_is_solved() -> None:
    """Fluid far off in a closed tube does not move."""
    near, far = (
        bem.solve(replace(BALL, channel=ms.Channel(diameter=4.0, length=length)))
        for length in (12.0, 300.0)
    )
    assert far.unknowns <= near.unknowns
    assert far.resistance[0, 0] == pytest.approx(near.resistance[0, 0], rel=1e-4)
    beyond = np.array([[30.0, 0.5, 0.5]])
    assert np.abs(far.velocity(beyond, np.array([1.0, 0, 0, 0, 0, 0]))).max() < 1e-3


@pytest.mark.parametrize(
    ("level", "off"), [("coarse", 0.05), pytest.param("standard", 0.01, marks=pytest.mark.slow)]
)
def test_a_long_cylinder_is_dragged_as_the_annulus_says(level: str, off: float) -> None:
    """Per length, ends taken off: 2 pi mu (1 + k^2) / ((1 + k^2) log 1/k - (1 - k^2)), no net flux.

    With densities of order 2 the tube leaks: half of the drag.
    """
    k, drags = 0.77, []
    for length in (2.0, 3.5):
        tube = ms.Channel(diameter=2.0, length=length + 4.0)
        body = ms.Cylinder(length=length, radius=k)
        drags.append(
            bem.solve(replace(BALL, body=body, channel=tube), level=level).resistance[0, 0]
        )
    exact = 2 * np.pi * (1 + k**2) / ((1 + k**2) * np.log(1 / k) - (1 - k**2))
    assert (drags[1] - drags[0]) / 1.5 == pytest.approx(exact, rel=off)


def test_torque_on_the_axis_follows_the_reflected_rotlet() -> None:
    """T = 8 pi mu a^3 (1 + 0.79682 (a/b)^3 + ...) [Brenner & Sonshine 1964]."""
    for ratio in (0.2, 0.3):
        R = bem.solve(ball_in(ratio)).resistance
        assert R[3, 3] / (8 * np.pi) == pytest.approx(1 / (1 - 0.79682 * ratio**3), rel=1e-3)


def test_a_wide_tube_is_free_fluid_and_its_side_a_plane() -> None:
    """Next to the side of a tube 15 times as wide the plane wall's resistance, to a/b."""
    gap, wide = 0.3, 15.0
    side = ball_in(1 / wide, position=(0.0, wide - 1.0 - gap, 0.0))
    near = bem.solve(side, level="coarse").resistance
    plane = bem.solve(replace(BALL, wall=ms.Wall(1.0 + gap)), level="coarse").resistance
    assert np.diag(near) / np.diag(plane) == pytest.approx(np.ones(6), abs=1.5 / wide)
    assert np.all(np.diag(near) > np.diag(plane))


def test_drag_off_the_axis_falls_as_greenstein_and_happel_say() -> None:
    """Along the tube 1 + f(beta) a/b, f = 2.10444 - 0.6977 beta^2 near the axis; it turns as well.

    Torque over 8 pi mu a^2 U: g = 1.296 beta (a/b)^2 to first order.
    """
    ratio, beta = 0.05, 0.2
    axis = bem.solve(ball_in(ratio)).resistance / (6 * np.pi)
    off = bem.solve(ball_in(ratio, position=(0.0, beta / ratio, 0.0))).resistance / (6 * np.pi)
    free = 1.0 - 1.0 / np.array([axis[0, 0], off[0, 0]])  # mobility is linear in a/b further
    assert free[0] / ratio == pytest.approx(2.10444, rel=5e-3)
    assert (free[0] - free[1]) / ratio == pytest.approx(0.6977 * beta**2, rel=0.2)
    assert abs(off[0, 5]) * 0.75 == pytest.approx(1.296 * beta * ratio**2, rel=0.2)


def test_a_mirrored_place_is_a_mirrored_resistance() -> None:
    """Place and tilt mirrored in q: R with the signs of the mirror image."""
    here = bem.solve(ball_in(0.4, position=(0.2, 0.8, 0.0), tilt=0.3), level="coarse").resistance
    there = bem.solve(ball_in(0.4, position=(0.2, -0.8, 0.0), tilt=-0.3), level="coarse").resistance
    signs = np.array([1, -1, 1, -1, 1, -1])
    scale = np.sqrt(np.outer(np.diag(here), np.diag(here)))
    assert np.abs((there * np.outer(signs, signs) - here) / scale).max() < 2e-3


def test_the_swimmer_in_a_tube_is_that_of_the_finite_elements() -> None:
    """Closed tube of diameter and length 10, all free but us, uq, ur, os held to the paper's four.

    The finite elements give u_s -0.0302, Omega_s -0.410 (481,000 unknowns, docs/accuracy-fem.md).
    """
    tube = replace(
        ROBOT,
        channel=ms.Channel(diameter=10.0, length=10.0),
        motion=ms.Motion(free=("us", "uq", "ur", "os")),
    )
    gait = tube.gait("bem", level="coarse")
    assert gait.mean_velocity[0] == pytest.approx(-0.0302, rel=0.02)
    assert gait.mean_velocity[3] == pytest.approx(-0.410, rel=0.02)
    assert gait.info["phases_solved"] == 1
    assert gait.one_pose == ""


def test_turns_of_a_tail_that_pass_a_wide_tube_leave_R_symmetric() -> None:
    """As Lorentz has it: where one patch of the tube sees two turns, both are resolved."""
    tube = ms.Channel(
        diameter=6.0, length=12.1, position=(0.0, 2.242, 0.883), tilt=0.3598, azimuth=-2.0969
    )
    assert bem.solve(replace(ROBOT, channel=tube)).asymmetry < 1e-4


def test_off_the_axis_a_gait_holds_at_one_pose() -> None:
    tube = replace(BALL, channel=ms.Channel(diameter=6.0, length=12.0, position=(0.0, 1.0, 0.0)))
    assert tube.gait("bem", level="coarse").one_pose == "channel"


def test_a_box_and_a_swimmer_that_touches_are_refused() -> None:
    box = replace(BALL, channel=ms.Channel(diameter=6.0, length=12.0, shape="box"))
    with pytest.raises(SpecError, match=r"channel\.shape"):
        bem.solve(box)
    with pytest.raises(SpecError, match=r"channel\.diameter"):
        bem.solve(replace(BALL, channel=ms.Channel(diameter=1.9, length=12.0)))


def test_an_azimuth_of_the_tube_is_a_turn_about_s():
    """Tube and tail turned alike about s: R is turned with them."""
    tube = ms.Channel(diameter=3.0, length=7.0, position=(0.0, 0.2, 0.1), tilt=0.2)
    turn = 0.7
    turned = bem.solve(
        replace(ROBOT, channel=replace(tube, azimuth=turn)), ROBOT.tail.sign * turn, level="coarse"
    )
    plain = bem.solve(replace(ROBOT, channel=tube), 0.0, level="coarse")
    c, s = np.cos(turn), np.sin(turn)
    Q = np.kron(np.eye(2), np.array([[1, 0, 0], [0, c, -s], [0, s, c]]))
    assert turned.resistance == pytest.approx(Q @ plain.resistance @ Q.T, rel=2e-3, abs=1.0)
    assert turned.propulsion == pytest.approx(Q @ plain.propulsion, rel=5e-3, abs=0.3)
