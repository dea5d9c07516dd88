"""The studio's server: what it answers, what it refuses, that it remembers nothing."""

import asyncio
import dataclasses
import hashlib
import json
import math
import re
import subprocess
import sys
import threading
import tomllib
from pathlib import Path

import numpy as np
import pytest

import microswim as ms
from microswim.gait.turning.driven import DRIVEN
from microswim.numerics.series.fourier import evaluate
from microswim.spec import presets
from microswim.spec.describe import to_tables
from microswim.spec.file import from_dict
from microswim.spec.tables import FIELDS
from microswim.spec.toml import to_toml
from microswim.studio import answers, magnet, maps, nearby_field, page
from microswim.studio import bounds as around
from microswim.studio import spec_tables as tables
from microswim.studio.app import LARGEST_BODY, create_app
from microswim.studio.brought import surfaces as brought
from microswim.studio.hosts import LOCAL, is_known, name_of
from microswim.studio.judge import flow
from microswim.studio.judge import jobs as work
from microswim.studio.judge.processes import Judge
from microswim.studio.server import address, listen
from microswim.studio.spec_tables import canonical
from microswim.studio.words import words
from microswim.swimmer.drag.coefficients import ValidityWarning

PAGE = Path(__file__).parents[2] / "studio" / "src"
HELIX = tomllib.loads(presets.read("tabak/helix"))
THICK = {**HELIX, "tail": {**HELIX["tail"], "radius": 0.12, "amplitude": 0.15}}
WAVE = tomllib.loads(presets.read("tabak/plane_wave"))
CELL = tomllib.loads(presets.read("goto/A"))
X = {"field": "tail.amplitude", "from": 0.04, "to": 0.16, "count": 7}
Y = {"field": "tail.waves", "from": 2.0, "to": 4.0, "count": 5}
WALL = {"distance": 0.9, "tilt": "20 deg", "azimuth": "-30 deg"}
CHANNEL = {
    "diameter": 4.0,
    "length": 8.0,
    "shape": "box",
    "position": [0.2, -0.3, 0.1],
    "tilt": 0.1,
}
CUSTOM = {**HELIX, "tail": {"kind": "custom", "shape": "os:getcwd", "length": 1, "radius": 0.01}}


@pytest.fixture(scope="module")
def app():
    return create_app(HELIX, "helix", warm=False)


def call(app, method, path, body=None, *, kind="application/json", host="127.0.0.1", headers=()):
    """Status, headers and body of one request, straight through the ASGI interface."""
    raw = body if isinstance(body, bytes) else b"" if body is None else json.dumps(body).encode()
    sent = [(b"host", host.encode()), (b"content-type", kind.encode()), *headers]
    scope = {
        "type": "http", "method": method, "path": path, "raw_path": path.encode(), "headers": sent,
        "query_string": b"", "scheme": "http", "http_version": "1.1", "asgi": {"version": "3.0"},
        "client": ("127.0.0.1", 1), "server": ("127.0.0.1", 80), "root_path": "",
    }  # fmt: skip
    received = []

    async def receive():
        return {"type": "http.request", "body": raw, "more_body": False}

    async def send(message):
        received.append(message)

    asyncio.run(app(scope, receive, send))
    data = b"".join(m.get("body", b"") for m in received)
    found = {k.decode(): v.decode() for k, v in received[0]["headers"]}
    is_json = "json" in found.get("content-type", "")
    return received[0]["status"], found, json.loads(data) if is_json else data.decode()


def answer(app, path, body, **options):
    status, _, made = call(app, "POST", path, body, **options)
    assert status == 200, made
    return made


def refusal(app, path, body, status=422, **options):
    got, _, made = call(app, "POST", path, body, **options)
    assert got == status
    assert made["error"].strip()
    return made["error"]


# ------------------------------------------------------------------ what it answers


@pytest.mark.parametrize("spec", [HELIX, WAVE, CELL], ids=["helix", "wave", "cell"])
def test_readings_are_those_of_the_package(app, spec):
    made = answer(app, "/api/solve", {"tables": spec})
    truth = ms.summary(from_dict(spec).gait())
    for name in ("swimming_speed", "efficiency", "mean_torque", "mean_power"):
        assert made["readings"][name] == pytest.approx(truth[name], rel=1e-6)
    assert made["readings"]["forward_velocity"] == pytest.approx(
        -truth["mean_velocity"][0], rel=1e-6
    )
    turns = truth["mean_velocity"][3] / (2 * math.pi)
    assert made["readings"]["body_rate_hz"] == pytest.approx(abs(turns), rel=1e-6, abs=1e-12)


