"""Many designs by the atlas are those one by one, in batches and in sweeps, and say their error."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.calibration.atlas.choice import not_atlas
from microswim.calibration.atlas.everywhere import everywhere
from microswim.cli import main
from microswim.models.rft.batch import expected_errors
from microswim.numerics.compiling.compiled import settled

TAIL = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05, handedness="right")
ROBOT = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=TAIL, fluid=ms.Fluid(viscosity=100.0))
VALUES = {"tail.amplitude": np.array([0.06, 0.1, 0.14]), "body.radius": np.array([0.4, 3.0, 0.6])}


def test_a_batch_is_its_gaits_and_nan_outside():
    many = everywhere(ROBOT)
    assert many is not None
    found, errors = ms.evaluate(many, VALUES), expected_errors(many, VALUES)
    assert np.isnan(found["mean_velocity"][1]).all()
    assert np.isnan(errors[1])
    for i in (0, 2):
        gait = ROBOT.with_({n: float(v[i]) for n, v in VALUES.items()}).gait("auto")
        assert gait.model == "atlas"
        assert found["mean_velocity"][i] == pytest.approx(gait.mean_velocity, rel=1e-7, abs=1e-12)
        for name in ("mean_power", "efficiency", "swimming_speed"):
            assert found[name][i] == pytest.approx(ms.summary(gait)[name], rel=1e-7)
        assert errors[i] == pytest.approx(gait.info["expected_error"]["us"], rel=1e-7)


def test_a_sweep_takes_each_design_by_the_model_that_serves_it():
    made = ms.sweep(ROBOT, {n: v.tolist() for n, v in VALUES.items()}, "auto")
    for i, amplitude in enumerate(VALUES["tail.amplitude"]):
        for j, radius in enumerate(VALUES["body.radius"]):
            one = ROBOT.with_({"tail.amplitude": float(amplitude), "body.radius": float(radius)})
            gait = one.gait("auto")
            assert gait.model == ("rft" if radius == 3.0 else "atlas")
            speed, error = made.swimming_speed.values[i, j], made.expected_error.values[i, j]
            assert speed == pytest.approx(ms.summary(gait)["swimming_speed"], rel=1e-7)
            assert error == pytest.approx(gait.info["expected_error"]["us"], rel=1e-7)


@pytest.mark.parametrize(
    ("name", "values"),
    [("tail.amplitude", [0.05, 0.1, 0.15]), ("coefficients.normal", [4.0, 6.0]),
     ("interaction.tail[0]", [0.8, 1.0])],
)  # fmt: skip
def test_a_sweep_by_a_law_of_the_spec_says_how_far_it_lies_from_the_atlas(name, values):
    robot = replace(ROBOT, coefficients=ms.Constant(normal=5.0, tangential=3.0))
    made = ms.sweep(robot, {name: values}, "auto")
    for value, error in zip(values, made.expected_error.values):
        gait = robot.with_({name: value}).gait("auto")
        assert gait.model == "rft"
        assert error == pytest.approx(gait.info["expected_error"]["us"], rel=1e-6)


def test_the_atlas_alone_says_why_it_does_not_serve():
    made = ms.sweep(ROBOT, {"body.radius": [0.5, 3.0]}, "atlas")
    assert made.status.values.tolist() == [1, 2]
    assert "body radius" in str(made.reason.values[1])


def test_a_beat_from_a_film_is_said_to_be_of_another_kind():
    """Not that no atlas came along, which a user would look for."""
    assert "it holds helical tails" in not_atlas(ms.Swimmer.preset("cells/sperm"))


@pytest.mark.parametrize(
    "change",
    [
        {"interaction.translation[0]": 1.2},
        {"coefficients.tip": True},
        {"motion.frequency_frame": "lab"},
    ],
)
def test_what_the_atlas_does_not_answer_in_batches_is_left(change):
    assert everywhere(ROBOT.with_(change)) is None
    made = ms.sweep(ROBOT.with_(change), {"tail.amplitude": [0.08, 0.1]}, "auto")
    for i, b in enumerate((0.08, 0.1)):
        gait = ROBOT.with_({**change, "tail.amplitude": b}).gait("auto")
        speed = ms.summary(gait)["swimming_speed"]
        assert made.swimming_speed.values[i] == pytest.approx(speed, rel=1e-7)


def test_commands_take_it_without_being_asked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        result = CliRunner().invoke(main, list(arguments))
        assert result.exit_code == 0, result.output
        return result.output

    run("new", "robot.toml")
    run("sweep", "robot.toml", "--over", "tail.amplitude=0.08:0.12:3", "--out", "a.zarr")
    import xarray as xr

    made = xr.open_zarr("a.zarr", chunks=None)
    assert made.attrs["model"] == "auto"
    assert np.all(made.expected_error.values < 0.1)
    found = json.loads(run("export", "robot.toml", "--format", "c", "--json"))
    assert found["model"] == "atlas"
    assert "expected error of u_s" in (tmp_path / "robot.h").read_text("utf-8")


def test_compiled_and_as_python_it_is_the_same():
    """To the rounding of sums whose terms are a million times the whole."""
    many = everywhere(ROBOT)
    values = {
        "tail.amplitude": np.linspace(0.05, 0.2, 40),
        "body.radius": np.linspace(0.3, 0.6, 40),
    }
    with settled(False):
        python = ms.evaluate(many, values)
    with settled(True):
        compiled = ms.evaluate(many, values)
    for name, value in python.items():
        scale = np.abs(value).max()
        assert np.allclose(compiled[name], value, rtol=1e-7, atol=1e-8 * scale), name


def test_a_design_is_searched_where_the_atlas_holds_and_says_so():
    over = {"tail.amplitude": (0.05, 0.5), "body.radius": (0.3, 3.0)}
    best = ms.design(ROBOT, over, maximize="efficiency", samples=64)
    here = best.swimmer.gait("auto")
    assert best.model == here.model == "atlas"
    assert best.swimmer.region is None
    assert best.value == pytest.approx(ms.summary(here)["efficiency"], rel=1e-7)
    assert best.expected_error == pytest.approx(here.info["expected_error"]["us"])
    assert "of the ranges" in " ".join(best.remarks)
    plain = ms.design(ROBOT, over, maximize="efficiency", samples=64, model="rft")
    assert plain.model == "rft"
    assert plain.value == pytest.approx(ms.summary(plain.swimmer.gait())["efficiency"], rel=1e-7)
    assert "error at the optimum is large" in " ".join(plain.remarks)


def test_where_the_atlas_holds_nowhere_the_surrogate_searches():
    best = ms.design(ROBOT, {"body.radius": (3.0, 4.0)}, maximize="swimming_speed", samples=16)
    assert best.model == "rft"
    with pytest.raises(ms.SpecError, match="holds nowhere"):
        ms.design(
            ROBOT, {"body.radius": (3.0, 4.0)}, maximize="efficiency", samples=16, model="atlas"
        )


def test_choices_that_two_models_answer_say_so():
    over = {"tail.amplitude": (0.05, 0.2), "tail.sections": ["perpendicular", "sheared"]}
    best = ms.design(ROBOT, over, maximize="swimming_speed", samples=16)
    assert "the atlas for perpendicular" in best.remarks[-1]


def test_helices_and_plane_waves_are_both_the_atlas():
    over = {"tail.amplitude": (0.08, 0.2), "tail.kind": ["helix", "plane_wave"]}
    best = ms.design(ROBOT, over, maximize="swimming_speed", samples=16)
    assert best.model == "atlas"
    assert "the atlas for" not in " ".join(best.remarks)


def test_robots_that_differ_by_chance_are_those_of_the_atlas():
    made = ms.robustness(ROBOT, {"tail.amplitude": "2%"}, samples=8)
    one = ROBOT.with_({"tail.amplitude": float(made["tail.amplitude"][0])})
    speed = ms.summary(one.gait("atlas"))["swimming_speed"]
    assert float(made.swimming_speed[0]) == pytest.approx(speed, rel=1e-7)


COLD_AND_WARM = """
import sys
import microswim as ms
tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
robot = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0))
for _ in range(30):
    robot.gait("auto")
print("numba" in sys.modules)
ms.warm_up()
from microswim.calibration.region.evaluate import helices
kernels = helices.alone, helices.parallel
before = [len(k.signatures) for k in kernels]
robot.gait("auto")
robot.gradient("swimming_speed", "tail.amplitude")
print(min(before), before == [len(k.signatures) for k in kernels])
"""


def test_no_gait_compiles_in_the_call():
    """One after the other they run as Python; after warming up nothing is left to compile."""
    run = [sys.executable, "-c", COLD_AND_WARM]
    found = subprocess.run(run, capture_output=True, text=True, check=True, timeout=300)
    assert found.stdout.split() == ["False", "1", "True"]
