"""Paths on the page: the circle beside a wall, a path seen from its start, two in one flow."""

import json
from dataclasses import replace

import numpy as np
import pytest
from chromium import opened
from scipy.linalg import expm
from test_studio import HELIX, answer, refusal

import microswim as ms
from boundaries import beside
from microswim.gait.gait import Gait
from microswim.spec.file import from_dict
from microswim.studio.app import create_app
from microswim.studio.brought import scenes
from microswim.studio.judge import jobs, path, together, verdict

FREE = {**HELIX, "motion": {"free": "all"}}


@pytest.fixture(scope="module")
def app():
    return create_app(HELIX, "helix", warm=False)


def quiet(done, total):
    """Nobody listens to the progress."""


def steady(V):
    """A gait that moves by one twist at all phases."""
    return Gait(np.eye(6)[None], -np.asarray(V, float)[None], np.zeros(1), rate=1.0)


@pytest.mark.parametrize("azimuth", [0.0, 1.1])
def test_the_circle_is_where_a_steady_twist_along_the_wall_goes(azimuth):
    """exp(t [V]) of the whole rigid motion stays on the ring that is drawn."""
    swimmer = ms.Swimmer.preset("tabak/helix", {"wall.distance": 1.0, "wall.azimuth": azimuth})
    n = np.array(swimmer.wall.normal)
    across = np.cross(n, [1.0, 0.0, 0.0])
    u, w = np.array([-0.2, 0.0, 0.0]) + 0.05 * across, -0.3 * n
    found = verdict.circle(swimmer, steady([*u, *w]))
    twist = np.zeros((4, 4))
    twist[:3, :3], twist[:3, 3] = np.cross(np.eye(3), w), u
    for t in (0.0, 1.0, 7.0, 15.0):
        away = expm(t * twist)[:3, 3] - found["centre"]
        assert np.linalg.norm(away) == pytest.approx(found["radius"], rel=1e-12)
        assert away @ n == pytest.approx(0.0, abs=1e-12)
    assert found["sense"] == "clockwise"  # it turns against the normal, seen from its tip


def test_there_is_no_circle_without_a_wall_or_without_turning():
    swimmer = ms.Swimmer.preset("tabak/helix")
    turning = steady([-0.2, 0, 0, 0, 0.1, 0])
    assert verdict.circle(swimmer, turning) is None
    beside_one = ms.Swimmer.preset("tabak/helix", {"wall.distance": 1.0})
    assert verdict.circle(beside_one, steady([-0.2, 0, 0, 0, 0, 0])) is None
    assert verdict.circle(beside_one, turning)["radius"] == pytest.approx(2.0)


def places(made, i=0):
    rows = made["swimmers"][i]
    n = len(made["time"])
    return tuple(np.reshape(rows[k], (n, m)) for k, m in (("x", 3), ("q", 4), ("phase", 1)))


def test_a_path_in_free_fluid_is_that_of_the_package():
    made = path.path({"tables": FREE, "turns": 5}, quiet)
    x, q, phase = places(made)
    truth = ms.trajectory(from_dict(FREE).gait(), made["time"])
    assert np.allclose(x, truth.position, atol=1e-5)
    assert np.allclose(np.abs((q * truth.quaternion.values).sum(axis=1)), 1.0, atol=1e-6)
    assert phase[-1, 0] == pytest.approx(10 * np.pi)
    screw = ms.screw(from_dict(FREE).gait())
    assert made["numbers"]["speed"] == pytest.approx(screw.speed, rel=0.01)


def test_a_path_beside_a_wall_is_seen_from_its_start(monkeypatch):
    """Lengths, and heights over the wall that the scene draws, are those of the path itself."""
    spec = {**FREE, "wall": {"distance": 0.9, "tilt": 0.2, "azimuth": 0.7}}
    swimmer = from_dict(spec)
    errors = {"us": 0.02, "or": 0.01, "how": "made up"}
    poses = replace(beside(swimmer), expected_error=errors)
    monkeypatch.setattr(path, "around", lambda swimmer, **options: poses)
    made = path.path({"tables": spec, "turns": 4}, quiet)
    x, q, _ = places(made)
    assert np.allclose(x[0], 0.0)
    assert np.allclose(q[0], [1, 0, 0, 0])
    truth = ms.path(swimmer, made["time"][-1], poses=poses, samples=len(made["time"]))
    gone = np.linalg.norm(truth.position - truth.position[0], axis=1)
    assert np.allclose(np.linalg.norm(x, axis=1), gone, atol=1e-6)
    height = 0.9 + x @ np.array(swimmer.wall.normal)
    assert np.allclose(height, truth.position[:, 2], atol=1e-6)
    assert made["numbers"]["outcome"] == truth.attrs["outcome"]
    assert made["expected_error"] == {"us": 0.02, "or": 0.01}