def test_the_page_is_told_of_every_field_and_quantity_it_shows(app):
    status, _, start = call(app, "GET", "/api/start")
    assert status == 200
    told = start["words"]
    assert set(told["fields"]) == set(FIELDS)
    assert told["fields"]["tail.kind"]["choices"] == [
        ["helix", "Helix"],
        ["plane_wave", "Plane wave"],
        ["elastic", "Elastic"],
        ["none", "None"],
    ]
    assert set(told["quantities"]) == set(start["answer"]["readings"]) | set(DRIVEN)
    assert set(told["outputs"]) <= set(told["quantities"])
    for sizes, value in (("um", 1e-6), ("mPa s", 1e-3), ("deg", math.pi / 180)):
        assert told["units"][sizes] == pytest.approx(value, rel=1e-15)
    for name in presets.names():
        spec = canonical(from_dict(tomllib.loads(presets.read(name))))
        each = [(part, t) for part, t in spec.items() for t in (t if isinstance(t, list) else [t])]
        assert {f"{part}.{field}" for part, t in each for field in t} <= set(told["fields"])


def test_the_page_has_no_list_of_its_own():
    """What fields, choices, units and quantities are called is not retyped in its sources."""
    sources = "".join(p.read_text(encoding="utf-8") for p in PAGE.rglob("*.ts"))
    names = [re.escape(name) for name in (*FIELDS, *words()["quantities"])]
    rows = re.findall(rf"""["']?({"|".join(names)})(?:\[\d\])?["']?: *["'{{\[]""", sources)
    assert not rows
    assert "mPa s" not in sources


@pytest.mark.parametrize("spec", [HELIX, WAVE], ids=["helix", "wave"])
def test_the_gait_that_travels_is_the_gait(app, spec):
    """R and F_p rebuilt from the 27 columns equal the gait's own at any phase."""
    sent = answer(app, "/api/solve", {"tables": spec})["gait"]
    gait = from_dict(spec).gait()
    phase = np.array([0.3, 2.1, 5.0])
    columns = evaluate(np.array(sent["series"]), phase)
    lower = np.tril_indices(6)
    R = gait.resistance(phase)
    scale = np.sqrt(np.einsum("ni,nj->nij", *[np.einsum("nii->ni", R)] * 2))
    error = (columns[:, :21] - R[:, lower[0], lower[1]]) / scale[:, lower[0], lower[1]]
    assert np.abs(error).max() < 1e-7
    F = gait.propulsion(phase)
    assert np.abs(columns[:, 21:] - F).max() < 1e-7 * np.abs(F).max()
    assert sent["rate"] == pytest.approx(gait.rate)


def test_who_chose_no_law_is_answered_by_the_atlas_again_and_again(app):
    """What the page sends back is the same swimmer: nobody has chosen a law since."""
    open_ = {name: table for name, table in HELIX.items() if name != "coefficients"}
    made = answers.solve(answers.solve(open_)["tables"])
    assert made["gait"]["model"] == "atlas"
    told = from_dict(open_).gait("auto").info["expected_error"]
    assert made["errors"]["swimming_speed"] == made["expected_error"] == pytest.approx(told["us"])
    assert made["errors"]["body_rate"] == pytest.approx(told["os"])
    map_ = maps.map_(open_, X, Y)
    assert map_["model"] == "atlas"
    assert all(e is not None and 0 < e < 0.2 for e in map_["expected_error"])
    chosen = {**made["tables"], "coefficients": {"law": "cox"}}
    assert answers.solve(chosen)["gait"]["model"] == "rft"


@pytest.mark.parametrize("name", ["tabak/helix", "goto/A"])
def test_presets_keep_the_model_of_the_paper(name):
    assert answers.solve(tomllib.loads(presets.read(name)))["gait"]["model"] == "rft"


@pytest.mark.parametrize("name", presets.names())
def test_canonical_tables_and_toml_say_the_same_swimmer(name):
    swimmer = ms.Swimmer.preset(name)
    full = tables.canonical(swimmer)
    for again in (from_dict(full), from_dict(tomllib.loads(to_toml(full, name)))):
        assert again.units == swimmer.units
        assert again.motion == swimmer.motion
        for field, value in swimmer.numbers.items():
            assert again.numbers[field] == pytest.approx(value, rel=1e-11), field


def test_a_map_is_the_surrogate_at_each_of_its_points(app):
    made = answer(app, "/api/map", {"tables": HELIX, "x": X, "y": Y})
    values = np.reshape(made["values"]["swimming_speed"], (5, 7))
    swimmer = from_dict(HELIX)
    for i, j in [(0, 0), (6, 4), (3, 1)]:
        changed = swimmer.with_({"tail.amplitude": made["x"][i], "tail.waves": made["y"][j]})
        truth = ms.screw(changed.gait()).speed
        assert values[j, i] == pytest.approx(truth, rel=2e-3)  # the tolerance of a map, twice


def test_impossible_designs_on_a_map_are_null(app):
    wide = {"field": "tail.radius", "from": 0.01, "to": 0.5, "count": 8}
    made = answer(app, "/api/map", {"tables": HELIX, "x": wide, "y": Y})
    speeds = np.array(made["values"]["swimming_speed"], dtype=object).reshape(5, 8)
    assert all(v is None for v in speeds[:, -1])
    assert all(v is not None for v in speeds[:, 0])


