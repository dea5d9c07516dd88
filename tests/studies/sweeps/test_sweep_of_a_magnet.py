"""A sweep of a robot with a magnet in a rotating field holds what the field does to it."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main

NAMES = ("step_out", "wobbling_onset", "speed_at_step_out", "speed_per_turn")


def robot():
    return ms.Swimmer(
        body=ms.Sphere(radius=5e-4),
        tail=ms.HelicalTail(length=2e-3, amplitude=2e-4, waves=2, radius=1e-4),
        fluid=ms.Fluid(viscosity=0.34, density=970.0),
        magnet=ms.Magnet(moment=(1e-6, 3e-6, 0.0)),
        field=ms.RotatingField(strength=3e-3, frequency=1.0),
        units="SI",
    )


def test_each_design_has_what_regimes_and_run_say_of_it():
    strength, waves = [1e-3, 3e-3], [1.5, 2.5]
    found = ms.sweep(robot(), {"field.strength": strength, "tail.waves": waves})
    for i, B in enumerate(strength):
        for j, n in enumerate(waves):
            one = robot().with_({"field.strength": B, "tail.waves": n})
            said = ms.io.numbers(one, one.gait("auto"))
            for name in NAMES:
                assert float(found[name][i, j]) == pytest.approx(said[name], rel=1e-10)
    assert found.step_out.attrs["units"] == "Hz"
    assert found.speed_per_turn.attrs["units"] == "m"
    # a field's strength only scales the rates
    assert found.step_out[1].values == pytest.approx(3.0 * found.step_out[0].values, rel=1e-9)


def test_a_swimmer_without_magnet_has_none_of_it():
    found = ms.sweep(ms.Swimmer.preset("tabak/helix"), {"tail.waves": [1.0, 2.0]})
    assert not set(NAMES) & set(found)


def test_a_store_is_gone_on_with_to_the_same_numbers(tmp_path):
    over = {"magnet.moment": [1e-6, 2e-6, 4e-6]}
    one = replace(robot(), magnet=ms.Magnet(moment=1e-6, direction=(0.2, 1, 0)))
    whole = ms.sweep(one, over, out=tmp_path / "a.zarr")
    again = ms.sweep(one, over, out=tmp_path / "a.zarr", resume=True)
    for name in NAMES:
        assert np.array_equal(whole[name], again[name])
    assert (whole.status == 1).all()


def test_the_command_writes_them(tmp_path):
    spec, out = tmp_path / "robot.toml", tmp_path / "s.zarr"
    spec.write_text(robot().to_toml(), encoding="utf-8")
    done = CliRunner().invoke(
        main, ["sweep", str(spec), "--over", "tail.waves=1:3:3", "--out", str(out), "--json"]
    )
    assert done.exit_code == 0, done.output
    json.loads(done.stdout)
    import xarray as xr

    with xr.open_zarr(out) as found:
        assert np.isfinite(found.step_out).all()
        assert found.step_out.attrs["units"] == "Hz"
