"""A gait as a function of the pose beside a wall: coordinates, factors, splines, and the whole."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses import fit, layout, wall
from microswim.errors import SpecError
from microswim.gait.poses import beside_wall
from microswim.gait.poses.table import WALL, WORK, PoseTable, resist
from microswim.gait.stepping import pack
from microswim.models import bem
from microswim.models.bem.patches.surface import positions
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.rigid_motion import multiply, rotation_matrix

ROBOT = ms.Swimmer.preset("tabak/helix")
CELL = ms.Swimmer.preset("goto/A")
HEADS = [ROBOT, CELL, replace(ROBOT, body=ms.Capsule(length=1.5, radius=0.4))]


def planted(swimmer: ms.Swimmer, made: Any) -> PoseTable:
    """Table of a wall that adds `made(xi, sigma, turn)`, (27,), to what the surrogate says."""
    shape = layout.shape_of(swimmer, 0.01)
    lowest = float(shape.numbers[beside_wall.LOWEST])
    values = np.empty((2, 9, 7, 9, 27))
    for index in np.ndindex(values.shape[:4]):
        side, i, j, k = index
        sigma = (1 - 2 * side) * j / 6
        values[index] = made(lowest * (1 - i / 8), sigma, 2 * np.pi * k / 9)
    return PoseTable(
        WALL, pack(swimmer.gait()), np.array([0.0, 0, 0, 0, 0, 1]), shape.numbers, shape.body,
        shape.tail, shape.kinks, fit.coefficients(values), switch=shape.switch,
    )  # fmt: skip


def asked(table: PoseTable, x: Any, q: Any, phase: float, compile_it: bool = True) -> Any:
    R, F, touch = np.empty((6, 6)), np.empty(6), np.empty(14)
    with settled(compile_it):
        resist(
            table, np.asarray(x, float), np.asarray(q, float), phase, R, F, touch, np.empty(WORK)
        )
    return R, F, touch


def turned(axis: Any, angle: float) -> Any:
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])


SMOOTH = np.random.default_rng(4).normal(size=(4, 27)) * 0.1


def smooth(xi: float, sigma: float, turn: float) -> Any:
    """Nothing at xi = 0, and what splines hold exactly; with a kink where the turn is full."""
    a, b, c, d = SMOOTH
    once = turn / (2.0 * np.pi) - turn**2 / (2.0 * np.pi) ** 2
    return xi * (a + b * sigma**2 + c * once + d * once * xi * sigma)


@pytest.mark.parametrize("swimmer", HEADS)
def test_the_gap_is_that_of_the_surface(swimmer: ms.Swimmer) -> None:
    """Against the boundary elements' own surface."""
    shape = layout.shape_of(swimmer, 0.01)
    length = shape.numbers[beside_wall.LENGTH]
    surface = bem.solve(replace(swimmer, wall=None), level="coarse").surface
    X = positions(surface, 17).reshape(-1, 3) - np.asarray(swimmer.body.centre)
    for tilt in (-0.6, -0.2, -0.05, 0.0, 0.1, 0.5):
        for psi in (0.3, 2.0, 4.4):
            n = np.array(ms.Wall(1.0, tilt=tilt, azimuth=-swimmer.tail.sign * psi).normal)
            assert shape.touch(tilt, psi) == pytest.approx(-(X @ n).min(), abs=4e-3 * length)


@pytest.mark.parametrize("swimmer", HEADS)
def test_coordinates_and_poses_are_inverse(swimmer: ms.Swimmer) -> None:
    """A planted xi, sigma, turn comes back from the pose that it stands for."""
    shape = layout.shape_of(swimmer, 0.01)
    for xi, sigma, turn in [
        (-3.0, 0.4, 1.0),
        (-1.0, -0.7, 5.0),
        (-4.0, -0.1, 2.2),
        (-0.1, 0.9, 0.1),
    ]:
        beside = wall.beside(swimmer, shape, *shape.pose(xi, sigma, turn))
        x, q = wall.start_of(beside.wall)
        touch, at = np.zeros(14), np.zeros(8)
        with settled(False):
            beside_wall.contact(
                np.array([0.0, 0, 0, 0, 0, 1]), shape.numbers, shape.body, shape.tail, x, q, 0.0,
                touch, at,
            )  # fmt: skip
            beside_wall.place(shape.numbers, shape.kinks, shape.switch, touch, 0.0, at)
        found = [at[2], at[3], 2.0 * np.pi * at[6]]
        assert found == pytest.approx([xi, sigma, turn], abs=1e-6)


