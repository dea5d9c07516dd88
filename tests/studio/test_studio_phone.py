"""The page on a phone, touched with a finger: the scene first, sheets one at a time, no overlap."""

import pytest
from chromium import opened, touch

import microswim as ms

pytestmark = pytest.mark.browser
SIZES = {"small": (360, 640), "phone": (390, 844), "lying": (844, 390), "tablet": (768, 1024)}
SHEETS = {
    "design": ".panel.left",
    **dict.fromkeys(("numbers", "map", "judge", "path", "drive"), ".panel.right"),
}
#: What can be touched and sticks out of the screen, or is too small for a finger (buttons: 32 px).
ASTRAY = """() => [...document.querySelectorAll("button, select, summary, input")].filter((e) => {
  const r = e.getBoundingClientRect();
  if (!r.width || !e.checkVisibility()) return false;
  const panel = e.closest(".panel, .actions.open");
  const across = r.left < -1 || r.right > innerWidth + 1;
  const lost = across || (!panel && (r.top < -1 || r.bottom > innerHeight + 1));
  return lost || (e.tagName === "BUTTON" && r.height < 32);
}).map((e) => e.id || e.className || e.textContent)"""

#: Distance of the camera from what it looks at.
BACKWARDS = "document.querySelector('#glance').textContent.includes('tail first')"
FAR = "() => studio.stage.camera.position.distanceTo(studio.stage.controls.target)"


@pytest.fixture(scope="module", params=SIZES)
def phone(request, browser, server):
    width, height = SIZES[request.param]
    size = {"width": width, "height": height}
    page = opened(browser, server, viewport=size, has_touch=True, is_mobile=True)
    page.wait_for_selector("body[data-warm]", state="attached")
    yield page
    assert page.complaints == []
    page.close()


def box(page, selector):
    found = page.locator(selector).bounding_box()
    return found["x"], found["y"], found["x"] + found["width"], found["y"] + found["height"]


def spread(page, x, y):
    """Two fingers on the scene, drawn apart to twice their distance."""
    browser = page.context.new_cdp_session(page)
    for event, apart in (("Start", 40), ("Move", 60), ("Move", 80)):
        points = [{"x": x + side * apart, "y": y, "id": side} for side in (0, 1)]
        browser.send("Input.dispatchTouchEvent", {"type": f"touch{event}", "touchPoints": points})
    browser.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    browser.detach()


def apart(a, b):
    return a[2] <= b[0] + 1 or b[2] <= a[0] + 1 or a[3] <= b[1] + 1 or b[3] <= a[1] + 1


def test_the_scene_comes_first_and_the_number_with_its_trust_is_in_sight(phone):
    assert not any(phone.is_visible(panel) for panel in (".panel.left", ".panel.right"))
    n = phone.text_content(".figure span")
    assert phone.is_visible("#glance")
    assert n in phone.text_content("#glance b")
    assert "swimming speed" in phone.text_content("#glance")
    assert phone.text_content("#glance .trust") == phone.text_content("#trust")
    assert phone.evaluate(ASTRAY) == []


@pytest.mark.parametrize("sheet", SHEETS)
def test_each_sheet_rises_alone_over_nothing_that_is_needed(phone, sheet, tmp_path):
    touch(phone, f"#sheet-{sheet}")
    panels = [p for p in (".panel.left", ".panel.right") if phone.is_visible(p)]
    assert panels == [SHEETS[sheet]]
    assert phone.get_attribute(f"#sheet-{sheet}", "aria-pressed") == "true"
    for other in (".dock", "#glance", "header"):
        assert apart(box(phone, panels[0]), box(phone, other)), other
    assert phone.evaluate(ASTRAY) == []
    assert phone.evaluate("document.documentElement.scrollWidth") <= phone.viewport_size["width"]
    assert len(phone.screenshot(path=tmp_path / f"{sheet}.png")) > 10_000
    touch(phone, f"#sheet-{sheet}")
    assert not phone.is_visible(panels[0])


def test_a_thumb_moves_a_slider_and_the_number_follows(phone):
    before = phone.text_content("#glance b")
    touch(phone, "#sheet-design")
    x0, y0, x1, y1 = box(phone, '[data-field="tail.amplitude"]')
    phone.locator('[data-field="tail.amplitude"]').scroll_into_view_if_needed()
    x0, y0, x1, y1 = box(phone, '[data-field="tail.amplitude"]')
    phone.touchscreen.tap(x0 + 0.8 * (x1 - x0), 0.5 * (y0 + y1))
    phone.wait_for_function(
        "n => document.querySelector('#glance b').textContent !== n", arg=before
    )
    touch(phone, "#sheet-design")


