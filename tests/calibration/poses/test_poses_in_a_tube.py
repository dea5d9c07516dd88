"""A gait as a function of the pose in a tube: the laws of the table, and solves at other poses."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses import lines as tube_lines
from microswim.calibration.poses import scattered, tube
from microswim.calibration.poses import solved as all_solved
from microswim.calibration.poses.layout import shape_of
from microswim.calibration.poses.scattered import Scatter
from microswim.calibration.poses.solved import Solves, level_of
from microswim.errors import SpecError
from microswim.gait.poses import in_tube, tube_contact
from microswim.gait.poses.table import TUBE, WORK, PoseTable, carry, resist
from microswim.gait.stepping import pack
from microswim.models import bem
from microswim.models.bem.patches.surface import positions
from microswim.models.bem.solution import middle_of
from microswim.models.bem.system import wrench_rows
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from oracles.ball_in_a_tube import drag

ROBOT = ms.Swimmer.preset("tabak/helix")
CELL = ms.Swimmer.preset("goto/A")
RADIUS = 1.5
MIX = np.random.default_rng(3).normal(size=(in_tube.FEATURES, 46)) * 0.1


def planted(swimmer: ms.Swimmer, radius: float, count: int = 60) -> PoseTable:
    """Table of a tube that adds a linear function of the features to what the surrogate says."""
    shape = tube.in_a_tube(swimmer, 0.02)
    numbers = tube.numbers_of(shape, 0.02)
    _, Z = tube_lines.places(shape, numbers, radius, count, among=400)
    Y = Z @ MIX
    known, (L, rest, carried) = scattered.known_of_each(Z, Y[:, :21], Y[:, 21:28], Y[:, 28:])
    gait = swimmer.gait()
    root = tube.root_of(gait)
    root[in_tube.SHARED] = 1.0
    return PoseTable(
        TUBE, pack(gait), np.array([0.0, 0, 0, 1, 0, 0, radius]), numbers, shape.body, shape.tail,
        np.zeros(0), np.zeros((0, 0, 0, 0, 0)), known, np.concatenate([L, rest]), carried, root,
    )  # fmt: skip


TABLE = planted(ROBOT, RADIUS)


def asked(table: PoseTable, x: Any, q: Any, phase: float, compile_it: bool = True) -> Any:
    R, F, touch, D = np.empty((6, 6)), np.empty(6), np.empty(14), np.empty(6)
    with settled(compile_it):
        x, q = np.asarray(x, float), np.asarray(q, float)
        G = resist(table, x, q, phase, R, F, touch, np.empty(WORK))
        carry(table, x, q, phase, D, np.empty(WORK))
    return R, F, touch, D, G


def turned(axis: Any, angle: float) -> Any:
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])


X, Q = np.array([4.0, 0.2, -0.3]), turned([0.1, 1.0, 0.3], 0.2)


@pytest.mark.parametrize(
    "swimmer", [ROBOT, CELL, replace(ROBOT, body=ms.Capsule(length=1.5, radius=0.4))]
)
def test_the_gap_in_a_tube_is_that_of_the_surface(swimmer: ms.Swimmer) -> None:
    """Against the boundary elements' own surface."""
    shape = tube.in_a_tube(swimmer, 0.02)
    length = shape.numbers[in_tube.LENGTH]
    numbers = tube.numbers_of(shape, 0.02)
    surface = bem.solve(replace(swimmer, wall=None), level="coarse").surface
    X = positions(surface, 17) - np.asarray(swimmer.body.centre)
    radius = 4.0 * length + 0.2 * float(swimmer.tail.apparent_length)
    lines, _ = tube_lines.places(shape, numbers, radius, 12, among=200)
    gaps, Z = np.empty((12, 2)), np.empty((12, in_tube.FEATURES))
    with settled(True):
        in_tube.of_lines(lines, shape.body, shape.tail, numbers, radius, gaps, Z)
    for line, nearest in zip(lines, gaps.min(axis=1), strict=True):
        Y = X + line[3:]
        far = np.linalg.norm(Y - (Y @ line[:3])[..., None] * line[:3], axis=-1).max()
        assert nearest == pytest.approx(radius - far, abs=4e-3 * length)


