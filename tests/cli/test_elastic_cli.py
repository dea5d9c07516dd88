"""Elastic tails from the command line, as a designer meets them."""

import json

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
    ("tail.drive=push", '"heave", "pivot", "rotate", "none"'),
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


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_any_swimmer_can_be_held(preset):
    free, held = (
        json.loads(run("run", "--preset", preset, "--model", "rft", "--json", *more).stdout)
        for more in ((), ("--set", "motion.free=none"))
    )
    assert held["mean_velocity"] == held["velocity_amplitude"] == [0.0] * 6
    assert held["held_wrench"] == pytest.approx(free["held_wrench"])
    assert held["held_wrench"][0] < 0.0
