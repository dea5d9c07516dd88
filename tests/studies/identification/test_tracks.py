"""Tracks of other programs: the same cell, however its file was written."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main

FPS, PIXEL = 50.0, 0.16


def cells():
    """Two cells in um: frames, positions; the second misses some frames."""
    frames = np.arange(40)
    one = np.stack([3.0 + 0.2 * frames, 7.0 + 0.1 * np.sin(frames)], axis=-1)
    two = np.stack([20.0 - 0.1 * frames, 5.0 + 0.05 * frames], axis=-1)
    kept = np.delete(frames, [4, 5, 17])
    return {"0": (frames, one), "12": (kept, two[kept])}


def rows():
    """Track, frame, x, y, sorted by frame as trackers write them."""
    found = [(n, int(f), *p) for n, (frames, x) in cells().items() for f, p in zip(frames, x)]
    return sorted(found, key=lambda row: (row[1], row[0]))


def trackmate(path):
    head = [
        "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME,RADIUS",
        "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,Radius",
        "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,R",
        ",,,(quality),(micron),(micron),(micron),(sec),,(micron)",
    ]
    lines = [
        f"ID{i},{i},{n},1,{x},{y},0.0,{f / FPS},{f},0.5" for i, (n, f, x, y) in enumerate(rows())
    ]
    path.write_text("\n".join([*head, *lines, "ID9999,9999,,1,0,0,0,0,0,0.5"]) + "\n")


def trackpy(path):
    lines = [f"{i},{y / PIXEL},{x / PIXEL},90.5,{f},{n}.0" for i, (n, f, x, y) in enumerate(rows())]
    path.write_text("\n".join([",y,x,mass,frame,particle", *lines]) + "\n")


def excel(path):
    lines = [f"{n};{f / FPS};{x};{y}".replace(".", ",") for n, f, x, y in rows()]
    path.write_bytes("\r\n".join(["Track;Time (s);X (µm);Y (µm)", *lines]).encode("cp1252"))


def xml_of_tracks(path):
    blocks = []
    for frames, x in cells().values():
        spots = "".join(
            f'<detection t="{f}" x="{a}" y="{b}" z="0.0"/>' for f, (a, b) in zip(frames, x)
        )
        blocks.append(f'<particle nSpots="{len(frames)}">{spots}</particle>')
    start = f'<Tracks spaceUnits="micron" frameInterval="{1 / FPS}" timeUnits="sec">'
    path.write_text(f'<?xml version="1.0"?>{start}{"".join(blocks)}</Tracks>')


def xml_of_model(path):
    spots = "".join(
        f'<Spot ID="{i}" POSITION_X="{x}" POSITION_Y="{y}" POSITION_Z="0" '
        f'POSITION_T="{f / FPS}" FRAME="{f}"/>'
        for i, (_, f, x, y) in enumerate(rows())
    )
    tracks = ""
    for name in cells():
        own = [i for i, row in enumerate(rows()) if row[0] == name]
        edges = "".join(
            f'<Edge SPOT_SOURCE_ID="{a}" SPOT_TARGET_ID="{b}"/>' for a, b in zip(own, own[1:])
        )
        tracks += f'<Track name="t" TRACK_ID="{name}">{edges}</Track>'
    path.write_text(
        f'<TrackMate version="7"><Model spatialunits="micron" timeunits="sec"><AllSpots>{spots}'
        f"</AllSpots><AllTracks>{tracks}</AllTracks></Model></TrackMate>"
    )


WRITERS = {
    "trackmate.csv": (trackmate, {}),
    "trackpy.csv": (trackpy, {"fps": FPS, "pixel": f"{PIXEL}um"}),
    "excel.csv": (excel, {}),
    "tracks.xml": (xml_of_tracks, {}),
    "model.xml": (xml_of_model, {}),
}


HEADERS = [
    "Spur;Zeit (s);x-Position (µm);y-Position (µm)",
    "Piste;Temps (secondes);x (micromètres);y (micromètres)",
    "Célula;Tiempo en segundos;x en µm;y en µm",
    "Track;aika [s];x [µm];y [µm]",
]


@pytest.mark.parametrize("header", HEADERS)
def test_headers_in_other_languages_are_known(tmp_path, header):
    """A column of time in any language: it alone has a unit of time."""
    lines = [f"{n};{f / FPS};{x};{y}".replace(".", ",") for n, f, x, y in rows()]
    (tmp_path / "own.csv").write_bytes("\r\n".join([header, *lines]).encode("cp1252"))
    excel(tmp_path / "same.csv")
    own, same = (ms.read_tracks(tmp_path / name) for name in ("own.csv", "same.csv"))
    assert list(own) == list(same)
    assert own["12"].position == pytest.approx(same["12"].position)
    assert own["12"].time == pytest.approx(same["12"].time)


@pytest.mark.parametrize("name", WRITERS)
def test_one_film_however_it_was_tracked(tmp_path, name):
    write, options = WRITERS[name]
    write(tmp_path / name)
    read = ms.read_tracks(tmp_path / name, **options)
    for track, (frames, x) in zip(read.values(), cells().values(), strict=True):
        assert track.time == pytest.approx(frames / FPS, abs=1e-12)
        assert track.position == pytest.approx(1e-6 * x, rel=1e-9)
    assert list(read) == (["0", "1"] if name == "tracks.xml" else ["0", "12"])


def test_columns_that_were_not_used_are_named(tmp_path):
    trackpy(tmp_path / "a.csv")
    assert ms.read_tracks(tmp_path / "a.csv", fps=50, pixel=1.6e-7).ignored == ("mass",)


def test_tracks_are_chosen_by_name_and_those_that_are_none_left_out(tmp_path):
    path = tmp_path / "a.csv"
    lines = [f"{i},{i * 0.1},0,a\n" for i in range(20)] + ["0,0,0,b\n", "1,0,0,b\n"]
    lines += [f"{i // 2},{i * 0.1},0,c\n" for i in range(40)]
    path.write_text("frame,x (um),y (um),track\n" + "".join(lines))
    read = ms.read_tracks(path, fps=10)
    assert list(read) == ["a"]
    assert "at least 12" in read.left_out["b"]
    assert "splits or merges" in read.left_out["c"]
    with pytest.raises(ms.SpecError, match="splits or merges"):
        ms.read_tracks(path, fps=10, track="c")
    with pytest.raises(ms.SpecError, match="--track = 'd'"):
        ms.read_tracks(path, fps=10, track="d")


def plain(header, step=0.1):
    return header + "\n" + "".join(f"{i * step:g},{i},{2 * i}\n" for i in range(20))


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (
            plain("time (s),x,y"),
            {},
            r"x has no unit; give --pixel, such as --pixel 0.11um, or a unit",
        ),
        (plain("time (s),x (px),y (px)"), {}, "is in pixels; give --pixel"),
        (plain("time (s),x (um),y (px)"), {}, "is in pixels; give --pixel"),
        (
            plain("time (s),x (um),y (um)"),
            {"pixel": "1um"},
            "is in um, no pixels; leave --pixel out",
        ),
        (plain("time,x (um),y (um)"), {}, "time has no unit; give a unit in the header"),
        (plain("frame,x (um),y (um)", 1), {}, "counts frames; give --fps"),
        (plain("time (s),x (um),y (um)"), {"fps": 5}, "counts no frames; leave --fps out"),
        (plain("time (s),x (px),y (px)"), {"pixel": "0.11"}, "a length with its unit"),
        (plain("time (s),x (px),y (px)"), {"pixel": "2 s"}, "--pixel"),
        (plain("time (s),x (px),y (px)"), {"pixel": -1.0}, "--pixel"),
        (plain("frame,x (um),y (um)", 1), {"fps": 0}, "--fps"),
        (plain("time (s),x (s),y (s)"), {}, "column x .s. must have the dimension of m"),
    ],
)
def test_what_a_file_does_not_say_is_asked_for(tmp_path, text, options, words):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(ms.SpecError, match=words):
        ms.read_tracks(path, **options)


def test_frames_that_are_called_time_are_frames_where_a_rate_is_given(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(plain("t,x (um),y (um)", 1))
    assert ms.read_tracks(path, fps="25 Hz")["0"].time[1] == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<Tracks>", "not an XML"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><Tracks/>', "entities"),
        ("<Tracks/>", "no tracks"),
        ("<svg/>", "no XML of TrackMate"),
        (
            '<Tracks><particle><detection t="0" x="a" y="1"/></particle></Tracks>',
            "without its numbers",
        ),
    ],
)
def test_an_xml_that_is_none_is_one_sentence(tmp_path, text, words):
    path = tmp_path / "a.xml"
    path.write_text(text)
    with pytest.raises(ms.SpecError, match=words):
        ms.read_tracks(path)


def test_the_command_gives_a_table_of_cells_with_pictures(tmp_path):
    trackmate(tmp_path / "spots.csv")
    out = tmp_path / "out"
    call = ["identify", str(tmp_path / "spots.csv"), "--json", "--out", str(out)]
    run = CliRunner().invoke(main, call)
    assert run.exit_code == 0, run.stderr
    result = json.loads(run.stdout)
    assert [row["track"] for row in result["cells"]] == ["0", "12"]
    low, high = result["cells"][1]["interval_95"]["speed"]
    assert low <= 1e-6 * FPS * np.hypot(0.1, 0.05) * (1 + 1e-9)
    assert high >= 1e-6 * FPS * np.hypot(0.1, 0.05) * (1 - 1e-9)
    assert sorted(p.name for p in out.iterdir()) == [
        "cells.csv", "displacement.csv", "track-0.png", "track-12.png"
    ]  # fmt: skip
    again = CliRunner().invoke(main, call)
    assert again.exit_code == 2
    assert "--force" in again.stderr
    shown = CliRunner().invoke(main, call[:2])
    assert "µm/s" in shown.stdout
    assert "25.00 Hz" in shown.stdout  # half the frame rate


def test_a_time_that_is_wrong_by_far_is_one_sentence(tmp_path):
    t = np.arange(60) / 25.0
    t[-1] = 1e20
    x = np.stack([t[::-1] * 0 + np.arange(60), np.sin(np.arange(60))], -1)
    with pytest.raises(ms.SpecError, match="is a time wrong"):
        ms.Track(time=t, position=x)
    table = np.column_stack([t, x])
    header = "time (s),x (um),y (um)"
    np.savetxt(tmp_path / "far.csv", table, delimiter=",", header=header, comments="")
    with pytest.raises(ms.SpecError, match=r"far\.csv: 60 positions in .* is a time wrong"):
        ms.read_tracks(tmp_path / "far.csv")


def test_a_cell_that_stands_still_exactly_does_not_swim():
    for place in ((1e-6, 1e-6), (10.3, 7.7), (0.0, 0.0)):
        track = ms.Track(time=np.arange(60) / 25.0, position=np.tile(place, (60, 1)))
        found = ms.describe_track(track)
        assert found.numbers["speed"] is None
        assert "does not swim" in found.notes[0]
