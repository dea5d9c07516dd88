"""``microswim path`` as a user types it."""

import json
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from boundaries import beside
from microswim.calibration.poses import around as poses_around
from microswim.cli import main

CELL = ["--preset", "goto/C", "--model", "rft", "--set", "gravity.density=1100 kg/m^3"]


def call(*args):
    return CliRunner().invoke(main, ["path", *map(str, args)])


def test_the_json_says_where_it_ended_and_how_wrong_that_is():
    run = call(*CELL, "--time", "0.5s", "--from", "0um,0um,10um", "--tilt", "20deg", "--json")
    assert run.exit_code == 0, run.output
    said = json.loads(run.stdout)
    swimmer = ms.Swimmer.preset("goto/C", {"gravity.density": "1100 kg/m^3"})
    found = ms.path(swimmer, 0.5, model="rft", position=(0, 0, 1e-5), tilt=np.radians(20.0))
    assert np.allclose(said["position"], found.position[-1], rtol=1e-12)
    assert said["outcome"] == "free"
    assert said["circle_radius"] is None
    assert said["gap_mean"] is None
    assert 0 <= said["expected_error"]["position"] < 1e-9
    assert {"us", "os", "how"} <= said["expected_error"]["velocity"].keys()
    assert said["dissipated"] > 0


def test_the_table_says_so_in_words():
    flow = ["--set", "flow.kind=shear", "--set", "flow.rate=1 1/s"]
    run = call(*CELL, "--time", "0.2s", *flow)
    assert run.exit_code == 0, run.output
    assert "outcome" in run.stdout
    assert "level of local drag" in run.stdout


@pytest.mark.parametrize("more", [[], ["--over", "tilt=0,0.1", "--out", "map"]])
def test_a_film_is_of_one_path_and_in_a_folder(more):
    run = call(*CELL, "--time", "0.1s", "--film", *more)
    assert run.exit_code == 2
    assert "--film: with --out DIR, and of one path" in run.stderr


def test_files_are_those_that_are_said(tmp_path):
    out, few = tmp_path / "o", ["--samples", "3"]
    run = call(*CELL, "--time", "0.1s", *few, "--out", out, "--film")
    assert run.exit_code == 0, run.output
    for name in ("path.png", "path.gif", "path.nc", "path.csv", "swimmer.pvd", "path.vtp",
                 "spec.toml"):  # fmt: skip
        assert (out / name).stat().st_size > 0
        assert name in run.stderr
    data = ms.io.load(out / "path.nc")
    table = np.loadtxt(out / "path.csv", delimiter=",", comments=("#", "t"))
    assert np.allclose(table[:, 1:4], data.position, rtol=1e-10)
    assert data.attrs["outcome"] == "free"
    again = call(*CELL, "--time", "0.1s", "--out", out)
    assert again.exit_code == 2
    assert "--resume" in again.stderr
    other = call(*CELL, "--time", "0.2s", "--out", out, "--resume")
    assert other.exit_code == 2
    assert "another path" in other.stderr
    before = {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()}
    asked = ("--set", "fluid.viscosity=2 mPa s", "--out", out, "--resume")
    changed = call(*CELL, "--time", "0.1s", *few, *asked)
    assert "another path" in changed.stderr, changed.output
    assert {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()} == before
    assert call(*CELL, "--time", "0.1s", *few, "--out", out, "--resume").exit_code == 0


def test_many_paths_with_noise_give_their_spread(tmp_path):
    noisy = [*CELL, "--set", "noise.temperature=298 K", "--time", "0.05s", "--paths", "40"]
    run = call(*noisy, "--samples", "3", "--out", tmp_path / "o", "--json")
    assert run.exit_code == 0, run.output
    said = json.loads(run.stdout)
    assert np.shape(said["covariance"]) == (3, 3)
    assert said["mean_square_displacement"] > 0
    table = np.loadtxt(tmp_path / "o" / "path.csv", delimiter=",", comments=("#", "t"))
    assert table.shape == (120, 10)