def test_the_optimum_beats_every_point_of_the_map(app):
    ask = {"tables": HELIX, "x": X, "y": Y, "output": "efficiency"}
    best = answer(app, "/api/optimum", ask)
    made = answer(app, "/api/map", ask)
    assert best["value"] >= 0.999 * max(made["values"]["efficiency"])
    there = {"tail.amplitude": best["x"], "tail.waves": best["y"]}
    assert from_dict(HELIX).with_(there).gait().efficiency == pytest.approx(best["value"], rel=2e-3)


def test_a_spec_file_is_read_and_completed(app):
    text = presets.read("goto/A").encode()
    status, _, made = call(app, "POST", "/api/spec", text, kind="text/plain")
    assert status == 200
    assert made["tables"]["tail"]["radius"] == "0.016 um"
    assert made["dimensional"]


def test_warnings_become_notes():
    with pytest.warns(ValidityWarning) as own:
        from_dict(THICK).gait()
    assert answers.solve(THICK)["notes"] == [str(own[0].message)]


def test_a_note_is_of_the_design_that_was_asked_not_of_another_that_is_solved_meanwhile(
    monkeypatch,
):
    """A map of thick filaments runs in another thread, whose warnings nobody asked for."""

    def beside(swimmer):
        other = threading.Thread(target=lambda: from_dict(THICK).gait())
        other.start()
        other.join()
        return shape(swimmer)

    shape = answers.shape
    monkeypatch.setattr(answers, "shape", beside)
    with pytest.warns(ValidityWarning):
        assert answers.solve(HELIX)["notes"] == []


@pytest.fixture(scope="module")
def calibrated():
    """A spec with a region, of few designs of another law."""
    from microswim.calibration.region.text import pack

    region = {"tail.amplitude": (0.06, 0.12)}
    made = ms.calibrate_region(from_dict(HELIX), region, "rft", solves=12, workers=0).swimmer
    return {k: v for k, v in HELIX.items() if k != "coefficients"} | {
        "region": {"data": pack(made.region)}
    }


def test_a_region_tells_its_error_and_its_bounds(app, calibrated):
    made = answer(app, "/api/solve", {"tables": calibrated})
    assert not {"coefficients", "interaction"} & set(made["tables"])
    assert answer(app, "/api/solve", {"tables": made["tables"]})["tables"] == made["tables"]
    swimmer = from_dict(calibrated)
    told = ms.expected_error(swimmer, swimmer.gait())["us"]
    assert made["expected_error"] == pytest.approx(told)
    again = from_dict(tomllib.loads(made["toml"]))
    assert ms.expected_error(again, again.gait())["us"] == pytest.approx(told)
    far = {**calibrated, "tail": {**HELIX["tail"], "amplitude": 0.2}}
    made = answer(app, "/api/solve", {"tables": far})
    assert made["expected_error"] is None
    assert any("outside" in note for note in made["notes"])


def test_a_calibration_at_one_design_says_where_and_the_surrogate_how_far_off(app):
    """Also of a file that was calibrated elsewhere; away from its design it says so."""
    swimmer = from_dict(HELIX)
    plain = answer(app, "/api/solve", {"tables": HELIX})
    assert plain["atlas_knows"]  # had the spec chosen no law
    bare = answer(app, "/api/solve", {"tables": {**HELIX, "coefficients": {}, "interaction": {}}})
    assert bare["gait"]["model"] == "atlas"
    assert not bare["atlas_knows"]
    assert plain["calibration"] is None
    assert plain["expected_error"] > 0.1
    fitted = ms.calibrate(swimmer, swimmer.gait("bem", level="coarse")).swimmer
    made = answer(app, "/api/solve", {"tables": to_tables(fitted)})
    assert made["calibration"]["here"]
    power = fitted.gait().mean_power / swimmer.gait("bem", level="coarse").mean_power - 1.0
    own = 0.0035  # of the reference itself
    assert made["errors"]["mean_torque"] == pytest.approx(abs(power) + own, abs=1e-6)
    cost = fitted.gait().efficiency / swimmer.gait("bem", level="coarse").efficiency - 1.0
    assert made["calibration"]["missed"]["efficiency"] == pytest.approx(cost, rel=1e-2)
    assert made["expected_error"] == pytest.approx(0.0035, abs=1e-4)
    again = tomllib.loads(made["toml"])
    away = {**again, "tail": {**again["tail"], "amplitude": 1.2 * HELIX["tail"]["amplitude"]}}
    made = answer(app, "/api/solve", {"tables": away})
    assert not made["calibration"]["here"]
    assert "tail.amplitude +20 %" in made["calibration"]["lines"][0]
    assert made["expected_error"] > 0.01


