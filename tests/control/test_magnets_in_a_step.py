"""A field that depends on place, and soft magnets, in the stepper, the C and the FMU."""

import ctypes
from dataclasses import replace

import fmpy
import numpy as np
import pytest

import microswim as ms
from microswim.control.export import compiler

PULL = ms.DipoleField(moment=(4.0, 8.0, -2.0), position=(0.03, 0.01, 0.02), frequency=0.4)
SOFT = ms.Magnet(susceptibility=((3.0, 0.4, 0), (0.4, 1, 0.2), (0, 0.2, 1.5)), volume=2e-10)
HARD = ms.Magnet(moment=(1e-6, 3e-6, -1e-6))


def robot(magnet):
    return ms.Swimmer(
        body=ms.Sphere(radius=5e-4),
        tail=ms.HelicalTail(length=2e-3, amplitude=2e-4, waves=2, radius=1e-4, frequency=0.0),
        fluid=ms.Fluid(viscosity=0.34),
        coefficients=ms.GrayHancock(),
        magnet=magnet,
        field=PULL,
        units="SI",
    )


def felt(t, x, field=PULL):
    return {"field": field.at(t, x), "field_gradient": field.gradient(t, x), "field_place": x}


@pytest.mark.parametrize("magnet", [HARD, SOFT], ids=["hard", "soft"])
def test_a_field_given_with_its_gradient_is_followed_at_first_order(magnet):
    """The pull is that of where the step began: it lags by half a step."""
    still = replace(PULL, frequency=0.0)
    one, end = ms.Stepper.of(robot(magnet), "rft", locked=True), 0.4
    path = ms.trajectory(robot(magnet).gait("rft"), [0, end], rate=0, moment=magnet, field=still)
    wanted, missed = path.position.values[-1], []
    for n in (20, 40, 80):
        state = ms.State.at()
        for _ in range(n):
            state = one.step(state, dt=end / n, **felt(0.0, state.position, still))
        missed.append(np.linalg.norm(state.position - wanted))
    assert missed[0] < 5e-3 * np.linalg.norm(wanted)
    assert missed[0] / missed[1] == pytest.approx(2.0, rel=0.1)
    assert missed[1] / missed[2] == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize("precision", ["double", "float"])
def test_the_c_feels_what_the_stepper_feels(tmp_path, precision):
    one = ms.Stepper.of(robot(SOFT), "rft", locked=True)
    state = ms.State.at([1e-3, 0, -2e-3], quaternion=[0.5, -0.5, 0.5, 0.5])
    given = felt(0.1, np.array([8e-4, 1e-4, -2e-3])) | {"field_rate": [0.0, 3.0, 1.0]}
    number = ctypes.c_double if precision == "double" else ctypes.c_float
    _, source = compiler.write(ms.c_model(one, "robot", precision=precision), tmp_path)
    compiler.shared_library([source], tmp_path / "model.so")
    code = ctypes.CDLL(str(tmp_path / "model.so"))
    y, u, p = (number * 8)(), (number * 37)(), (number * 10)()
    code.robot_defaults(y, u, p)
    y[:], u[:] = state.values, one.held(1, given)[0]
    for _ in range(10):
        state = one.step(state, dt=0.02, **given)
        assert code.robot_step(p, u, number(0.02), y) == 0
    close = 1e-12 if precision == "double" else 2e-5
    assert np.array(y) == pytest.approx(state.values, rel=close, abs=close)
    assert abs(state.position[0] - 1e-3) > 1e-5


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_the_fmu_takes_gradients(tmp_path, fmi):
    one = ms.Stepper.of(replace(robot(HARD), field=None), "rft", locked=True)
    ms.export_fmu(one, tmp_path / "robot.fmu", name="robot", fmi=fmi)
    given = felt(0.1, np.array([1e-4, 0, 0]))
    values = {f"field_{a}": v for a, v in zip("xyz", given["field"])}
    values |= {f"field_place_{a}": v for a, v in zip("xyz", given["field_place"])}
    for i, row in zip("xyz", given["field_gradient"]):
        values |= {f"field_gradient_{i}{j}": v for j, v in zip("xyz", row)}
    found = fmpy.simulate_fmu(
        str(tmp_path / "robot.fmu"), stop_time=0.2, step_size=0.02, output_interval=0.02,
        start_values=values, output=["x", "y", "z"],
    )  # fmt: skip
    state = ms.State.at()
    for _ in range(10):
        state = one.step(state, dt=0.02, **given)
    last = [float(found[-1][a]) for a in "xyz"]
    assert last == pytest.approx(state.position, rel=1e-9)


@pytest.mark.parametrize(
    "field",
    [
        ms.RotatingField(strength=3e-3, frequency=2.0, axis=(0, 0, 1), cone=0.2),
        ms.UniformField(strength=3e-3, direction=(0, 1, 1)),
    ],
    ids=lambda f: f.kind,
)
def test_a_field_tells_what_a_step_takes(field):
    one, state = ms.Stepper.of(replace(robot(HARD), field=field), "rft", locked=True), ms.State.at()
    for k in range(10):
        state = one.step(state, dt=0.02, **field.felt(0.02 * k, state.position))
    path = ms.trajectory(robot(HARD).gait("rft"), [0, 0.2], rate=0, moment=HARD, field=field)
    assert state.quaternion == pytest.approx(path.quaternion.values[-1], abs=1e-6)
