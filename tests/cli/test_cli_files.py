"""Files that commands write: nothing replaced unasked, nothing half-written, no work lost."""

import errno
import json
import math

import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure

from microswim.cli import _files, calibrate, main
from microswim.errors import MicroswimError, SpecError
from microswim.spec import presets


def call(*args):
    return CliRunner().invoke(main, [str(a) for a in args])


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(presets.read("tabak/helix"))
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ("calibrate", "--measured", "mean.us=-0.05", "-o"),
        ("studio", "--snapshot"),
    ],
)
def test_the_spec_itself_is_not_replaced_unasked(arguments, spec):
    before = spec.read_text()
    name, *rest = arguments
    run = call(name, spec, *rest, spec)
    assert run.exit_code == 2
    assert "--force" in run.stderr
    assert spec.read_text() == before
    assert call(name, spec, *rest, spec, "--force").exit_code == 0
    assert spec.read_text() != before


OVER = ("--over", "tail.waves=2:3")


@pytest.mark.parametrize(
    ("arguments", "made"),
    [
        (("design", *OVER, "--maximize", "swimming_speed", "--out"), "sensitivity.png"),
        (("validate", "--over", "tail.waves=2,3", "--out"), "errors.csv"),
    ],
)
def test_a_folder_with_results_is_refused_before_the_work(arguments, made, spec, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / made).write_text("mine")
    name, *rest = arguments
    run = call(name, spec, *rest, out)
    assert run.exit_code == 2
    assert made in run.stderr
    assert (out / made).read_text() == "mine"


def test_a_folder_in_place_of_a_file_is_said_at_once(spec, tmp_path):
    run = call("calibrate", spec, "--reference", "bem", "-o", tmp_path)
    assert run.exit_code == 2
    assert run.stderr.startswith("Error: --out = ")
    assert "folder" in run.stderr


def test_a_result_that_cannot_be_written_is_printed(spec, tmp_path, monkeypatch):
    def full(path, text):
        raise MicroswimError(f"{path}: not written: No space left on device")

    monkeypatch.setattr(calibrate, "write", full)
    run = call("calibrate", spec, "--measured", "mean.us=-0.05", "-o", tmp_path / "new.toml")
    assert run.exit_code == 1
    assert "[interaction]" in run.stdout
    assert "new.toml: not written" in run.stderr


def test_a_file_where_a_folder_is_needed_is_named(tmp_path):
    (tmp_path / "a").write_text("")
    with pytest.raises(SpecError, match="this is a file"):
        _files.check_file("--output", tmp_path / "a" / "b.toml", force=False)


MAGNET = """
[fluid]
viscosity = "1 mPa s"
[body]
shape = "spheroid"
semi_axes = ["4 um", "2 um"]
[tail]
kind = "helix"
length = "20 um"
amplitude = "2 um"
waves = 3
radius = "0.25 um"
ramp = 0.2
frequency = "10 Hz"
[magnet]
moment = ["0 A m^2", "2e-14 A m^2", "0 A m^2"]
[field]
kind = "rotating"
strength = "5 mT"
frequency = "10 Hz"
"""
TRACK = "time (s),x (px),y (px)\n" + "\n".join(
    f"{0.01 * i:.3f},{0.5 * i + 3 * math.sin(i):.4f},{3 * math.cos(i):.4f}" for i in range(60)
)
SCENE = """
[[swimmer]]
spec = "ball.toml"
force = [1.0, 0.0, 0.0]
[[swimmer]]
spec = "ball.toml"
position = [0.0, 4.0, 0.0]
"""
BALL = """
[fluid]
viscosity = 1.0
[body]
shape = "sphere"
radius = 1.0
[tail]
kind = "none"
"""
WROTE = (  #: commands that write pictures, and a word of what they have found by then
    (("run", "SPEC", "--model", "rft"), "efficiency"),
    (("design", "SPEC", "--over", "tail.amplitude=0.05:0.15", "--maximize", "swimming_speed"),
     "maximize"),
    (("design", "SPEC", "--over", "tail.amplitude=0.05:0.15", "--maximize", "swimming_speed",
      "--minimize", "mean_torque"), "designs"),
    (("validate", "SPEC", "--option", "level=coarse", "--over", "tail.amplitude=0.08:0.1:2",
      "--workers", "0"), "median"),
    (("identify", "TRACK", "--pixel", "1 um"), "straight"),
    (("regimes", "MAGNET", "--frequency", "1Hz:5Hz:3"), "precession"),
    (("path", "SPEC", "--time", "1"), "outcome"),
    (("group", "SCENE", "--level", "coarse"), "unknowns"),
)  # fmt: skip


@pytest.mark.parametrize("as_json", [False, True], ids=["table", "json"])
@pytest.mark.parametrize(("words", "says"), WROTE, ids=[words[0] for words, _ in WROTE])
def test_numbers_are_printed_though_their_picture_is_not(
    spec, tmp_path, monkeypatch, words, says, as_json
):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    track, magnet, out = (tmp_path / n for n in ("track.csv", "magnet.toml", "out"))
    track.write_text(TRACK)
    magnet.write_text(MAGNET)
    (tmp_path / "ball.toml").write_text(BALL)
    (scene := tmp_path / "scene.toml").write_text(SCENE)
    places = {"SPEC": spec, "TRACK": track, "MAGNET": magnet, "SCENE": scene}
    monkeypatch.setattr(Figure, "savefig", full)
    flags = ["--json"] if as_json else []
    run = call(*(places.get(word, word) for word in words), *flags, "--out", out)
    assert run.exit_code == 1, run.output
    assert "No space left on device" in run.stderr
    assert len(json.loads(run.stdout)) > 1 if as_json else says in run.stdout
    assert run.stderr.count("Error:") == 1


@pytest.mark.parametrize("command", ["identify", "run"])
def test_a_table_in_the_place_of_the_spec_is_told(spec, tmp_path, command):
    track = tmp_path / "track.csv"
    track.write_text(TRACK)
    run = call(command, *([spec] if command == "identify" else []), track)
    assert run.exit_code == 2
    assert run.stderr.count("\n") == 1
    assert "track.csv: a table where the spec belongs" in run.stderr
