"""The wall and the channel of a spec file, and who knows them."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.jobs import store

SPEC = """
[fluid]
viscosity = 1.0
[body]
shape = "sphere"
radius = 0.5
[tail]
kind = "helix"
length = 2.0
amplitude = 0.1
waves = 2
radius = 0.05
"""
SI = """
[fluid]
viscosity = "1 mPa s"
[body]
shape = "sphere"
radius = "1 um"
[tail]
kind = "helix"
length = "5 um"
amplitude = "0.2 um"
waves = 2
radius = "0.05 um"
[wall]
distance = "2 um"
tilt = "-10 deg"
azimuth = 0.5
"""


def read(tmp_path, text):
    path = tmp_path / "robot.toml"
    path.write_text(text)
    return ms.Swimmer.from_toml(path)


def test_a_wall_of_the_spec_and_its_angles_in_either_unit(tmp_path):
    wall = read(tmp_path, SI).wall
    assert dataclasses.astuple(wall) == pytest.approx((2e-6, -np.pi / 18, 0.5))
    assert np.linalg.norm(wall.normal) == pytest.approx(1.0)


def test_the_plane_of_a_wall_lies_at_its_distance_and_noses_down_where_tilted():
    centre = np.array([-0.5, 0.0, 0.0])
    plane = ms.Wall(2.0, tilt=0.3, azimuth=0.5).plane(centre)
    assert (centre - plane[:3]) @ plane[3:] == pytest.approx(2.0)
    ahead, behind = centre - [1, 0, 0], centre + [1, 0, 0]
    heights = [(x - plane[:3]) @ plane[3:] for x in (ahead, behind)]
    assert heights[1] - heights[0] == pytest.approx(2 * np.sin(0.3))


def test_a_channel_of_the_spec(tmp_path):
    text = SPEC + '[channel]\ndiameter = 6.0\nlength = 8\nposition = [0, 0.5, 0]\ntilt = "90 deg"\n'
    channel = read(tmp_path, text).channel
    tilt = np.pi / 2
    assert channel == ms.Channel(diameter=6, length=8, position=(0.0, 0.5, 0.0), tilt=tilt)
    assert np.allclose(channel.axes[:, 0], [0.0, -1.0, 0.0])


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ("[wall]\ndistance = -1", r"wall\.distance = -1.*positive length"),
        ("[wall]\ndistance = 1\ntilt = 2", r"wall\.tilt = 2.*right angle"),
        ("[wall]\ntilt = 0.1", r"wall\.distance: missing"),
        ('[wall]\ndistance = 1\ntilt = "1 m"', r"wall\.tilt = '1 m'"),
        (
            "[wall]\ndistance = 1\n[channel]\ndiameter = 9\nlength = 9",
            r"wall, channel: one of them",
        ),
        ('[channel]\ndiameter = 9\nlength = 9\nshape = "tube"', r"channel\.shape = 'tube'"),
        ("[channel]\ndiameter = 9", r"channel\.length: missing"),
    ],
)
def test_what_makes_no_sense_is_one_sentence(tmp_path, table, sentence):
    with pytest.raises(ms.SpecError, match=sentence) as caught:
        read(tmp_path, SPEC + table)
    assert "\n" not in str(caught.value)


def test_the_default_channel_is_the_papers():
    """Ten diameters of the body wide [Tabak Sec. 2.2]; as long in the base case [Tabak Table 1]."""
    channel = ms.Channel.around(ms.Swimmer.preset("tabak/helix"))
    assert (channel.diameter, channel.length) == (10.0, 10.0)
    stout = ms.Spheroid(semi_axes=(0.5, 0.8))
    wider = ms.Channel.around(dataclasses.replace(ms.Swimmer.preset("tabak/helix"), body=stout))
    assert wider.diameter == pytest.approx(10 * 1.6)


def test_numbers_of_the_surroundings_can_vary(tmp_path):
    swimmer = read(tmp_path, SPEC + "[wall]\ndistance = 2.0\n")
    assert swimmer.numbers["wall.distance"] == 2.0
    assert swimmer.with_({"wall.distance": 3.0}).wall.distance == 3.0
    paths = {
        store.place(Path(), s, "bem", {}) for s in (swimmer, swimmer.with_({"wall.tilt": 0.1}))
    }
    assert len(paths) == 2  # a solve beside one wall is not found for another


def test_the_surrogate_says_that_it_knows_no_wall(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(SPEC + "[wall]\ndistance = 2.0\n")
    run = CliRunner().invoke(main, ["run", str(path)])
    assert run.exit_code == 0
    assert "knows no wall" in run.output
    shown = CliRunner().invoke(main, ["run", str(path), "--json", "--set", "wall.distance=0.9"])
    assert "knows no wall" in json.loads(shown.output)["info"]["remarks"][0]