def test_a_killed_path_goes_on_where_it_was(tmp_path):
    out = tmp_path / "o"
    args = [*CELL, "--set", "noise.temperature=298 K", "--time", "40s", "--out", str(out)]
    code = "import sys; from microswim.cli import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", code, "path", *args],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        while process.poll() is None and not (out / "checkpoint.npz").exists():
            time.sleep(0.01)
    finally:
        process.kill()
        process.wait()
    assert not (out / "path.nc").exists()
    with np.load(out / "checkpoint.npz") as kept:
        assert 1 <= kept["chunks"] < 48
        part = kept["position"]
    run = call(*args, "--resume", "--json")
    assert run.exit_code == 0, run.output
    whole = ms.io.load(out / "path.nc").position.values
    assert np.array_equal(whole[: part.shape[1]], part[0])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--time", "5"], "--time"),
        (["--time", "-1s"], "--time"),
        (["--time", "1s", "--from", "0um,1um"], "--from"),
        (["--time", "1s", "--from", "0,1,2"], "--from"),
        (["--time", "1s", "--tilt", "3um"], "--tilt"),
        (["--time", "1s", "--paths", "3"], "paths"),
        (["--time", "1s", "--resume"], "--out"),
        (["--time", "1e9s"], "steps"),
    ],
)
def test_what_makes_no_sense_is_a_sentence(options, said):
    run = call(*CELL, *options)
    assert run.exit_code == 2, run.output
    assert said in run.stderr
    assert run.stderr.count("Error") == 1
    assert "Traceback" not in run.output


def test_a_run_says_what_acts_along_a_path_alone():
    run = CliRunner().invoke(main, ["run", *CELL])
    assert run.exit_code == 0, run.output
    assert "without [gravity]" in run.stdout
    assert "microswim path" in run.stdout


def test_motors_of_given_torque_are_told_one_by_one(tmp_path):
    out = tmp_path / "out"
    args = ["--preset", "several/two-tails", "--set", "motor.torque=40", "--time", "1"]
    args += ["--samples", "9"]
    run = call(*args, "--json", "--out", out)
    assert run.exit_code == 0, run.output
    said = json.loads(run.stdout)
    assert len(said["motor_frequency"]) == 2
    assert said["phase_difference"][0] == 0.0
    assert said["motor_work"] == pytest.approx(
        2 * np.pi * 40 * sum(said["motor_frequency"]), rel=1e-3
    )
    header = (out / "path.csv").read_text().splitlines()[2]
    assert header.endswith("motor_phase[0],motor_phase[1],motor_rate[0],motor_rate[1]")
    again = call(*args, "--json", "--out", out, "--resume")
    assert json.loads(again.stdout)["position"] == said["position"]
    late = call(*args, "--time", "2", "--out", out, "--resume")
    assert late.exit_code == 2
    assert "another path" in late.stderr
    assert (out / "swimmer.pvd").exists()
    told = call(*args)
    assert "motors turn at" in told.stdout
    assert call(*args, "--over", "tilt=0:60deg:3").exit_code == 2


def test_tails_on_hooks_tell_how_they_stand(tmp_path):
    hook = ["--set", "hook.stiffness=[0.5, 1.0]", "--set", "hook.length=0.1"]
    args = ["--preset", "several/two-tails", "--set", "motor.torque=40", "--time", "0.1", *hook]
    args += ["--samples", "5"]
    run = call(*args, "--json", "--out", tmp_path / "out")
    assert run.exit_code == 0, run.output
    said = json.loads(run.stdout)
    assert said["hook_bend"][0] > said["hook_bend"][1] > 0.0
    assert said["largest_hook_bend"] >= said["hook_bend"][0]
    assert "[hook] bends" in run.stderr
    assert (tmp_path / "out" / "swimmer.pvd").exists()
    assert "widest angle of two tails" in call(*args).stdout
    refused = call(*args, "--model", "bem")
    assert refused.exit_code == 2
    assert "remove [hook]" in refused.stderr


def test_poses_tell_their_error_and_what_is_kept_of_them(monkeypatch):
    """How well others are met stands in the table; who interrupts the solves is told of them."""
    robot = ["--preset", "tabak/helix", "--set", "wall.distance=1", "--set", "motion.free=all"]
    swimmer = ms.Swimmer.preset("tabak/helix", {"wall.distance": 1, "motion.free": "all"})
    off = {"us": 0.01, "uq": 0.02, "ur": 0.005, "os": 0.0, "oq": 0.0, "or": 0.0, "how": "of two"}
    made = replace(beside(swimmer), expected_error=off)
    monkeypatch.setattr(poses_around, "around", lambda *_, **__: made)
    run = call(*robot, "--time", "1")
    assert run.exit_code == 0, run.output
    assert "velocities within 2 % of the speed" in " ".join(run.stdout.split())

    def stopped(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(poses_around, "around", stopped)
    for more in ([], ["--over", "tilt=0,0.1"]):
        run = call(*robot, "--time", "1", *more)
        assert run.exit_code == 130
        assert "what was solved is kept: the same command goes on" in run.stderr
