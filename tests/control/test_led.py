"""A robot led along a path: it arrives, loads act, and the command prints, writes and refuses."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.control.led import led

EXAMPLES = Path(__file__).parents[2] / "examples" / "control"
WAY = 1e-3 * np.array([[0, 0, 0], [-0.3, 0.1, 0], [-0.6, 0.1, 0.1]])
TABLE = "x (mm),y (mm),z (mm)\n0,0,0\n-0.3,0.1,0\n-0.6,0.1,0.1\n"


def robot(**changes):
    field = ms.RotatingField(strength=5e-3, frequency=1.0)
    one = replace(ms.Swimmer.from_toml(EXAMPLES / "coil_robot.toml"), field=field)
    return replace(one, body=ms.Spheroid(semi_axes=(6e-4, 5e-4)), **changes)


def follower(one, **options):
    return ms.PathFollower(swimmer=one, path=WAY, frequency=8.0, **options)


@pytest.fixture(scope="module")
def gait():
    return robot().gait()


def test_it_arrives_and_starts_body_first(gait):
    found = led(follower(robot(), gait=gait))
    assert found.arrived
    assert found.currents is None
    assert found.off.max() < 0.2e-3
    assert found.position[0] == pytest.approx(WAY[0])
    w, x, y, z = found.quaternion[0]
    ahead = -np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    assert ahead == pytest.approx((WAY[1] - WAY[0]) / np.linalg.norm(WAY[1] - WAY[0]))
    assert np.linalg.norm(found.field, axis=1) == pytest.approx(5e-3)


def test_a_flow_carries_it_and_weight_pulls_it_down(gait):
    """Over the first step, for which the command is the same."""
    loads = {"flow": ms.UniformFlow(speed=1e-3, direction=(0, 1, 0))}
    gravity = ms.Gravity(density=3000.0)
    calm, flow, heavy = (
        led(follower(robot(**more), gait=gait), time=1e-3, dt=1e-3)
        for more in ({}, loads, {"gravity": gravity})
    )
    assert not calm.arrived
    carried = flow.position[1] - calm.position[1]
    assert carried == pytest.approx([0.0, 1e-6, 0.0], abs=1e-12)
    fallen = heavy.position[1] - calm.position[1]
    assert fallen[2] < 0
    volume = 4.0 / 3.0 * np.pi * 6e-4 * 5e-4**2
    rough = 9.81 * (3000.0 - 970.0) * volume / (6 * np.pi * 0.34 * 6e-4) * 1e-3
    assert -fallen[2] == pytest.approx(rough, rel=0.4)  # the tail adds weight and drag


def test_noise_shakes_it_and_the_seed_tells_how(gait):
    warm = robot(noise=ms.Noise(temperature=1e9))
    one, same, other = (
        led(follower(warm, gait=gait), time=0.02, seed=s).position[-1] for s in (1, 1, 2)
    )
    assert one == pytest.approx(same, abs=0.0)
    assert np.linalg.norm(one - other) > 1e-8


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wall": ms.Wall(distance=5e-3)}, r"wall: a led robot swims in free fluid"),
        ({"channel": ms.Channel(diameter=1e-2, length=2e-2)}, r"channel: a led robot"),
    ],
)
def test_surroundings_that_do_not_act_are_refused(changes, words, gait):
    with pytest.raises(ms.SpecError, match=words):
        led(follower(robot(**changes), gait=gait))


def run(*args):
    return CliRunner().invoke(main, ["follow", *map(str, args)])


@pytest.fixture
def way(tmp_path):
    file = tmp_path / "way.csv"
    file.write_text(TABLE)
    return file


def test_the_command_prints_and_writes_currents_of_coils(way, tmp_path):
    out = tmp_path / "led"
    told = run(EXAMPLES / "coil_robot.toml", "--path", way, "--strength", "5mT", "--frequency",
               "8Hz", "--time", "0.1s", "--json", "--out", out)  # fmt: skip
    assert told.exit_code == 0, told.stderr
    report = json.loads(told.stdout)
    assert not report["arrived"]
    assert 0.05 < report["largest_current"] < 1.0
    assert report["expected_error"]["velocity"]["us"] > 0
    head, *rows = (out / "follow.csv").read_text().splitlines()
    assert "off (m)" in head
    assert head.count("(A)") == 8
    assert len(rows) > 20
    assert (out / "follow.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("x,y,z\n0,0,0\n1,0,0\n", "x has no unit; write it into the header, as x (mm)"),
        ("x (mm),y (mm),z (mm)\n0,0,0\n", "two corners or more"),
        ("x (mm),y (mm),z (mm)\n0,0,0\n0,0,0\n", "finite corners that differ"),
        ("x (mm),y (mT),z (mm)\n0,0,0\n1,0,0\n", "y (mT)"),
    ],
)
def test_one_sentence_says_what_is_wrong(way, table, words):
    way.write_text(table)
    told = run(EXAMPLES / "coil_robot.toml", "--path", way, "--strength", "5mT")
    assert told.exit_code == 2
    assert words in told.stderr
    assert len(told.stderr.strip().splitlines()) == 1
