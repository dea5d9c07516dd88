"""The command line: one JSON object, one sentence for a mistake, all files or none."""

import json
import math
import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import Commands, main
from microswim.cli._options import change
from microswim.spec import presets
from microswim.spec.toml import to_toml

HELIX = presets.read("tabak/helix")


def call(*args):
    return CliRunner().invoke(main, [str(a) for a in args])


def numbers(*args):
    result = call(*args, "--json")
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout, parse_constant=lambda name: pytest.fail(f"bare {name}"))


def sentence(result, status=2):
    """The one sentence on stderr of a command that failed."""
    assert result.exit_code == status, (result.stdout, result.stderr, result.exception)
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("Error: ")
    return line


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(HELIX)
    return path


@pytest.mark.parametrize("name", Commands("main").list_commands(None))
def test_help_of_every_command_has_an_example(name):
    result = call(name, "--help")
    assert result.exit_code == 0
    assert f"  microswim {name}" in result.stdout


def test_version():
    assert call("--version").stdout == f"microswim {ms.__version__}\n"


def test_run_json_is_the_contract(spec):
    found = numbers("run", spec)
    gait = ms.Swimmer.from_toml(spec).gait()
    assert found["model"] == "rft"
    assert found["units"] == "dimensionless"
    assert found["mean_velocity"] == pytest.approx(gait.mean_velocity, abs=1e-14)
    assert found["velocity_amplitude"] == pytest.approx(gait.velocity_amplitude, abs=1e-14)
    assert found["swimming_speed"] == pytest.approx(ms.screw(gait).speed)
    assert found["efficiency"] == pytest.approx(gait.efficiency)
    assert found["wall_seconds"] > 0
    assert found["body_turns_per_period"] == pytest.approx(gait.mean_velocity[3] / (2 * math.pi))


def test_run_takes_the_atlas_where_nobody_chose_a_law(tmp_path):
    """Every velocity with its error and how it is known; a law chosen is a law used."""
    path = tmp_path / "fresh.toml"
    assert call("new", path).exit_code == 0
    found = numbers("run", path)
    assert found["model"] == "atlas"
    error = found["expected_error"]
    assert set(error) == {"us", "uq", "ur", "os", "oq", "or", "how"}
    assert all(error[name] > 0 for name in ("us", "uq", "os", "or"))
    assert "boundary-element" in error["how"]
    assert "±" in call("run", path).stdout
    shown = numbers("show", path)
    assert (shown["model"], shown["expected_error"]) == ("atlas", error)
    chosen = numbers("run", path, "--set", "coefficients.law=cox")
    assert chosen["model"] == "rft"
    assert chosen["expected_error"]["us"] > error["us"]


def test_run_with_an_accuracy(spec):
    found = numbers("run", spec, "--accuracy", "2%")
    assert found["model"] == "bem"
    assert found["expected_error"]["us"] <= 0.02
    assert "accuracy" in sentence(call("run", spec, "--accuracy", "two"))
    assert "accuracy" in sentence(call("run", spec, "--accuracy", "2%", "--model", "rft"))


def test_run_in_si_gives_the_known_speed_of_a_cell():
    found = numbers("run", "--preset", "goto/C")  # reading notes: 10.21 um/s, 7.10 Hz
    assert found["units"] == "SI"
    assert found["swimming_speed"] == pytest.approx(10.21e-6, rel=1e-3)
    assert abs(found["body_rotation_frequency"]) == pytest.approx(7.10, rel=1e-3)
    assert "10.21 µm/s" in call("run", "--preset", "goto/C").stdout


def test_what_is_not_a_finite_number_is_null():
    found = numbers("run", "--preset", "tabak/plane_wave")
    assert found["path_pitch"] is None or found["path_pitch"] > 1e6  # it goes straight


def test_a_swimmer_at_rest_can_be_printed():
    found = numbers("run", "--preset", "tabak/helix", "--set", "tail.frequency=0")
    assert found["swimming_speed"] == 0
    assert found["efficiency"] == 0


def test_set_overrides_any_field(spec):
    found = numbers("run", spec, "--set", "tail.amplitude=0.12", "--set", "tail.wavelength=0.5")
    swimmer = ms.Swimmer.from_toml(spec).with_({"tail.amplitude": 0.12, "tail.wavelength": 0.5})
    assert found["mean_velocity"][0] == pytest.approx(swimmer.gait().mean_velocity[0], rel=1e-12)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a.b=3", 3),
        ("a.b = 0.5", 0.5),
        ("a.b=5 um", "5 um"),
        ('a.b="5 um"', "5 um"),
        ("a.b=helix", "helix"),
        ("a.b=[1, 2]", [1, 2]),
        ("a.b=false", False),
        ("a.b=x=1", "x=1"),
    ],
)
def test_values_of_set(text, value):
    assert change(text) == ("a.b", value)


