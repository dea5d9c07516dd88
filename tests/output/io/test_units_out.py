"""Numbers that leave the program carry the units of the swimmer, whatever model made them."""

import json

import numpy as np
import pint
import pytest
import xarray as xr
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main

SI = {"body.radius": "0.5 um", "tail.length": "2 um", "tail.amplitude": "0.1 um"}
SPEC = """
[fluid]
viscosity = "1 mPa s"
[body]
shape = "sphere"
radius = "0.5 um"
[tail]
kind = "helix"
length = "2 um"
amplitude = "0.1 um"
waves = 2
radius = "0.1 um"
frequency = "50 Hz"
ramp = 0.3
"""


@pytest.fixture(scope="module")
def spec(tmp_path_factory):
    path = tmp_path_factory.mktemp("units") / "cell.toml"
    path.write_text(SPEC)
    return path


def test_boundary_elements_keep_the_units(spec, tmp_path):
    gait = ms.Swimmer.from_toml(spec).gait("bem", level="coarse")
    assert gait.units == "SI"
    call = ["run", str(spec), "--model", "bem", "--level", "coarse", "--out", str(tmp_path / "r")]
    result = CliRunner().invoke(main, [*call, "--json"])
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["units"] == "SI"
    assert "units: s, m, rad" in (tmp_path / "r" / "trajectory.csv").read_text(encoding="utf-8")
    run = ms.io.load(tmp_path / "r" / "run.nc")
    assert run.swimming_speed.units == "m/s"
    assert "units of the spec" not in (tmp_path / "r" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("stored", [False, True])
def test_every_variable_of_a_sweep_has_its_unit(spec, tmp_path, stored):
    over = {"tail.amplitude": [1e-7, 1.1e-7], "tail.waves": [2, 3]}
    out = tmp_path / "a.zarr" if stored else None
    found = ms.sweep(ms.Swimmer.from_toml(spec), over, out=out)
    if stored:
        found = xr.open_zarr(out)
    registry = pint.UnitRegistry()
    for name in {*found.data_vars, *over} - {"status", "reason"}:
        for unit in found[name].attrs["units"].split(","):
            registry.parse_units(unit.strip().replace("N m", "N*m"))
    assert found["tail.amplitude"].units == "m"
    assert found["tail.waves"].units == "1"
    assert found.mean_torque.units == "N m"
    bare = ms.sweep(ms.Swimmer.preset("tabak/helix"), {"tail.amplitude": [0.1]})
    assert bare["tail.amplitude"].units == "length"
    assert bare.mean_power.units == "power"


def test_a_path_has_units_throughout(spec):
    path = ms.trajectory(ms.Swimmer.from_toml(spec).gait(), np.linspace(0, 0.02, 3))
    assert all(path[name].attrs.get("units") for name in (*path.data_vars, "time"))
