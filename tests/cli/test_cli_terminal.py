"""Options in one sentence; terminals that are narrow, plain, closed or on a full disk."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from microswim.cli import _progress, main

COMMAND = Path(sys.executable).with_name("microswim")
HELIX = ("run", "--preset", "tabak/helix")


def call(*args):
    return CliRunner().invoke(main, [str(a) for a in args])


def shell(*args, stdout=subprocess.PIPE, **environment):
    return subprocess.run(
        [COMMAND, *map(str, args)],
        env=os.environ | environment,
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--foo",), "No such option '--foo'"),
        (("rum",), 'did you mean "run"?'),
        (("run", "--foo"), "see microswim run --help"),
        (("run", "--preset"), "requires an argument"),
        (("run", "--model", "cfd"), "'cfd' is not one of"),
        (("calibrate", "--preset", "tabak/helix", "--solves", "3"), "x>=6"),
        ((*HELIX, "--level", "fine"), "bem and fem have levels"),
        (("export", *HELIX[1:], "--format", "c", "--level", "fine"), "bem and fem have levels"),
        (
            ("calibrate", *HELIX[1:], "--region", "tail.waves=1:2", "--measured", "speed=1"),
            "--measured has no meaning with --region",
        ),
        (
            ("sweep", *HELIX[1:], "--over", "tail.waves=1,2", "--scheduler", "garbage"),
            "HOST:PORT",
        ),
        (("sweep", *HELIX[1:], "--over", "tail.waves=1,2", "--cluster", "slurm"), "sbatch"),
    ],
)
def test_a_wrong_option_is_one_sentence(arguments, says, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    rest = ("--out", tmp_path / "out") if arguments[0] == "sweep" else ()
    run = call(*arguments, *rest)
    assert run.exit_code == 2, run.output
    assert run.stdout == ""
    (line,) = run.stderr.splitlines()
    assert line.startswith("Error: ")
    assert says in line
    assert not (tmp_path / "out").exists()


def test_a_narrow_terminal_shows_every_number_and_note():
    wide, narrow = shell(*HELIX, COLUMNS="120").stdout, shell(*HELIX, COLUMNS="40").stdout
    assert "…" not in narrow
    for words in ("0.06717", "negative: the body leads", "half of peak to peak"):
        assert words in wide
        assert words in narrow


def test_an_ascii_terminal_gets_plain_letters():
    run = shell("run", "--preset", "goto/C", PYTHONIOENCODING="ascii", COLUMNS="120")
    assert run.returncode == 0, run.stderr
    assert "10.21 um/s" in run.stdout


@pytest.mark.parametrize("arguments", [("--help",), HELIX, ("presets",)])
def test_a_full_disk_is_one_sentence(arguments):
    with open("/dev/full", "w") as full:
        run = shell(*arguments, stdout=full)
    assert run.returncode == 1
    (line,) = run.stderr.splitlines()
    assert "No space left" in line


def test_a_back_end_that_matplotlib_does_not_know_does_no_harm(tmp_path):
    run = shell(*HELIX, "--out", tmp_path / "out", MPLBACKEND="nonsense")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "out" / "trajectory.png").exists()


def test_work_that_counts_nothing_shows_that_it_goes_on(capsys, monkeypatch):
    monkeypatch.setattr(_progress._Lines, "first", 0.01)
    monkeypatch.setattr(_progress._Lines, "next", 0.01)
    with _progress.bar("design robot") as progress:
        time.sleep(0.1)
        silent = capsys.readouterr().err
        progress(1, 4)
        time.sleep(0.1)
    assert "design robot: 0 s" in silent
    assert "design robot: 1 of 4" in capsys.readouterr().err