def test_some_poses_are_solved_or_all(monkeypatch):
    asked = []

    def stop(swimmer, **options):
        asked.append(sorted(options))
        raise ms.MicroswimError("far enough")

    monkeypatch.setattr(path, "around", stop)
    tube = {**FREE, "channel": {"diameter": 4.0, "length": 20.0}}
    wall = {**FREE, "wall": {"distance": 0.9}}
    for tables, poses in ((wall, "some"), (tube, "some"), (tube, "all")):
        with pytest.raises(ms.MicroswimError, match="far enough"):
            path.path({"tables": tables, "poses": poses}, quiet)
    assert asked == [["grid", "progress"], ["progress", "scatter"], ["progress"]]


def pair(**second):
    return {"members": [{"tables": HELIX}, {"tables": HELIX, **second}], "turns": 1}


def test_two_far_apart_swim_as_alone_and_near_ones_otherwise():
    far = together.together(pair(position=[0.0, 0.0, -200.0]), quiet)
    n = far["numbers"]
    assert n["speeds"] == pytest.approx(n["alone"], rel=1e-3)
    near = together.together(pair(position=[0.0, 0.0, -3.5]), quiet)
    assert near["numbers"]["alone"] == pytest.approx(n["alone"])
    off = abs(np.array(near["numbers"]["speeds"]) / n["alone"] - 1.0)
    assert off.max() > 1e-3
    assert (off < near["expected_error"]["us"] + 0.02).all()
    x, _, _ = places(near, 1)
    assert np.allclose(x[0], [0.0, 0.0, -3.5])


@pytest.mark.parametrize(
    ("question", "word"),
    [
        ({"members": [{"tables": HELIX}]}, "give two"),
        ({"members": [{"tables": HELIX}, 3]}, "members\\[1\\]"),
        ({"members": [{"tables": HELIX}, {"tables": {**HELIX, "wall": {"distance": 2.0}}}]}, "B:"),
        ({"members": [{"tables": HELIX}, {"tables": HELIX, "position": [0, 0]}]}, "position"),
    ],
)
def test_what_cannot_be_put_together_is_refused_before_a_process_is_busy(question, word):
    with pytest.raises(ms.SpecError, match=word):
        jobs.check("together", question)


def test_two_that_are_too_near_are_told_to_part():
    outcome, why = jobs.answer("together", pair(position=[0.0, 0.0, -1.03]), lambda told: None)
    assert outcome == "failed"
    assert "put them apart" in why


@pytest.mark.parametrize("turns", [0, "many", 1e9])
def test_how_long_is_a_number_within_reason(turns):
    with pytest.raises(ms.SpecError, match="turns"):
        path.path({"tables": FREE, "turns": turns}, quiet)


def test_what_nothing_turns_has_no_path():
    still = {**FREE, "tail": {**FREE["tail"], "frequency": 0.0}}
    with pytest.raises(ms.SpecError, match="nothing turns"):
        path.path({"tables": still}, quiet)


# ------------------------------------------------------------------ scenes


@pytest.mark.parametrize("name", scenes.shipped())
def test_the_scenes_of_the_menu_are_read(app, name):
    made = answer(app, "/api/scene", scenes.shipped()[name].encode(), kind="text/plain")
    assert len(made["designs"]) == len(made["places"]) == 2
    assert made["places"][0]["position"] == [0.0, 0.0, 0.0]
    jobs.check("together", {"members": [
        {"tables": d["answer"]["tables"], **p} for d, p in zip(made["designs"], made["places"])
    ]})  # fmt: skip