@pytest.mark.parametrize(("swimmer", "tilt"), [(ROBOT, -0.5), (ROBOT, -0.25), (CELL, -0.2)])
def test_a_turn_is_full_where_another_turn_of_the_tail_is_nearest(
    swimmer: Any, tilt: float
) -> None:
    """The nearest point runs along the tail, and jumps back once, where the coordinate is 0."""
    shape, many = layout.shape_of(swimmer, 0.01), 400
    nearest, turns = np.empty(many), np.empty(many)
    touch, at, wall_at_0 = np.zeros(14), np.zeros(8), np.array([0.0, 0, 0, 0, 0, 1])
    _, q = wall.start_of(ms.Wall(1.0, tilt=tilt))
    x = np.array([0.0, 0.0, 20.0 * shape.numbers[beside_wall.REACH]])
    for k in range(many):
        phase = 2.0 * np.pi * k / many
        beside_wall.contact(
            wall_at_0, shape.numbers, shape.body, shape.tail, x, q, phase, touch, at
        )
        beside_wall.place(shape.numbers, shape.kinks, shape.switch, touch, phase, at)
        n = touch[11:14]
        nearest[k] = np.cross(n, touch[8:11])[0] + (touch[7] - x[2]) * n[0]
        turns[k] = at[6]
    jumps, fulls = np.abs(np.diff(nearest, append=nearest[:1])), np.diff(turns, append=turns[:1])
    wave = float(swimmer.tail.apparent_length / swimmer.tail.number_of_waves)
    assert np.flatnonzero(jumps > 0.3 * wave) == pytest.approx(np.flatnonzero(fulls < 0.0), abs=1)
    assert (jumps > 0.3 * wave).sum() == 1


def test_factors_and_matrices_are_inverse() -> None:
    """R and F_p come back from their factors, at any attitude."""
    rng = np.random.default_rng(1)
    A = rng.normal(size=(6, 6))
    R, F = A @ A.T + np.eye(6), rng.normal(size=6)
    numbers = layout.shape_of(ROBOT, 0.01).numbers
    touch, S, H = np.zeros(14), np.empty((6, 6)), np.empty(6)
    touch[4:7] = rotation_matrix(turned([0.3, -0.5, 0.8], 2.1)).T @ [0.0, 0.0, 1.0]
    one = fit.factors(R, F, touch[4:7], *numbers[[6, 7]])
    beside_wall.from_factors(numbers, touch, one, S, H, np.empty(6))
    assert pytest.approx(R, rel=1e-9, abs=1e-9) == S
    assert pytest.approx(F, rel=1e-9, abs=1e-9) == H


def test_a_wall_that_adds_nothing_leaves_free_fluid() -> None:
    """Wherever the swimmer is: the kernel's own factors of free fluid are those of the gait."""
    table, gait = planted(ROBOT, lambda *_: np.zeros(27)), ROBOT.gait()
    rng = np.random.default_rng(2)
    for phase in (0.0, 1.0, -4.0):
        q = rng.normal(size=4)
        R, F, _ = asked(table, [1.0, 2.0, rng.uniform(2.8, 5.0)], q / np.linalg.norm(q), phase)
        assert pytest.approx(gait.resistance(phase), rel=1e-9, abs=1e-9) == R
        assert pytest.approx(gait.propulsion(phase), rel=1e-9, abs=1e-9) == F


def test_a_wall_knows_no_place_along_it_and_no_heading() -> None:
    """Moved along the wall and turned about its normal, the swimmer feels the same."""
    table = planted(ROBOT, smooth)
    x, q = np.array([0.0, 0.0, 0.8]), turned([0.2, 1.0, 0.1], 0.3)
    R, F, touch = asked(table, x, q, 1.0)
    spun = multiply(turned([0, 0, 1], 2.0), q)
    for place, attitude in ((x + [5.0, -3.0, 0.0], q), (x, spun)):
        S, H, other = asked(table, place, attitude, 1.0)
        assert pytest.approx(R, rel=1e-9) == S
        assert pytest.approx(F, rel=1e-9) == H
        assert other == pytest.approx(touch, rel=1e-9)


