"""How long one waits at first: imports, commands, the first map; with caches and without.

    python benchmarks/bench_startup.py

Processor seconds of fresh interpreters, the least of several, and beside each its ratio to the
import of NumPy and scipy.linalg in the same run. "First ever" has an empty cache of compiled code
(NUMBA_CACHE_DIR). Results go to benchmarks/results/startup.json.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from clock import keep

HERE = Path(__file__).parent
COMMAND = Path(sys.executable).with_name("microswim")
MAP = """
import numpy as np, microswim as ms
swimmer = ms.Swimmer.preset("tabak/{}")
amplitude, waves = np.linspace(0.05, 0.15, {n}), np.linspace(2.0, 4.0, {n})
ms.sweep(swimmer, {{"tail.amplitude": amplitude, "tail.waves": waves}})
"""


def python(code):
    return [sys.executable, "-c", code]


def run(*arguments):
    return [COMMAND, "run", *arguments, "--json"]


def spent(command, cache=None):
    """Processor seconds of a process."""
    environment = os.environ | ({"NUMBA_CACHE_DIR": cache} if cache else {})
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # an installed package has its bytecode
    before = os.times()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
    after = os.times()
    now, then = (t.children_user + t.children_system for t in (after, before))
    return now - then


def fresh(command):
    """Processor seconds with an empty cache of compiled code."""
    with tempfile.TemporaryDirectory() as folder:
        return spent(command, folder)


def main(repeats=7):
    """Run all and print the table."""
    os.environ["OMP_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / "robot.toml"
        subprocess.run([COMMAND, "new", spec], check=True, stdout=subprocess.DEVNULL)
        bare = python("pass")
        helix = run("--preset", "tabak/helix")
        first_map = python(MAP.format("helix", n=20))
        commands = {
            "import numpy, scipy.linalg": python("import numpy, scipy.linalg"),
            "import microswim": python("import microswim"),
            "import, and a first gait": python(
                "import microswim as ms; ms.Swimmer.preset('tabak/helix').gait()"
            ),
            "microswim --help": [COMMAND, "--help"],
            "microswim run, helix": helix,
            "microswim run, plane wave": run("--preset", "tabak/plane_wave"),
            "microswim run, a cell in SI units": run("--preset", "goto/C"),
            "microswim run, a spec of microswim new": run(str(spec)),
            "import, and a map of 20 x 20, helix": first_map,
            "import, and a map of 20 x 20, plane wave": python(MAP.format("plane_wave", n=20)),
            "import, and a map of 200 x 200, helix": python(MAP.format("helix", n=200)),
        }
        interpreter = min(spent(bare) for _ in range(repeats))
        seconds = {
            name: min(spent(command) for _ in range(repeats)) - interpreter
            for name, command in commands.items()
        }
        seconds["first ever microswim run, helix"] = min(fresh(helix) for _ in range(3))
        seconds["first ever map of 20 x 20, helix"] = min(fresh(first_map) for _ in range(3))
    unit = seconds["import numpy, scipy.linalg"]
    results = {
        "processor seconds": {
            name: {"seconds": value, "over NumPy and SciPy": value / unit}
            for name, value in seconds.items()
        },
    }
    keep("startup", results)
    for name, value in seconds.items():
        print(f"{name:45s} {value:6.2f} {value / unit:6.2f}")


if __name__ == "__main__":
    main()
