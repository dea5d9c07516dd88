"""Take the pictures of the studio that the documentation shows: pictures.py [NAME ...].

Wants Chromium and playwright, as the browser tests do. Look at what it made before you commit it.
"""

import os
import re
import subprocess
import sys
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "studio"))
from chromium import CHROMIUM, FLAGS, opened  # noqa: E402

OUT = ROOT / "docs" / "img"
WIDE = {"width": 1280, "height": 800}


def put(page, name):
    page.select_option("#presets", value=name)
    page.wait_for_function(f"() => studio.store.design.name === '{name}'")
    page.wait_for_function("() => studio.store.design.latest.idle")


def swum(page, seconds=12):
    page.wait_for_timeout(1000 * seconds)


def mapped(page):
    page.wait_for_selector(".map .legend")
    swum(page, 6)


def studio(page):
    put(page, "shapes/capsule")
    page.click("#arrows")
    mapped(page)


def flow(page):
    put(page, "tabak/helix")
    page.click("#flow")
    page.wait_for_function("() => studio.flow.shown")
    swum(page)


def followed(page, seconds):
    """The path of what is on show, once its poses are solved: minutes, the first time."""
    page.click("[role=tablist] >> text=Path")
    page.click("#ask-path")
    page.wait_for_selector("#went", timeout=3_600_000)
    swum(page, seconds)


def channel(page):
    put(page, "shapes/in-a-tube")
    page.fill('input[aria-label="Tilt, value"]', "25")
    page.keyboard.press("Enter")
    page.wait_for_function("() => studio.store.design.latest.idle")
    followed(page, 16)


def wall(page):
    put(page, "cells/beside-a-wall")
    followed(page, 16)


def together(page):
    page.select_option("#presets", value="together/two-robots")
    page.wait_for_selector("#went")
    swum(page, 14)


def elastic(page):
    put(page, "soft/heaving")
    mapped(page)


def upwards(page):
    """Until the field points up, so that its arrow is seen from the side."""
    page.wait_for_function("""() => { const { time, x } = studio.actors()[0].pose;
      const { B } = studio.driver.drive.field(time, x); return B[2] > 0.9 * Math.hypot(...B); }""")
    page.evaluate("() => { studio.view.paused = true; }")


def field(page):
    put(page, "shapes/magnet")
    page.click("[role=tablist] >> text=Drive")
    page.click("#drive-field")
    swum(page, 20)
    upwards(page)


def dropped(page):
    from microswim import Swimmer
    from microswim.output.io.stl import write_stl

    tables = re.findall(
        r"```toml\n(.*?)```", (ROOT / "docs/tutorials/cad.md").read_text(), re.DOTALL
    )
    spec, stl = Path("/tmp/picture.toml"), Path("/tmp/robot.stl")
    spec.write_text(tables[0])
    write_stl(stl, Swimmer.from_toml(spec), fineness=0.8)
    page.set_input_files("#file", spec)
    page.wait_for_function("() => studio.store.design.name === 'picture'")
    page.set_input_files("#file", stl)
    page.select_option("#drop-unit", "mm")
    page.click("#card-do")
    page.wait_for_function("() => studio.store.design.name === 'robot'")
    page.click("[role=tablist] >> text=Drive")
    page.click("#drive-field")
    swum(page, 20)


def tracks(page):
    made = re.findall(
        r"cat > plant.py <<'END'\n(.*?)END\n",
        (ROOT / "docs/tutorials/movie.md").read_text(),
        re.DOTALL,
    )
    subprocess.run(
        [sys.executable, "-c", made[0]], cwd="/tmp", check=True, stdout=subprocess.DEVNULL
    )
    page.set_input_files("#file", "/tmp/spots.csv")
    page.fill("#drop-pixel", "0.11um")
    page.fill("#drop-fps", "25")
    page.click("#card-do")
    page.wait_for_selector("#tracks")


def compare(page):
    put(page, "tabak/helix")
    page.click("#compare")
    page.fill('input[aria-label="Amplitude, value"]', "0.15")
    page.keyboard.press("Enter")
    mapped(page)


TAKEN = [studio, flow, channel, wall, together, elastic, field, dropped, tracks, compare]


def take(browser, address, act):
    page = opened(browser, address, viewport=WIDE)
    page.wait_for_selector("body[data-warm]", state="attached")
    act(page)
    picture = Image.open(BytesIO(page.screenshot())).convert("RGB")
    page.close()
    file = OUT / f"studio-{act.__name__}.jpg"
    picture.save(file, quality=90, subsampling=0, optimize=True)
    print(f"{file.relative_to(ROOT)}: {file.stat().st_size // 1024} kB")


def main():
    wanted = sys.argv[1:]
    code = "from microswim.cli import main; main(['studio', '--no-browser', '--port', '0'])"
    server = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True,
                              env={**os.environ, "PYTHONUNBUFFERED": "1"})  # fmt: skip
    address = re.search(r"http://127\.0\.0\.1:\d+/", server.stdout.readline()).group()
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
            for act in TAKEN:
                if not wanted or act.__name__ in wanted:
                    take(browser, address, act)
            browser.close()
    finally:
        server.terminate()


if __name__ == "__main__":
    main()
