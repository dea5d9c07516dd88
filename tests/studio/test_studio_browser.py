"""The studio as a person uses it: headless Chromium drags, clicks, reads and looks."""

import csv
import io
import json
import re
import tomllib

import numpy as np
import pytest
from chromium import calm, opened

import microswim as ms
from microswim.calibration.region.text import pack
from microswim.spec import presets
from microswim.spec.file import from_dict
from microswim.spec.toml import to_toml
from microswim.studio.spec_tables import canonical

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def page(browser, server):
    made = opened(browser, server)
    made.wait_for_selector("body[data-warm]", state="attached")
    yield made
    made.close()


def number(page, name):
    return float(page.get_attribute(f".answers [data-reading={name}]", "data-value"))


def shown_tables(page):
    return page.evaluate("() => studio.store.design.answer.tables")


def settled(page):
    """Wait until what is shown answers what is set."""
    for _ in range(600):
        idle, wanted, got = page.evaluate(
            "() => (d => [d.latest.idle, d.tables, d.answer.tables])(studio.store.design)"
        )
        if idle and (wanted == got or canonical(from_dict(wanted)) == got):
            return got
        page.wait_for_timeout(50)
    raise AssertionError("the page does not come to rest")


def take(page, what):
    page.click("#take")
    with page.expect_download() as download:
        page.click(what)
    with open(download.value.path(), "rb") as file:
        return file.read()


def test_it_opens_and_swims(page, tmp_path):
    assert number(page, "swimming_speed") == pytest.approx(
        ms.screw(ms.Swimmer.preset("tabak/helix").gait()).speed, rel=1e-6
    )
    before = page.evaluate("() => studio.actors()[0].pose.phase")
    page.wait_for_function("(p) => studio.actors()[0].pose.phase > p", arg=before)
    picture = page.screenshot(path=tmp_path / "studio.png")
    assert picture[:4] == b"\x89PNG"
    assert page.evaluate(COLOURS) > 40  # body, tail and grid on a dark ground, shaded
    assert page.complaints == []


# Distinct shades on the stage, coarsely.
COLOURS = """async () => {
  const bitmap = await createImageBitmap(await studio.picture());
  const canvas = new OffscreenCanvas(160, 90), g = canvas.getContext('2d');
  g.drawImage(bitmap, 0, 0, 160, 90);
  const d = g.getImageData(0, 0, 160, 90).data, seen = new Set();
  for (let i = 0; i < d.length; i += 4)
    seen.add((d[i] >> 3) * 1024 + (d[i + 1] >> 3) * 32 + (d[i + 2] >> 3));
  return seen.size;
}"""


def test_the_page_integrates_as_the_package_does(page):
    """Pose after 3.7 periods: the page's Runge-Kutta against the package's Lie-group method."""
    page.evaluate("() => { studio.view.paused = true; const a = studio.actors()[0]; a.restart(); "
                  "a.advance(3.7, studio.driver.drive, 4 * studio.driver.fastest); }")  # fmt: skip
    pose = page.evaluate("() => studio.actors()[0].pose")
    tables = page.evaluate("() => studio.store.design.answer.tables")
    path = ms.trajectory(from_dict(tables).gait(), [0.0, 3.7])
    assert pose["time"] == pytest.approx(3.7)
    assert np.allclose(pose["x"], path.position[-1], atol=1e-6)
    assert np.allclose(pose["q"], path.quaternion[-1], atol=1e-6)