def beside_the_tube(body: Any, t: Any, b: Any, radius: float) -> Any:
    """What touches, (n, 7), of a body alone where lines are the tube's axis."""
    shape = tube.in_a_tube(replace(ROBOT, body=body), 0.02)
    numbers = tube.numbers_of(shape, 0.02)
    b = b - (b * t).sum(axis=1)[:, None] * t
    out, work = np.empty((len(t), 14)), np.empty(16)
    with settled(True):
        for line, row in zip(np.concatenate([t, b], axis=-1), out, strict=True):
            tube_contact.of_line(line, shape.body, np.zeros((0, 3)), numbers, radius, row, work)
    return out[:, :7]


@pytest.mark.parametrize("tilt", [0.0, 0.02, 0.15, 0.4])
@pytest.mark.parametrize(
    "body",
    [
        ms.Cylinder(length=3.75, radius=1.0),
        ms.Capsule(length=3.0, radius=1.0),
        ms.Sphere(radius=1),
        ms.Spheroid(semi_axes=(2.5, 1.0)),
    ],
    ids=["cylinder", "capsule", "sphere", "spheroid"],
)
def test_the_gap_of_a_body_is_that_of_its_farthest_point(body: Any, tilt: float) -> None:
    """Against all points of its surface: two humps lie close, of either end of a cylinder."""
    radius, n = 4.0, 150
    rng = np.random.default_rng(5)
    side, turn = rng.uniform(0, 2 * np.pi, (2, n))
    t = np.stack([np.full(n, np.cos(tilt)), *(np.sin(tilt) * f(side) for f in CIRCLE)], axis=-1)
    b = np.stack([0.0 * turn, *(f(turn) for f in CIRCLE)], axis=-1) * rng.uniform(0, 3, (n, 1))
    gaps = beside_the_tube(body, t, b, radius)[:, 0]
    theta, phi = np.meshgrid(np.linspace(0, np.pi, 301), np.linspace(0, 2 * np.pi, 181))
    out = np.stack([np.cos(theta), *(np.sin(theta) * f(phi) for f in CIRCLE)], axis=-1)
    X = (body.surface_point(out.reshape(-1, 3)) - body.centre) @ np.eye(3)
    for axis, away, gap in zip(t, b, gaps, strict=True):
        Y = X + away
        far = np.linalg.norm(Y - (Y @ axis)[:, None] * axis, axis=-1).max()
        assert gap == pytest.approx(radius - far, abs=5e-4)


def test_what_holds_a_cylinder_off_a_tube_goes_smoothly_from_end_to_end() -> None:
    """It lies along the wall, tilted to and fro: both ends bear it, and no gap or moment jumps."""
    tilts = np.linspace(-0.03, 0.03, 601)
    t = np.stack([np.cos(tilts), 0.02 + 0.0 * tilts, np.sin(tilts)], axis=-1)
    t /= np.linalg.norm(t, axis=1)[:, None]
    body = ms.Cylinder(length=3.75, radius=1.0)
    found = beside_the_tube(body, t, np.array([0.0, 0.0, 2.95]) + 0.0 * t, 4.0)
    ends = found[[0, -1], 2]
    assert np.abs(ends) == pytest.approx(1.875, abs=0.25)  # its half length, of one end
    assert ends[0] * ends[1] < 0.0
    assert np.abs(np.diff(found, axis=0)).max(axis=0) == pytest.approx(0.0, abs=0.05)
    assert np.linalg.norm(found[:, 4:], axis=1).min() > 0.95


CIRCLE = np.cos, np.sin


def test_a_line_is_the_pose_that_is_solved() -> None:
    """The swimmer with its channel starts where the line says, and the other way round."""
    shape = shape_of(ROBOT, 0.02)
    lines, _ = tube_lines.places(shape, tube.numbers_of(shape, 0.02), RADIUS, 8, among=50)
    for line in lines:
        near = tube.beside(ROBOT, RADIUS, line)
        x, q = tube.start_of(near)
        found = np.empty(6)
        tube_contact.axis_in_body(TABLE.boundary, 0.0, x, q, found)
        assert found == pytest.approx(line, abs=1e-12)
        centre = np.asarray(ROBOT.body.centre) - middle_of(near)
        assert near.channel is not None
        along = near.channel.axes[:, 0]
        assert centre - (centre @ along) * along == pytest.approx(line[3:], abs=1e-12)