def test_a_turn_about_s_is_a_change_of_phase() -> None:
    """Of a body of revolution with a rigid tail: R(q turned by a, phase - sign a) is R turned."""
    table = planted(ROBOT, smooth)
    x, q, a = np.array([0.0, 0.0, 0.9]), turned([0.2, 1.0, 0.1], 0.2), 0.7
    R, F, _ = asked(table, x, q, 1.0)
    S, H, _ = asked(table, x, multiply(q, turned([1, 0, 0], a)), 1.0 - ROBOT.tail.sign * a)
    Q = np.kron(np.eye(2), rotation_matrix(turned([1, 0, 0], a)))
    assert pytest.approx(R, rel=1e-9) == Q @ S @ Q.T
    assert pytest.approx(F, rel=1e-9) == Q @ H


def test_resistance_is_positive_definite_whatever_was_solved() -> None:
    table = planted(ROBOT, lambda *at: 5.0 * smooth(*at))
    rng = np.random.default_rng(0)
    for _ in range(50):
        q = rng.normal(size=4)
        R, _, touch = asked(table, [0.0, 0.0, rng.uniform(0.5, 4.0)], q / np.linalg.norm(q), 1.0)
        if touch[0] <= 0.0:
            continue
        assert np.array_equal(R, R.T)
        scale = 1 / np.sqrt(np.diag(R))
        assert np.linalg.eigvalsh(R * np.outer(scale, scale)).min() > -1e-12


def test_interpolation_is_of_fourth_order_between_and_smooth_in_phase() -> None:
    """A function that splines and series hold exactly comes back between the nodes."""
    table = planted(ROBOT, smooth)
    shape = layout.shape_of(ROBOT, 0.01)
    for xi, sigma, turn in [(-2.2, 0.33, 1.1), (-0.7, -0.51, 4.0)]:
        beside = wall.beside(ROBOT, shape, *shape.pose(xi, sigma, turn))
        x, q = wall.start_of(beside.wall)
        R, F, touch = asked(table, x, q, 0.0)
        units = shape.numbers[[6, 7]]
        found = fit.factors(R, F, touch[4:7], *units)
        found -= fit.factors(
            ROBOT.gait().resistance(0.0), ROBOT.gait().propulsion(0.0), touch[4:7], *units
        )
        assert found == pytest.approx(smooth(xi, sigma, turn), abs=1e-6)


def test_poses_left_out_of_a_fine_grid_lie_on_a_spline_through_the_others() -> None:
    """A cubic of the tilt and a wave of the turn come back; what was solved is kept."""
    grid = wall.Grid()
    shape = layout.shape_of(ROBOT, grid.smallest)
    among = wall._solved_of(shape, grid)
    assert not among.all()
    tilt, turn = np.linspace(0.0, 1.0, grid.tilts), 2.0 * np.pi * np.arange(grid.phases) / 16
    whole = (tilt**3 - tilt)[:, None] * (2.0 + np.cos(turn + 0.3))
    whole = np.broadcast_to(whole[None, :, :, None], (grid.gaps - 1, *whole.shape, 28))
    solved = among[:, grid.tilts - 1 :]
    some = np.where(solved[..., None], whole, np.nan)
    filled = wall._filled(some)
    assert filled == pytest.approx(whole, abs=0.02)
    assert np.array_equal(filled[solved], whole[solved])


@pytest.mark.parametrize("sigma", [-0.4, 0.4])
def test_phases_lie_closer_where_the_nearest_turn_of_the_tail_changes(sigma: float) -> None:
    """By `CLOSER` there, and as much farther apart half a turn on."""
    shape, step, since = layout.shape_of(ROBOT, 0.01), 0.02, []
    for turn in (-0.5 * step, 0.5 * step, np.pi - 0.5 * step, np.pi + 0.5 * step):
        _, tilt, psi = shape.pose(-3.0, sigma, turn)
        with settled(False):
            switch = beside_wall.switched(shape.switch, min(tilt, shape.kink(psi)))
        since.append(psi - switch)
    there, opposite = (d % (2.0 * np.pi) for d in np.diff(since)[::2])
    assert [there / step, step / opposite] == pytest.approx([1 / beside_wall.CLOSER] * 2, rel=1e-3)


@pytest.mark.parametrize("swimmer", [ROBOT, CELL])
def test_a_steep_tail_counts_its_phase_from_the_tip(swimmer: ms.Swimmer) -> None:
    """Where the tip is nearest at all phases, poses of neighbouring tilts have about one phase."""
    grid = wall.Grid()
    shape = layout.shape_of(swimmer, grid.smallest)
    slope = 2.0 * np.pi * swimmer.tail.number_of_waves / swimmer.tail.apparent_length
    never = -np.arctan(slope * np.hypot(shape.tail[:, 1], shape.tail[:, 2]).max())
    poses = [shape.pose(-3.0, s, 1.0) for s in np.linspace(-1.0, 0.0, grid.tilts)]
    steep = np.array([psi for _, tilt, psi in poses if tilt < never - 0.1])
    assert len(steep) > 2
    apart = np.diff(np.unwrap(steep))
    assert np.abs(apart).max() < 0.3
    assert abs(apart[0]) < 1e-3


