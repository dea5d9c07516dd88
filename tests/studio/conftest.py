"""The studio's server, one for all tests, as it remembers nothing; a browser for those of a module.

While a browser is open no other event loop can run in the process, so it is closed in between.
"""

import os
import re
import signal
import subprocess
import sys

import chromium
import pytest


@pytest.fixture(scope="session")
def server():
    code = "from microswim.cli import main; main(['studio', '--no-browser', '--port', '0'])"
    env = {**os.environ, "PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=env,
        start_new_session=True,
    )  # fmt: skip
    try:
        line = process.stdout.readline()
        yield re.search(r"http://127\.0\.0\.1:\d+/", line).group()
    finally:
        os.killpg(process.pid, signal.SIGKILL)  # nobody waits for a solve that is under way
        process.wait(90)
        process.stdout.close()


@pytest.fixture(scope="module")
def browser():
    if chromium.CHROMIUM is None:
        pytest.skip("no Chromium is installed: the studio's page is not tested here")
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium.CHROMIUM, args=chromium.FLAGS)
        yield opened
        opened.close()