def test_a_dragged_slider_moves_the_numbers_and_requests_do_not_pile_up(page):
    under_way, most, sent = set(), [0], [0]

    def begins(request):
        if request.url.endswith("/api/solve"):
            under_way.add(request)
            sent[0] += 1
            most[0] = max(most[0], len(under_way))

    page.on("request", begins)
    page.on("requestfinished", lambda r: under_way.discard(r))
    before = number(page, "swimming_speed")
    box = page.locator('input[type=range][data-field="tail.amplitude"]').bounding_box()
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + box["width"] / 2, y)
    page.mouse.down()
    for i in range(16):
        page.mouse.move(box["x"] + box["width"] * (0.5 + 0.02 * i), y)
    page.mouse.up()
    tables = settled(page)
    assert tables["tail"]["amplitude"] > 0.14
    after = number(page, "swimming_speed")
    assert after != before
    assert after == pytest.approx(ms.screw(from_dict(tables).gait()).speed, rel=1e-6)
    assert most[0] == 1
    assert 1 <= sent[0] <= 18
    page.click("#undo")
    assert settled(page)["tail"]["amplitude"] == 0.1


def test_undo_and_redo(page):
    first = settled(page)
    page.fill('input[aria-label="Amplitude, value"]', "0.14")
    page.keyboard.press("Enter")
    changed = settled(page)
    assert changed["tail"]["amplitude"] == 0.14
    page.click("#undo")
    assert settled(page) == first
    page.click("#redo")
    assert settled(page) == changed
    page.keyboard.press("Control+z")
    assert settled(page) == first


def test_a_click_on_the_map_moves_the_design_there(page):
    page.wait_for_function("() => studio.map.count > 0")
    box = page.locator("#map").bounding_box()
    page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.5 * box["height"])
    tables = settled(page)
    x, y = page.evaluate("() => [studio.map.answer.x, studio.map.answer.y]")
    assert tables["tail"]["amplitude"] == pytest.approx(x[0] + 0.75 * (x[-1] - x[0]), rel=0.03)
    assert tables["tail"]["waves"] == pytest.approx(y[0] + 0.5 * (y[-1] - y[0]), rel=0.03)
    assert number(page, "efficiency") == pytest.approx(
        from_dict(tables).gait().efficiency, rel=1e-6
    )
    page.click("#undo")
    settled(page)


def test_the_optimum_button_finds_better(page):
    before = number(page, "swimming_speed")
    page.click("#optimum")
    page.wait_for_selector(".notice:has-text('Best on this map')")
    settled(page)
    assert number(page, "swimming_speed") > before
    page.click("#undo")
    settled(page)


def test_the_judge_is_asked_and_the_surrogate_calibrated(page):
    page.click("#tab-judge")
    page.select_option("#level", "coarse")
    page.click("#ask-judge")
    page.wait_for_selector("#cancel-judge")
    page.wait_for_selector("#verdict")
    row = page.inner_text("[data-row=swimming_speed]")
    assert re.search(r"[+−]\d", row)
    reference = page.evaluate("() => studio.store.design.reference.answer.readings")
    assert abs(reference["forward_velocity"] - number(page, "forward_velocity")) > 1e-3
    page.click("#calibrate")
    page.wait_for_selector("#trust.good:has-text('calibrated at this design')")
    assert "efficiency" in page.inner_text("#missed")  # as plain as what agrees
    assert page.get_attribute("#missed", "class") in ("trust fair", "trust poor")
    settled(page)
    assert number(page, "forward_velocity") == pytest.approx(
        reference["forward_velocity"], rel=1e-6
    )
    page.keyboard.press("Control+z")
    settled(page)
    page.select_option("#presets", "tabak/helix-sbt")
    page.wait_for_selector("#verdict", state="detached")  # that was of another design
    page.select_option("#presets", "tabak/helix")
    page.wait_for_function("() => studio.store.design.name === 'tabak/helix'")
    page.click("#tab-map")


