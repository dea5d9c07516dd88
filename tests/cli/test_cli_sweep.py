"""``microswim sweep`` and ``design --uncertain`` as a user types them; a Slurm of three scripts."""

import json
import os
import stat

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main

OVER = ["--over", "tail.amplitude=0.05:0.15:3,tail.waves=2,3"]


def call(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def sweep(*arguments):
    return call("sweep", "--preset", "tabak/helix", *arguments)


def test_a_grid_lands_in_a_store_and_json_counts_it(tmp_path):
    run = sweep(*OVER, "--out", tmp_path / "a.zarr", "--json")
    assert run.exit_code == 0, run.output
    report = json.loads(run.stdout)
    assert (report["designs"], report["failed"]) == (6, 0)
    store = xr.open_zarr(report["store"])
    assert store.sizes == {"tail.amplitude": 3, "tail.waves": 2, "component": 6}
    gait = ms.Swimmer.preset("tabak/helix", {"tail.amplitude": 0.1}).gait()
    row = store.sel({"tail.amplitude": 0.1, "tail.waves": 3.0}, method="nearest")
    assert float(row.swimming_speed) == pytest.approx(ms.screw(gait).speed, rel=1e-7)


def test_a_list_of_designs_and_its_failures(tmp_path):
    designs = tmp_path / "designs.csv"
    designs.write_text("tail.amplitude,tail.handedness\n0.1,left\n0.1,right\n-1,left\n")
    run = sweep("--designs", designs, "--out", tmp_path / "a.zarr")
    assert run.exit_code == 0, run.output
    assert "3 designs, 1 failed" in run.stdout
    assert "1 x tail.amplitude = -1" in run.stdout
    speed = xr.open_zarr(tmp_path / "a.zarr").swimming_speed.values
    assert speed[0] == pytest.approx(speed[1])
    assert np.isnan(speed[2])


def test_a_sweep_in_which_every_design_fails_says_why_and_fails(tmp_path):
    run = sweep("--over", "tail.amplitude=-1,-2", "--out", tmp_path / "a.zarr")
    assert run.exit_code == 1
    assert "every design failed: tail.amplitude = -1" in run.stderr


def test_a_store_in_the_way_is_refused_and_resumed_when_asked(tmp_path):
    store = tmp_path / "a.zarr"
    assert sweep(*OVER, "--out", store).exit_code == 0
    again = sweep(*OVER, "--out", store)
    assert again.exit_code == 2
    assert "--resume" in again.stderr or "resume" in again.stderr
    assert sweep(*OVER, "--out", store, "--resume").exit_code == 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "--over NAME=A:B:N or --designs FILE"),
        (["--over", "tail.amplitud=0:1:2"], 'did you mean "tail.amplitude"'),
        (["--designs", "missing.csv"], "missing.csv: no such file"),
        ([*OVER, "--scheduler", "a:1", "--cluster", "slurm"], "one of the two"),
    ],
)
def test_what_makes_no_sense_is_one_sentence(arguments, says, tmp_path):
    run = sweep(*arguments, "--out", tmp_path / "a.zarr")
    assert run.exit_code == 2
    assert says in run.stderr
    assert not (tmp_path / "a.zarr").exists()


def test_the_level_reaches_the_reference(tmp_path):
    out = tmp_path / "a.zarr"
    one = ["--over", "tail.waves=2", "--model", "bem", "--level", "coarse", "--workers", 1]
    run = sweep(*one, "--out", out)
    assert run.exit_code == 0, run.output
    coarse = ms.Swimmer.preset("tabak/helix", {"tail.waves": 2.0}).gait("bem", level="coarse")
    found = xr.open_zarr(out).mean_velocity.values[0]
    assert found == pytest.approx(coarse.mean_velocity, rel=1e-9, abs=1e-12)


def test_an_uncertain_design_keeps_away_from_the_limit():
    wish = ["--maximize", "swimming_speed", "--subject-to", "mean_torque<=120", "--json"]
    over = ["--preset", "tabak/helix-constant", "--over", "tail.amplitude=0.02:0.3"]
    exact = json.loads(call("design", *over, *wish).stdout)
    run = call("design", *over, *wish, "--uncertain", "tail.amplitude=5%")
    assert run.exit_code == 0, run.output
    robust = json.loads(run.stdout)
    assert exact["quantities"]["mean_torque"] == pytest.approx(120)
    assert robust["quantities"]["mean_torque"] < 119
    assert robust["yield"] > 0.95 - 4 * robust["yield_error"]


SBATCH = """#!/bin/sh
script="$FAKE_SLURM/job.$$"  # the original is gone once it is submitted
cp "$1" "$script"
setsid sh "$script" >/dev/null 2>&1 </dev/null &
echo "$!" >> "$FAKE_SLURM/jobs"
echo "Submitted batch job $!"
"""
SCANCEL = '#!/bin/sh\nfor job in "$@"; do kill -- "-$job" 2>/dev/null; done; exit 0\n'


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """`sbatch` that starts the job's script on this machine, `scancel` that ends it."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name, text in {"sbatch": SBATCH, "scancel": SCANCEL}.items():
        (folder / name).write_text(text)
        (folder / name).chmod(stat.S_IRWXU)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("FAKE_SLURM", str(tmp_path))
    yield tmp_path / "jobs"
    if (tmp_path / "jobs").exists():
        jobs = (tmp_path / "jobs").read_text().split()
        os.system(" ".join([str(folder / "scancel"), *jobs]))


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::UserWarning:distributed", "ignore::FutureWarning")
def test_slurm_jobs_solve_the_designs(slurm, tmp_path):
    run = sweep(
        *("--over", "tail.waves=2,2.5,3", "--model", "bem", "--level", "coarse"),
        *("--cluster", "slurm", "--workers", 1, "--out", tmp_path / "a.zarr", "--json"),
    )
    assert run.exit_code == 0, run.output
    assert len(slurm.read_text().split()) == 1
    report = json.loads(run.stdout)
    assert (report["designs"], report["failed"]) == (3, 0)
