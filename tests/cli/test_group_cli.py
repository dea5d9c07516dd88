"""``microswim group``: what it prints, writes and refuses."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main

SCENE = (
    '[[swimmer]]\npreset = "tabak/helix"\n'
    '[[swimmer]]\npreset = "tabak/helix"\nposition = [0, 3, 0]\nphase = "90 deg"\n'
)


def run(*args):
    return CliRunner().invoke(main, ["group", *map(str, args)])


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "pair.toml"
    path.write_text(SCENE)
    return path


def test_it_prints_writes_and_says_how_wrong_it_may_be(scene, tmp_path):
    # one motor held still: no phases to average over
    still = ("--set", "tail.frequency=0", "--set", "swimmer[0].force=[1,0,0]", "--level", "coarse")
    result = run(scene, *still, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    R, V = np.array(found["resistance"]), np.array(found["mean_velocity"])
    assert R.shape == (12, 12)
    assert V.shape == (2, 6)
    assert R @ V.reshape(-1) == pytest.approx([1] + 11 * [0], abs=1e-9)
    assert found["units"] == "dimensionless"
    assert len(found["expected_error"]["us"]) == 2
    assert 0 < found["expected_error"]["us"][0] < 0.1
    assert found["expected_error"]["how"]
    assert found["gap"] == pytest.approx(2.0, rel=0.05)
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert names == {"group.json", "swimmers.vtp", "flow.png"}
    again = run(scene, *still, "--out", tmp_path / "out")
    assert again.exit_code == 2
    assert "--force" in again.stderr


def test_the_table_names_each_swimmer_and_its_error(scene):
    result = run(scene, "--set", "tail.frequency=0", "--set", "swimmer[0].force=[1,0,0]",
                 "--level", "coarse")  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert "swimmer 1" in result.stdout
    assert "±" in result.stdout


def test_swimmers_that_overlap_are_refused_before_anything_is_written(scene, tmp_path):
    result = run(scene, "--set", "swimmer[1].position=[0,0.5,0]", "--level", "coarse",
                 "--out", tmp_path / "out")  # fmt: skip
    assert result.exit_code == 2
    assert "swimmer 1 overlaps or touches swimmer 0" in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_file_without_coarser_patches_states_no_error_rather_than_none(tmp_path):
    """Its patches are the same at the level below: nothing is known, which is not zero."""
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.icosphere(2).export(tmp_path / "ball.stl")
    (tmp_path / "ball.toml").write_text(
        '[fluid]\nviscosity = 1.0\n[body]\nshape = "mesh"\nfile = "ball.stl"\nscale = 1.0\n'
        '[tail]\nkind = "none"\n'
    )
    path = tmp_path / "one.toml"
    path.write_text('[[swimmer]]\nspec = "ball.toml"\nforce = [1, 0, 0]\n')
    result = run(path, "--level", "coarse", "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["mean_velocity"][0][0] == pytest.approx(1 / (6 * np.pi), rel=0.02)
    assert found["expected_error"]["us"] == [None]
    assert found["expected_error"]["how"].startswith("not known")


def test_with_a_time_it_follows_the_swimmers(scene, tmp_path):
    asked = ("--level", "coarse", "--time", "0.2", "--samples", "3")
    result = run(scene, *asked, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    known = ms.group_path(ms.Group.from_toml(scene), [0.0, 0.1, 0.2], level="coarse")
    assert np.array(found["position"]) == pytest.approx(known.position[-1].values, abs=1e-12)
    apart = np.linalg.norm(np.diff(known.position.values, axis=1), axis=-1)
    assert found["nearest"] == pytest.approx(apart.min())
    assert found["expected_error"]["velocity"] == pytest.approx(known.expected_error.max())
    rows = (tmp_path / "out" / "paths.csv").read_text().splitlines()
    assert rows[0] == "t,track,x,y,z"
    assert [float(x) for x in rows[-1].split(",")[2:]] == pytest.approx(found["position"][1])
    assert {"paths.png", "paths.nc", "checkpoint.npz"} <= {
        p.name for p in (tmp_path / "out").iterdir()
    }
    assert run(scene, *asked, "--out", tmp_path / "out").exit_code == 2
    again = run(scene, *asked, "--out", tmp_path / "out", "--resume")
    assert again.exit_code == 0, again.stderr
    assert "within" in again.stdout


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (("--time", "-1"), "--time"),
        (("--time", "1 s"), "--time"),
        (("--time", "1", "--resume"), "--resume"),
    ],
)
def test_a_time_that_makes_no_sense_is_refused(scene, asked, said):
    result = run(scene, *asked)
    assert result.exit_code == 2
    assert said in result.stderr


PLACES = "x;y;z;dx;dy;dz;phase (deg)\n" + "".join(
    f"{12 * (i % 3)};{12 * (i // 3)},5;0;1;0,1;{i}e-2;{30 * i}\n" for i in range(9)
)


def test_many_places_make_many_swimmers_seen_from_afar(tmp_path):
    (tmp_path / "cells.csv").write_text(PLACES)
    scene = tmp_path / "drop.toml"
    scene.write_text('[[swimmer]]\npreset = "tabak/helix"\nplaces = "cells.csv"\n')
    members = ms.Group.from_toml(scene).members
    assert [m.position[1] for m in members[::3]] == [0.5, 12.5, 24.5]
    assert members[4].direction == pytest.approx((1.0, 0.1, 0.04))
    assert members[3].phase == pytest.approx(np.pi / 2)
    asked = ("--time", "3", "--samples", "3", "--level", "coarse", "--model", "far")
    result = run(scene, *asked, "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["model"] == "far"
    assert np.shape(found["position"]) == (9, 3)
    assert found["nearest"] == pytest.approx(12.0, abs=0.1)
    assert 0 < found["expected_error"]["velocity"] < 0.02
    assert "swimmer 8" in run(scene, *asked).stdout


@pytest.mark.parametrize(
    ("table", "more", "told"),
    [
        ("x,y\n1,2\n", "", "no column z"),
        ("x,y,z\n1,2,\n", "", "z: no number in row 1"),
        ("x (um),y (um),z (um)\n1,2,3\n", "", "has a unit and the swimmer has none"),
        ("x,y,z,dx\n1,2,3,1\n", "", "give dx, dy and dz"),
        ("x,y,z,spin\n1,2,3,1\n", "", "column spin: not known"),
        ("x,y,z\n1,2,3\n", "position = [1, 2, 3]\n", "its places say it too"),
    ],
)
def test_places_that_are_none_are_refused_in_a_sentence(tmp_path, table, more, told):
    (tmp_path / "cells.csv").write_text(table)
    scene = tmp_path / "drop.toml"
    scene.write_text(f'[[swimmer]]\npreset = "tabak/helix"\nplaces = "cells.csv"\n{more}')
    result = run(scene, "--time", "3", "--model", "far")
    assert result.exit_code == 2
    assert told in result.stderr
    assert "Traceback" not in result.stderr


POSES = "pose,swimmer,x,y,z,phase (deg)\n0,1,0,3,0,90\n1,1,0,0.3,0,0\n2,0,0,-1,0,0\n2,1,0,3,1,0\n"


def test_with_poses_it_solves_at_each(scene, tmp_path):
    (tmp_path / "poses.csv").write_text(POSES)
    asked = ("--level", "coarse", "--poses", tmp_path / "poses.csv", "--out", tmp_path / "out")
    result = run(scene, *asked, "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    group = ms.Group.from_toml(scene)
    last = group.moved(positions=[(0, -1, 0), (0, 3, 1)], phases=[0, 0]).solve(level="coarse")
    assert np.array(found["velocity"][2]) == pytest.approx(last.velocity, abs=1e-9)
    assert np.array(found["resistance"][2]) == pytest.approx(last.resistance, abs=1e-9)
    assert "overlaps" in found["refused"][1]
    assert found["gap"][1] is None
    rows = (tmp_path / "out" / "poses.csv").read_text().splitlines()
    assert rows[0].startswith("pose,swimmer,u_s,u_q,u_r,Omega_s")
    assert float(rows[-1].split(",")[2]) == pytest.approx(last.velocity[1, 0])
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert {"poses.csv", "poses.nc", "poses.json", "checkpoint.npz"} <= names
    assert run(scene, *asked).exit_code == 2
    again = run(scene, *asked, "--resume")
    assert again.exit_code == 0, again.stderr
    assert "1 of 3 poses refused" in again.stdout


@pytest.mark.parametrize(
    ("text", "asked", "said"),
    [
        (POSES.replace("2,1,", "2,7,"), (), "0 to 1"),
        (POSES.replace("2,1,", "2,0,"), (), "stands twice"),
        (POSES.replace("phase (deg)", "pace"), (), "no such column: pace"),
        (POSES.replace("x,", "x (um),"), (), "has a unit and the swimmer has none"),
        (POSES.replace(",x,", ",dx,"), (), "y, z alone"),
        (POSES, ("--time", "1"), "give one of them"),
    ],
)
def test_poses_that_make_no_sense_are_refused(scene, tmp_path, text, asked, said):
    (tmp_path / "poses.csv").write_text(text)
    result = run(scene, "--poses", tmp_path / "poses.csv", *asked, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert said in result.stderr
    assert not (tmp_path / "out").exists()
