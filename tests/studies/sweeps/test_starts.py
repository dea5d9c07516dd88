"""Maps of starts: each point is its path, what cannot start is told, a killed map goes on."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import microswim as ms
from boundaries import beside
from microswim.cli import main
from microswim.studies.sweeps import starts as at_starts

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
BY_WALL = replace(ROBOT, wall=ms.Wall(1.0))
WALL = beside(BY_WALL)
OVER = {"z": [0.3, 0.8, 2.0], "tilt": [-0.2, 0.3]}


def test_each_point_is_the_path_from_there(tmp_path):
    keep = tmp_path / "map.json"
    found = ms.starts(BY_WALL, 0.5, OVER, poses=WALL, keep=keep, workers=0)
    assert dict(found.sizes) == {"z": 3, "tilt": 2, "axis": 3}
    assert found.outcome.values[0].tolist() == ["inside", "inside"]
    alone = ms.path(BY_WALL, 0.5, poses=WALL, position=(0, 0, 0.8), tilt=0.3)
    one = found.sel(z=0.8, tilt=0.3)
    assert str(one.outcome.values) == alone.attrs["outcome"]
    assert one.gap_mean == pytest.approx(alone.attrs["gap_mean"])
    assert one.drift.values == pytest.approx(alone.attrs["drift"])
    seen = []
    held = json.loads(keep.read_text("utf-8"))
    held["rows"].pop("5")
    keep.write_text(json.dumps(held), encoding="utf-8")
    again = ms.starts(
        BY_WALL, 0.5, OVER, poses=WALL, keep=keep, workers=0, progress=lambda *n: seen.append(n)
    )
    assert seen == [(5, 6), (6, 6)]  # one alone is followed again
    assert again.identical(found)
    with pytest.raises(ms.SpecError, match="another map"):
        ms.starts(BY_WALL, 0.6, OVER, poses=WALL, keep=keep, workers=0)


@pytest.mark.parametrize("given", [True, False])
def test_distance_and_tilt_of_the_wall_are_starts_too(given, monkeypatch):
    """By one table of poses, whatever the wall's distance and tilt."""
    asked = []
    monkeypatch.setattr(at_starts, "around", lambda one: asked.append(one) or WALL)
    poses = WALL if given else None
    over = {"wall.distance": [0.3, 0.8, 2.0], "wall.tilt": [0.0, 0.3]}
    found = ms.starts(BY_WALL, 0.5, over, poses=poses, workers=0)
    other = ms.starts(BY_WALL, 0.5, {"z": [0.3, 0.8, 2.0], "tilt": [0.0, 0.3]}, poses=WALL,
                      workers=0)  # fmt: skip
    assert found.outcome.values.tolist() == other.outcome.values.tolist()
    assert found.drift.values == pytest.approx(other.drift.values, nan_ok=True)
    assert len(asked) == (not given)
    designs = at_starts.with_poses(BY_WALL, over | {"tail.waves": [2.0, 3.0], "x": [0.0, 1.0]})
    assert [one.tail.waves for one in designs] == [2.0, 3.0]


def test_a_field_of_the_swimmer_varies_too():
    """In free fluid: twice the rate, twice the drift."""
    found = ms.starts(ROBOT, 1.0, {"tail.frequency": [0.5, 1.0]}, model="rft", workers=0)
    half = ms.path(ROBOT.with_({"tail.frequency": 0.5}), 1.0, model="rft")
    assert found.drift.values[0] == pytest.approx(half.attrs["drift"], rel=1e-6)
    assert found.outcome.values.tolist() == ["free", "free"]


@pytest.mark.parametrize(
    ("over", "said"),
    [({}, "names and values"), ({"up": [1.0]}, "one of x, y, z"), ({"z": []}, "one value or more")],
)
def test_what_is_no_grid_is_refused(over, said):
    with pytest.raises(ms.SpecError, match=said):
        ms.starts(BY_WALL, 1.0, over, poses=WALL)


def test_a_map_of_noise_is_refused():
    noisy = replace(ROBOT, noise=ms.Noise(temperature=1.0))
    with pytest.raises(ms.SpecError, match="noise"):
        ms.starts(noisy, 1.0, {"z": [1.0]})


def test_the_legend_of_all_outcomes_lies_within_the_picture():
    ends = np.array([["free", "escaped", "orbits"], ["trapped", "touched", "inside"]])
    found = xr.Dataset({"outcome": (("z", "tilt"), ends)}, {"z": [1.0, 2.0], "tilt": [0, 1, 2]})
    figure = ms.plots.starts(found)
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert figure.bbox.x0 <= legend.x0 < legend.x1 <= figure.bbox.x1


def test_the_command_writes_map_and_picture_and_goes_on(tmp_path):
    args = ["path", "--preset", "tabak/helix", "--time", "1", "--model", "rft", "--json"]
    args += ["--over", "tilt=0:60deg:3,z=1,2", "--out", str(tmp_path / "map")]
    done = CliRunner().invoke(main, args)
    assert done.exit_code == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["outcomes"] == {"free": 6}
    assert np.array(told["over"]["tilt"]) == pytest.approx([0.0, np.pi / 6, np.pi / 3])
    assert {p.name for p in (tmp_path / "map").iterdir()} >= {"starts.nc", "starts.png"}
    refused = CliRunner().invoke(main, args)
    assert refused.exit_code == 2
    again = CliRunner().invoke(main, [*args, "--resume"])
    assert again.exit_code == 0
    assert json.loads(again.stdout)["outcome"] == told["outcome"]
    bad = CliRunner().invoke(main, [*args[:-4], "--over", "tilt=0:60deg"])
    assert bad.exit_code == 2
    assert "FIRST:LAST:COUNT" in bad.stderr