def test_the_optimum_of_a_calibrated_surrogate_lies_in_its_region(app, calibrated):
    ask = {"tables": calibrated, "x": X, "y": Y, "output": "swimming_speed"}
    made = answer(app, "/api/map", ask)
    assert made["inside"]["x"] == [0.06, 0.12]
    assert made["inside"]["y"] == [3.0, 3.0]
    best = answer(app, "/api/optimum", ask)
    assert 0.06 <= best["x"] <= 0.12
    assert best["y"] == 3.0
    elsewhere = {**ask, "x": {**X, "from": 0.13}}
    assert "calibrated" in refusal(app, "/api/optimum", elsewhere)
    assert answer(app, "/api/map", {"tables": HELIX, "x": X, "y": Y})["inside"] is None


@pytest.mark.parametrize("around", [{"wall": WALL}, {"channel": CHANNEL}], ids=["wall", "channel"])
@pytest.mark.parametrize("si", [False, True])
def test_walls_and_channels_come_back_whole(around, si):
    (part, table), unit = next(iter(around.items())), " um" if si else ""
    spec = CELL if si else HELIX
    lengths = {"distance", "diameter", "length"}
    given = {k: f"{v}{unit}" if si and k in lengths else v for k, v in table.items()}
    if si and "position" in given:
        given["position"] = [f"{v}{unit}" for v in given["position"]]
    swimmer = from_dict({**spec, part: given})
    full = tables.canonical(swimmer)
    for again in (from_dict(full), from_dict(tomllib.loads(to_toml(full, part)))):
        assert getattr(again, part) == getattr(swimmer, part) or again.numbers == pytest.approx(
            swimmer.numbers, rel=1e-11
        )


def test_what_is_odd_about_a_swimmer_travels_to_the_page(app):
    free = answer(app, "/api/solve", {"tables": HELIX})
    assert (free["gait"]["one_pose"], free["remarks"]) == ("", [])
    beside = answer(app, "/api/solve", {"tables": {**HELIX, "wall": WALL}})
    assert beside["gait"]["one_pose"] == "wall"  # the page lets it stay where it is
    assert any("no path is followed" in remark for remark in beside["remarks"])
    odd = answer(app, "/api/solve", {"tables": {**HELIX, "tail": {**HELIX["tail"], "ramp": 0.0,
                 "amplitude": 0.6}}})  # fmt: skip
    assert any("does not touch the body" in remark for remark in odd["remarks"])


def test_the_wall_in_the_scene_is_that_of_the_judge(app):
    """Distance and normal from the body's centre are those of `Wall.plane`."""
    made = answer(app, "/api/solve", {"tables": {**HELIX, "wall": WALL}})["around"]
    swimmer = from_dict({**HELIX, "wall": WALL})
    plane = swimmer.wall.plane([0.0, 0.0, 0.0])
    assert np.allclose(-made["distance"] * np.array(made["normal"]), plane[:3])
    assert np.allclose(made["normal"], plane[3:])
    assert made["normal"][0] == pytest.approx(math.sin(math.radians(20)))


def test_the_channel_in_the_scene_is_that_of_the_judge():
    mesh = pytest.importorskip("microswim.models.fem.mesh", reason="needs the extra fem")
    swimmer = from_dict({**HELIX, "channel": CHANNEL})
    outline = mesh.Outline.of(swimmer)
    theirs = outline.unit * (outline.middle_of(swimmer.channel) - outline.centre)
    assert np.allclose(around.scene(swimmer)["middle"], theirs)


@pytest.mark.parametrize("spec", [HELIX, WAVE], ids=["helix", "wave"])
def test_what_touches_a_wall_is_refused_where_it_touches(app, spec):
    """The least distance is that of the farthest point of body and tail, by a fine sampling."""
    swimmer = from_dict({**spec, "wall": {**WALL, "distance": 5.0}})
    n, tail = np.array(swimmer.wall.normal), swimmer.tail
    s, phase = np.meshgrid(
        np.linspace(0, tail.apparent_length, 400), np.linspace(0, 2 * np.pi, 200)
    )
    line = tail.centreline(s, phase)[0] + [float(swimmer.body.semi_axes3[0]), 0, 0]
    least = max(float((-line @ n).max()) + tail.radius, float(swimmer.body.semi_axes3[0]))
    for share, status in ((0.99, 422), (1.01, 200)):
        wall = {**WALL, "distance": share * least}
        got, _, made = call(app, "POST", "/api/solve", {"tables": {**spec, "wall": wall}})
        assert got == status
        assert status == 200 or "wall.distance" in made["error"]


@pytest.mark.parametrize("change", [{"diameter": 0.8}, {"length": 3.0}, {"position": [0, 0, 1.6]}])
def test_what_does_not_fit_into_a_channel_is_refused(app, change):
    spec = {**HELIX, "channel": {**CHANNEL, **change}}
    assert "channel" in refusal(app, "/api/solve", {"tables": spec})


def test_a_map_does_not_offer_what_the_surrogate_does_not_know(app):
    distance = {"field": "wall.distance", "from": 1.0, "to": 2.0, "count": 4}
    spec = {**HELIX, "wall": WALL}
    refusal(app, "/api/map", {"tables": spec, "x": distance, "y": Y})
    free = answer(app, "/api/map", {"tables": HELIX, "x": X, "y": Y})["values"]
    assert answer(app, "/api/map", {"tables": spec, "x": X, "y": Y})["values"] == free


