"""Files dropped onto the page: surfaces become bodies, a beat a tail, tracks are described."""

import json

import numpy as np
import pytest
from test_studio import call

import microswim as ms
from microswim.errors import SpecError
from microswim.output.io.stl import write_stl
from microswim.studio import answers
from microswim.studio.app import create_app
from microswim.studio.brought import examples, films
from microswim.studio.brought import surfaces as dropped
from microswim.studio.spec_tables import swimmer_of

HELIX = {
    "fluid": {"viscosity": 100.0},
    "body": {"shape": "sphere", "radius": 0.5},
    "tail": {"kind": "helix", "length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05},
}


@pytest.fixture(scope="module")
def app():
    return create_app(HELIX, "helix", warm=False)


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    """A sphere of radius 0.5 as a file."""
    path = tmp_path_factory.mktemp("stl") / "ball.stl"
    fluid = ms.Fluid(viscosity=1.0)
    robot = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=ms.NoTail(), fluid=fluid)
    return write_stl(path, robot, fineness=0.5).read_bytes()


def drop(app, path, content, **ask):
    body = json.dumps(ask).encode() + b"\n" + content
    status, _, text = call(app, "POST", path, body, kind="application/octet-stream")
    return status, text


def test_a_dropped_surface_is_a_body_and_stands_beside_the_spec_that_is_taken_away(app, ball):
    status, told = drop(app, "/api/surface", ball, name="my ball.STL")
    assert status == 200
    assert told["size"] == pytest.approx([1.0, 1.0, 1.0], rel=1e-2)
    tables = {**HELIX, "tail": {"kind": "none"}}
    tables["body"] = {"shape": "mesh", "file": told["file"], "scale": 1.0}
    made = answers.solve(tables)
    assert made["tables"]["body"]["file"] == told["file"]
    assert 'file = "my_ball.stl"' in made["toml"]
    R = np.array(made["gait"]["series"][0])
    stokes = 6 * np.pi * 100.0 * 0.5
    assert R[0] == pytest.approx(stokes, rel=0.02)
    assert made["shape"]["mesh"]["faces"]


@pytest.mark.parametrize(
    "file", ["/etc/passwd", "head.stl", "dropped/../../x.stl", "dropped/" + 64 * "0" + "/a.stl"]
)
@pytest.mark.parametrize("part", ["body", "tail", "field"])
def test_no_other_file_is_read(part, file):
    with pytest.raises(SpecError, match="file"):
        swimmer_of({**HELIX, part: {"shape": "mesh", "file": file, "scale": 1.0}})


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.exe", b"x"), ("a.stl", b""), ("a.stl", b"solid nothing"), ("../../a.stl.py", b"x")],
)
def test_what_is_no_surface_is_a_sentence(app, name, content):
    status, told = drop(app, "/api/surface", content, name=name)
    assert status == 422
    assert told["error"]


def test_the_newest_files_are_kept(monkeypatch, tmp_path):
    monkeypatch.setattr(dropped, "MOST_FILES", 3)
    tokens = [dropped.keep(f"{i}.stl", str(i).encode()) for i in range(5)]
    assert dropped.place_of(tokens[-1]).read_bytes() == b"4"
    with pytest.raises(SpecError, match="drop it here again"):
        dropped.place_of(tokens[0])


def spots():
    """Two cells, one straight at 20 um/s, one on a circle at 10 um/s; frames, micrometres."""
    rows = ["track,frame,x (um),y (um)"]
    random = np.random.default_rng(5)
    for i in range(80):
        t = i / 25.0
        for cell, x in enumerate(
            ((20 * t, 0.0), (10 * np.sin(t), 10 - 10 * np.cos(t))),
        ):
            a, b = x + random.normal(0, 0.03, 2)
            rows.append(f"{cell},{i},{a:.4f},{b:.4f}")
    return "\n".join(rows).encode()


def test_tracks_are_described_once_it_is_known_how_long_a_frame_is(app):
    status, told = drop(app, "/api/film", spots(), name="cells.csv", tables=HELIX)
    assert status == 422
    assert told["error"].startswith("cells.csv: frame counts frames; give fps")
    status, told = drop(app, "/api/film", spots(), name="cells.csv", tables=HELIX, fps="25")
    assert status == 200
    straight, round_ = told["cells"]
    for cell, speed in ((straight, 20e-6), (round_, 10e-6)):
        value, low, high = cell["numbers"]["speed"]
        assert low < speed < high
        assert high - low < 0.1 * value
    assert round_["numbers"]["turning_rate"][0] == pytest.approx(1.0, rel=0.05)


def beat():
    """The tutorial's beat without its noise."""
    s, t = np.linspace(0, 50.0, 26), np.arange(50) / 250.0
    psi = np.sqrt(s / 50.0) * 0.9 * np.sin(2 * np.pi * (30.0 * t[:, None] - 0.9 * s / 50.0))
    rows = ["frame,s (um),angle"]
    rows += [f"{i},{s[j]:.4f},{psi[i, j]:.6f}" for i in range(t.size) for j in range(s.size)]
    return "\n".join(rows).encode()


def test_a_traced_beat_is_the_tail_of_a_swimmer(app):
    status, told = drop(app, "/api/film", beat(), name="beat.csv", tables=HELIX, fps="250")
    assert status == 200
    tail = told["tables"]["tail"]
    assert float(tail["frequency"].split()[0]) == pytest.approx(30.0, rel=1e-3)
    assert told["tables"]["motion"]["free"] == ["us", "uq", "or"]
    assert "guess" in " ".join(told["notes"])
    made = answers.solve(told["tables"])
    assert made["shape"]["tails"][0]["line"]
    assert made["readings"]["forward_velocity"] > 0


def test_the_beat_of_the_menu_is_that_of_the_sperm_it_was_traced_from():
    told = films.read("beat.csv", examples.content("files/beat.csv"), {"tables": HELIX})
    sperm = ms.Swimmer.preset(examples.SPERM).tail
    np.testing.assert_allclose(told["tables"]["tail"]["modes"], sperm.modes, atol=1e-4)


def test_the_robot_of_the_menu_is_its_preset(app):
    _, told = drop(app, "/api/surface", examples.content("files/robot.stl"), name="robot.stl")
    robot = ms.Swimmer.preset(examples.ROBOT)
    across = 2.0 * (robot.tail.amplitude + robot.tail.radius)
    assert told["size"][0] > 1e3 * (robot.tail.length + 2.0 * robot.body.semi_axes3[0])
    assert told["size"][1] == pytest.approx(
        1e3 * max(across, 2.0 * robot.body.semi_axes3[1]), rel=0.1
    )


def test_the_tracks_of_the_menu_are_read_without_a_question(app):
    _, _, listed = call(app, "GET", "/api/presets", kind="")
    assert listed["files"] == examples.names()
    status, _, text = call(app, "GET", "/api/files/tracks.csv", kind="")
    assert (status, text.encode()) == (200, examples.content("files/tracks.csv"))
    told = films.read("tracks.csv", examples.content("files/tracks.csv"), {"tables": HELIX})
    assert len(told["cells"]) == examples.CELLS
    assert all(cell["numbers"]["speed"] for cell in told["cells"])
    status, _, said = call(app, "GET", "/api/files/passwd", kind="")
    assert status == 422
    assert "files/beat.csv" in said["error"]


@pytest.mark.parametrize("name", ["a.png", "a.csv"])
def test_what_is_no_table_is_a_sentence_without_the_place_of_a_file(name):
    with pytest.raises(SpecError) as refused:
        films.read(name, b"\x00\x01nonsense", {})
    assert "/tmp" not in str(refused.value)