def test_what_is_known_comes_back_and_a_smooth_function_between() -> None:
    """Features enter linearly: met at other poses as well."""
    shape = shape_of(ROBOT, 0.02)
    lines, Z = tube_lines.places(shape, TABLE.numbers, RADIUS, 6, among=300, seed=5)
    root = tube.root_of(ROBOT.gait())
    for line, z in zip(lines, Z, strict=True):
        x, q = tube.start_of(tube.beside(ROBOT, RADIUS, line))
        R, F, _, _, G = asked(TABLE, x, q, 0.0)
        made = replace(
            ROBOT.gait(), resistance_series=R[None], propulsion_series=F[None],
            activity_series=np.array([G]),
        )  # fmt: skip
        near = tube.of_tail(shape, TABLE.numbers, RADIUS, line)
        assert tube.targets(made, root, near) == pytest.approx(z @ MIX[:, :28], abs=0.01)


def test_a_tube_knows_no_place_along_it_no_side_and_no_end() -> None:
    """Moved along it, turned about it, and turned end for end, the swimmer feels the same."""
    R, F, touch, D, G = asked(TABLE, X, Q, 1.0)
    ways = [(turned([1, 0, 0], 2.0), 1.0), (turned([0, 1, 0], np.pi), -1.0)]
    for turn, sense in [(np.array([1.0, 0, 0, 0]), 1.0), *ways]:
        place = rotation_matrix(turn) @ X + [7.0, 0.0, 0.0]
        S, H, other, E, K = asked(TABLE, place, multiply(turn, Q), 1.0)
        assert pytest.approx(R, rel=1e-9, abs=1e-7) == S
        assert pytest.approx(F, rel=1e-9, abs=1e-7) == H
        assert other == pytest.approx(touch, abs=1e-9)
        assert sense * E == pytest.approx(D, rel=1e-9)
        assert pytest.approx(G, rel=1e-9) == K


def test_a_turn_about_s_in_a_tube_is_a_change_of_phase() -> None:
    a = 0.7
    R, F, touch, D, _ = asked(TABLE, X, Q, 1.0)
    S, H, other, E, _ = asked(
        TABLE, X, multiply(Q, turned([1, 0, 0], a)), 1.0 - ROBOT.tail.sign * a
    )
    one = rotation_matrix(turned([1, 0, 0], a))
    both = np.kron(np.eye(2), one)
    assert pytest.approx(R, rel=1e-9, abs=1e-9) == both @ S @ both.T
    assert pytest.approx(F, rel=1e-9, abs=1e-9) == both @ H
    assert pytest.approx(D, rel=1e-9, abs=1e-12) == both @ E
    for k in (1, 4, 8, 11):
        assert pytest.approx(touch[k : k + 3], abs=1e-9) == one @ other[k : k + 3]


def test_compiled_and_python_agree_in_a_tube() -> None:
    for plain, fast in zip(asked(TABLE, X, Q, 3.0, False), asked(TABLE, X, Q, 3.0), strict=True):
        assert fast == pytest.approx(plain, rel=1e-8, abs=1e-9)


def test_resistance_in_a_tube_is_positive_definite_whatever_was_solved() -> None:
    table = TABLE._replace(weights=4.0 * TABLE.weights)
    rng = np.random.default_rng(0)
    for _ in range(50):
        q = rng.normal(size=4)
        R, *_ = asked(table, rng.uniform(-1, 1, 3), q / np.linalg.norm(q), 1.0)
        assert np.array_equal(R, R.T)
        scale = 1 / np.sqrt(np.diag(R))
        assert np.linalg.eigvalsh(R * np.outer(scale, scale)).min() > -1e-9