def test_a_map_without_symmetry_is_thinned(app):
    body = {"shape": "ellipsoid", "semi_axes": [0.6, 0.5, 0.4]}
    wide = {"x": {**X, "count": 40}, "y": {**Y, "count": 30}}
    made = answer(app, "/api/map", {"tables": {**HELIX, "body": body}, **wide})
    assert (len(made["x"]), len(made["y"])) == maps.MOST_SINGLY
    assert made["x"][-1] == X["to"]
    assert len(made["values"]["efficiency"]) == len(made["x"]) * len(made["y"])


# ------------------------------------------------------------------ what it refuses


def test_code_in_a_spec_is_never_imported(app, monkeypatch):
    monkeypatch.setattr("microswim.spec.trusted._run", lambda *file: pytest.fail("imported"))
    assert "custom" in refusal(app, "/api/solve", {"tables": CUSTOM})
    assert "custom" in refusal(app, "/api/map", {"tables": CUSTOM, "x": X, "y": Y})
    assert "custom" in refusal(app, "/api/optimum", {"tables": CUSTOM, "x": X, "y": Y})
    assert "custom" in refusal(app, "/api/jobs", {"tables": CUSTOM, "kind": "judge"})
    assert "custom" in refusal(app, "/api/snapshot", {"designs": [{"tables": CUSTOM}]})
    text = to_toml(CUSTOM, "bad").encode()
    assert "custom" in refusal(app, "/api/spec", text, kind="text/plain")


@pytest.mark.parametrize(
    ("text", "status", "word"),
    [
        (b"[fluid\nviscosity", 422, "TOML"),
        (b"\xff\xfe\x00", 422, "UTF-8"),
        (b"# " + b"x" * (LARGEST_BODY + 1), 413, "KiB"),
        (b"# " + b"x" * (tables.LARGEST_SPEC + 1), 422, "at most"),
        (b"a = " + b"[" * 5000, 422, "TOML"),
        (b"", 422, "fluid"),
    ],
)
def test_uploads_are_checked(app, text, status, word):
    assert word in refusal(app, "/api/spec", text, status, kind="text/plain")


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"amplitude": -1}, "tail.amplitude"),
        ({"amplitude": "1 um"}, "unit"),
        ({"waves": 200, "amplitude": 1e-4, "radius": 1e-4}, "at most 60"),
        ({"colour": "red"}, "colour"),
        ({"radius": 3.0}, "touches itself"),
    ],
)
def test_a_wrong_number_is_a_sentence(app, change, word):
    spec = {**HELIX, "tail": {**HELIX["tail"], **change}}
    sentence = refusal(app, "/api/solve", {"tables": spec})
    assert word in sentence
    assert "\n" not in sentence


@pytest.mark.parametrize(
    "body", [b"{", b"[]", b"null", b'{"tables": 3}', b'{"tables": {"a": NaN}}']
)
def test_nonsense_is_a_sentence(app, body):
    refusal(app, "/api/solve", body)


@pytest.mark.parametrize(
    "change",
    [
        {"count": 10**6},
        {"count": 2.5},
        {"from": 1.0, "to": 0.5},
        {"field": "tail.kind"},
        {"from": None},
    ],
)
def test_a_map_has_limits(app, change):
    refusal(app, "/api/map", {"tables": HELIX, "x": {**X, **change}, "y": Y})


def test_too_many_designs_on_a_map_are_refused(app):
    big = {**X, "count": 100}
    assert "designs" in refusal(
        app, "/api/map", {"tables": HELIX, "x": big, "y": {**Y, "count": 100}}
    )


def test_other_pages_and_other_names_of_this_machine_are_refused(app):
    body = {"tables": HELIX}
    refusal(app, "/api/solve", body, 415, kind="text/plain")
    refusal(app, "/api/solve", body, 403, headers=[(b"origin", b"http://elsewhere.example")])
    for name in (
        "elsewhere.example",
        "127.0.0.1.elsewhere.example",
        "[::2]:80",
        "[::1",
        "",
        "a]:1",
    ):
        assert call(app, "GET", "/", host=name)[0] == 400
    for name in ("127.0.0.1:8642", "localhost:1", "[::1]:8642", "[::1]", "LOCALHOST"):
        assert call(app, "GET", "/", host=name)[0] == 200
    assert (
        call(app, "POST", "/api/solve", body, headers=[(b"origin", b"http://127.0.0.1")])[0] == 200
    )


@pytest.mark.parametrize(
    ("host", "local", "open_"),
    [
        ("127.0.0.1:8642", True, True),
        ("[::1]:8642", True, True),
        ("192.0.2.7:80", False, True),
        ("[2001:db8::7]:80", False, True),
        ("rebound.example", False, False),
        ("192.0.2.7.rebound.example:80", False, False),
        ("robot.example", False, True),
        ("127.0.0.1:80:80", False, False),
        ("[::1]x", False, False),
    ],
)
def test_names_that_can_be_rebound_are_refused(host, local, open_):
    """Listening to the network: any address in numbers, and the name that was asked for."""
    assert is_known(name_of(host), LOCAL) is local
    assert is_known(name_of(host), ("*", "robot.example")) is open_