def test_the_flow_is_asked_and_drawn(page, tmp_path):
    """The button asks the boundary elements; what is drawn is the answer of its series."""
    page.click("#flow")
    page.wait_for_function("() => studio.flow.shown")
    assert page.inner_text("#flow") == "Flow"
    assert page.get_attribute("#flow", "aria-pressed") == "true"
    before = page.evaluate("() => studio.frames()")
    page.wait_for_function("(n) => studio.frames() > n + 1", arg=before)
    field, fastest = page.evaluate(FLOW)
    assert 0.3 < fastest / page.evaluate("() => studio.flow.answer.scale") < 10.0
    tail = page.evaluate("() => studio.store.design.answer.shape")
    assert fastest < 2 * np.pi * (tail["reach"] + tail["radius"])  # no faster than the tail
    assert field > 100  # points of the slice that move
    assert page.screenshot(path=tmp_path / "flow.png")[:4] == b"\x89PNG"
    page.fill('input[aria-label="Ramp, value"]', "0.2")
    page.keyboard.press("Enter")
    page.wait_for_function("() => !studio.flow.shown")  # it belonged to another design
    assert page.get_attribute("#flow", "aria-pressed") == "false"
    page.keyboard.press("Control+z")
    settled(page)


# How many points of the slice move, and how fast the fastest of them.
FLOW = """() => {
  const f = studio.flow.velocities, speeds = [];
  for (let i = 0; i < f.length; i += 3) speeds.push(Math.hypot(f[i], f[i + 1], f[i + 2]));
  return [speeds.filter((v) => v > 0).length, Math.max(...speeds)];
}"""


def test_a_wall_is_put_moved_judged_and_taken_away(page, tmp_path):
    reading = ".answers [data-reading=swimming_speed]"
    page.click("[data-field=bounds][data-value=wall]")
    page.wait_for_function("() => studio.store.design.answer.around?.kind === 'wall'")
    assert "nothing of the wall" in page.inner_text("#trust")
    page.wait_for_selector(reading + "[data-value=null]")  # no path beside what would turn with it
    page.evaluate("() => { const a = studio.actors()[0]; a.restart(); "
                  "a.advance(30, studio.driver.drive, studio.driver.fastest); }")  # fmt: skip
    pose = page.evaluate("() => studio.actors()[0].pose")
    assert (pose["x"], pose["q"]) == ([0, 0, 0], [1, 0, 0, 0])
    assert pose["phase"] > 6  # the tail turns, the swimmer stays where the answer holds
    assert "no path is followed" in page.inner_text("#remarks")
    page.fill('input[aria-label="Tilt, value"]', "10")
    page.keyboard.press("Enter")
    page.fill('input[aria-label="Distance, value"]', "0.3")
    page.keyboard.press("Enter")
    page.wait_for_selector("#problem:has-text('touches the wall')")
    page.fill('input[aria-label="Distance, value"]', "1.2")
    page.keyboard.press("Enter")
    page.wait_for_selector("#problem", state="hidden")
    tables = settled(page)
    wall = from_dict(tables).wall
    assert (wall.distance, wall.tilt) == pytest.approx((1.2, np.radians(10)))
    drawn = page.evaluate("() => studio.actors()[0].around.room({x: [0, 0, 0], q: [1, 0, 0, 0], "
                          "phase: 0, time: 0}, studio.store.design.answer.shape)")  # fmt: skip
    assert 0.3 < drawn < 0.7 + 1e-9  # the body's equator is 0.7 from the plane, the tail nearer
    spec = tomllib.loads(take(page, "#take-spec").decode())
    assert from_dict(spec).wall == wall
    assert page.screenshot(path=tmp_path / "wall.png")[:4] == b"\x89PNG"
    page.click("[data-field=bounds][data-value='']")
    page.wait_for_function("() => !studio.store.design.answer.around")
    page.wait_for_selector("#remarks", state="hidden")
    assert "wall" not in settled(page)


