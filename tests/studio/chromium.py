"""A headless Chromium with the studio's page in it, for the tests that use it as a person."""

import shutil

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    *("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-component-update"),
    "--disable-sync",
]
PATIENCE = 120_000  # milliseconds; software WebGL on a busy machine draws a frame a second
#: Few frames a second, each of a quarter of the points: graphics in software take a core else.
CALM = """(() => {
  const next = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (draw) => setTimeout(() => next(draw), 150);
})()"""
SIZE = {"viewport": {"width": 1280, "height": 720}}


def calm(browser, **options):
    """A page that is not opened yet and draws seldom."""
    coarse = {} if options.get("is_mobile") else {"device_scale_factor": 0.5}
    page = browser.new_page(**{**SIZE, **coarse, **options})
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


COUNTED = """() => {
  if (window.clicks === undefined) {
    window.clicks = 0;
    window.addEventListener("click", () => { window.clicks += 1; }, true);
  }
  return window.clicks;
}"""


def touch(page, selector):
    """A finger on a button; what it does has begun. A tap right after a pinch may be lost."""
    before, clicked = page.evaluate(COUNTED), "(n) => window.clicks > n"
    page.tap(selector)
    for _ in range(200):
        if page.evaluate(clicked, before):
            return
        page.wait_for_timeout(50)
    page.tap(selector)
    page.wait_for_function(clicked, arg=before)
