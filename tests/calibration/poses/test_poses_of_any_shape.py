"""Poses beside a wall of waving tails and boxes: the laws of the table, and solves elsewhere."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses import any_shape, scattered, wall
from microswim.calibration.poses.solved import SolvedPoses
from microswim.control.export.boundary import boundary_of
from microswim.control.posed_stepper import PosedStepper
from microswim.errors import SpecError
from microswim.gait.poses import any_shape as compiled_shape
from microswim.gait.poses import beside_wall
from microswim.gait.poses.table import WALL, WORK, PoseTable, resist
from microswim.gait.stepping import pack
from microswim.models import bem
from microswim.models.bem.patches.surface import positions
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.rigid_motion import multiply

WAVE = ms.Swimmer.preset("tabak/plane_wave")
HELIX = ms.Swimmer.preset("tabak/helix")
BOX = replace(HELIX, body=ms.Box(size=(1.2, 1.0, 0.7)))
EGG = replace(WAVE, body=ms.Ellipsoid(semi_axes=(0.7, 0.5, 0.3)))
MIX = np.random.default_rng(3).normal(size=(compiled_shape.FEATURES, 28)) * 0.05


def planted(swimmer: ms.Swimmer, count: int = 60) -> PoseTable:
    """Table of a wall that adds a linear function of the features to what the surrogate says."""
    shape = any_shape.shape_of(swimmer, 0.02)
    _, Z, _ = any_shape.places(shape, count, 2 * count)
    known, weights = scattered.known_of_both(Z, Z @ MIX)
    gait = swimmer.gait()
    return PoseTable(
        WALL, pack(gait), np.array([0.0, 0, 0, 0, 0, 1]), shape.numbers, shape.body, shape.tail,
        np.zeros(0), np.zeros((0, 0, 0, 0, 0)), known, weights, root=any_shape.powers(gait),
    )  # fmt: skip


TABLE = planted(WAVE)


def asked(table: PoseTable, x: Any, q: Any, phase: float, compile_it: bool = True) -> Any:
    R, F, touch = np.empty((6, 6)), np.empty(6), np.empty(14)
    with settled(compile_it):
        x, q = np.asarray(x, float), np.asarray(q, float)
        G = resist(table, x, q, phase, R, F, touch, np.empty(WORK))
    return R, F, touch, G


def turned(axis: Any, angle: float) -> Any:
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])


@pytest.mark.parametrize("swimmer", [WAVE, BOX, EGG])
def test_the_gap_is_that_of_the_surface_at_any_phase(swimmer: ms.Swimmer) -> None:
    """Against the boundary elements' own surface, whose tip leans with the wave's slope."""
    table, tail = planted(swimmer, 24), swimmer.tail
    for phase, n in [(0.7, [0.2, 0.6, 0.7]), (4.0, [-0.5, -0.2, 0.4]), (2.0, [0.6, 0.3, -0.9])]:
        ahead = replace(swimmer, tail=replace(tail, phase=phase))  # type: ignore[type-var]
        surface = bem.solve(ahead, level="coarse").surface
        X = positions(surface, 17).reshape(-1, 3) - np.asarray(swimmer.body.centre)
        n = np.array(n) / np.linalg.norm(n)
        x, q, _ = any_shape.start_at(np.array([*n, 5.0, phase]))
        touch = asked(table, x, q, phase)[2]
        assert touch[0] == pytest.approx(5.0 + (X @ n).min(), abs=3e-3)
        assert touch[4:7] == pytest.approx(n, abs=1e-12)
        lowest = X[(X @ n).argmin()]
        part = touch[:7] if touch[0] <= touch[7] else touch[7:]
        assert part[1:4] == pytest.approx(np.cross(lowest, n), abs=0.03)


def test_a_wall_far_away_leaves_free_fluid() -> None:
    """At any phase and attitude: C C' and w_0 are those of the gait."""
    gait = WAVE.gait()
    for phase in (0.0, 1.3, 4.0):
        R, F, _, _ = asked(TABLE, [0.0, 0.0, 1e9], turned([0.3, 1.0, 0.2], 0.8), phase)
        assert pytest.approx(gait.resistance(phase), rel=1e-6, abs=1e-4) == R
        assert pytest.approx(gait.propulsion(phase), rel=1e-6, abs=1e-4) == F


@pytest.mark.parametrize(
    ("swimmer", "signs", "later"),
    [
        (WAVE, (1, 1, -1, -1, -1, 1), 0.0),  # mirrored in r
        (WAVE, (1, -1, 1, -1, 1, -1), np.pi),  # mirrored in q, half a period on
        (BOX, (1, -1, -1, 1, -1, -1), np.pi),  # turned about s, half a turn of the tail on
    ],
)
def test_an_image_of_itself_feels_the_same(swimmer: Any, signs: Any, later: float) -> None:
    table = TABLE if swimmer is WAVE else planted(swimmer)
    for n in ([0.2, 0.6, 0.7], [-0.5, -0.2, 0.4]):
        pose = np.array([*(np.array(n) / np.linalg.norm(n)), 1.9, 0.9])
        x, q, phase = any_shape.start_at(pose)
        R, F, touch, G = asked(table, x, q, phase)
        image = pose.copy()
        image[:3] *= signs[:3]
        x, q, _ = any_shape.start_at(image)
        S, H, other, K = asked(table, x, q, phase + later)
        assert pytest.approx(R, rel=1e-9, abs=1e-6) == np.outer(signs, signs) * S
        assert pytest.approx(F, rel=1e-9, abs=1e-6) == np.array(signs) * H
        assert touch[[0, 7]] == pytest.approx(other[[0, 7]], abs=1e-9)
        assert pytest.approx(G, rel=1e-9) == K