@pytest.mark.parametrize("name", ["../app.py", "..%2fapp.py", "app.py", "", "studio.map"])
def test_only_the_built_files_can_be_had(app, name):
    assert call(app, "GET", f"/static/{name}")[0] == 404


def test_a_failure_of_ours_is_a_sentence_too(app, monkeypatch, caplog):
    monkeypatch.setattr(answers, "describe", lambda *_: 1 / 0)
    assert "terminal" in refusal(app, "/api/solve", {"tables": HELIX}, 500)
    assert "ZeroDivisionError" in caplog.text


def test_it_listens_on_this_machine_only():
    with listen("127.0.0.1", 0) as one:
        assert one.getsockname()[0] == "127.0.0.1"
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", address("127.0.0.1", one))
        assert address("::1", one).startswith("http://[::1]:")
        one.listen()
        with pytest.raises(ms.MicroswimError, match="--port"):
            listen("127.0.0.1", one.getsockname()[1])


# ------------------------------------------------------------------ that it remembers nothing


def test_pages_share_nothing(app):
    before = call(app, "GET", "/api/start")[2]
    changed = {**HELIX, "tail": {**HELIX["tail"], "amplitude": 0.15}}
    ours = answer(app, "/api/solve", {"tables": changed, "name": "mine"})
    theirs = answer(app, "/api/solve", {"tables": HELIX})
    assert ours["readings"] != theirs["readings"]
    assert call(app, "GET", "/api/start")[2] == before


def test_requests_at_once_do_not_mix(app):
    """Maps and solutions from several threads are those of one after the other."""
    specs = [{**HELIX, "tail": {**HELIX["tail"], "length": 1.6 + 0.1 * i}} for i in range(6)]
    alone = [answer(app, "/api/map", {"tables": s, "x": X, "y": Y})["values"] for s in specs]
    together = [None] * 6

    def ask(i):
        together[i] = answer(app, "/api/map", {"tables": specs[i], "x": X, "y": Y})["values"]

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(6)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert together == alone


# ------------------------------------------------------------------ the judge


def wait(judge, token, until, seconds=120.0):
    for _ in range(int(seconds / 0.05)):
        status = judge.job(token).status()
        if until(status):
            return status
        threading.Event().wait(0.05)
    raise AssertionError(f"still {status['state']}")


def test_the_judge_judges_reports_and_can_be_sent_away(app):
    judge = Judge()
    try:
        token = judge.start("judge", {"tables": WAVE, "level": "coarse"})
        judge.cancel(token)
        assert judge.job(token).status()["state"] == "cancelled"
        token = judge.start("judge", {"tables": HELIX, "level": "coarse"})
        status = wait(judge, token, lambda s: s["state"] != "running")
        assert status["state"] == "done", status
        assert status["done"] >= 1
        rows = {r["name"]: r for r in status["answer"]["rows"]}
        reference = from_dict(HELIX).gait("bem", level="coarse")
        speed = rows["forward_velocity"]
        assert speed["reference"] == pytest.approx(-reference.mean_velocity[0], rel=1e-9)
        assert speed["error"] == pytest.approx(speed["surrogate"] / speed["reference"] - 1)
        calibrated = answers.solve(status["answer"]["calibration"]["tables"])
        assert calibrated["readings"]["forward_velocity"] == pytest.approx(
            speed["reference"], rel=1e-6
        )
        assert judge.job("another token") is None
    finally:
        judge.close()


def test_a_job_that_fails_says_why():
    outcome, why = work.answer("judge", {"tables": CUSTOM}, lambda value: None)
    assert outcome == "failed"
    assert "custom" in why


def test_the_flow_ends_at_the_wall_and_is_refused_in_a_channel(monkeypatch):
    """At the wall the fluid rests; what the image does behind it is not shown."""
    monkeypatch.setattr(flow, "FLOW_PHASES", 2)
    low = {**WAVE, "tail": {**WAVE["tail"], "waves": 1}, "wall": {"distance": 0.55}}
    made = flow.flow({"tables": low}, lambda i, n: None)
    mean = np.reshape(made["series"][0], (*made["shape"], 3))
    q = np.linspace(*made["q"], made["shape"][0])
    assert np.abs(mean[q < -0.55]).max() == 0.0
    nearest = int(np.flatnonzero(q > -0.55)[0])
    assert 0.0 < np.abs(mean[nearest]).max() < 0.5 * np.abs(mean).max()
    with pytest.raises(ms.SpecError, match="channel"):
        flow.flow({"tables": {**HELIX, "channel": CHANNEL}}, lambda i, n: None)


