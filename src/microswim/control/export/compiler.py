"""The C compiler of this machine, where an export needs one."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from microswim.control.export.cmodel import CModel
from microswim.errors import MicroswimError
from microswim.numerics import files

FLAGS = [
    "-std=c99",
    "-O2",
    "-fPIC",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
    "-ffp-contract=off",
]

TIMER = """
#include "@name@.h"
#include <stdio.h>
#include <time.h>
int main(void)
{
    @name@_state y;
    @name@_inputs u;
    @name@_parameters p;
    double best = 1e30;
    const long n = @count@;
    @name@_defaults(&y, &u, &p);
    const double rate = u.motor_rate > 0 ? u.motor_rate : u.motor_rate < 0 ? -u.motor_rate : 1.0;
    for (int repeat = 0; repeat < 9; ++repeat) {
        const clock_t start = clock();
        for (long i = 0; i < n; ++i)
            if (@name@_step(&p, &u, 0.05 / rate, &y)) return 1;
        const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC / (double)n;
        if (seconds < best) best = seconds;
    }
    printf("%.6e %.3e\\n", best, y.phase);
    return 0;
}
"""


def found() -> list[str] | None:
    """Return the command of the C compiler: ``CC`` of the environment, else cc, gcc or clang;
    None: none.
    """
    chosen = shlex.split(os.environ.get("CC", ""))
    for command in [chosen] if chosen else [["cc"], ["gcc"], ["clang"]]:
        if shutil.which(command[0]):
            return command
    return None


def required() -> list[str]:
    """Return the compiler's command.

    Raises
    ------
    MicroswimError
        If there is none.
    """
    command = found()
    if command is None:
        raise MicroswimError(
            "no C compiler is on the path (cc, gcc, clang or what CC names); install one, for "
            'example the package gcc, or export with "--format c"'
        )
    return command


def shared_library(sources: list[Path], target: Path) -> None:
    """Compile sources into a shared library.

    Raises
    ------
    MicroswimError
        If there is no compiler, or it fails.
    """
    link = ["-dynamiclib"] if sys.platform == "darwin" else ["-shared"]
    run([*required(), *FLAGS, *link, "-o", str(target), *map(str, sources), "-lm"])


def run(command: list[str]) -> str:
    """Run a command and return what it printed; one sentence if it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise MicroswimError(f"{command[0]} could not be run: {error}") from None
    if done.returncode:
        first = next((x for x in done.stderr.splitlines() if "error" in x), done.stderr[:200])
        raise MicroswimError(f"{command[0]} failed with status {done.returncode}: {first}")
    return done.stdout


def write(model: CModel, folder: Path) -> list[Path]:
    """Write header and source into a folder."""
    paths = [folder / f"{model.name}.h", folder / f"{model.name}.c"]
    for path, text in zip(paths, (model.header, model.source)):
        files.write(path, text)
    return paths


def measured(model: CModel) -> dict[str, float | int | None]:
    """Return bytes of the compiled model and seconds per step; None where there is no compiler.

    A step is one internal step of order 4, least processor time of several runs.
    """
    if found() is None:
        return {"object_bytes": None, "seconds_per_step": None}
    with tempfile.TemporaryDirectory() as scratch:
        here = Path(scratch)
        _, source = write(model, here)
        timer, thing, program = here / "timer.c", here / "model.o", here / "timer"
        few = "#define BOUNDED 1" in model.source  # a step beside a boundary takes longer
        text = TIMER.replace("@count@", "300" if few else "20000")
        timer.write_text(text.replace("@name@", model.name), encoding="utf-8")
        run([*required(), *FLAGS, "-c", "-o", str(thing), str(source)])
        run([*required(), *FLAGS, "-o", str(program), str(timer), str(thing), "-lm"])
        seconds = float(run([str(program)]).split()[0])
        return {"object_bytes": thing.stat().st_size, "seconds_per_step": seconds}