SCENE = """[[swimmer]]
preset = "tabak/helix"
{first}
[[swimmer]]
preset = "tabak/helix"
{second}
"""


def test_a_scene_that_is_moved_as_a_whole_is_the_same_scene():
    """What the page holds is where the second is, seen from the first."""
    here = scenes.read(SCENE.format(first="", second="position = [3, 1, 2]\ndirection = [0, 1, 0]"))
    first = "position = [1, 1, 1]\ndirection = [0, 1, 0]"  # a quarter turn about z
    second = "position = [0, 4, 3]\ndirection = [-1, 0, 0]"
    moved = scenes.read(SCENE.format(first=first, second=second))
    for a, b in zip(here["places"], moved["places"], strict=True):
        assert a["position"] == pytest.approx(b["position"], abs=1e-12)
        assert a["direction"] == pytest.approx(b["direction"], abs=1e-12)
    rotations = [
        ms.Member(swimmer=from_dict(HELIX), **m["places"][1]).rotation for m in (here, moved)
    ]
    assert np.allclose(rotations[0][:, 0], rotations[1][:, 0])


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('[[swimmer]]\nspec = "/etc/passwd"', "reads no file"),
        ('[[swimmer]]\npreset = "goto/C"\nset = {"body.file" = "/a.stl"}', "reads no file"),
        ('[[swimmer]]\npreset = "tabak/helix"', "two of them"),
        (SCENE.format(first="", second="force = [1, 0, 0]\nposition = [9, 0, 0]"), "are shown"),
        (SCENE.format(first="", second="position = [9, 0, 0]")
         + "[wall]\nnormal = [0, 0, 1]\nposition = [0, 0, -5]", "free fluid"),
        (SCENE.format(first="", second="position = [9, 0, 0]")
         + '[field]\nkind = "rotating"\nstrength = 1.0\nfrequency = 1.0', "has a magnet"),
        (SCENE.format(first="", second="position = [9, 0, 0]")
         + '[field]\nkind = "coils"\nfile = "/etc/passwd"', "reads no file"),
        ("[[swimmer]", "not valid TOML"),
    ],
)  # fmt: skip
def test_a_scene_that_is_not_shown_is_refused_with_a_way_on(app, text, word):
    assert word in refusal(app, "/api/scene", text.encode(), kind="text/plain")


# ------------------------------------------------------------------ in the browser


@pytest.fixture(scope="module")
def page(browser, server):
    made = opened(browser, server)
    yield made
    assert made.complaints == []
    made.close()


POSE = "(i) => { const { x, q } = studio.actors()[i].pose; return [[...x], [...q]]; }"


@pytest.mark.browser
def test_the_page_goes_along_the_path_and_comes_back(page):
    page.click("#tab-path")
    page.select_option("#turns", "100")
    page.click("#ask-path")
    page.wait_for_selector("#went")
    assert re_number(page.inner_text("[data-went=speed]")) > 0
    page.evaluate("() => { studio.view.paused = true; studio.replay().time = 31.25; }")
    page.wait_for_function("() => Math.abs(studio.actors()[0].pose.time - 31.25) < 1e-9")
    x, q = page.evaluate(POSE, 0)
    tables = page.evaluate("() => studio.store.design.answer.tables")
    truth = ms.trajectory(from_dict(tables).gait(), [0.0, 31.25])
    assert np.allclose(x, truth.position[-1], atol=1e-4)
    assert abs(np.dot(q, truth.quaternion[-1])) == pytest.approx(1.0, abs=1e-5)
    page.fill('input[aria-label="Amplitude, value"]', "0.11")
    page.keyboard.press("Enter")
    page.wait_for_function("() => !studio.replay()")  # it was that of another design
    page.wait_for_selector("#went")  # and is asked for again as the hand rests
    page.click("#leave-path")
    page.wait_for_function("() => !studio.replay()")
    page.evaluate("() => { studio.view.paused = false; }")