def test_the_flow_obeys_the_no_slip_condition():
    """On the front of the body the fluid moves with the body."""
    spec = {**HELIX, "tail": {**HELIX["tail"], "waves": 1, "amplitude": 0.15}}
    made = flow.flow({"tables": spec}, lambda i, n: None)
    rows, columns = made["shape"]
    mean = np.reshape(made["series"][0], (rows, columns, 3))
    s = np.linspace(*made["s"], columns)
    i = int(np.argmin(np.abs(s + 1.0)))  # the front pole of a body of radius 1/2
    body = from_dict(spec).gait("bem", level="coarse").mean_velocity
    near = abs(s[i] + 1.0)
    assert mean[rows // 2, i, 0] == pytest.approx(body[0], rel=0.05 + 3 * near)
    assert np.abs(mean[0]).max() < np.abs(mean).max() / 2  # and far away it moves less


# ------------------------------------------------------------------ page, snapshot, command


def test_a_snapshot_is_whole_and_safe():
    evil = "</script><script>alert(1)</script>"
    html = page.snapshot(
        [{"name": evil, "tables": HELIX}], {"x": X, "y": Y, "output": "efficiency"}
    )
    assert "alert(1)</script>" not in html
    assert not re.search(r"""(src|href)=["'](?!data:)""", html.split("<script")[0])
    facts = re.search(r'id="snapshot">(.*?)</script>', html, re.DOTALL).group(1)
    data = json.loads(facts)
    assert data["designs"][0]["name"] == evil
    assert data["designs"][0]["answer"]["readings"]["swimming_speed"] > 0
    assert len(data["map"]["values"]["efficiency"]) == 35


def test_the_built_page_is_that_of_its_sources():
    """As `studio/vite.config.js` stamps it: neither sources nor built files change alone."""
    studio = Path(__file__).parents[2] / "studio"
    named = ["index.html", "package.json", "package-lock.json", "tsconfig.json", "vite.config.js"]
    inside = [f.relative_to(studio).as_posix() for f in (studio / "src").rglob("*") if f.is_file()]
    digest = hashlib.sha256()
    for name in sorted([*inside, *named]):
        digest.update(f"{name}\n".encode())
        digest.update((studio / name).read_bytes().replace(b"\r\n", b"\n"))
    found = {"sources": digest.hexdigest()}
    for name in ("index.html", "studio.css", "studio.js"):
        found[name] = hashlib.sha256(page.text(name).encode()).hexdigest()
    stamp = dict(reversed(line.split()) for line in page.text("sources.txt").splitlines())
    assert stamp == found, "run `make studio`"


def test_the_lock_names_no_registry():
    """`npm ci` takes the packages from wherever the reader's npm takes them."""
    lock = (Path(__file__).parents[2] / "studio" / "package-lock.json").read_text(encoding="utf-8")
    assert '"resolved"' not in lock


def test_built_files_are_small_and_speak_to_nobody_else():
    for name in ("index.html", "studio.js", "studio.css", "licences.txt"):
        text = page.text(name)
        assert 0 < len(text) < 1_000_000
        assert not re.search(r"""(?:fetch|import)\(\s*["'`]https?:|url\(\s*["']?https?:""", text)


def test_the_command_writes_a_snapshot(tmp_path):
    spec, out = tmp_path / "robot.toml", tmp_path / "robot.html"
    spec.write_text(presets.read("tabak/helix"), encoding="utf-8")
    asked = ["studio", str(spec), "--snapshot", str(out)]
    code = "import sys; from microswim.cli import main; main(sys.argv[1:])"
    done = subprocess.run(
        [sys.executable, "-c", code, *asked], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "</html>" in out.read_text(encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", code, "studio", "nowhere.toml"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "nowhere.toml" in done.stderr


@pytest.mark.parametrize("waves", [3, 20, 59])
def test_the_usual_map_is_a_map_about_the_design(waves):
    tail = {**HELIX["tail"], "waves": waves, "amplitude": 0.005, "radius": 0.002}
    ask = page.usual_map({**HELIX, "tail": tail})
    made = maps.map_({**HELIX, "tail": tail}, ask["x"], ask["y"])
    assert any(v for v in made["values"]["swimming_speed"])


PLACED = ms.Swimmer(
    body=ms.Sphere(radius=5e-4),
    tail=ms.HelicalTail(length=2e-3, amplitude=2e-4, waves=2, radius=1e-4),
    fluid=ms.Fluid(viscosity=0.34),
    magnet=ms.Magnet(moment=(1e-6, 3e-6, 0.0)),
    field=ms.DipoleField(moment=(0, 5, 0), position=(0.05, 0, 0)),
    units="SI",
)


def test_the_page_has_the_field_where_its_own_sliders_do_not_describe_it():
    turning = dataclasses.replace(PLACED, field=ms.RotatingField(strength=1e-3, frequency=1.0))
    soft = ms.Magnet(susceptibility=(2.0, 1.0, 1.0), volume=1e-10)
    inside = dataclasses.replace(PLACED.field, position=(0.0, 0.0, 0.0))
    for one, own in (
        (PLACED, True),
        (dataclasses.replace(turning, magnet=soft), True),
        (turning, False),
        (dataclasses.replace(PLACED, field=inside), False),
    ):
        told = answers.describe(one, one.gait("rft"))
        assert (told["magnet"]["own"] is not None) == own
        assert (told["magnet"]["softness"] is not None) == (one.magnet is soft)
        unknown = [line for line in told["remarks"] if "not known about the place" in line]
        assert len(unknown) == (one.field is inside)
    with pytest.raises(ms.SpecError, match="place"):
        magnet.asked({"tables": {}, "time": 0.0, "place": [0.0, "x", 0.0]})


def test_a_map_of_step_out_asks_each_design():
    """It is linear in the field, and at a design what `ms.regimes` finds there."""
    turning = dataclasses.replace(
        PLACED,
        magnet=ms.Magnet(moment=3e-6, direction=1.2),
        field=ms.RotatingField(strength=1e-3, frequency=1.0),
        motion=ms.Motion(free="all"),
    )
    tables = canonical(turning)
    assert "step_out" in answers.describe(turning, turning.gait("rft"))["magnet"]["driven"]
    x = {"field": "field.strength", "from": 1e-3, "to": 2e-3, "count": 2}
    y = {"field": "tail.amplitude", "from": 1.8e-4, "to": 2.2e-4, "count": 3}
    made = maps.map_(tables, x, y, "step_out")
    found = np.reshape(made["values"]["step_out"], (3, 2))
    assert found[:, 1] == pytest.approx(2.0 * found[:, 0], rel=1e-4)
    told = ms.regimes(turning, [0.5], gait=turning.gait(made["model"]))
    assert found[1, 0] == pytest.approx(told.step_out, rel=1e-4)
    best = maps.optimum(tables, x, y, "step_out", zooms=1)
    assert best["value"] >= found.max() * (1 - 1e-4)
    plain = maps.map_(tables, x, y)
    assert "step_out" not in plain["values"]


@pytest.mark.parametrize(
    "field",
    [
        ms.DipoleField(moment=(0, 5, 0), position=(0.05, 0, 0), frequency=2.0),
        ms.DipoleField(moment=(0, 5, 1), position=(0.05, 0, 0.01), velocity=(0.02, 0, 0)),
        ms.MagnetField(remanence=1.3, size=(0.02, 0.02, 0.02), position=(0, 0, -0.05), frequency=3),
        ms.OscillatingField(strength=5e-3, frequency=3.0, direction=(0, 1, 1)),
    ],
)
def test_the_field_about_a_place_agrees_with_the_field_between_its_nodes(field):
    start, place = 0.3, np.array([1e-3, -2e-3, 5e-4])
    made = nearby_field.nearby(field, start, place, 3e-3)
    random = np.random.default_rng(3)
    places = place + random.uniform(-1, 1, (20, 3)) * (made["half"] or 1.0)
    for time in start + random.uniform(0, 1, 4) * (made["span"] or 10.0):
        B, J = nearby_field.at(made, time, places)
        true = np.broadcast_to(field.at(time, places), B.shape)
        assert np.abs(B - true).max() < 4e-4 * np.abs(true).max()
        assert (
            np.abs(J - field.gradient(time, places)).max()
            <= 1e-3 * np.abs(field.gradient(time, places)).max()
        )


def test_a_spec_of_this_machine_brings_the_file_of_its_field(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    rows = [
        f"{x},{y},{z},{x},{-y},0"
        for x in (-0.01, 0, 0.01, 0.02)
        for y in (-0.01, 0, 0.01, 0.02)
        for z in (-0.01, 0, 0.01, 0.02)
    ]
    grid = tmp_path / "grid.csv"
    grid.write_text("\n".join(["x (m),y (m),z (m),Bx (T),By (T),Bz (T)", *rows]))
    given = canonical(dataclasses.replace(PLACED, field=ms.UniformField(strength=1.0)))
    given["field"] = {"kind": "coils", "file": str(grid)}
    with pytest.raises(ms.SpecError, match="microswim studio SPEC"):
        answers.solve(given)
    told = answers.solve(brought.admitted(given))
    _, J = nearby_field.at(told["magnet"]["own"], 0.0, [[0.0, 0.0, 0.0]])
    assert np.allclose(J[0], np.diag([1.0, -1.0, 0.0]), atol=1e-9)


@pytest.mark.parametrize("axis", [0, 2])
def test_the_page_is_told_along_which_axis_a_body_alone_is_long(axis):
    robot = ms.Swimmer(
        body=ms.Ellipsoid(semi_axes=tuple(np.roll([1.6, 0.5, 0.5], axis))),
        tail=ms.NoTail(),
        fluid=ms.Fluid(viscosity=1.0),
        magnet=ms.Magnet(moment=(0.0, 1.0, 0.0)),
        field=ms.RotatingField(strength=1.0, frequency=0.02),
    )
    assert answers.describe(robot, robot.gait())["magnet"]["long"] == axis
