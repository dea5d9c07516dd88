"""Finite elements from the command line: in time, kept, resumed after a kill, refused in words."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from microswim import Swimmer
from microswim.cli import main
from microswim.errors import MicroswimError
from microswim.numerics import archive

pytest.importorskip("ngsolve", reason="needs the extra fem")

from microswim.models import fem, memory
from microswim.models.fem import picture
from microswim.models.fem.gait import LOOKING
from microswim.models.fem.swimming import forget_flows_after

pytestmark = pytest.mark.fem

SHORT = """
[fluid]
viscosity = 2.0
density = 1.0
[body]
shape = "sphere"
radius = 0.5
[tail]
kind = "helix"
length = 0.6
amplitude = 0.08
waves = 1
ramp = 0.3
radius = 0.08
sections = "sheared"
[channel]
diameter = 4.0
length = 4.0
"""


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    return path


def call(*args):
    return CliRunner().invoke(main, [str(a) for a in args])


def refusal(result, status=2):
    assert result.exit_code == status, (result.stdout, result.stderr, result.exception)
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    return line


def numbers(*args):
    result = call(*args, "--json")
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_march_without_density_is_the_gait(spec, tmp_path):
    """The command and the function see the same channel, level and swimmer; tables say the same."""
    still = ("--set", "fluid.density=0.0", "--level", "coarse")
    steps = ("--periods", 0.25, "--steps-per-period", 8, "--out", tmp_path / "swum")
    march, seen = numbers("swim", spec, *still, *steps), []
    gait = Swimmer.from_toml(spec).gait("fem", level="coarse", progress=lambda *n: seen.append(n))
    assert gait.info["remarks"] == [LOOKING]
    assert seen == [(i, 9) for i in range(1, 10)]  # mesh, one phase: factorisation, seven flows
    assert gait.info["channel"]["diameter"] == 4.0
    assert march["unknowns"] == gait.info["unknowns"]
    for i in (0, 3):
        assert march["mean_velocity"][i] == pytest.approx(gait.mean_velocity[i], rel=0.05)
    assert march["reynolds"] == 0.0
    table = np.loadtxt(tmp_path / "swum" / "swim.csv", delimiter=",", skiprows=1)
    kept = xr.load_dataset(tmp_path / "swum" / "swim.nc", engine="h5netcdf")
    assert table.shape == (2, 27)
    assert table[:, 2:8] == pytest.approx(kept.velocity.values, rel=1e-10)
    assert kept.attrs["spec"].count("[channel]") == 1
    assert "--resume goes on" in refusal(call("swim", spec, *still, *steps))


def test_what_is_missing_is_said_before_any_work(spec, tmp_path, monkeypatch):
    assert "--out" in refusal(call("swim", spec, "--resume"))
    assert "--out" in refusal(call("swim", spec, "--film"))
    monkeypatch.setattr(picture, "find_spec", lambda name: None)
    line = refusal(call("swim", spec, "--film", "--out", tmp_path / "a"))
    assert 'pip install "microswim[viz]"' in line
    monkeypatch.setattr(fem, "find_spec", lambda name: None)
    for command in (("run", spec, "--model", "fem"), ("swim", spec)):
        assert 'pip install "microswim[fem]"' in refusal(call(*command), status=1)
    assert not (tmp_path / "a").exists()


def test_what_does_not_fit_into_memory_is_refused(spec, monkeypatch):
    monkeypatch.setattr(memory, "available", lambda: 3e8)
    line = refusal(call("run", spec, "--model", "fem", "--level", "coarse"), status=1)
    assert "GB of memory and 0.3 GB are free" in line


def test_flow_files_that_no_checkpoint_vouches_for_are_removed(tmp_path):
    """A kill while a flow is written leaves half a file, later than the checkpoint."""
    for step in (2, 4, 6):
        (tmp_path / f"flow-{step:05d}.vtu").write_text("half")
        (tmp_path / f"flow-{step:05d}.skin.vtu").write_text("half")
    forget_flows_after(4, tmp_path)
    left = sorted(f.name for f in tmp_path.iterdir())
    assert left == [f"flow-0000{n}{end}" for n in (2, 4) for end in (".skin.vtu", ".vtu")]


def test_a_refused_resume_leaves_the_folder_as_it_was(spec, tmp_path, monkeypatch):
    """The data in it are of the old spec, so the old spec stays beside them."""
    from microswim.models import fem

    def refuse(swimmer, **options):
        raise MicroswimError("checkpoint = ...: it belongs to another swimmer")

    monkeypatch.setattr(fem, "swim", refuse)
    (tmp_path / "checkpoint.npz").write_bytes(b"of the old spec")
    (tmp_path / "spec.toml").write_text("# the old spec\n")
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.is_file()}
    asked = ("--set", "tail.amplitude=0.12", "--out", tmp_path, "--resume")
    assert "another swimmer" in refusal(call("swim", spec, *asked), status=1)
    after = {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.is_file()}
    assert after == before


@pytest.mark.slow
def test_killed_march_goes_on_to_the_same_numbers(spec, tmp_path):
    """kill -9 in the middle; --resume; the same table as without the kill, film included."""
    pytest.importorskip("pyvista", reason="needs the extra viz")
    options = ("--periods", "0.75", "--steps-per-period", "8", "--checkpoint-every", "2")
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    assert call("swim", spec, *options, "--out", whole).exit_code == 0
    command = [sys.executable, "-c", "from microswim.cli import main; main()", "swim", str(spec)]
    command += [*options, "--out", str(broken), "--film"]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    kept = broken / "checkpoint.npz"
    try:
        until = time.time() + 600
        while not kept.exists() and process.poll() is None and time.time() < until:
            time.sleep(0.02)
        os.kill(process.pid, signal.SIGKILL)
    finally:
        process.kill()
        process.wait()
    assert not (broken / "swim.nc").exists()
    assert 0 < archive.unpack(kept.read_bytes())[0]["step"] < 6
    assert "--resume goes on" in refusal(call("swim", spec, *options, "--out", broken))
    assert call("swim", spec, *options, "--out", broken, "--film", "--resume").exit_code == 0
    one, two = (xr.load_dataset(f / "swim.nc", engine="h5netcdf") for f in (whole, broken))
    for name in ("velocity", "wrench_body", "wrench_tail", "position", "quaternion"):
        scale = np.abs(one[name].values).max()
        assert np.abs(one[name].values - two[name].values).max() <= 1e-9 * scale, name
    from PIL import Image

    with Image.open(broken / "flow.gif") as film, Image.open(broken / "flow.png") as still:
        assert film.n_frames == 3
        assert still.size == (1200, 800)
    assert (broken / "flow.pvd").read_text().count("flow/flow-0000") == 3