#: Along the first axis of the plane, more of it as the motors turn; the plane faces -y.
FLOW_OF_BOTH = {
    "s": [-3.0, 3.0], "q": [-3.0, 3.0], "shape": [8, 8], "scale": 1.0,
    "series": [[1.0, 0.0, 0.0] * 64, [0.5, 0.0, 0.0] * 64, [0.0] * 192],
    "frame": {"origin": [1.0, 0.0, -1.75], "quaternion": [0.5**0.5, -(0.5**0.5), 0.0, 0.0]},
}  # fmt: skip


def flow_of_both(page, asked):
    """It is asked for where both are, lies on the plane that comes, and goes with the path."""
    page.click("#flow")
    page.wait_for_function("() => studio.flow.ofBoth")
    ask = asked[-1]
    assert ask["kind"] == "pair_flow"
    assert ask["time"] == pytest.approx(0.5)
    assert [m["position"] for m in ask["members"]] == [[0, 0, 0], pytest.approx([0.25, 0, -3.5])]
    assert ask["members"][0]["phase"] == pytest.approx(3.14)
    assert page.inner_text("#flowbar").startswith("flow of both 0")
    corner = page.evaluate(
        "() => { const g = studio.flow.group; const v = g.position.clone().set(3, 3, 0);"
        " return g.localToWorld(v).divideScalar(studio.stage.scale).toArray(); }"
    )
    assert corner == pytest.approx([4.0, 0.0, -4.75], abs=1e-6)
    page.evaluate("() => { studio.view.paused = false; }")
    page.wait_for_function("() => studio.flow.turned > 1")
    page.evaluate("() => { studio.view.paused = true; }")
    turned, u, phase = page.evaluate(
        "() => [studio.flow.turned, studio.flow.velocities[0], studio.actors()[0].pose.phase]"
    )
    assert u == pytest.approx(1.0 + 0.5 * np.cos(turned), abs=1e-5)
    assert phase == pytest.approx(3.14 + turned)
    assert page.evaluate("() => studio.replay().time") == 0.5


@pytest.mark.browser
def test_a_path_is_asked_for_again_where_the_answer_to_a_change_is_late(page):
    """Later than the hand rests: the path that was asked for then is of the design before."""
    page.click("#tab-path")
    page.select_option("#turns", "100")
    page.click("#ask-path")
    page.wait_for_selector("#went")

    def late(route):
        page.wait_for_timeout(900)
        route.continue_()

    page.route("**/api/solve", late)
    page.fill('input[aria-label="Amplitude, value"]', "0.12")
    page.keyboard.press("Enter")
    page.wait_for_function("() => !studio.replay()")
    page.wait_for_selector("#went")
    page.unroute("**/api/solve")
    page.click("#leave-path")
    page.wait_for_function("() => !studio.replay()")


@pytest.mark.browser
def test_a_scene_of_the_menu_puts_two_swimmers_where_it_says(page):
    """The solve is made up: where the page puts what is answered is what is asked here.

    A path of one is on show before.
    """
    asked = []
    rows = {"x": [0.0] * 6, "q": [1.0, 0, 0, 0] * 2, "phase": [0.0, 6.28]}
    other = {**rows, "x": [0.0, 0, -3.5, 0.5, 0, -3.5]}
    numbers = {"turns": 20, "speeds": [0.03, 0.031], "alone": [0.03, 0.03], "apart": 3.5}
    made = {"time": [0.0, 1.0], "swimmers": [rows, other], "numbers": numbers,
            "expected_error": {"us": 0.07}}  # fmt: skip
    one = {"time": [0.0, 1.0], "swimmers": [rows], "numbers": {"turns": 20, "speed": 0.03},
           "expected_error": {}}  # fmt: skip

    def start(route):
        asked.append(json.loads(route.request.post_data))
        route.fulfill(json={"token": "made-up"})

    def done(route):
        answer = {"together": made, "pair_flow": FLOW_OF_BOTH}.get(asked[-1]["kind"], one)
        told = {"state": "done", "done": 1, "total": 1, "seconds": 1.0, "answer": answer}
        route.fulfill(json=told)

    page.route("**/api/jobs", start)
    page.route("**/api/jobs/made-up", done)
    page.click("#tab-path")
    page.click("#ask-path")
    page.wait_for_selector("[data-went=speed]")
    page.select_option("#presets", value="together/two-robots")
    page.wait_for_selector("[data-went=speed-0]")
    assert page.locator(".notice.error").count() == 0
    assert asked[-1]["members"][1]["position"] == pytest.approx([0.0, 0.0, -3.5])
    assert "7.0 %" in page.inner_text("[data-went=speed-0]")
    page.evaluate("() => { studio.view.paused = true; studio.replay().time = 0.5; }")
    page.wait_for_function("() => Math.abs(studio.actors()[1].pose.time - 0.5) < 1e-9")
    assert page.evaluate(POSE, 1)[0] == pytest.approx([0.25, 0.0, -3.5])
    flow_of_both(page, asked)
    page.focus("#place-ahead")
    page.keyboard.press("End")  # two lengths ahead: along -s
    page.wait_for_function("() => studio.paths.made === null || studio.replay().time === 0")
    page.wait_for_selector("#went")
    assert not page.evaluate("() => studio.flow.shown")
    assert page.locator("#flowbar").is_hidden()
    length = page.evaluate(
        "() => (s => s.length + 2 * s.semi_axes[0])(studio.actors()[0].answer.shape)"
    )
    assert asked[-1]["members"][1]["position"] == pytest.approx([-2 * length, 0.0, -3.5])
    page.unroute("**/api/jobs")
    page.unroute("**/api/jobs/made-up")
    page.select_option("#presets", value="tabak/helix")
    page.wait_for_function("() => studio.store.designs.length === 1")


