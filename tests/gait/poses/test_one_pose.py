"""A gait beside a wall holds at one pose: its velocity is given, a path along it is not."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.gait.quantities import summary
from microswim.numerics.rigid_motion import multiply, rotation_matrix

BESIDE = {"wall.distance": 0.9}
SLIDING = ("us", "ur", "oq")  # along a wall across q, and about its normal


def swimmer(**changes):
    fields = {k.replace("__", "."): v for k, v in changes.items()}
    return ms.Swimmer.preset("tabak/helix", {**BESIDE, **fields})


@cache
def gait(**changes):
    return swimmer(**changes).gait("bem", level="coarse")


def test_every_door_to_a_path_is_shut_with_a_sentence(tmp_path):
    beside = gait()
    assert np.isfinite(beside.mean_velocity).all()
    for door in (
        lambda: ms.trajectory(beside, [0.0, 1.0]),
        lambda: ms.trajectory(beside, [0.0, 1.0], force=[1.0, 0, 0]),
        lambda: ms.Stepper(beside),
        lambda: ms.io.dataset(swimmer(), beside, periods=3),
        lambda: ms.c_model(ms.Stepper(beside)),
        lambda: ms.export_fmu(ms.Stepper(beside), tmp_path / "x.fmu"),
    ):
        with pytest.raises(ms.SpecError, match="wall would turn with the swimmer"):
            door()
    assert list(tmp_path.iterdir()) == []


def test_numbers_of_the_path_are_left_out_and_said_to_be():
    beside = gait()
    found = summary(beside)
    assert np.isnan([found["swimming_speed"], found["path_radius"], ms.screw(beside).pitch]).all()
    assert np.isfinite(found["mean_velocity"]).all()
    assert found["efficiency"] > 0
    assert any("holds at this pose of the wall" in r for r in beside.info["remarks"])
    assert beside.at_rate(2.0).one_pose == "wall"


def test_the_command_says_so_and_writes_no_path(tmp_path):
    args = ["run", "--preset", "tabak/helix", "--model", "bem", "--level", "coarse"]
    args += ["--set", "wall.distance=0.9"]
    done = CliRunner().invoke(main, [*args, "--json"])
    assert done.exit_code == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["swimming_speed"] is None
    assert len(found["mean_velocity"]) == 6
    shown = CliRunner().invoke(main, args)
    assert "holds at this pose" in " ".join(shown.stdout.split())
    done = CliRunner().invoke(main, [*args, "--out", str(tmp_path / "run")])
    assert done.exit_code == 0
    assert "no path was drawn" in done.stderr
    written = {p.name for p in (tmp_path / "run").iterdir()}
    assert written == {"report.html", "velocity.png", "run.nc", "spec.toml"}
    assert "position" not in ms.io.load(tmp_path / "run" / "run.nc")


@pytest.mark.parametrize("around", [{"wall": ms.Wall(0.9)}, {"channel": ms.Channel(
    diameter=3.0, length=9.0, position=(0.0, 0.2, 0.0))}], ids=["wall", "channel"])  # fmt: skip
def test_the_surrogate_has_no_path_either_where_its_boundary_would_turn(around):
    """It knows no boundary, and a path in free fluid is none beside one."""
    swimmer = replace(ms.Swimmer.preset("tabak/helix"), **around)
    beside = swimmer.gait()
    assert beside.one_pose == next(iter(around))
    with pytest.raises(ms.SpecError, match="would turn with"):
        ms.trajectory(beside, [0.0, 1.0])
    assert beside.mean_velocity == pytest.approx(
        ms.Swimmer.preset("tabak/helix").gait().mean_velocity, rel=1e-12
    )
    slides = swimmer.with_({"motion.free": ("us",)}).gait()
    assert slides.one_pose == ""


def test_a_swimmer_that_slides_along_its_wall_has_a_path():
    """Free along the wall and about its normal: the wall is where it was, seen from the body."""
    free = gait(motion__free=SLIDING)
    assert free.one_pose == ""
    path = ms.trajectory(free, np.linspace(0, 5, 11))
    assert np.abs(path.position[:, 1]).max() < 1e-12
    held = ms.Stepper(free).step(ms.State.at(), dt=1.0)
    assert held.position[1] == pytest.approx(0.0, abs=1e-12)


def mask(free):
    return tuple(name in free for name in ("us", "uq", "ur", "os", "oq", "or"))


WALLS = [
    (ms.Wall(2.0), ("us", "ur", "oq"), True),
    (ms.Wall(2.0), ("us",), True),
    (ms.Wall(2.0), ("uq",), False),
    (ms.Wall(2.0), ("os",), False),
    (ms.Wall(2.0, azimuth=np.pi / 2), ("us", "uq", "or"), True),
    (ms.Wall(2.0, azimuth=np.pi / 2), ("us", "oq"), False),
    (ms.Wall(2.0, azimuth=0.3), ("us",), True),
    (ms.Wall(2.0, azimuth=0.3), ("ur",), False),
    (ms.Wall(2.0, tilt=np.pi / 2), ("uq", "ur", "os"), True),
    (ms.Wall(2.0, tilt=0.1), ("us",), False),
    (ms.Wall(2.0, tilt=0.1), (), True),
    (ms.Channel(position=(0.0, 1.0, 0.0)), ("us",), True),
    (ms.Channel(position=(0.0, 1.0, 0.0)), ("us", "os"), False),
    (ms.Channel(position=(1.0, 0.0, 0.0)), ("us", "os"), True),
    (ms.Channel(shape="box"), ("us",), True),
    (ms.Channel(shape="box"), ("os",), False),
    (ms.Channel(tilt=0.1), ("us",), False),
]


@pytest.mark.parametrize(("boundary", "free", "stays"), WALLS, ids=str)
def test_a_boundary_stays_if_no_free_motion_moves_it(boundary, free, stays):
    assert boundary.stays(mask(free)) is stays


@pytest.mark.parametrize(("wall", "free", "stays"), [w for w in WALLS if type(w[0]) is ms.Wall])
def test_the_wall_seen_from_a_body_that_moved_says_the_same(wall, free, stays):
    """By moving the body through each free motion and measuring where the plane lies then."""
    n, moved = np.array(wall.normal), 0.0
    for i in np.flatnonzero(mask(free)):
        axis = np.eye(3)[i % 3]
        x = 0.1 * axis if i < 3 else np.zeros(3)
        q = np.array([np.cos(0.05), *(np.sin(0.05) * axis)]) if i > 2 else np.array([1.0, 0, 0, 0])
        seen = rotation_matrix(multiply(q * [1, -1, -1, -1], np.array([1.0, 0, 0, 0]))) @ n
        moved = max(moved, np.abs(seen - n).max(), abs(x @ n))
    assert bool(moved < 1e-12) is stays


def test_free_fluid_has_paths_as_ever():
    assert ms.Swimmer.preset("tabak/helix").gait("bem", level="coarse").one_pose == ""
