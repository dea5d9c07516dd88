"""A body without a tail: it resists, a field or a force moves it, and every door takes it."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.spec.file import from_dict, override

FLUID = ms.Fluid(viscosity=1.3)
ELLIPSOID = ms.Ellipsoid(semi_axes=(1.0, 0.5, 0.4))


def alone(body=ELLIPSOID, **parts):
    return ms.Swimmer(body=body, tail=ms.NoTail(), fluid=FLUID, **parts)


@pytest.mark.parametrize("body", [ELLIPSOID, ms.Capsule(length=2.0, radius=0.4)])
def test_all_models_and_mobility_give_the_resistance_of_the_body(body):
    robot = alone(body)
    known = body.resistance(FLUID.viscosity)
    root = np.sqrt(np.outer(known.diagonal(), known.diagonal()))
    gaits = [robot.gait(model, **more) for model, more in
             (("rft", {}), ("auto", {}), ("bem", {"level": "standard"}))]  # fmt: skip
    for gait in gaits:
        assert not gait.propulsion_series.any()
        assert gait.rate == 0.0
        assert np.abs(gait.resistance(1.0) - known).max() < 5e-4 * root.max()
    assert np.abs(ms.mobility(robot).resistance - known).max() < 5e-4 * root.max()


def test_it_rests_and_every_number_says_so():
    robot = alone()
    numbers = ms.summary(robot.gait("auto"))
    for name in ("swimming_speed", "mean_power", "efficiency", "path_radius", "frequency"):
        assert numbers[name] == 0.0
    assert not np.any(numbers["mean_velocity"])
    path = ms.trajectory(robot.gait(), [0.0, 5.0])
    assert not path.position.values.any()


def test_a_force_drags_it_by_its_own_resistance():
    path = ms.trajectory(alone().gait(), [0.0, 7.0], force=[2.0, 0.0, 0.0])
    speed = 2.0 / ELLIPSOID.resistance(FLUID.viscosity)[0, 0]
    assert path.position.values[-1] == pytest.approx([7.0 * speed, 0.0, 0.0])


def test_a_magnetic_sphere_steps_out_where_the_closed_form_says():
    """m B = 8 pi mu a^3 w at step-out; path and stepper follow the field below it."""
    robot = alone(
        ms.Sphere(radius=0.5),
        magnet=ms.Magnet(moment=(0.0, 1.0, 0.0)),
        field=ms.RotatingField(strength=1.0, frequency=0.1),
    )
    found = ms.regimes(robot, [0.02, 0.1], model="rft")
    exact = 1.0 / (8.0 * np.pi * FLUID.viscosity * 0.125) / (2.0 * np.pi)
    assert found.step_out == pytest.approx(exact, rel=1e-6)


def test_path_and_stepper_turn_a_magnetic_sphere_into_the_field_as_the_closed_form():
    """8 pi mu a^3 angle' = -m B sin(angle): tan(angle/2) falls with exp(-m B t/(8 pi mu a^3))."""
    robot = alone(ms.Sphere(radius=0.5), magnet=ms.Magnet(moment=(0.0, 1.0, 0.0)))
    field, end = [0.0, 0.0, 2.0], 3.0
    left = np.exp(-2.0 * end / (8.0 * np.pi * FLUID.viscosity * 0.125))
    exact = 2.0 * np.arctan(left)  # the moment starts across the field
    path = ms.trajectory(robot.gait(), [0.0, end], moment=robot.magnet, field=field)
    stepper, state = ms.Stepper.of(robot), ms.State.at()
    for _ in range(30):
        state = stepper.step(state, dt=end / 30, field=field)
    for q in (path.quaternion.values[-1], np.ravel(state.quaternion)):
        w, x, y, z = q
        along = 2.0 * (y * z + w * x)  # lab z of the body's axis q
        assert np.arccos(along) == pytest.approx(exact, rel=1e-5)


def test_a_long_moment_across_holds_at_any_slow_rate():
    """Turned about its long axis by a moment across it, a body precesses by no angle at all."""
    robot = alone(
        ms.Cylinder(length=2.0, radius=0.5),
        magnet=ms.Magnet(moment=(0.0, 1.0, 0.0)),
        field=ms.RotatingField(strength=1.0, frequency=0.1),
    )
    top = ms.regimes(robot, [0.01], model="rft").step_out
    found = ms.regimes(robot, [2e-4 * top, 0.5 * top], model="rft")
    assert found.regime == ("synchronous", "synchronous")
    assert found.precession_angle == pytest.approx([0.0, 0.0], abs=1e-6)


def test_a_spec_file_holds_it_and_gives_it_back(tmp_path):
    robot = alone()
    assert 'kind = "none"' in robot.to_toml()
    path = tmp_path / "robot.toml"
    path.write_text(robot.to_toml())
    assert ms.Swimmer.from_toml(path) == robot


def test_a_tail_is_taken_off_by_one_override():
    tables = {"fluid": {"viscosity": 1.0}, "body": {"shape": "sphere", "radius": 1.0},
              "tail": {"kind": "helix", "length": 2.0, "amplitude": 0.1, "waves": 3,
                       "radius": 0.05}}  # fmt: skip
    assert from_dict(tables, {"tail.kind": "none"}).tail == ms.NoTail()
    assert override(tables, {"body.shape": "none"})["body"] == {"shape": "none"}
    assert "length" in tables["tail"]


def test_neither_body_nor_tail_is_refused():
    with pytest.raises(ms.SpecError, match="needs a body or a tail"):
        alone(ms.NoBody())


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda robot: ms.validate(robot, {"fluid.viscosity": [1.0]}, "rft"), "map of errors"),
        (lambda robot: ms.calibrate(robot, robot.gait(), ["translation.s"]), "a calibration"),
        (lambda robot: robot.gait("atlas"), "helical"),
        (lambda robot: robot.gait("elastic"), "elastic"),
    ],
)
def test_what_wants_propulsion_says_that_there_is_none(call, said):
    with pytest.raises(ms.SpecError, match=said):
        call(alone())


def test_the_commands_take_it(tmp_path):
    spec = tmp_path / "robot.toml"
    spec.write_text(alone().to_toml())
    for args in (
        ["run", "--json"],
        ["show", "--json"],
        ["mobility", "--level", "coarse", "--json"],
    ):
        done = CliRunner().invoke(main, [args[0], str(spec), *args[1:]])
        assert done.exit_code == 0, done.output
        said = json.loads(done.stdout)
        assert "NaN" not in done.stdout
    assert said["resistance"][0][0] > 0
    told = json.loads(CliRunner().invoke(main, ["run", str(spec), "--json"]).stdout)
    assert told["expected_error"]["us"] == 0.0
    assert "without a tail" in told["expected_error"]["how"]


@pytest.mark.parametrize(
    ("height", "drag"), [(1.5431, 1.5675), (1.1276, 2.1514), (1.0453, 2.6475), (1.005004, 3.7863)]
)
def test_a_sphere_slides_beside_a_wall_as_published(height, drag):
    """Force along the wall over 6 pi mu a U without turning [Goldman et al. 1967], table 1."""
    robot = alone(ms.Sphere(radius=1.0), wall=ms.Wall(distance=height))
    R = robot.gait("bem").resistance(0.0)
    assert R[0, 0] / (6.0 * np.pi * FLUID.viscosity) == pytest.approx(drag, rel=1e-3)
    assert np.linalg.eigvalsh(R).min() > 0.0