def test_it_stops_at_the_end_of_its_channel_and_starts_again(page, tmp_path):
    page.click("[data-field=bounds][data-value=channel]")
    page.wait_for_function("() => studio.store.design.answer.around?.kind === 'cylinder'")
    page.click("[data-field='channel.shape'][data-value=box]")
    page.wait_for_function("() => studio.store.design.answer.around?.kind === 'box'")
    settled(page)
    assert page.inner_text("#model-bem") == "Finite elements"
    assert page.screenshot(path=tmp_path / "channel.png")[:4] == b"\x89PNG"
    assert "the channel would turn" in page.inner_text("#remarks")
    page.click("[data-field='channel.shape'][data-value=cylinder]")  # which looks the same, turned
    page.wait_for_function("() => studio.store.design.answer.around?.kind === 'cylinder'")
    page.wait_for_function("() => !studio.store.design.answer.gait.one_pose")
    page.evaluate("() => { studio.view.paused = false; const a = studio.actors()[0]; a.restart(); "
                  "a.advance(30, studio.driver.drive, studio.driver.fastest); }")  # fmt: skip
    page.wait_for_selector(".notice:has-text('come to the wall')")
    assert page.evaluate("() => studio.view.paused")
    page.click("#play")
    page.wait_for_function("() => !studio.view.paused && studio.actors()[0].pose.time < 20")
    page.click("[data-field='channel.shape'][data-value=box]")
    page.wait_for_function("() => studio.store.design.answer.around?.kind === 'box'")
    page.click("#flow")  # boundary elements know tubes, no boxes
    page.wait_for_selector(".notice.error:has-text('channel.shape')")
    page.click("[data-field=bounds][data-value='']")
    page.wait_for_function("() => !studio.store.design.answer.around")
    settled(page)
    assert page.inner_text("#model-bem") == "Boundary elements"


@pytest.mark.slow
@pytest.mark.fem
@pytest.mark.parametrize("kind", ["wall", "channel"])
def test_the_judge_beside_a_wall_and_in_a_channel(page, tmp_path, kind):
    pytest.importorskip("ngsolve", reason="needs the extra fem")
    page.click(f"[data-field=bounds][data-value={kind}]")
    page.wait_for_function("() => studio.store.design.answer.around")
    tables = settled(page)
    page.click("#tab-judge")
    page.select_option("#level", "coarse")
    page.click("#ask-judge")
    page.wait_for_selector("#cancel-judge")
    page.wait_for_selector("#verdict")
    model = {"wall": "bem", "channel": "fem"}[kind]
    truth = from_dict(tables).gait(model, level="coarse")
    found = page.evaluate("() => studio.store.design.reference.answer.readings")
    assert found["forward_velocity"] == pytest.approx(-truth.mean_velocity[0], rel=1e-9)
    page.click("#calibrate")
    page.wait_for_selector("#trust.good:has-text('calibrated at this design')")
    settled(page)
    assert number(page, "forward_velocity") == pytest.approx(found["forward_velocity"], rel=1e-6)
    assert page.screenshot(path=tmp_path / f"{kind}.png")[:4] == b"\x89PNG"
    page.keyboard.press("Control+z")
    page.click("[data-field=bounds][data-value='']")
    page.wait_for_function("() => !studio.store.design.answer.around")
    settled(page)
    page.click("#tab-map")


def test_a_calibrated_region_shows_its_error_in_colour(page):
    region = {"tail.amplitude": (0.06, 0.12)}
    swimmer = ms.Swimmer.preset("tabak/helix")
    made = ms.calibrate_region(swimmer, region, "rft", solves=12, workers=0).swimmer
    spec = tomllib.loads(presets.read("tabak/helix")) | {"region": {"data": pack(made.region)}}
    del spec["coefficients"]  # the region takes their place
    text = to_toml(spec, "calibrated").encode()
    page.set_input_files(
        "#file", files=[{"name": "calibrated.toml", "mimeType": "text/plain", "buffer": text}]
    )
    page.wait_for_function("() => studio.store.design.name === 'calibrated'")
    error = ms.expected_error(made, made.gait())["us"]
    assert page.get_attribute("#trust", "class") == "trust good"
    shown = float(re.search(r"error ([\d.]+) %", page.inner_text("#trust")).group(1))
    assert shown == pytest.approx(100 * error, rel=0.06)
    page.wait_for_selector("#inside")
    page.fill('input[aria-label="Amplitude, value"]', "0.19")
    page.keyboard.press("Enter")
    page.wait_for_selector("#trust.fair:has-text('outside its calibrated region')")
    page.select_option("#presets", "tabak/helix")
    page.wait_for_function("() => studio.store.design.name === 'tabak/helix'")
    settled(page)


