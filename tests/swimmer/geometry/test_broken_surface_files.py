"""Surface files broken at random: a body, or one sentence that says what to do, and no more."""

import logging
import re
import struct

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from microswim.cli import main
from microswim.errors import MicroswimError
from microswim.swimmer.geometry.solids.reading import read

trimesh = pytest.importorskip("trimesh")

BOX = trimesh.creation.box((2.0, 1.0, 0.6))
WHOLE = {
    "binary.stl": BOX.export(file_type="stl"),
    "text.stl": BOX.export(file_type="stl_ascii").encode(),
    "binary.ply": BOX.export(file_type="ply"),
    "text.ply": BOX.export(file_type="ply", encoding="ascii"),
    "text.obj": BOX.export(file_type="obj").encode(),
}
NUMBERS = st.sampled_from(
    [b"nan", b"inf", b"1e400", b"-1e308", b"1e-320", b"", b"x", b"1,5", b"0", b"-1", b"7",
     b"4294967295", b"99999999999999999999", b"1e200"]
)  # fmt: skip
COUNTS = st.sampled_from([0, 1, 11, 13, 10**6, 2**31, 2**32 - 1])
SINGLES = st.sampled_from([np.nan, np.inf, 1e30, -3e38, 0.0, 1e-40, 1.0])
HEADS = st.sampled_from(
    [b"", b"solid", b"ply\nformat ascii 1.0\nend_header\n", b"\0" * 84, b"solid x\nendsolid x\n",
     b"v 0 0 0\nf 1 1 1\n", b"\xff\xfe"]
)  # fmt: skip


def cut(data, whole, kind):
    return whole[: data.draw(st.integers(0, len(whole)))]


def overwritten(data, whole, kind):
    at, gone = data.draw(st.integers(0, len(whole))), data.draw(st.integers(0, 60))
    return whole[:at] + data.draw(st.binary(max_size=40)) + whole[at + gone :]


def other_number(data, whole, kind):
    found = list(re.finditer(rb"[-+]?\d[\d.e+-]*", whole))
    if not found:
        return whole
    one = found[data.draw(st.integers(0, len(found) - 1))]
    return whole[: one.start()] + data.draw(NUMBERS) + whole[one.end() :]


def lines_moved(data, whole, kind):
    lines = whole.split(b"\n")
    i, j = (data.draw(st.integers(0, len(lines) - 1)) for _ in range(2))
    lines[i : i + 1] = data.draw(st.sampled_from([[], [lines[i], lines[j]], [lines[j]]]))
    return b"\n".join(lines)


def other_head(data, whole, kind):
    return data.draw(HEADS) + data.draw(st.sampled_from([b"", whole]))


def counted_wrong(data, whole, kind):
    count = data.draw(COUNTS)
    if kind == "binary.stl":
        return whole[:80] + struct.pack("<I", count) + whole[84:]
    what = data.draw(st.sampled_from([b"vertex", b"face"]))
    return re.sub(b"element " + what + rb" \d+", b"element %s %d" % (what, count), whole)


def wild_coordinate(data, whole, kind):
    if kind != "binary.stl" or len(whole) < 134:
        return whole
    at = (
        84
        + 50 * data.draw(st.integers(0, (len(whole) - 134) // 50))
        + 4 * data.draw(st.integers(0, 11))
    )
    return whole[:at] + struct.pack("<f", data.draw(SINGLES)) + whole[at + 4 :]


WAYS = [cut, overwritten, other_number, lines_moved, other_head, counted_wrong, wild_coordinate]


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_a_broken_file_is_a_body_or_one_sentence(tmp_path, caplog, capfd, data):
    """Nor does the reader beneath print or log anything of its own."""
    kind = data.draw(st.sampled_from(sorted(WHOLE)))
    broken = WHOLE[kind]
    for way in data.draw(st.lists(st.sampled_from(WAYS), min_size=1, max_size=3)):
        broken = way(data, broken, kind)
    file = tmp_path / f"broken{kind[-4:]}"
    file.write_bytes(broken)
    with caplog.at_level(logging.WARNING):
        try:
            surface = read(file).surface
        except MicroswimError as error:
            said = str(error)
            assert "\n" not in said
            assert len(said) < 250 + len(str(file))
            assert "; " in said or "," in said, said  # what to do about it
        else:
            assert np.isfinite(surface.volume)
            assert surface.volume > 0.0
    assert not caplog.records
    assert capfd.readouterr() == ("", "")


NAN = WHOLE["text.obj"].replace(b"0.50000000", b"nan")
MANY = WHOLE["binary.stl"][:80] + b"\xff" * 4
HOLED = "\n".join(
    WHOLE["text.stl"].decode().split("\n")[:1] + WHOLE["text.stl"].decode().split("\n")[8:]
)


@pytest.mark.parametrize(
    ("name", "content", "options", "word"),
    [
        ("cut.stl", WHOLE["binary.stl"][:300], ["--scale", "1 mm"], "cut off"),
        ("empty.stl", b"", ["--scale", "1 mm"], "export"),
        ("empty.obj", b"", ["--scale", "1 mm"], "export"),
        ("many.stl", MANY, ["--scale", "1 mm"], "cut off"),
        ("holed.stl", HOLED.encode(), ["--scale", "1 mm"], "close it"),
        (
            "no.obj",
            WHOLE["text.obj"].replace(b"0.50000000", b"nan"),
            ["--scale", "1 mm"],
            "no numbers",
        ),
        ("unit.stl", WHOLE["binary.stl"], [], "has no unit"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_on_the_command_line_nothing_is_left_behind(tmp_path, name, content, options, word):
    file, out = tmp_path / name, tmp_path / "out"
    file.write_bytes(content)
    told = CliRunner().invoke(main, ["mobility", str(file), "--out", str(out), *options])
    assert told.exit_code == 2, told.output
    assert told.stdout == ""
    assert word in told.stderr
    assert len(told.stderr.strip().split("\n")) == 1
    assert "Traceback" not in told.stderr
    assert not out.exists()


def test_broken_normals_are_not_spoken_of(tmp_path, caplog):
    """They are not used; the reader beneath logs a traceback about them."""
    file = tmp_path / "normals.stl"
    file.write_bytes(re.sub(rb"facet normal \S+", b"facet normal x", WHOLE["text.stl"]))
    with caplog.at_level(logging.WARNING):
        assert read(file).surface.volume == pytest.approx(1.2)
    assert not caplog.records