@pytest.mark.parametrize("q", [turned([0, 0, 1], 0.0), turned([0, 0, 1], 0.35)])
def test_lubrication_in_a_tube_goes_on_below_the_smallest_gap(q: Any) -> None:
    """R along what touches grows like 1/gap, of body and of tail, without a jump."""
    pushed, gaps = [], np.geomspace(1e-6, 0.012, 60)
    start = asked(TABLE, [0.0, 0.0, 0.0], q, 0.0)[2]
    outwards = -rotation_matrix(q) @ start[4:7]
    outwards[0] = 0.0
    for gap in gaps:
        x = np.zeros(3)
        for _ in range(20):
            x = x + (asked(TABLE, x, q, 0.0)[2][0] - gap) * outwards
        R, _, touch, _, _ = asked(TABLE, x, q, 0.0)
        N = np.concatenate([touch[4:7], touch[1:4]])
        pushed.append(1.0 / (N @ np.linalg.solve(R, N)))
    slopes = np.diff(np.log(pushed)) / np.diff(np.log(gaps))
    assert slopes[:35] == pytest.approx(-1.0, abs=0.01)  # further off, what else is near counts
    assert np.abs(np.diff(np.log(pushed))).max() < 0.4


def test_a_path_in_a_tube_starts_where_the_spec_says() -> None:
    channel = ms.Channel(diameter=3.0, length=9.0, position=(1.0, 0.2, -0.3), tilt=0.2, azimuth=0.5)
    robot = replace(ROBOT, channel=channel)
    x, q = tube.start_of(robot)
    middle = np.array([0.5 * (2.0 + 0.05 - 1.0), 0.0, 0.0])  # from nose to tip
    there = x + rotation_matrix(q) @ (middle - np.asarray(ROBOT.body.centre))
    assert there == pytest.approx([1.0, 0.2, -0.3])
    assert rotation_matrix(q)[0, 0] == pytest.approx(np.cos(0.2))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"channel": None}, "channel: missing"),
        ({"channel": ms.Channel(shape="box")}, "channel.shape"),
        ({"channel": ms.Channel(diameter=0.9)}, "channel.diameter"),
        ({"body": ms.Ellipsoid(semi_axes=(0.6, 0.5, 0.4))}, "body of revolution"),
    ],
)
def test_what_is_no_tube_for_it_is_refused(change: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        tube.in_tube(replace(ROBOT, **{"channel": ms.Channel(diameter=3.0), **change}))


def test_no_pose_need_be_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then no error is known; what the tube adds is added to free fluid at its best."""
    gait = ROBOT.gait()
    better = replace(gait, resistance_series=1.1 * gait.resistance_series)

    def found(best: Any, _: Any, asked: list[Any], left_out: int, *__: Any, **___: Any) -> Any:
        assert left_out == 0
        rng = np.random.default_rng(1)
        made = [
            replace(
                gait, resistance_series=gait.resistance_series * grows,
                info={"in_poiseuille": (0.1 * grows * np.arange(6)).tolist()},
            )
            for grows in rng.uniform(1.0, 1.2, len(asked))
        ]  # fmt: skip
        return Solves(gait, best, made, [])

    robot = replace(ROBOT, channel=ms.Channel(diameter=2 * RADIUS, length=30.0))
    drags = []
    for best in (gait, better):
        monkeypatch.setattr(tube, "solved", partial(found, best))
        poses = tube.in_tube(robot, scatter=Scatter(poses=40, left_out=0))
        assert poses.expected_error == {}
        assert poses.gait is best
        drags.append(poses.at(*poses.start, 0.0)[0][0, 0])
    assert 0.9 < drags[0] / gait.resistance(0.0)[0, 0] < 1.3
    assert drags[1] == pytest.approx(1.1 * drags[0], rel=1e-4)  # but for the tail's own part


def test_of_a_fifth_of_the_poses_the_tail_is_close_and_of_another_the_body() -> None:
    """The others are those of all poses; those close lie evenly in the logarithm of the gap."""
    shape = shape_of(ROBOT, 0.02)
    numbers = tube.numbers_of(shape, 0.02)
    lines, Z = tube_lines.with_close_ones(shape, numbers, RADIUS, 40)
    even, _ = tube_lines.places(shape, numbers, RADIUS, 32, among=64)
    assert np.array_equal(lines[:24], even[:24])
    gaps, z = np.empty((40, 2)), np.empty((40, in_tube.FEATURES))
    in_tube.of_lines(lines, shape.body, shape.tail, numbers, RADIUS, gaps, z)
    assert np.array_equal(z, Z)
    assert gaps.min() > numbers[in_tube.LEAST]
    for part, some in ((1, slice(24, 32)), (0, slice(32, 40))):
        assert gaps[some, part].max() < 10.0 * numbers[in_tube.LEAST]
        assert np.median(gaps[some, part]) < 5.0 * numbers[in_tube.LEAST]
    others, _ = tube_lines.with_close_ones(shape, numbers, RADIUS, 16, seed=1)
    assert not {tuple(v) for v in others} & {tuple(v) for v in lines}


def test_a_tube_that_leaves_little_room_has_poses_all_over_it() -> None:
    """Head a twenty-fifth of its radius from the tube: as far off the axis as it may be, tilted."""
    radius = 0.52
    shape = shape_of(ROBOT, 0.02)
    numbers = tube.numbers_of(shape, 0.02)
    lines, _ = tube_lines.places(shape, numbers, radius, 200, among=400)
    away = np.linalg.norm(lines[:, 3:], axis=1)
    assert len(lines) == 200
    assert 0.008 < away.max() < 0.01  # gaps from 0.01 on, of 0.02
    # the tip's middle, 2.5 behind the centre and .1 off s, may be .46 from the axis
    assert 0.1 < np.arccos(lines[:, 0].min()) < np.arcsin(0.57 / 2.5)


def test_fewer_poses_are_solved_where_they_meet_those_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A quarter, a half, all: as long as the error is above what is asked; the first stay."""
    solved_poses: list[list[Any]] = []
    errors: list[float] = []
    gait = ROBOT.gait()

    def solves(_: Any, asked: list[ms.Swimmer], left_out: int, *__: Any, **___: Any) -> Solves:
        solved_poses.append([s.channel for s in asked[: len(asked) - left_out]])
        return Solves(gait, gait, [], [])

    monkeypatch.setattr(tube, "solved", solves)
    monkeypatch.setattr(tube, "_table", lambda *_: None)
    monkeypatch.setattr(tube, "error_of", lambda *_: {"us": errors.pop(0), "how": "planted"})
    robot = replace(ROBOT, channel=ms.Channel(diameter=3.0, length=9.0))
    for told, counts in (([0.02, 0.005], [100, 200]), ([0.02, 0.02, 0.02], [100, 200, 400])):
        solved_poses.clear()
        errors[:] = told
        tube.in_tube(robot, scatter=Scatter(poses=400, left_out=2))
        assert [len(p) for p in solved_poses] == counts
        assert all(set(map(repr, a)) <= set(map(repr, b)) for a, b in pairwise(solved_poses))
    assert Scatter(poses=400, within=0.0).parts == [400]
    off = {"us": 0.015, "how": "planted"}
    assert Scatter().enough(off, [9000, 6500])
    assert not Scatter().enough(off, [9000, 2500])
    assert not Scatter().enough(off, [6400, 6400])  # the base case in a tube of 1.6 body radii


def test_each_part_finds_the_solves_of_the_one_before_without_a_cache(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where nothing can be kept for good, as beside a home that cannot be written."""
    folders: list[Any] = []
    gait = ROBOT.gait()

    def solves(*_: Any, folder: Any, **__: Any) -> Solves:
        folders.append(folder)
        assert Path(folder).is_dir()
        return Solves(gait, gait, [], [])

    monkeypatch.setattr(all_solved, "cache_folder", lambda _: None)
    monkeypatch.setattr(tube, "solved", solves)
    monkeypatch.setattr(tube, "_table", lambda *_: None)
    monkeypatch.setattr(tube, "error_of", lambda *_: {"us": 1.0})
    robot = replace(ROBOT, channel=ms.Channel(diameter=3.0, length=9.0))
    tube.in_tube(robot, scatter=Scatter(poses=400, left_out=2))
    assert len(folders) == 3
    assert len(set(folders)) == 1
    assert not Path(folders[0]).exists()


@pytest.mark.slow
def test_poses_in_a_tube_that_were_not_used_are_met(tmp_path: Path) -> None:
    """Few poses of a short robot in a wide tube: direct solves elsewhere, and what flow does."""
    short = ROBOT.with_({"tail.length": 0.8, "tail.waves": 1.0})
    short = replace(short, channel=ms.Channel(diameter=5.0, length=20.0))
    few = Scatter(poses=150, left_out=4)
    poses = tube.in_tube(short, scatter=few, folder=tmp_path, workers=0)
    assert 0 < poses.expected_error["us"] < 0.1
    seen = []
    again = tube.in_tube(
        short, scatter=few, folder=tmp_path, workers=0, progress=lambda done, of: seen.append(done)
    )
    assert seen == [151, 155]  # all of them kept
    assert np.array_equal(again.table.weights, poses.table.weights)
    speed = np.linalg.norm(poses.gait.velocity(0.0)[:3])
    line = np.array([np.cos(0.3), -np.sin(0.3), 0.0, 0.3 * np.sin(0.3), 0.3 * np.cos(0.3), 0.4])
    near = tube.beside(short, 2.5, line)
    solved = bem.solve(near, level="coarse")
    x, q = tube.start_of(near)
    R, F = poses.at(x, q, 0.0)
    V = -np.linalg.solve(R, F) * solved.rate
    assert np.abs(V - solved.twist)[:3].max() < 0.05 * speed
    D = asked(poses.table, x, q, 0.0)[3]
    held = np.linalg.solve(solved.resistance, solved.in_poiseuille)
    flow = np.concatenate([(1 - 0.25 / 6.25) * line[:3], np.cross(line[:3], line[3:]) / 6.25])
    assert D + flow == pytest.approx(held, abs=0.02)
    path = ms.path(short, time=5.0, poses=poses)
    assert path.gap.values.min() > 0


@pytest.mark.parametrize("ratio", [0.4, 0.6, 0.8])
def test_patches_of_poses_hold_the_fluid_that_a_ball_pushes_ahead(ratio: float) -> None:
    """Longer ones on the tube's side let 3 % of the drag through at .6."""
    tube = ms.Channel(diameter=2 / ratio, length=8.0)
    ball = ms.Swimmer(
        body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0), channel=tube
    )
    R = bem.solve(ball, level=level_of(ball, None)).resistance
    assert R[0, 0] / (6 * np.pi) == pytest.approx(drag(ratio), rel=0.01)


def test_a_sphere_in_poiseuilles_flow_obeys_faxen_and_reciprocity() -> None:
    """``U/u = 1 - 2/3 l^2 + O(l^5)`` on the axis; off it as the flow solved for itself says."""
    ball = ms.Swimmer(body=ms.Sphere(radius=0.2), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0))
    on = replace(ball, channel=ms.Channel(diameter=2.0, length=5.0))
    solved = bem.solve(on, level="coarse")
    V = np.linalg.solve(solved.resistance, solved.in_poiseuille)
    assert V[0] == pytest.approx(1 - 2 / 3 * 0.2**2, abs=2e-4)
    assert V[1:] == pytest.approx(np.zeros(5), abs=1e-6)
    off = replace(on, channel=replace(on.channel, position=(0.0, 0.5, 0.1)))
    solved = bem.solve(off, level="coarse", keep=True)
    assert solved.factors is not None
    X = solved.surface.nodes - middle_of(off)
    u = np.zeros_like(X)
    u[..., 0] = (1 - X[..., 1] ** 2 - X[..., 2] ** 2) * solved.surface.on_swimmer[:, None]
    density = solved.factors.solve(u.reshape(-1, 1))
    rows = wrench_rows(solved.surface, solved.centre, solved.surface.on_swimmer)
    assert (rows @ density)[:, 0] == pytest.approx(solved.in_poiseuille, rel=3e-3, abs=3e-3)
