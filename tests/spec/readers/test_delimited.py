"""Tables as other programs save them: the same numbers, or one sentence."""

import itertools

import numpy as np
import pytest

import microswim as ms
from microswim.spec.readers import measured
from microswim.spec.readers.delimited import rows

KNOWN = {"time": ("time", "t"), "x": ("x",), "y": ("y", "pos_y")}
CODINGS = ("utf-8", "utf-8-sig", "cp1252", "utf-16")
NUMBERS = np.array([[0.0, 1.5, -2.25], [0.5, 1e-3, 3.0], [1.0, 12.125, 0.0]])


def written(path, mark, comma, coding, quoted, header):
    """The numbers as a program with those habits saves them."""

    def cell(value):
        text = f"{value:g}".replace(".", ",") if comma else f"{value:g}"
        return f'"{text}"' if quoted or (comma and mark == ",") else text

    lines = [mark.join(header), *(mark.join(map(cell, row)) for row in NUMBERS)]
    path.write_bytes("\r\n".join([*lines, ""]).encode(coding))
    return path


@pytest.mark.parametrize(
    ("mark", "comma", "coding", "quoted"),
    list(itertools.product(",;\t", (False, True), CODINGS, (False, True))),
)
def test_the_same_numbers_however_they_are_saved(tmp_path, mark, comma, coding, quoted):
    path = written(
        tmp_path / "t.csv", mark, comma, coding, quoted, ["t (s)", "x (µm)", "pos_y [µm]"]
    )
    table = measured.read(path, KNOWN, ("x", "y"))
    found = np.stack([table.numbers[n] for n in ("time", "x", "y")], axis=-1)
    assert found.tolist() == NUMBERS.tolist()
    assert table.units == {"time": "s", "x": "µm", "y": "µm"}


@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("time,x,y", [None, None, None]),
        ("time_s,x_um,y_um", ["s", "um", "um"]),
        ("Time (ms),X [nm],Y / nm", ["ms", "nm", "nm"]),
        ("time,x,y\n(s),(um),(um)", ["s", "um", "um"]),
        ("sep=,\ntime,x,y", [None, None, None]),
        ("# saved by a program\ntime,x,y", [None, None, None]),
    ],
)
def test_units_are_found_in_titles_or_below_them(tmp_path, header, units):
    path = tmp_path / "t.csv"
    path.write_text(f"{header}\n0,1,2\n\n1,,3\n")
    table = measured.read(path, KNOWN, ("x", "y"))
    assert [table.units[n] for n in ("time", "x", "y")] == units
    assert np.isnan(table.numbers["x"][1])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,x,y,x\n0,1,2,3\n", "x stands twice"),
        ("t,time,x,y\n0,0,1,2\n", "no column|one column"),
        ("time,x,y\n0,1,2\n1,oops,3\n", "a number is missing in the row 1, oops, 3"),
        ("time,x,y\n", "no rows below"),
        ("time;x;y\n0.5;1,234;2\n1.5;2,345;3\n", "decimal comma or a thousand"),
    ],
)
def test_what_is_no_table_is_one_sentence(tmp_path, text, words):
    path = tmp_path / "t.csv"
    path.write_text(text)
    if "one column" in words:  # two words for one thing: the first of the list is taken
        assert measured.read(path, KNOWN, ("x", "y")).titles["time"] == "time"
        return
    with pytest.raises(ms.SpecError, match=words):
        measured.read(path, KNOWN, ("x", "y"))


def test_rows_of_designs_with_semicolons_and_decimal_commas(tmp_path):
    path = tmp_path / "designs.csv"
    path.write_bytes(
        "tail.amplitude;tail.handedness\n0,1 mm;left\n0,12 mm;right\n".encode("cp1252")
    )
    assert rows(path) == [
        {"tail.amplitude": "0.1 mm", "tail.handedness": "left"},
        {"tail.amplitude": "0.12 mm", "tail.handedness": "right"},
    ]


@pytest.mark.parametrize("mark", [",", ";"])
@pytest.mark.parametrize("odd", ["", '"c1"', "#c1", " c1 "])
def test_rows_read_at_once_are_those_read_one_by_one(tmp_path, monkeypatch, mark, odd):
    """Names with quotes or a hash go the slow way; both ways say the same of the same file."""
    path = tmp_path / "t.csv"
    cells = [(i / 8, -i / 4, i * 1e-7, f"c{i % 3}") for i in range(40)]
    lines = [mark.join(f"{v:g}" if isinstance(v, float) else v for v in row) for row in cells]
    lines = [line.replace(".", ",") for line in lines] if mark == ";" else lines
    if odd:
        lines[7] = lines[7].replace("c1", odd)
    path.write_text("\n".join([mark.join(["t", "x", "y", "track"]), *lines[:20], "", *lines[20:]]))
    known = KNOWN | {"track": ("track",)}
    fast = measured.read(path, known, ("x", "y"), "track")
    monkeypatch.setattr("numpy.loadtxt", lambda *a, **k: (_ for _ in ()).throw(ValueError))
    slow = measured.read(path, known, ("x", "y"), "track")
    assert all((fast.numbers[n] == slow.numbers[n]).all() for n in ("time", "x", "y"))
    assert fast.numbers["x"].tolist() == [row[1] for row in cells]
    assert [w.strip() for w in fast.labels] == [w.strip() for w in slow.labels]
    assert len(fast.labels) == 40
