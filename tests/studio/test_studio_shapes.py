"""In Chromium: bodies and tails as what they are, files dropped, links, pictures taken away."""

import io
import struct

import chromium
import numpy as np
import pytest
from test_studio_dropped import beat, spots

import microswim as ms
from microswim.output.io.stl import write_stl

AROUND = 15  # points of a ring of the page's tube, the first twice
RINGS = """() => {
  const actor = studio.actors()[0];
  const mesh = actor.sqr.children[0].children[0];
  return [[...mesh.geometry.attributes.position.array], actor.pose.phase, mesh.rotation.x];
}"""
THINNER = """() => {
  const tables = structuredClone(studio.store.design.tables);
  tables.tail.radius_end = 0.02;
  return studio.store.take("thinner", tables);
}"""
LENGTH = "() => studio.actors()[0].sqr.children.length"


@pytest.fixture(scope="module")
def page(browser, server):
    made = chromium.opened(browser, server, device_scale_factor=1)  # pictures are looked at
    yield made
    made.close()


def put(page, name):
    page.evaluate("() => { window.former = studio.store.design.answer; }")
    page.select_option("#presets", value=name)
    page.wait_for_function(f"() => studio.store.design.name === '{name}'")
    page.wait_for_function(
        "() => studio.store.design.answer !== window.former && studio.store.design.latest.idle"
    )


def rings(page):
    """Middle of each ring of the tail's tube in the frame of the joint, and the phase."""
    points, phase, turn = page.evaluate(RINGS)
    points = np.reshape(points, (-1, AROUND, 3))[:, :-1]
    c, s = np.cos(turn), np.sin(turn)
    turned = points @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T
    return turned.mean(axis=1), phase


@pytest.mark.parametrize("name", ["shapes/ribbon", "soft/heaving", "cells/sperm"])
def test_the_tail_on_the_stage_is_that_of_the_package(page, name):
    put(page, name)
    page.evaluate("() => { studio.view.paused = true; }")
    middle, phase = rings(page)
    tail = ms.Swimmer.preset(name).settled.tail
    on_tail = middle[:-5]  # the last five are the round tip
    s = np.linspace(0.0, float(tail.apparent_length), len(on_tail))
    true = tail.centreline(s, phase)[0]
    assert np.abs(on_tail - true).max() < 2e-3 * float(tail.apparent_length)
    page.evaluate("() => { studio.view.paused = false; }")


def test_a_filament_that_tapers_is_drawn_thinner_to_its_tip(page):
    put(page, "tabak/helix-sbt")
    page.evaluate(THINNER)
    page.wait_for_function("() => studio.store.design.name === 'thinner'")
    page.wait_for_function("() => studio.store.design.latest.idle")
    points = np.reshape(page.evaluate(RINGS)[0], (-1, AROUND, 3))[:-5, :-1]
    radius = np.linalg.norm(points - points.mean(axis=1, keepdims=True), axis=-1).mean(axis=1)
    tail = ms.Swimmer.preset("tabak/helix-sbt").with_({"tail.radius_end": 0.02}).tail
    s = np.linspace(0.0, tail.apparent_length, len(radius))
    assert radius == pytest.approx(float(tail.radius) * tail.narrowing(s), rel=0.02)
    assert page.get_by_label("Radius at the tip, value").count() == 1


def test_a_body_alone_has_no_tail_on_the_stage_and_no_map(page):
    put(page, "shapes/rod")
    assert page.evaluate(LENGTH) == 0
    assert page.locator("#map").is_hidden()
    assert "body alone" in page.inner_text("#trust")


def test_another_body_and_another_tail_are_one_choice_away(page):
    put(page, "tabak/helix-constant")
    for field, word, key in (("body.shape", "capsule", "body"), ("tail.kind", "elastic", "kind")):
        page.select_option(f'select[data-field="{field}"]', word)
        page.wait_for_function(f"() => studio.store.design.answer.shape.{key} === '{word}'")
    assert page.evaluate("() => studio.store.design.answer.gait.model") == "elastic"