@pytest.mark.browser
def test_a_path_beside_a_wall_leads_with_its_own_speed(page):
    """The answer is made up; the surrogate, which knows no wall, stands below it."""
    numbers = {"turns": 20, "speed": 12.5e-6, "outcome": "orbits", "gap_mean": 1e-6}
    rows = {"x": [0.0] * 6, "q": [1.0, 0, 0, 0] * 2, "phase": [0.0, 6.28]}
    made = {"time": [0.0, 1.0], "swimmers": [rows], "numbers": numbers,
            "expected_error": {"us": 0.02, "uq": 0.031}}  # fmt: skip
    done = {"state": "done", "done": 1, "total": 1, "seconds": 1.0, "answer": made}
    page.route("**/api/jobs", lambda route: route.fulfill(json={"token": "made-up"}))
    page.route("**/api/jobs/made-up", lambda route: route.fulfill(json=done))
    page.select_option("#presets", value="cells/beside-a-wall")
    page.wait_for_function("() => studio.store.design.name === 'cells/beside-a-wall'")
    assert "knows nothing of the wall" in page.inner_text("#trust")
    page.click("#tab-path")
    page.click("#ask-path")
    page.wait_for_selector("#went-speed")
    assert page.inner_text("#went-speed .figure").split() == ["12.5", "µm/s"]
    assert "Boundary elements at poses: ± 3.1 %" in page.inner_text("#trust")
    assert "knows nothing of the wall" in page.inner_text("#gait-trust")
    page.click("#leave-path")
    page.wait_for_selector("#went-speed", state="detached")
    assert "knows nothing of the wall" in page.inner_text("#trust")
    page.unroute("**/api/jobs")
    page.unroute("**/api/jobs/made-up")
    page.select_option("#presets", value="tabak/helix")
    page.wait_for_function("() => studio.store.design.name === 'tabak/helix'")


def re_number(text):
    return float(text.split()[0])


@pytest.mark.browser
def test_the_ring_of_a_pose_is_drawn_when_the_judge_has_answered(page):
    """Drawn from the judge's circle, and gone with the design that it was of."""
    circle = {"radius": 2.0, "centre": [0, 0, -2.0], "normal": [0, 1, 0], "sense": "clockwise",
              "towards": 0.1}  # fmt: skip
    page.evaluate(
        """(circle) => { const { store } = studio, d = store.design;
        d.reference = { answer: d.answer, of: JSON.stringify(d.answer.tables), circle };
        store.tell("answer"); }""",
        circle,
    )
    drawn = "() => studio.actors()[0].whole.visible"
    assert page.evaluate(drawn)
    page.fill('input[aria-label="Amplitude, value"]', "0.12")
    page.keyboard.press("Enter")
    page.wait_for_function("() => !studio.actors()[0].whole.visible")
