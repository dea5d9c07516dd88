"""Files that commands write: nothing replaced unasked, nothing half-written, no work lost."""

import pytest
from click.testing import CliRunner

from microswim.cli import _files, calibrate, main
from microswim.errors import MicroswimError, SpecError
from microswim.spec import presets


def call(*args):
    return CliRunner().invoke(main, [str(a) for a in args])


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(presets.read("tabak/helix"))
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ("calibrate", "--measured", "mean.us=-0.05", "-o"),
        ("studio", "--snapshot"),
    ],
)
def test_the_spec_itself_is_not_replaced_unasked(arguments, spec):
    before = spec.read_text()
    name, *rest = arguments
    run = call(name, spec, *rest, spec)
    assert run.exit_code == 2
    assert "--force" in run.stderr
    assert spec.read_text() == before
    assert call(name, spec, *rest, spec, "--force").exit_code == 0
    assert spec.read_text() != before


OVER = ("--over", "tail.waves=2:3")


@pytest.mark.parametrize(
    ("arguments", "made"),
    [
        (("design", *OVER, "--maximize", "swimming_speed", "--out"), "sensitivity.png"),
        (("validate", "--over", "tail.waves=2,3", "--out"), "errors.csv"),
    ],
)
def test_a_folder_with_results_is_refused_before_the_work(arguments, made, spec, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / made).write_text("mine")
    name, *rest = arguments
    run = call(name, spec, *rest, out)
    assert run.exit_code == 2
    assert made in run.stderr
    assert (out / made).read_text() == "mine"


def test_a_folder_in_place_of_a_file_is_said_at_once(spec, tmp_path):
    run = call("calibrate", spec, "--reference", "bem", "-o", tmp_path)
    assert run.exit_code == 2
    assert run.stderr.startswith("Error: --output = ")
    assert "folder" in run.stderr


def test_a_result_that_cannot_be_written_is_printed(spec, tmp_path, monkeypatch):
    def full(path, text):
        raise MicroswimError(f"{path}: not written: No space left on device")

    monkeypatch.setattr(calibrate, "write", full)
    run = call("calibrate", spec, "--measured", "mean.us=-0.05", "-o", tmp_path / "new.toml")
    assert run.exit_code == 1
    assert "[interaction]" in run.stdout
    assert "new.toml: not written" in run.stderr


def test_a_file_where_a_folder_is_needed_is_named(tmp_path):
    (tmp_path / "a").write_text("")
    with pytest.raises(SpecError, match="this is a file"):
        _files.check_file("--output", tmp_path / "a" / "b.toml", force=False)
