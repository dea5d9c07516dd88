"""A headless Chromium with the studio's page in it, for the tests that use it as a person."""

import shutil

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    *("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-component-update"),
    "--disable-sync",
]
PATIENCE = 120_000  # milliseconds; software WebGL on a busy machine draws a frame a second
#: Four frames a second, each of a quarter of the points: graphics in software take a core else.
CALM = """(() => {
  const next = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (draw) => setTimeout(() => next(draw), 250);
})()"""
SIZE = {"viewport": {"width": 1280, "height": 720}, "device_scale_factor": 0.5}


def calm(browser, **options):
    """A page that is not opened yet and draws seldom."""
    page = browser.new_page(**{**SIZE, **options})
    page.set_default_timeout(PATIENCE)
    page.add_init_script(CALM)
    return page


def opened(browser, address, **options):
    """A page that is ready, with what it complained of."""
    page = calm(browser, **options)
    page.complaints = []
    page.on("pageerror", lambda e: page.complaints.append(str(e)))
    page.on("console", lambda m: page.complaints.append(m.text) if m.type == "error" else None)
    page.goto(address, wait_until="commit")
    page.wait_for_selector("body[data-ready]")
    return page
