"""The page for those who see little or use no mouse: axe-core over every state, keys, order."""

from pathlib import Path

import axe_playwright_python
import pytest
from chromium import opened
from test_studio_dropped import spots

pytestmark = pytest.mark.browser
AXE = Path(axe_playwright_python.__file__).with_name("axe.min.js").read_text(encoding="utf-8")
SIZES = {"desktop": (1280, 800), "phone": (390, 844)}
FAULTS = """async () => (await axe.run(document, { resultTypes: ["violations"] })).violations
  .map((v) => [v.impact, v.id, ...v.nodes.map((n) => n.target.join(" "))])"""
FOCUSED = """() => { const e = document.activeElement, r = e.getBoundingClientRect();
  return [e.id || e.ariaLabel || e.textContent || e.tagName, r.width * r.height,
    [...document.querySelectorAll("*")].indexOf(e)]; }"""


@pytest.fixture(scope="module", params=SIZES)
def page(request, browser, server):
    width, height = SIZES[request.param]
    phone = request.param == "phone"
    size = {"width": width, "height": height}
    made = opened(browser, server, viewport=size, has_touch=phone, is_mobile=phone)
    made.evaluate(AXE)
    made.evaluate("() => { studio.view.paused = true; }")
    made.is_phone = phone
    yield made
    assert [c for c in made.complaints if "422" not in c] == []  # but for what is asked back
    made.close()


@pytest.mark.slow
def test_axe_finds_no_fault_in_any_panel_or_dialog(page):
    panels = ["map", "judge", "path", "drive"]
    heads = "#sheet-{}" if page.is_phone else "#tab-{}"
    for name in [*panels, *(["design", "numbers"] if page.is_phone else [])]:
        page.click(heads.format(name))
        assert page.evaluate(FAULTS) == [], name
    page.click(heads.format("drive"))
    page.click("#drive-field")
    assert page.evaluate(FAULTS) == [], "field"
    page.click("#drive-motor")
    page.keyboard.press("Escape")
    if page.is_phone:
        page.click("#more")
    page.click("#take")
    assert page.evaluate(FAULTS) == [], "take away"
    page.click("#take")
    films = [{"name": "spots.csv", "mimeType": "text/csv", "buffer": spots()}]
    page.set_input_files("#file", files=films)
    page.wait_for_selector("#drop-fps")
    assert page.evaluate(FAULTS) == [], "how long a frame is"
    page.fill("#drop-fps", "25")
    page.click("#card-do")
    page.wait_for_selector("#tracks")
    assert page.evaluate(FAULTS) == [], "tracks"
    page.click("#card-close")
    for _ in range(2):  # compare, and end it; on a phone the menu folds each time
        if page.is_phone:
            page.click("#more")
        page.click("#compare")
        assert page.evaluate(FAULTS) == [], "compare"


def test_tab_goes_over_the_page_in_the_order_in_which_it_is_read(page):
    """Every stop is in sight and further down the page than the one before it."""
    page.focus("#presets")  # the first of all, wherever another test has left off
    places = []
    for _ in range(14):
        page.keyboard.press("Tab")
        name, area, place = page.evaluate(FOCUSED)
        assert area > 0, name
        places.append(place)
    assert places == sorted(places)
    assert len(set(places)) == len(places)


def test_keys_move_the_design_over_the_map(page):
    if page.is_phone:
        page.click("#sheet-map")
    else:
        page.click("#tab-map")
    page.wait_for_function("() => studio.map.answer")
    before = page.evaluate("() => studio.store.design.tables.tail.amplitude")
    page.focus("#map")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    after = page.evaluate("() => studio.store.design.tables.tail.amplitude")
    x = page.evaluate("() => studio.map.answer.x")
    assert after - before == pytest.approx(3 * (x[-1] - x[0]) / 50, rel=0.02)
    assert page.evaluate("() => studio.store.design.past.length") > 0  # and can be undone
