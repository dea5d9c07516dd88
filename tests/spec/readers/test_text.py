"""Text from elsewhere: read as its writer meant it, or refused in one sentence by every door."""

import os

import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.spec import presets

HELIX = presets.read("tabak/helix")


def refused(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exit_code == 2, (result.stdout, result.stderr, result.exception)
    (line,) = result.stderr.splitlines()
    return line


@pytest.mark.parametrize("coding", ["utf-8-sig", "utf-16", "utf-8"])
def test_a_spec_as_other_programs_save_it(tmp_path, coding):
    path = tmp_path / "robot.toml"
    path.write_bytes(f"# µ\n{HELIX}".encode(coding))
    assert ms.Swimmer.from_toml(path).numbers == ms.Swimmer.preset("tabak/helix").numbers
    result = CliRunner().invoke(main, ["run", str(path), "--json"])
    assert result.exit_code == 0, result.stderr


BAD = {
    "latin-1": f"# viscosité\n{HELIX}".encode("latin-1"),
    "half a mark": b"\xff\xfe\x00",
    "picture": b"\x89PNG\r\n\x1a\n\0\0",
    "nested": b"x = " + b"[" * 100_000,
    "deep but valid": b"x = " + b"[" * 60 + b"]" * 60,
    "dotted": ("a." * 3000 + "b = 1").encode(),
    "many digits": b"x = " + b"9" * 5000,
    "long": b"#" * (5 * 1024**2),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_spec(tmp_path, name):
    path = tmp_path / "robot.toml"
    path.write_bytes(BAD[name])
    line = refused("run", path)
    assert str(path) in line
    assert len(line) < 400


def test_devices_and_pipes_are_not_read(tmp_path):
    assert "device" in refused("run", "/dev/zero")
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    assert "pipe" in refused("run", pipe)


DOORS = {
    "designs": ("sweep", "--preset", "tabak/helix", "--out", "a.zarr", "--designs"),
    "table": ("calibrate", "--preset", "tabak/helix", "--table"),
    "series": ("calibrate", "--preset", "tabak/helix", "--series"),
    "track": ("identify", "--preset", "tabak/helix"),
}


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("bad", ["missing", "latin", "binary", "empty", "huge field", "device"])
def test_every_door_of_a_table_refuses_alike(tmp_path, monkeypatch, door, bad):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "table.csv"
    data = {
        "latin": b"gr\xf6\x81e,x\n1,2\n",  # neither UTF-8 nor a Windows code page
        "binary": b"time,x\n\0\0\0,1\n",
        "empty": b"",
        "huge field": b'time,x,y\n"' + b"1" * 200_000 + b'",2,3\n1,1,1\n',
    }
    if bad in data:
        path.write_bytes(data[bad])
    command, *options = DOORS[door]
    given = "/dev/zero" if bad == "device" else path
    line = (
        refused(command, given, *options) if door == "track" else refused(command, *options, given)
    )
    assert str(given) in line


def test_a_designs_list_with_a_mark_and_blanks(tmp_path):
    path = tmp_path / "designs.csv"
    path.write_text("tail.amplitude, tail.handedness\n0.1, left\n0.12, right\n", "utf-8-sig")
    out = str(tmp_path / "a.zarr")
    call = ["sweep", "--preset", "tabak/helix", "--designs", str(path), "--out", out]
    result = CliRunner().invoke(main, call)
    assert result.exit_code == 0, result.stderr
    assert "2 designs, 0 failed" in result.stdout