def test_of_any_shape_a_wall_knows_no_place_along_it_and_no_heading() -> None:
    x, q = np.array([0.0, 0.0, 1.2]), turned([0.2, 1.0, 0.1], 0.3)
    R, F, touch, G = asked(TABLE, x, q, 1.0)
    spun = multiply(turned([0, 0, 1], 2.0), q)
    for place, attitude in ((x + [5.0, -3.0, 0.0], q), (x, spun)):
        S, H, other, K = asked(TABLE, place, attitude, 1.0)
        assert pytest.approx(R, rel=1e-9, abs=1e-9) == S
        assert pytest.approx(F, rel=1e-9, abs=1e-9) == H
        assert other == pytest.approx(touch, abs=1e-9)
        assert pytest.approx(G, rel=1e-9) == K


def test_compiled_and_python_agree_of_any_shape() -> None:
    x, q = np.array([0.0, 0.0, 0.52]), turned([0.2, 1.0, 0.1], 0.1)
    for plain, fast in zip(asked(TABLE, x, q, 3.0, False), asked(TABLE, x, q, 3.0), strict=True):
        assert fast == pytest.approx(plain, rel=1e-8, abs=1e-10)


def test_what_is_known_of_any_shape_comes_back_and_a_smooth_function_between() -> None:
    """Targets of a gait made by the table are the linear function that was planted."""
    shape, free = any_shape.shape_of(WAVE, 0.02), WAVE.gait()
    poses, Z, H = any_shape.places(shape, 6, 50, seed=5)
    for pose, z, h in zip(poses, Z, H, strict=True):
        x, q, phase = any_shape.start_at(pose)
        R, F, _, G = asked(TABLE, x, q, phase)
        made = replace(
            free, resistance_series=R[None], propulsion_series=F[None],
            activity_series=np.array([G]),
        )  # fmt: skip
        assert any_shape.targets(made, free, pose, h) == pytest.approx(z @ MIX, abs=0.02)


def test_resistance_of_any_shape_is_positive_definite_and_grows_like_one_over_the_gap() -> None:
    table, pushed, gaps = TABLE, [], np.geomspace(1e-6, 0.012, 40)
    q = any_shape.start_at(np.array([0.3, 0.8, 0.52, 1.0, 0.0]))[1]
    height = -asked(table, np.zeros(3), q, 0.4)[2][0]
    for gap in gaps:
        R, _, touch, _ = asked(table, [0.0, 0.0, height + gap], q, 0.4)
        scale = 1 / np.sqrt(np.diag(R))
        assert np.linalg.eigvalsh(R * np.outer(scale, scale)).min() > -1e-9
        N = np.concatenate([touch[4:7], touch[1:4]])
        pushed.append(1.0 / (N @ np.linalg.solve(R, N)))
    slopes = np.diff(np.log(pushed)) / np.diff(np.log(gaps))
    assert slopes[:30] == pytest.approx(-1.0, abs=0.01)


def test_what_has_no_formula_is_refused_by_a_wall() -> None:
    soft = ms.ElasticTail(length=2.0, radius=0.05, bending=1.0, drive="pivot", angle=0.3)
    bent = {"tail.mean_curvature": 0.4, "tail.sections": "perpendicular"}
    for swimmer in (replace(WAVE, tail=soft), WAVE.with_(bent), WAVE.with_({"tail.phase": 1.0})):
        with pytest.raises(SpecError, match="one helical tail or straight plane wave"):
            wall.beside_wall(replace(swimmer, wall=ms.Wall(3.0)))


def test_no_c_is_written_of_any_shape_beside_a_wall() -> None:
    gait = WAVE.gait()
    start = wall.start_of(ms.Wall(2.0))
    poses = SolvedPoses(gait, TABLE, start, {})
    stepper = PosedStepper(gait, replace(WAVE, wall=ms.Wall(2.0)), poses=poses)
    with pytest.raises(SpecError, match="C beside it"):
        boundary_of(stepper)


def test_a_quarter_of_the_poses_is_close_to_the_wall() -> None:
    """Beyond those that lie close by chance; and all are where they were asked to be."""
    shape = any_shape.shape_of(WAVE, 0.02)
    usual, Z, _ = any_shape.places(shape, 60, 120)
    poses, with_close, _ = any_shape.with_close_ones(shape, 80)
    assert np.array_equal(poses[:60], usual)
    assert np.array_equal(with_close[:60], Z)
    assert len(poses) == 80
    near = with_close[60:, :2].min(axis=1)
    assert near.max() <= any_shape.NEAR + 1e-6
    assert near.min() == pytest.approx(float(shape.numbers[beside_wall.LOWEST]), abs=0.2)
    assert (Z[:, :2].min(axis=1) > any_shape.NEAR).any()


@pytest.mark.slow
def test_poses_of_a_waving_tail_that_were_not_used_are_met(tmp_path: Path) -> None:
    """Few poses of a short swimmer: direct solves elsewhere, and a path that is never lost."""
    short = WAVE.with_({"tail.length": 0.8, "tail.waves": 1.0, "motion.free": "all"})
    short = replace(short, wall=ms.Wall(1.2))
    few = scattered.Scatter(poses=120, left_out=4)
    poses = any_shape.beside_wall_of_any_shape(
        short, wall.start_of(short.wall), scatter=few, folder=tmp_path, workers=0
    )
    assert 0 < poses.expected_error["us"] < 0.5
    path = ms.path(short, time=3.0, poses=poses)
    assert path.gap.values.min() > 0