def dropped(page, tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    page.set_input_files("#file", path)


def test_a_surface_dropped_is_the_robot(page, tmp_path):
    put(page, "tabak/helix-sbt")
    robot = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0))
    content = write_stl(tmp_path / "x.stl", robot, fineness=0.5).read_bytes()
    held = []
    page.route("**/api/solve", lambda route: held.append(route))
    dropped(page, tmp_path, "ball.stl", content)
    page.click("#card-do")
    page.wait_for_selector("dialog .busy")  # while it is solved no other design can be chosen
    page.click("#card-close")
    page.wait_for_selector("dialog", state="detached")
    assert page.evaluate("() => studio.store.design.name") == "tabak/helix-sbt"
    assert len(held) == 1
    page.unroute("**/api/solve")
    dropped(page, tmp_path, "ball.stl", content)
    page.click("#card-do")
    page.wait_for_function("() => studio.store.design.name === 'ball'")
    page.wait_for_selector("dialog", state="detached")
    assert page.evaluate("() => studio.store.design.answer.shape.mesh.faces.length") > 1000
    page.click("#undo")
    page.wait_for_function("() => studio.store.design.answer.shape.body === 'sphere'")


def test_a_beat_and_tracks_dropped_ask_for_what_they_do_not_say(page, tmp_path):
    dropped(page, tmp_path, "cells.csv", spots())
    page.fill("#drop-fps", "25")
    page.click("#card-do")
    page.wait_for_selector("#tracks tbody tr:nth-child(2)")
    assert "±" in page.inner_text("#tracks")
    page.click("#card-close")
    dropped(page, tmp_path, "beat.csv", beat())
    page.fill("#drop-fps", "250")
    page.click("#card-do")
    page.wait_for_function("() => studio.store.design.name === 'beat'")
    assert page.evaluate("() => studio.store.design.answer.shape.kind") == "waveform"


def test_a_number_with_an_exponent_is_seen_whole(page):
    """2.99e-15 that reads 2.99e-1 is another number."""
    put(page, "soft/heaving")
    page.focus("input[type=range][data-field='tail.bending']")
    page.keyboard.press("ArrowLeft")
    page.wait_for_function("() => studio.store.design.answer.tables.tail.bending.length > 12")
    cut = "(all) => all.filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.value)"
    assert page.eval_on_selector_all(".row .number", cut) == []


def test_a_link_opens_the_same_designs(page, browser, server):
    put(page, "soft/heaving")
    page.click("#compare")
    page.wait_for_function("() => location.hash.length > 20 && studio.store.designs.length === 2")
    page.wait_for_timeout(500)
    other = chromium.opened(browser, page.url)
    tables = "() => studio.store.designs.map((d) => [d.name, d.answer.tables])"
    assert other.evaluate(tables) == page.evaluate(tables)
    other.close()
    page.click("#compare")
    broken = chromium.opened(browser, f"{server}#d=nonsense")
    assert "holds no design" in broken.inner_text("#notices")
    broken.close()


def test_each_of_two_designs_says_how_sure_it_is(page):
    put(page, "tabak/plane_wave")
    page.click("#compare")
    lines = page.locator(".answers .trust").all_inner_texts()
    assert [line[:2] for line in lines] == ["A:", "B:"]
    page.click("#compare")
    page.click("[role=tablist] >> text=Drive")
    page.click("#drive-field")
    assert page.inner_text("#drive-trust .trust")
    page.click("#compare")
    assert page.inner_text(".drive .caption").startswith("B: ")
    page.click("#compare")
    page.click("#drive-motor")


def test_the_atlas_answers_in_place_of_a_law_at_one_click(page):
    put(page, "tabak/helix")
    assert "55 %" in page.inner_text("#trust")
    page.click("#by-atlas")
    page.wait_for_selector("#trust.good:has-text('Atlas, inside its range')")
    assert page.locator("#by-atlas").count() == 0
    law = page.locator('[data-field="coefficients.law"]')
    assert law.evaluate("e => e.selectedOptions[0].textContent") == "As it comes"
    page.click("#undo")
    page.wait_for_selector("#by-atlas")
    assert law.input_value() == "lighthill"


def test_a_picture_has_its_scale_and_what_it_shows(page, tmp_path):
    put(page, "shapes/capsule")
    page.click("#take")
    with page.expect_download() as taken:
        page.click("#take-png")
    png = (tmp_path / "p.png").resolve()
    taken.value.save_as(png)
    from matplotlib.image import imread

    data = png.read_bytes()
    size = struct.unpack(">II", data[16:24])
    image = imread(io.BytesIO(data))[..., :3]
    assert image.shape[:2] == size[::-1]
    height, width = image.shape[:2]
    foot = image[int(0.94 * height) :, int(0.4 * width) : int(0.6 * width)]
    head = image[: int(0.08 * height), : int(0.4 * width)]
    assert (foot.min(axis=-1) > 0.6).sum() > 60  # the bar and its length
    assert (head.min(axis=-1) > 0.6).sum() > 100  # the name and the speed


def test_nothing_went_wrong_on_the_way(page):
    unexpected = [c for c in page.complaints if "422" not in c]
    assert unexpected == []
