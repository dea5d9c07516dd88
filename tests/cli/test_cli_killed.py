"""Commands that are killed: what they leave is gone after the next."""

import subprocess
import sys
import time

from click.testing import CliRunner

from microswim.cli import main

RUN = ["run", "--preset", "tabak/helix", "--out"]


def test_what_a_killed_run_left_is_gone_after_the_next(tmp_path):
    """The scratch folder is hidden; nobody would look for it."""
    out = tmp_path / "results"
    code = "import sys; from microswim.cli import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", code, *RUN, out],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        while process.poll() is None and not list(tmp_path.glob(".results.*/spec.toml")):
            time.sleep(0.005)
    finally:
        process.kill()
        process.wait()
    assert [p.name.startswith(".results.") for p in tmp_path.iterdir()] == [True]
    run = CliRunner().invoke(main, [*RUN, str(out)])
    assert run.exit_code == 0, run.output
    assert [p.name for p in tmp_path.iterdir()] == ["results"]


def test_a_full_disk_is_a_sentence_that_names_the_folder(tmp_path, monkeypatch):
    from pathlib import Path

    write = Path.write_bytes

    def full(self, data):
        if ".nc" in self.name:
            raise OSError(28, "No space left on device")
        return write(self, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    run = CliRunner().invoke(main, [*RUN, str(tmp_path / "results")])
    assert run.exit_code == 1
    said = "".join(run.stderr.split())
    assert f"{tmp_path}/results/run.nc:notwritten:Nospaceleftondevice" in said
    assert list(tmp_path.iterdir()) == []
