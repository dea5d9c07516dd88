"""One planted film as other programs write it: the same positions, or one sentence."""

import numpy as np
import pytest

import microswim as ms

N, FPS, PIXEL = 24, 100.0, 0.11
T = np.arange(N) / FPS
CELLS = {k: np.stack([40 + 30 * k + 20 * T, 60 + k * T + 0.6 * np.sin(50 * T)], -1) for k in (0, 1)}


def rows(line):
    return "".join(
        line(k, i, x, y, x / PIXEL, y / PIXEL) + "\n"
        for k, cell in CELLS.items()
        for i, (x, y) in enumerate(cell)
    )


def xml(point, part):
    return "".join(
        part.format(k, "".join(point(i, x / PIXEL, y / PIXEL) for i, (x, y) in enumerate(cell)))
        for k, cell in CELLS.items()
    )


TRACKMATE = (
    "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME\n"
    "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame\n"
    "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame\n"
    ",,,(quality),({0}),({0}),({0}),({1}),\n"
)
UM, BOTH = {"fps": 100}, {"fps": 100, "pixel": "0.11um"}
#: What each program writes; and what has to be said with it.
FILES = {
    "trackmate.csv": (
        TRACKMATE.format("micron", "sec")
        + rows(lambda k, i, x, y, u, v: f"ID{i},{i},{k},1,{x},{y},0,{i / FPS},{i}"),
        {},
    ),
    "trackmate-pixels.csv": (
        TRACKMATE.format("pixel", "frame")
        + rows(lambda k, i, x, y, u, v: f"ID{i},{i},{k},1,{u},{v},0,{i},{i}"),
        BOTH,
    ),
    "trackmate6.csv": (
        " ,Label,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME\n"
        + rows(lambda k, i, x, y, u, v: f"{i},ID{i},{i},{k},1,{x},{y},0,{i / FPS},{i}"),
        {"pixel": "1um", "fps": 100},
    ),
    "trackpy.csv": (
        ",y,x,mass,size,ecc,signal,raw_mass,ep,frame,particle\n"
        + rows(lambda k, i, x, y, u, v: f"{i},{v},{u},1,2,.1,9,3,.05,{i},{float(k)}"),
        BOTH,
    ),
    "cell-id.csv": (
        "# made by a program\nCell ID,Time (ms),Centroid X (nm),CentroidY (nm),Area (px)\n"
        + rows(lambda k, i, x, y, u, v: f"{k},{1e3 * i / FPS},{1e3 * x},{1e3 * y},44"),
        {},
    ),
    "no-spaces.csv": (
        "trackNo,T,PosX,PosY\n,s,micron,micron\n"
        + rows(lambda k, i, x, y, u, v: f"{k},{i / FPS},{x},{y}"),
        {},
    ),
    "imaris.csv": (
        "\nPosition\n ==================== \n"
        "Position X,Position Y,Position Z,Unit,Category,Collection,Time,TrackID,ID,\n"
        + rows(lambda k, i, x, y, u, v: f"{x},{y},0,um,Spot,Position,{i + 1},{10**9 + k},{i},"),
        UM,
    ),
    "manual-tracking.xls": (
        "\tTrack n°\tSlice n°\tX\tY\tDistance\tVelocity\tPixel Value\n"
        + rows(lambda k, i, x, y, u, v: f"{i}\t{k + 1}\t{i + 1}\t{u}\t{v}\t-1\t-1\t120"),
        BOTH,
    ),
    "mtrackj.txt": (
        "Nr\tTID\tPID\tx [pixel]\ty [pixel]\tt [frame]\tI [val]\n"
        + rows(lambda k, i, x, y, u, v: f"{i}\t{k + 1}\t{i + 1}\t{u}\t{v}\t{i + 1}\t120"),
        BOTH,
    ),
    "mtrackj.mdf": (
        "MTrackJ 1.5.1 Data File\nAssembly 1\nCluster 1\n"
        + xml(lambda i, u, v: f"Point {i + 1} {u} {v} 1.0 {i + 1}.0 1.0\n", "Track {}\n{}")
        + "End of MTrackJ Data File\n",
        BOTH,
    ),
    "icy.xml": (
        '<root><trackfile version="1"/><trackgroup description="a">'
        + xml(
            lambda i, u, v: f'<detection t="{i}" x="{u}" y="{v}" z="0"/>',
            '<track id="{}">{}</track>',
        )
        + "</trackgroup></root>",
        BOTH,
    ),
    "trackmate-tracks.xml": (
        '<Tracks spaceUnits="pixel" frameInterval="1.0" timeUnits="frame">'
        + xml(
            lambda i, u, v: f'<detection t="{i}" x="{u}" y="{v}" z="0"/>',
            "<!--{}--><particle>{}</particle>",
        )
        + "</Tracks>",
        BOTH,
    ),
    "cellprofiler.csv": (
        "ImageNumber,ObjectNumber,Location_Center_X,Location_Center_Y,TrackObjects_Label_50\n"
        + rows(lambda k, i, x, y, u, v: f"{i + 1},{k + 1},{u},{v},{k + 1}"),
        BOTH,
    ),
    "ilastik.csv": (
        "frame,labelimageId,trackId,lineageId,Object_Center_0,Object_Center_1\n"
        + rows(lambda k, i, x, y, u, v: f"{i},{k},{k + 2},{k},{u},{v}"),
        BOTH,
    ),
    "btrack.csv": (
        "ID,t,x,y,z,parent,root\n"
        + rows(lambda k, i, x, y, u, v: f"{k + 1},{i},{u},{v},0,{k},{k}"),
        BOTH,
    ),
    "mosaic.csv": (
        " ,Trajectory,Frame,x,y,z,m0\n"
        + rows(lambda k, i, x, y, u, v: f"{i},{k + 1},{i},{u},{v},0,1"),
        BOTH,
    ),
    "spaces.txt": ("id t x y\n" + rows(lambda k, i, x, y, u, v: f"{k} {i}  {u} {v}"), BOTH),
    "excel.csv": (
        'sep=;\nZeit (s);Spur;"x (µm)";y (µm)\n'
        + rows(lambda k, i, x, y, u, v: f'{i / FPS};{k};"{x}";{y}'.replace(".", ",")),
        {},
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_the_same_film_of_every_program_has_the_same_positions(tmp_path, name):
    text, options = FILES[name]
    file = tmp_path / name
    file.write_bytes(text.encode("cp1252"))
    tracks = ms.read_tracks(file, **options)
    assert len(tracks) == len(CELLS)
    for track, cell in zip(tracks.values(), CELLS.values()):
        assert track.position * 1e6 == pytest.approx(cell, rel=1e-9)
        assert np.diff(track.time) == pytest.approx(1.0 / FPS)
    for missing in options:
        some = {key: value for key, value in options.items() if key != missing}
        with pytest.raises(ms.SpecError, match=f"--{missing}"):
            ms.read_tracks(file, **some)


def test_a_column_that_names_points_names_no_tracks(tmp_path):
    lines = "ID,frame,x (um),y (um)\n" + "".join(f"{7 + i},{i},{i},0\n" for i in range(20))
    (tmp_path / "one.csv").write_text(lines)
    tracks = ms.read_tracks(tmp_path / "one.csv", fps=25)
    assert list(tracks) == ["0"]
    assert tracks.ignored == ("ID",)


def test_a_row_that_stands_twice_is_taken_once(tmp_path):
    lines = [f"{i},{2 * i},0,{k}" for k in (0, 1) for i in range(20)]
    file = tmp_path / "twice.csv"
    file.write_text("\n".join(["frame,x (um),y (um),track", *lines, lines[3], lines[25]]))
    tracks = ms.read_tracks(file, fps=25)
    assert [len(track.time) for track in tracks.values()] == [20, 20]
    assert tracks.remarks == ("2 rows stand twice, each is taken once",)


BROKEN = {
    "no-mdf.mdf": "x,y\n1,2\n",
    "short.mdf": "MTrackJ 1.5.1 Data File\nCluster 1\nTrack 1\nPoint 1 2.0\n",
    "empty.mdf": "MTrackJ 1.5.1 Data File\nEnd of MTrackJ Data File\n",
    "nothing.xml": "<root><trackgroup/></root>",
    "hole.xml": '<root><trackgroup><track><detection t="0" y="1"/></track></trackgroup></root>',
    "words.csv": "Position\n=====\nmore words\n",
    "two-units.csv": "x,y,t (s),unit,unit\n1,2,3,um,um\n",
    "words-below.csv": "Position\nx (um),y (um),time (s)\nword,word,word\n",
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_one_sentence(tmp_path, name):
    (tmp_path / name).write_text(BROKEN[name])
    with pytest.raises(ms.SpecError) as refused:
        ms.read_tracks(tmp_path / name)
    assert str(refused.value).startswith(str(tmp_path / name))
    assert "\n" not in str(refused.value)
