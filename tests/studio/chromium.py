"""A headless Chromium with the studio's page in it, for the tests that use it as a person."""

import shutil

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    *("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-component-update"),
    "--disable-sync",
]
PATIENCE = 120_000  # milliseconds; software WebGL on a busy machine draws a frame a second


def opened(browser, address, **options):
    """A page that is ready, with what it complained of."""
    page = browser.new_page(**{"viewport": {"width": 1280, "height": 720}, **options})
    page.set_default_timeout(PATIENCE)
    page.complaints = []
    page.on("pageerror", lambda e: page.complaints.append(str(e)))
    page.on("console", lambda m: page.complaints.append(m.text) if m.type == "error" else None)
    page.goto(address, wait_until="commit")
    page.wait_for_selector("body[data-ready]")
    return page