def test_a_mistake_is_a_notice_and_the_page_lives_on(page):
    page.fill('input[aria-label="Filament radius, value"]', "9")
    page.keyboard.press("Enter")
    page.wait_for_selector("#problem:has-text('touches itself')")
    page.fill('input[aria-label="Filament radius, value"]', "0.05")
    page.keyboard.press("Enter")
    page.wait_for_selector("#problem", state="hidden")
    settled(page)
    bad = {
        "name": "bad.toml",
        "mimeType": "text/plain",
        "buffer": b'[tail]\nkind = "custom"\nshape = "os:getcwd"',
    }
    page.set_input_files("#file", files=[bad])
    page.wait_for_selector(".notice.error:has-text('no code')")
    for name, text, word in (
        ("torn.toml", b"[tail", "not valid TOML"),
        ("huge.toml", b"# " + b"x" * 600_000, "256 KiB"),
        ("bytes.toml", b"\xff\xfe\x00\x01", "not valid TOML"),
    ):
        page.set_input_files("#file", files=[{**bad, "name": name, "buffer": text}])
        page.wait_for_selector(f".notice.error:has-text('{word}')")
    assert page.evaluate("() => studio.store.design.problem") is None


def test_a_value_may_bring_its_unit_and_a_refused_design_is_greyed(page):
    page.select_option("#presets", "goto/C")
    page.wait_for_function("() => studio.store.design.name === 'goto/C'")
    page.wait_for_selector(".map .legend")  # of its wavelength, where the one before has waves
    settled(page)
    box = 'input[aria-label="Length, value"]'
    page.fill(box, "0.006 mm")
    page.keyboard.press("Enter")
    page.wait_for_function("() => studio.store.design.tables.tail.length === '6.0 um'")
    assert settled(page)["tail"]["length"] == "6.0 um"
    assert page.locator("#backwards").count() == 0
    page.fill('input[aria-label="Frequency, value"]', "-70")
    page.keyboard.press("Enter")
    page.wait_for_selector("#backwards:has-text('tail first')")
    page.click("#undo")
    settled(page)
    page.fill(box, "6 furlongs")
    page.keyboard.press("Enter")
    page.wait_for_selector(".notice.error:has-text('known unit')")
    assert shown_tables(page)["tail"]["length"] == "6.0 um"
    before = page.evaluate("() => document.querySelector('[data-field=\"tail.length\"]').offsetTop")
    page.fill('input[aria-label="Filament radius, value"]', "9")
    page.keyboard.press("Enter")
    page.wait_for_selector("#problem:visible")
    assert page.evaluate("() => document.body.classList.contains('refused')")
    after = page.evaluate("() => document.querySelector('[data-field=\"tail.length\"]').offsetTop")
    assert after == before  # nothing moves under the hand
    page.click("#undo")
    page.wait_for_selector("body:not(.refused)")
    settled(page)


def test_a_second_design_keeps_the_ranges_of_the_first(page):
    ranges = "() => [...studio.store.design.ranges].sort()"
    page.fill('input[aria-label="Length, value"]', "9")
    page.keyboard.press("Enter")
    settled(page)
    first = page.evaluate(ranges)
    page.click("#compare")
    assert page.evaluate(ranges) == first
    page.click("#compare")
    page.select_option("#presets", "tabak/helix")
    page.wait_for_function("() => studio.store.design.name === 'tabak/helix'")
    settled(page)


def test_each_design_has_a_map_over_two_of_its_own_numbers(page):
    for name in ("cells/beside-a-wall", "cells/sperm", "goto/A"):
        page.select_option("#presets", name)
        page.wait_for_function(f"() => studio.store.design.name === '{name}'")
        x, y = page.evaluate("() => [studio.map.field.x, studio.map.field.y]")
        assert x != y, name
    assert (x, y) == ("tail.amplitude", "tail.wavelength")


