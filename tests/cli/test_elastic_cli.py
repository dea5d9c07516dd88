"""Elastic tails from the command line, as a designer meets them."""

import json
import math

import pytest
from click.testing import CliRunner

from microswim.cli import main
from oracles.elastic_filament import thrust

RATE = 6.283185307179586
SPEC = """
[fluid]
viscosity = 1.0
[body]
shape = "none"
[tail]
kind = "elastic"
length = 1.0
radius = 0.01
bending = {bending}
base = "hinged"
drive = "heave"
amplitude = 0.02
[coefficients]
law = "constant"
normal = 2.0
tangential = 1.2
[motion]
free = "none"
"""


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "held.toml"
    path.write_text(SPEC.format(bending=2.0 * RATE / 4.0**4))
    return path


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def test_a_held_tail_pushes_as_the_closed_form_says(spec):
    found = json.loads(run("run", spec, "--json").stdout)
    assert found["model"] == "elastic"
    assert found["mean_velocity"] == [0.0] * 6
    push = -found["held_wrench"][0] / ((2.0 - 1.2) * RATE * 0.02**2)
    assert push == pytest.approx(thrust(4.0, "hinged"), rel=5e-3)
    assert found["info"]["sperm_number"] == pytest.approx(4.0)


def test_sweeps_over_the_stiffness(spec, tmp_path):
    import xarray as xr

    made = run(
        "sweep", spec, "--over", "tail.bending=0.05:0.5:3", "--set", 'motion.free="all"',
        "--set", 'body.shape="sphere"', "--set", "body.radius=0.2",
        "--model", "elastic", "--out", tmp_path / "s.zarr", "--workers", "0",
    )  # fmt: skip
    assert made.exit_code == 0, made.output
    assert (xr.open_zarr(tmp_path / "s.zarr").swimming_speed > 0.0).all()


def test_a_new_spec_runs(tmp_path):
    path = tmp_path / "new.toml"
    assert run("new", path, "--kind", "elastic", "--units", "um").exit_code == 0
    found = run("run", path, "--json")
    assert found.exit_code == 0, found.output
    assert json.loads(found.stdout)["info"]["settles"]


@pytest.mark.parametrize(("change", "sentence"), [
    ("tail.drive=rotate", "tail.amplitude = 0.02: must be left out"),
    ("tail.drive=push", '"heave", "pivot", "rotate", "moment", "none"'),
    ("tail.drive=pivot", "tail.amplitude = 0.02: must be left out"),
    ("tail.angle=0.1", "must be left out with drive"),
    ("tail.bending=0", "must be a positive stiffness"),
    ('motion.line_element="apparent"', '"arc" for an elastic tail'),
    ("tail.bending=1e-9", "too sharply"),
    ('coefficients={law = "lighthill"}', "wavelength"),
    ("hook={stiffness = 1.0, length = 0.1}", "the hook is the hinge"),
    ("hook={stiffness = 1.0}", "hook.length: missing"),
])  # fmt: skip
def test_what_cannot_be_is_refused_in_a_sentence(spec, change, sentence):
    found = run("run", spec, "--set", change)
    assert found.exit_code in (1, 2)
    assert sentence in found.output
    assert "Traceback" not in found.output


def test_a_base_that_turns(spec, tmp_path):
    """Tilted by half a radian: thrust towards the body and a torque against the motor."""
    text = spec.read_text().replace('"hinged"', '"clamped"').replace('"heave"', '"rotate"')
    spec.write_text(text.replace("amplitude = 0.02", 'angle = "30 deg"'))
    found = json.loads(run("run", spec, "--json").stdout)
    assert found["held_wrench"][0] < 0.0
    assert -found["held_wrench"][3] == pytest.approx(found["mean_torque"])
    assert found["info"]["settles"]
    hinged = run("run", spec, "--set", "tail.base=hinged")
    assert "a hinge hands on no turning" in hinged.output


TURNED = """
[fluid]
viscosity = "1 mPa s"
[body]
shape = "sphere"
radius = "1 um"
[coefficients]
law = "cox"
[tail]
kind = "elastic"
length = "8 um"
radius = "0.05 um"
bending = "4e-24 N m^2"
drive = "rotate"
frequency = "20 Hz"
"""


def test_a_helix_at_rest_with_a_hook(tmp_path):
    """By its radius and pitch, and by a table of points beside the spec: the same speed."""
    spec, table = tmp_path / "cell.toml", tmp_path / "shape.csv"
    hook = '[hook]\nstiffness = "4e-25 N m^2"\nlength = "0.1 um"\n'
    spec.write_text(TURNED + 'rest_radius = "0.2 um"\nrest_pitch = "-2.2 um"\n' + hook)
    first = json.loads(run("run", spec, "--json").stdout)
    assert first["info"]["settles"]
    assert first["mean_velocity"][0] < 0.0
    x = [0.02 * i for i in range(360)]
    rows = [
        f"{s},{0.2 * math.cos(k * s)},{0.2 * math.sin(k * s)}" for k in [-RATE / 2.2] for s in x
    ]
    arc = 0.02 * 359 * math.hypot(1.0, 0.2 * RATE / 2.2)
    table.write_text("x,y,z\n" + "\n".join(rows))
    spec.write_text(TURNED.replace("8 um", f"{arc:.6f} um") + 'file = "shape.csv"\n' + hook)
    drawn = run("run", spec, "--json")
    spec.write_text(
        TURNED.replace("8 um", f"{arc:.6f} um")
        + 'rest_radius = "0.2 um"\nrest_pitch = "-2.2 um"\n' + hook
    )  # fmt: skip
    told = json.loads(run("run", spec, "--json").stdout)
    assert json.loads(drawn.stdout)["mean_velocity"] == pytest.approx(
        told["mean_velocity"], rel=2e-3, abs=1e-12
    )