def test_tables_survive_the_way_to_toml_and_back():
    import tomllib

    for name in presets.names():
        tables = tomllib.loads(presets.read(name))
        assert tomllib.loads(to_toml(tables, "again")) == tables


BAD = {
    "no truth value": ("coefficients.tip=3", "coefficients.tip = 3: must be true or false"),
    "negative radius": ("tail.radius=-0.05", "tail.radius"),
    "NaN": ("tail.amplitude=nan", "tail.amplitude"),
    "infinite": ("body.radius=inf", "body.radius"),
    "unknown key": ("tail.amplitud=0.1", "tail.amplitude"),
    "unknown table": ("tale.amplitude=0.1", "tale"),
    "wrong dimension": ("fluid.viscosity=1 um", "fluid.viscosity"),
    "mixed units": ("tail.amplitude=1 um", "unit"),
    "a tail that touches itself": ("tail.radius=0.4", "touches itself"),
    "no number": ("tail.waves=many", "tail.waves"),
    "no equals sign": ("tail.waves", "--set"),
    "no field": ("=3", "--set"),
    "a date": ("tail.waves=1979-05-27", "tail.waves"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_values_are_one_sentence(spec, name):
    text, word = BAD[name]
    assert word in sentence(call("run", spec, "--set", text))


FILES = {
    "both waves and wavelength": (
        HELIX.replace("waves = 3", "waves = 3\nwavelength = 0.6"),
        "waves",
    ),
    "neither": (HELIX.replace("waves = 3", "# nothing"), "waves"),
    "syntax error": ("[body\nradius = 1", "TOML"),
    "empty": ("", "missing"),
    "not text": (b"\x89PNG\r\n\xff\xfe\x00", "read"),
    "nul": (b"\x00\x01\x02", "binary"),
    "a list for a table": ("fluid = [1, 2]", "fluid"),
}


@pytest.mark.parametrize("name", FILES)
def test_bad_files_are_one_sentence(tmp_path, name):
    content, word = FILES[name]
    path = tmp_path / "bad.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert word in sentence(call("run", path))


def test_no_file_a_folder_and_no_spec_at_all(tmp_path):
    assert "no such file" in sentence(call("run", tmp_path / "nothing.toml"))
    assert str(tmp_path) in sentence(call("run", tmp_path))
    assert "--preset" in sentence(call("run"))
    assert "tabak/helix" in sentence(call("run", "--preset", "tabak/helx"))


def test_the_real_process_ends_with_status_2_and_one_line(tmp_path):
    command = [sys.executable, "-c", "from microswim.cli import main; main()"]
    run = [*command, "run", "--preset", "tabak/helix", "--set", "tail.radius=-1"]
    done = subprocess.run(run, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "Error: tail.radius = -1.0: must be a positive length\n"


def test_a_misspelt_command_gets_a_hint():
    result = call("rn")
    assert result.exit_code == 2
    assert 'did you mean "run"?' in result.stderr


def test_ctrl_c_leaves_without_a_traceback(monkeypatch, spec):
    def interrupt(self, model="rft", **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(ms.Swimmer, "gait", interrupt)
    result = call("run", spec)
    assert result.exit_code == 130
    assert result.stderr == "interrupted\n"


def test_a_failing_solver_is_one_sentence_with_status_1(monkeypatch, spec):
    def fail(self, model="rft", **options):
        raise ms.MicroswimError("the solver did\nnot converge")

    monkeypatch.setattr(ms.Swimmer, "gait", fail)
    assert "the solver did not converge" in sentence(call("run", spec), status=1)


def test_a_warning_is_one_sentence_on_stderr(spec):
    result = call("run", spec, "--set", "tail.waves=5", "--set", "tail.amplitude=0.05", "--json")
    assert result.exit_code == 0
    json.loads(result.stdout)
    (line,) = result.stderr.splitlines()
    assert line.startswith("Warning: Lighthill")


def test_out_writes_everything_and_says_where(tmp_path):
    out = tmp_path / "results"
    result = call("run", "--preset", "goto/C", "--periods", 3, "--out", out, "--json")
    assert result.exit_code == 0, result.stderr
    assert str(out) in result.stderr
    names = {p.name for p in out.iterdir()}
    assert names == {"run.nc", "trajectory.csv", "swimmer.pvd", "path.vtp", "vtk", "spec.toml"} | {
        "trajectory.png",
        "velocity.png",
        "report.html",
    }
    run = ms.io.load(out / "run.nc")
    assert float(run.swimming_speed) == json.loads(result.stdout)["swimming_speed"]
    assert ms.Swimmer.from_toml(out / "spec.toml") == ms.Swimmer.preset("goto/C")
    assert run.attrs["spec"] == presets.read("goto/C")
    page = (out / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 2
    assert "http" not in page
    assert os.listdir(tmp_path) == ["results"]


def test_out_keeps_the_overrides(tmp_path):
    out = tmp_path / "results"
    change_ = ("--set", "tail.amplitude=0.12", "--periods", 1, "--out", out)
    assert call("run", "--preset", "tabak/helix", *change_).exit_code == 0
    assert ms.Swimmer.from_toml(out / "spec.toml").tail.amplitude == 0.12


def test_a_folder_with_files_is_refused_and_force_spares_strangers(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "spec.toml").write_text("old")
    args = ("run", "--preset", "tabak/helix", "--periods", 1, "--out", tmp_path)
    assert "--force" in sentence(call(*args))
    assert call(*args, "--force").exit_code == 0
    assert call(*args, "--force").exit_code == 0
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert (tmp_path / "spec.toml").read_text() == HELIX
    assert "a folder" in sentence(call(*args[:-1], tmp_path / "mine.txt"))


def test_nothing_is_left_half_written(tmp_path, monkeypatch):
    def fail(*args, **options):
        raise OSError(28, "No space left on device", "report.html")

    monkeypatch.setattr("microswim.output.report.html.page", fail)
    result = call("run", "--preset", "tabak/helix", "--periods", 1, "--out", tmp_path / "new")
    assert result.exit_code == 1
    (line,) = result.stderr.splitlines()
    assert "No space left" in line
    assert "efficiency" in result.stdout  # what was found is not lost
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["helix", "plane_wave"])
def test_new_specs_are_one_swimmer_in_any_units(tmp_path, kind):
    """Speed in lengths per period does not depend on the units (nor on the viscosity)."""
    speeds = {}
    for units, metre in (("none", 1.0), ("um", 1e-6), ("mm", 1e-3)):
        path = tmp_path / f"{units}.toml"
        assert call("new", path, "--kind", kind, "--units", units).exit_code == 0
        found = numbers("run", path)
        speeds[units] = found["swimming_speed"] / found["frequency"] / metre
    assert speeds["um"] == pytest.approx(speeds["none"], rel=1e-9)
    assert speeds["mm"] == pytest.approx(speeds["none"], rel=1e-9)


def test_new_does_not_overwrite(spec):
    assert "exists already" in sentence(call("new", spec))
    assert spec.read_text() == HELIX


def test_new_prints_without_a_file():
    assert call("new").stdout.count("[") > 5


def test_presets_are_listed_and_shown():
    listed = numbers("presets")["presets"]
    assert [p["name"] for p in listed] == presets.names()
    assert all(len(p["about"]) > 20 for p in listed)
    shown = call("presets", "--show", "goto/C").stdout
    assert shown == presets.read("goto/C")


def test_show_gives_the_known_coefficients():
    found = numbers("show", "--preset", "tabak/helix")  # reading notes, section 2
    assert found["alpha"] == pytest.approx(0.727727, abs=1e-6)
    assert found["c_n"] == pytest.approx(780.37, abs=0.01)
    assert found["c_t"] == pytest.approx(537.58, abs=0.01)
    assert found["reynolds_number"] == pytest.approx(0.01)
    assert "0.7277" in call("show", "--preset", "tabak/helix").stdout


def test_demo_agrees_with_the_known_numbers(tmp_path):
    from microswim.cli.demo import comparison

    result = call("demo", "--no-bem", "--out", tmp_path / "demo")
    assert result.exit_code == 0, result.stderr
    assert (tmp_path / "demo" / "report.html").stat().st_size > 50_000
    rows = {row[0]: row for row in comparison(bem=False).rows}
    assert rows["the paper's CFD"][1] == "-0.0380"
    assert rows["RFT constant + gamma"][-1] == "0.00 %"
    assert rows["RFT Lighthill + gamma"][-1] == "0.00 %"
    assert "-0.0370" in result.stdout


@pytest.mark.slow
def test_demo_solves_with_boundary_elements_too():
    from microswim.cli.demo import comparison

    *_, bem = comparison(bem=True).rows
    assert bem[0] == "boundary elements"
    assert abs(float(bem[-1].split()[0])) < 0.5