def test_what_grows_stays_in_the_picture_and_says_which_way_it_swims(phone):
    touch(phone, "#sheet-design")
    before = phone.evaluate(FAR)
    for length, times in (("4", 1.39), ("2", 1.0)):
        phone.fill('input[aria-label="Length, value"]', length)
        phone.keyboard.press("Enter")
        grown = f"([t, far]) => Math.abs(({FAR})() / far - t) < 0.1"
        phone.wait_for_function(grown, arg=[times, before])
    for rate, far in (("-1", True), ("1", False)):
        phone.fill('input[aria-label="Frequency, value"]', rate)
        phone.keyboard.press("Enter")
        phone.wait_for_function(f"(far) => {BACKWARDS} === far", arg=far)
    touch(phone, "#sheet-design")


def test_a_touch_of_the_scene_lowers_the_sheet_and_two_fingers_come_nearer(phone):
    touch(phone, "#sheet-numbers")
    x0, _, _, y1 = box(phone, "#glance")
    phone.touchscreen.tap(x0 + 5, y1 + 30)
    phone.wait_for_selector(".panel.right", state="hidden")
    before = phone.evaluate(FAR)
    spread(phone, x0 + 100, y1 + 60)
    phone.wait_for_function(f"before => ({FAR})() < 0.6 * before", arg=before)
    assert phone.evaluate("visualViewport.scale") == 1  # the scene came nearer, not the page


def test_the_header_folds_and_all_of_it_is_reached(phone):
    assert not phone.is_visible("#compare")
    touch(phone, "#more")
    for name in ("#undo", "#redo", "#compare", "#take"):
        assert phone.is_visible(name)
    touch(phone, "#take")
    for name in ("#take-png", "#take-link"):
        phone.locator(name).scroll_into_view_if_needed()
        assert phone.is_visible(name)
    assert phone.evaluate(ASTRAY) == []
    phone.keyboard.press("Escape")
    assert not phone.is_visible("#compare")
    touch(phone, "#more")
    touch(phone, "#compare")
    assert not phone.is_visible("#compare")  # nor does it lie over the two numbers
    assert phone.evaluate("() => studio.store.designs.length") == 2
    assert phone.locator("#glance .trust").count() == phone.locator("#glance b").count() == 2
    touch(phone, "#arrows")
    assert apart(box(phone, "#glance"), box(phone, ".arrows"))  # two lines of numbers
    touch(phone, "#arrows")
    touch(phone, "#more")
    touch(phone, "#compare")


def test_what_a_field_drives_is_in_sight_with_its_trust(phone):
    motor = phone.text_content("#glance b")
    touch(phone, "#sheet-drive")
    touch(phone, "#drive-field")
    phone.wait_for_function("() => /\\d/.test(document.querySelector('#glance b').textContent)")
    phone.evaluate("() => { studio.view.paused = true; }")
    phone.wait_for_timeout(300)
    driven = phone.text_content("#driven-speed").strip()
    assert phone.text_content("#glance b").replace(" ", "") == driven
    phone.evaluate("() => { studio.view.paused = false; }")
    assert phone.text_content("#glance .trust") == phone.text_content("#drive-trust .trust")
    touch(phone, "#drive-motor")
    assert phone.text_content("#glance b") == motor
    touch(phone, "#sheet-drive")


def test_where_inertia_is_felt_the_number_in_sight_says_so_in_the_same_colour(phone):
    fast = {"field.frequency": "300 Hz", "fluid.kinematic_viscosity": "1 cSt"}
    text = ms.Swimmer.preset("shapes/magnet", fast).to_toml()
    phone.evaluate("(text) => studio.store.load('fast', text)", text)
    phone.wait_for_function("() => studio.store.design.name === 'fast'")
    touch(phone, "#sheet-drive")
    touch(phone, "#drive-field")
    phone.wait_for_function("() => document.querySelector('#glance small.poor')?.textContent")
    assert phone.text_content("#glance small.poor") == "inertia is felt"
    phone.wait_for_selector("#inertia")
    assert "inertia, which is left out" in phone.text_content("#inertia")
    shades = [
        phone.evaluate("(s) => getComputedStyle(document.querySelector(s)).color", s)
        for s in ("#glance small.poor", "#inertia")
    ]
    assert shades[0] == shades[1]
    touch(phone, "#drive-motor")
    touch(phone, "#sheet-drive")
    phone.evaluate(
        "(text) => studio.store.load('tabak/helix', text)",
        ms.Swimmer.preset("tabak/helix").to_toml(),
    )
    phone.wait_for_function("() => studio.store.design.name === 'tabak/helix'")


def test_a_notice_hides_neither_the_number_nor_the_legend(phone):
    touch(phone, "#arrows")
    phone.evaluate("() => dispatchEvent(new ErrorEvent('error', { message: 'made up' }))")
    phone.wait_for_selector(".notice:has-text('made up')")
    for below in ("#glance", ".arrows"):
        assert apart(box(phone, ".notice"), box(phone, below)), below
    phone.click(".notice button")
    touch(phone, "#arrows")