@pytest.mark.parametrize(("lines", "sentence"), [
    ('rest_pitch = "1 um"\n', "rest_radius: missing"),
    ('rest_radius = "1 um"\nrest = [[0, 0, 0]]\n', "one of the two"),
    ("rest = [[0, 0, 0], [1, 0, 0]]\n", "4 to 2000"),
    ("rest = [[0, 0, 0], [0, 0, 0], [2, 0, 0], [3, 1, 0]]\n", "the same place"),
    ('file = "none.csv"\n', "none.csv"),
    ('moment = "1e-18 N m"\n', "left out with drive"),
    ("", "tail.angle: missing"),
])  # fmt: skip
def test_shapes_at_rest_that_cannot_be(tmp_path, lines, sentence):
    spec = tmp_path / "cell.toml"
    spec.write_text(TURNED + lines)
    found = run("run", spec)
    assert found.exit_code == 2
    assert sentence in found.output


def test_waves_of_inner_moment(spec):
    text = spec.read_text().replace('"hinged"', '"clamped"').replace('"heave"', '"moment"')
    spec.write_text(text.replace("amplitude = 0.02", "moment = 0.5\nwavelength = 1.0"))
    found = json.loads(run("run", spec, "--set", "motion.free=all", "--json").stdout)
    assert found["mean_velocity"][0] < 0.0


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_any_swimmer_can_be_held(preset):
    free, held = (
        json.loads(run("run", "--preset", preset, "--model", "rft", "--json", *more).stdout)
        for more in ((), ("--set", "motion.free=none"))
    )
    assert held["mean_velocity"] == held["velocity_amplitude"] == [0.0] * 6
    assert held["held_wrench"] == pytest.approx(free["held_wrench"])
    assert held["held_wrench"][0] < 0.0


def test_a_path_from_rest(spec, tmp_path):
    """Files and numbers of a tail followed in time, and of one that its magnet drives."""
    free = ["--set", "motion.free=all", "--set", "tail.bending=1"]
    refused = run("path", spec, *free, "--time", "0.5", "--from-rest")
    assert "a hinge to nothing has no angle" in refused.output
    free += ["--set", 'body.shape="sphere"', "--set", "body.radius=0.2"]
    out = tmp_path / "out"
    made = run("path", spec, *free, "--time", "0.5", "--from-rest", "--out", out, "--json")
    assert made.exit_code == 0, made.output
    found = json.loads(made.stdout)
    assert found["model"] == "elastic"
    assert found["motor_work"] == pytest.approx(found["dissipated"], rel=0.01)  # it is stiff
    assert found["motor_work"] > 0.0
    files = {"path.nc", "path.csv", "path.png", "spec.toml", "swimmer.pvd", "path.vtp"}
    assert files <= {p.name for p in out.iterdir()}
    assert len(list((out / "vtk").iterdir())) > 20
    magnetic = [*free, "--set", "tail.drive=none", "--set", "tail.magnet=[0.1, 0, 0]"]
    field = 'field={kind = "uniform", strength = 1.0, direction = [0, 1, 0]}'
    text = spec.read_text().replace("amplitude = 0.02\n", "").replace('"hinged"', '"clamped"')
    spec.write_text(text)
    turned = json.loads(
        run("path", spec, *magnetic, "--set", field, "--time", "0.5", "--json").stdout
    )
    assert turned["motor_work"] == 0.0
    assert turned["quaternion"][3] > 0.0
    wrong = run("path", "--preset", "tabak/helix", "--time", "1", "--from-rest")
    assert "for a tail of kind elastic" in wrong.output


def test_a_tail_that_misses_its_body_is_refused_without_an_amplitude(tmp_path):
    spec = tmp_path / "bent.toml"
    spec.write_text(
        '[body]\nshape = "sphere"\nradius = 0.2\n[tail]\nkind = "elastic"\nlength = 1.0\n'
        'radius = 0.02\nbending = 1.0\ndrive = "pivot"\nangle = 0.3\nrest_radius = 0.25\n'
        "rest_pitch = 1.0\n[fluid]\nviscosity = 1.0\n"
    )
    found = run("run", spec, "--model", "bem", "--level", "coarse")
    assert found.exit_code == 2
    assert "begins beside the body" in found.output
    assert "None" not in found.output
