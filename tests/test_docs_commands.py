"""The commands on pages, run word for word in an empty folder, as a reader types them.

Blocks of a page share the folder. A block of TOML goes to the end of robot.toml, one of CSV into
the file that the sentence before it names. Before a block stand ``<!-- not run -->`` (it installs,
takes many minutes or needs other machines) or ``<!-- background -->`` (it serves until the end).
"""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
BLOCK = re.compile(r"(?:<!-- ([a-z ]+) -->\n)?```(sh|toml|csv)\n(.*?)```", re.DOTALL)
PAGES = [*sorted((DOCS / "tutorials").glob("*.md")), DOCS / "start.md"]
WITH_COMMANDS = [p for p in PAGES if "```sh" in p.read_text(encoding="utf-8")]


def environment():
    binaries = str(Path(sys.executable).parent)
    return os.environ | {
        "PATH": binaries + os.pathsep + os.environ["PATH"],
        "OMP_NUM_THREADS": "1",
        "COLUMNS": "120",
    }


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_COMMANDS, ids=lambda p: p.stem)
def test_commands_on_pages_run(page, tmp_path):
    text = page.read_text(encoding="utf-8")
    serving, ran = [], 0
    try:
        for block in BLOCK.finditer(text):
            how, kind, code = block.groups()
            if how == "not run":
                continue
            if kind == "toml":
                with (tmp_path / "robot.toml").open("a") as spec:
                    spec.write("\n" + code)
            elif kind == "csv":
                name = re.findall(r"`([\w.]+\.csv)`", text[: block.start()])[-1]
                (tmp_path / name).write_text(code)
            else:
                command = ["bash", "-e", "-c", code]
                started = subprocess.Popen(
                    command, cwd=tmp_path, env=environment(), start_new_session=True,
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                )  # fmt: skip
                if how == "background":
                    serving.append(started)
                    continue
                said = started.communicate(timeout=1500)[0]
                assert started.returncode == 0, f"{code}\n{said}"
                ran += 1
    finally:
        for process in serving:
            os.killpg(process.pid, signal.SIGTERM)
            process.communicate()
    assert ran