def test_what_has_no_units_is_not_put_beside_what_has(page):
    page.click("#compare")
    page.click("#tab-drive")
    page.click("#drive-field")
    page.evaluate("() => { studio.view.paused = true; }")
    page.select_option("#presets", "tabak/helix")
    page.wait_for_function("() => studio.store.design.name === 'tabak/helix'")
    assert page.evaluate("() => studio.store.designs.length") == 1
    assert page.text_content("#driven-speed") == "–"  # not that of the one before
    page.evaluate("() => { studio.view.paused = false; }")
    page.click("#tab-map")
    settled(page)


def test_what_has_no_magnet_begins_with_its_motor(page):
    page.click("#tab-drive")
    page.select_option("#presets", "shapes/magnet")
    page.wait_for_function("() => studio.store.design.answer.magnet.moment !== null")
    page.click("#drive-field")
    page.select_option("#presets", "tabak/helix")
    page.wait_for_function("() => studio.store.design.name === 'tabak/helix'")
    assert page.evaluate("() => studio.driver.magnetic") is False
    assert page.get_attribute("#drive-motor", "aria-pressed") == "true"
    page.click("#tab-map")
    settled(page)


def test_a_rotating_field_and_its_step_out(page):
    page.click("#tab-drive")
    page.click("#drive-field")
    run = """(share) => { const { driver } = studio, a = studio.actors()[0];
      driver.restart(); a.restart(); driver.set('share', share);
      for (let i = 0; i < 240; i++) {
        a.advance(0.06, driver.drive, driver.fastest); driver.watch(a.pose);
      }
      return [driver.measured, driver.rate, driver.stepOut, a.pose.x[0]]; }"""
    rate, field, _, x = page.evaluate(run, 0.6)
    assert rate == pytest.approx(field, rel=0.02)
    assert x < -0.1  # ahead, as the heading says
    assert re.match("Synchronous|Wobbling", page.inner_text("#step"))
    rate, field, top, _ = page.evaluate(run, 1.5)
    assert rate == pytest.approx(field - np.sqrt(field**2 - top**2), rel=0.1)  # over few beats
    assert "Stepped out" in page.inner_text("#step")
    page.evaluate("() => document.activeElement.blur()")
    for key in ("ArrowLeft", "ArrowUp", "ArrowUp", "+"):
        page.keyboard.press(key)
    found = page.evaluate(
        "() => [studio.driver.azimuth, studio.driver.elevation, studio.driver.share]"
    )
    assert found == pytest.approx([-5, 10, 1.55])
    page.click("#drive-motor")
    page.click("#tab-map")


TILTED = {
    "motion.free": "all",
    "magnet": {"moment": [0.5, float(np.sqrt(0.75)), 0.0]},
    "field": {"kind": "rotating", "strength": 60.0, "frequency": 0.0025},
}


@pytest.fixture(scope="module")
def another(browser, server):
    """A page that goes from robot to robot in its field."""
    made = opened(browser, server)
    made.click("#tab-drive")
    yield made
    made.close()


def driven_by_its_field(page, robot, known, folder):
    """Put a robot in its field on the page, paused; `known` of the magnet has come."""
    spec = folder / f"{folder.name}.toml"
    spec.write_text(robot.to_toml())
    page.set_input_files("#file", spec)
    page.wait_for_function("(name) => studio.store.design.name === name", arg=folder.name)
    page.wait_for_function(f"() => studio.store.design.answer.magnet.{known} !== null")
    page.click("#drive-field")
    page.evaluate("() => { studio.view.paused = true; }")