def test_compiled_and_python_agree_beside_a_wall() -> None:
    table = planted(ROBOT, smooth)
    x, q = np.array([0.0, 0.0, 0.51]), turned([0.2, 1.0, 0.1], 0.1)
    for plain, fast in zip(asked(table, x, q, 3.0, False), asked(table, x, q, 3.0), strict=True):
        assert fast == pytest.approx(plain, rel=1e-10, abs=1e-12)


def test_lubrication_goes_on_below_the_smallest_gap() -> None:
    """What touches resists like one over the gap, without a jump, to any gap."""
    table = planted(ROBOT, smooth)
    q, across, pushed = wall.start_of(ms.Wall(1.0, tilt=0.2))[1], [], []
    for height in 0.5 + 0.5 * np.geomspace(1e-8, 0.02, 40):
        R, _, touch = asked(table, [0, 0, height], q, 0.0)
        N = np.concatenate([touch[4:7], touch[1:4]])
        across.append(touch[0])
        pushed.append(1.0 / (N @ np.linalg.solve(R, N)))
    below = np.array(across[1:]) < table.numbers[beside_wall.LEAST]
    slopes = np.diff(np.log(pushed)) / np.diff(np.log(across))
    assert below.sum() > 20
    assert slopes[below] == pytest.approx(-1.0, abs=1e-3)
    assert np.abs(np.diff(np.log(pushed))).max() < 1.0


@pytest.mark.parametrize(("tilt", "azimuth"), [(0.0, 0.0), (0.4, 1.0), (-0.3, -2.0)])
def test_a_path_starts_where_the_spec_says(tilt: float, azimuth: float) -> None:
    stated = ms.Wall(0.8, tilt=tilt, azimuth=azimuth)
    x, q = wall.start_of(stated)
    Q = rotation_matrix(q)
    assert pytest.approx(np.array(stated.normal), abs=1e-12) == Q.T @ [0.0, 0.0, 1.0]
    assert x[2] == 0.8
    assert Q[1, 0] == pytest.approx(0.0, abs=1e-12)  # s has no component along y
    assert Q[0, 0] > 0


def test_a_grid_is_for_what_has_three_coordinates() -> None:
    wave = ms.Swimmer.preset("tabak/plane_wave")
    with pytest.raises(SpecError, match="body of revolution with one helical tail"):
        wall.beside_wall(replace(wave, wall=ms.Wall(2.0)), grid=wall.Grid())


@pytest.mark.slow
def test_poses_not_used_are_met_and_a_path_follows_them(tmp_path: Path) -> None:
    """A coarse grid beside a wall: direct solves elsewhere within the error that is stated, and a
    path at the gap of which is never lost.
    """
    short = replace(ROBOT.with_({"tail.length": 0.8, "tail.waves": 1.0}), wall=ms.Wall(0.8))
    few = wall.Grid(gaps=5, tilts=5, phases=12, smallest=0.05, left_out=8)
    poses = wall.beside_wall(short, grid=few, folder=tmp_path, workers=0)
    assert 0 < poses.expected_error["us"] < 0.1
    seen = []
    again = wall.beside_wall(
        short, grid=few, folder=tmp_path, workers=0, progress=lambda done, of: seen.append(done)
    )
    assert seen == [4 * 9 * 12 + 1, 4 * 9 * 12 + 1 + 8]  # all of them kept
    assert np.array_equal(again.table.factors, poses.table.factors)
    speed = np.linalg.norm(poses.gait.velocity(0.0)[:3])
    for distance, tilt in [(0.7, 0.0), (1.3, 0.3), (0.6, 0.2)]:
        near = replace(short, wall=ms.Wall(distance, tilt=tilt, azimuth=1.0))
        solved = bem.solve(near, level="coarse")
        R, F = poses.at(*wall.start_of(near.wall), 0.0)
        V = -np.linalg.solve(R, F) * solved.rate
        assert np.abs(V - solved.twist)[:3].max() < 0.05 * speed
    path = ms.path(short, time=5.0, poses=poses)
    assert path.gap.values.min() > 0
