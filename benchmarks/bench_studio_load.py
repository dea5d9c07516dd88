"""How long the studio's page takes to load on this machine, in Chromium with software graphics.

    python benchmarks/bench_studio_load.py

Loads in a browser and a server that were just started (cold), in a browser alone just started, and
again in the same browser, all from the loopback. "numbers": the panels stand with the numbers of
the design; "picture": the swimmer is drawn. What must hold: numbers within a second, cold too.
Bytes and requests do not depend on what else the machine does, processor seconds of the page's
process hardly; the others do, so the load is printed with them.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "studio"))
from chromium import CHROMIUM, FLAGS, PATIENCE

SERVE = "from microswim.cli import main; main(['studio', '--no-browser', '--port', '0'])"
MARKS = """() => ["resource", "navigation"].flatMap((kind) => performance.getEntriesByType(kind))
  .reduce((sum, e) => [sum[0] + 1, sum[1] + e.transferSize], [0, 0])
  .concat(["ready", "drawn"].map((name) => performance.getEntriesByName(name)[0].startTime))"""


@contextmanager
def served():
    """Address of a studio that was just started."""
    server = subprocess.Popen(
        [sys.executable, "-c", SERVE],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    try:
        yield re.search(r"http://127\.0\.0\.1:\d+/", server.stdout.readline()).group()
    finally:
        server.terminate()
        server.wait()


def loaded(page, address):
    """Requests, bytes, milliseconds to the numbers and to the picture, processor seconds."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    page.goto(address, wait_until="commit")
    page.wait_for_function(
        "() => performance.getEntriesByName('drawn').length", timeout=PATIENCE, polling=50
    )
    found = {m["name"]: m["value"] for m in session.send("Performance.getMetrics")["metrics"]}
    return [*page.evaluate(MARKS), found["ProcessTime"]]


def told(what, rows):
    """A line of the least of each number."""
    requests, size, ready, drawn, busy = (min(column) for column in zip(*rows, strict=True))
    print(f"{what:34}{requests:9.0f}{size / 1e3:9.0f}{ready:9.0f}{drawn:9.0f}{busy:11.2f}")


def main():
    print(f"{'':34}{'requests':>9}{'kB':>9}{'numbers':>9}{'picture':>9}{'processor':>11}")
    with sync_playwright() as playwright:

        def browser():
            return playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)

        cold, fresh, again = [], [], []
        for _ in range(3):
            with served() as address:
                one = browser()
                cold.append(loaded(one.new_page(), address))
                one.close()
        with served() as address:
            for _ in range(3):
                one = browser()
                opened = one.new_context()
                page = opened.new_page()
                fresh.append(loaded(page, address))
                page.wait_for_selector("body[data-warm]", state="attached", timeout=PATIENCE)
                page.close()
                again += [loaded(opened.new_page(), address) for _ in range(3)]
                one.close()
    told("server and browser just started", cold)
    told("browser just started", fresh)
    told("again", again)
    print(f"load of the machine meanwhile: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