@pytest.mark.parametrize("frequency", [0.0008, 0.0025, 0.013])
def test_the_magnet_and_the_field_of_a_spec_drive_it_and_its_regime_is_told(
    another, frequency, tmp_path
):
    """The page steps in time; `ms.regimes` finds the states of steady turning."""
    robot = ms.Swimmer.preset("tabak/helix-constant", TILTED)
    robot = robot.with_({"field.frequency": frequency})
    driven_by_its_field(another, robot, "moment", tmp_path)
    rate, strength, leans = another.evaluate(
        """(T) => { const { driver } = studio, a = studio.actors()[0];
        driver.restart(); a.restart();
        for (let i = 0; i < 16 * 60; i++) {
          a.advance(T / 16, driver.drive, driver.fastest); driver.watch(a.pose);
        }
        return [driver.rate, driver.B, driver.leans]; }""",
        1.0 / frequency,
    )
    assert (rate, strength) == pytest.approx((2.0 * np.pi * frequency, 60.0))
    told = ms.regimes(robot, [frequency], gait=robot.gait())
    angles = [told.precession_angle[0], *(state[0] for state in told.others[0])]
    assert min(abs(np.degrees(a) - np.mean(leans)) for a in angles) < 1.0
    assert another.inner_text("#step").lower().startswith(told.regime[0])
    assert all(another.is_visible(f".arrows .{name}") for name in ("field", "moment"))
    another.screenshot(path=tmp_path / "field.png")


def test_a_body_that_is_long_across_s_steps_out_as_it_turns_about_its_long_axis(another, tmp_path):
    """At ``m B`` over the drag of turning about r; it turns a fourth as readily about s."""
    robot = ms.Swimmer(
        body=ms.Ellipsoid(semi_axes=(0.4, 0.3, 1.2)),
        tail=ms.NoTail(),
        fluid=ms.Fluid(viscosity=1.0),
        motion=ms.Motion(free="all"),
        magnet=ms.Magnet(moment=(0.0, 2.0, 0.0)),
        field=ms.RotatingField(strength=3.0, frequency=0.3),
    )
    driven_by_its_field(another, robot, "moment", tmp_path)
    about_r = np.linalg.inv(robot.gait().resistance(0.0))[5, 5]
    found = another.evaluate("() => [studio.driver.stepOut, studio.driver.rate]")
    assert found == pytest.approx([2.0 * 3.0 * about_r, 2.0 * np.pi * 0.3], rel=1e-6)


def test_a_field_that_depends_on_place_drives_it_as_a_path_has_it(another, tmp_path):
    """Torque and force of a magnet's field, asked anew as the robot comes near it."""
    robot = ms.Swimmer(
        body=ms.Sphere(radius=5e-4),
        tail=ms.HelicalTail(length=2e-3, amplitude=2e-4, waves=2, radius=1e-4, frequency=0.0),
        fluid=ms.Fluid(viscosity=0.34),
        motion=ms.Motion(free="all"),
        magnet=ms.Magnet(moment=(1e-6, 3e-6, 0.0)),
        field=ms.DipoleField(moment=(0, 8, 0), position=(0.05, 0, 0), velocity=(-0.01, 0, 0)),
        units="SI",
    )
    driven_by_its_field(another, robot, "own", tmp_path)
    asked, x = another.evaluate(
        """async () => { const { driver } = studio, a = studio.actors()[0];
        driver.restart(); a.restart();
        let asked = 0;
        for (let i = 0; i < 400; i++) {
          while (driver.waits(a.answer, a.pose)) {
            asked += 1; await new Promise((r) => setTimeout(r, 20));
          }
          a.advance(5e-3, driver.driveOf(a.answer), driver.fastest); driver.watch(a.pose);
        }
        return [asked, a.pose.x]; }"""
    )
    gait = (
        robot.gait("atlas")
        if another.evaluate("() => studio.store.design.answer.gait.model") == "atlas"
        else robot.gait()
    )
    found = ms.path(robot, 2.0, gait=gait)
    end = found.position.values[-1]
    assert asked  # the field goes on being known
    assert np.allclose(x, end, atol=5e-4 * np.linalg.norm(end))
    assert "mT here" in another.inner_text("#step")
    another.screenshot(path=tmp_path / "placed.png")


def test_what_one_takes_away(page, browser, tmp_path):
    page.evaluate("() => { const a = studio.actors()[0]; a.restart(); a.begin(); "
                  "a.advance(2, studio.driver.drive, studio.driver.fastest); }")  # fmt: skip
    assert take(page, "#take-png")[:4] == b"\x89PNG"
    spec = tomllib.loads(take(page, "#take-spec").decode())
    assert from_dict(spec).numbers == from_dict(shown_tables(page)).numbers
    rows = list(csv.DictReader(io.StringIO(take(page, "#take-csv").decode())))
    times = [float(r["time"]) for r in rows]
    path = ms.trajectory(from_dict(spec).gait(), [0.0, *times])
    found = np.array([[float(r[k]) for k in "xyz"] for r in rows])
    assert np.allclose(found, path.position[1:], atol=1e-4)
    html = tmp_path / "snapshot.html"
    html.write_bytes(take(page, "#take-html"))
    asked = []
    alone = calm(browser, offline=True)
    alone.on("request", lambda r: asked.append(r.url))
    alone.goto(html.as_uri(), wait_until="commit")
    alone.wait_for_selector("body[data-ready]")
    assert number(alone, "swimming_speed") == number(page, "swimming_speed")
    alone.wait_for_function("() => studio.actors()[0].pose.phase > 0.1")
    assert alone.evaluate(COLOURS) > 40
    boxes = [alone.locator(f"#map-{s}").bounding_box() for s in ("output", "x", "y")]
    assert min(b["width"] for b in boxes) > 100  # room for the names of the map's axes
    assert boxes[1]["y"] == boxes[2]["y"] > boxes[0]["y"]
    alone.screenshot(path=tmp_path / "snapshot.png")
    assert [u for u in asked if not u.startswith(("file:", "data:", "blob:"))] == []
    alone.close()


def test_two_designs_side_by_side_and_two_tabs_apart(page, browser, server):
    page.click("#compare")
    page.select_option('[data-field="tail.kind"]', "plane_wave")
    page.wait_for_function("() => studio.store.design.answer.shape.kind === 'plane_wave'")
    cells = page.locator(".answers [data-reading=swimming_speed]")
    values = [float(cells.nth(i).get_attribute("data-value")) for i in range(2)]
    assert len(set(values)) == 2
    assert page.evaluate("() => studio.actors().length") == 2
    other = opened(browser, server)
    assert json.dumps(shown_tables(other)) != json.dumps(shown_tables(page))
    assert other.evaluate("() => studio.store.designs.length") == 1
    other.close()


def test_a_field_that_the_server_tells_is_on_the_page(browser, server):
    """The page knows no field of its own: a made-up one gets its label, unit and choices."""

    def with_dye(route):
        start = route.fetch().json()
        told = {"help": "made up", "entries": [], "usual": [0.0, 5.0], "choices": []}
        start["words"]["fields"] |= {
            "fluid.dye": {"kind": "quantity", "label": "Dye", **told},
            "fluid.hue": {**told, "kind": "word", "label": "Hue", "choices": [["r", "Red"]]},
        }
        start["answer"]["tables"]["fluid"] |= {"dye": "2 kg/m^3", "hue": "r"}
        route.fulfill(json=start)

    fresh = calm(browser)
    fresh.route("**/api/start", with_dye)
    fresh.goto(server, wait_until="commit")
    fresh.wait_for_selector("body[data-ready]")
    slider = fresh.locator('input[type=range][data-field="fluid.dye"]')
    assert slider.get_attribute("aria-label") == "Dye"
    assert fresh.input_value('input[aria-label="Dye, value"]') == "2"
    assert float(slider.input_value()) == pytest.approx(400, abs=1)  # of 1000, from 0 to 5
    assert fresh.text_content('[data-field="fluid.hue"][data-value="r"]') == "Red"
    assert fresh.locator("#map-x option", has_text="fluid: dye").count() == 1
    fresh.close()


def test_nothing_went_wrong_on_the_way(page):
    """But for the refusals that were provoked."""
    assert [c for c in page.complaints if "422" not in c] == []
