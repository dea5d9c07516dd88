"""The exported model beside a wall and in a tube: it steps, answers and refuses as Python's does.

The boundaries are made up (tests/boundaries.py), with something in every number of their tables.
"""

import ctypes
import json
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner
from fmpy.validation import validate_fmu

import microswim as ms
from boundaries import RADIUS, beside, inside
from microswim.cli import main
from microswim.control.export import compiler
from microswim.numerics.rigid_motion import rotation_matrix

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
MOMENT = (0.0, 3.0, 1.0)
LOADS = {"force": (1.0, -2.0, -6.0), "torque": (0.5, 0.2, -0.3), "field": (0.4, 1.0, 0.1)}
LOADS |= {"field_rate": (0.3, 0.0, 0.2), "motor_rate": 5.0}
AT = {"wall": (0.1, -0.2, 0.8), "tube": (4.0, 0.3, -0.2)}
TURNED = np.array([0.99, 0.02, -0.1, 0.06]) / np.linalg.norm([0.99, 0.02, -0.1, 0.06])


@cache
def stepper(where):
    rng = np.random.default_rng(1)
    if where == "wall":
        swimmer = replace(ROBOT, wall=ms.Wall(1.0))
        poses = beside(swimmer)
        factors = poses.table.factors
        table = poses.table._replace(factors=factors + 0.02 * rng.normal(size=factors.shape))
    else:
        body = ms.Cylinder(length=2.0, radius=0.5) if where == "tube of a cylinder" else ROBOT.body
        channel = ms.Channel(diameter=2 * RADIUS, length=30.0)
        swimmer = replace(ROBOT, channel=channel, body=body)
        poses = inside(swimmer)
        weights, carried = poses.table.weights, poses.table.carried
        table = poses.table._replace(
            weights=weights + 0.01 * rng.normal(size=weights.shape),
            carried=0.01 * rng.normal(size=carried.shape),
        )
    poses = replace(poses, table=table)
    return ms.Stepper.of(swimmer, poses=poses, moment=MOMENT, resolution=24)


class Code:
    """The C of a stepper, compiled, with its three records."""

    def __init__(self, where, precision="double"):
        self.number = ctypes.c_double if precision == "double" else ctypes.c_float
        self.c = library(where, precision)
        self.c.robot_gap.restype = self.number
        self.c.robot_message.restype = ctypes.c_char_p
        self.y, self.u, self.p = ((self.number * n)() for n in (8, 37, 10))
        self.c.robot_defaults(self.y, self.u, self.p)

    def give(self, one, state, inputs):
        self.y[:] = state.values
        self.u[:] = one.held(1, inputs)[0]

    def step(self, dt):
        return self.c.robot_step(self.p, self.u, self.number(dt), self.y)

    def outputs(self):
        twist, torque = (self.number * 6)(), self.number()
        assert self.c.robot_outputs(self.p, self.u, self.y, twist, ctypes.byref(torque)) == 0
        return np.array(twist), torque.value


FOLDER = tempfile.TemporaryDirectory()


@cache
def library(where, precision):
    folder = Path(FOLDER.name) / f"{where}-{precision}"
    folder.mkdir()
    _, source = compiler.write(ms.c_model(stepper(where), "robot", precision=precision), folder)
    compiler.shared_library([source], folder / "robot.so")
    return ctypes.CDLL(str(folder / "robot.so"))


def flows(where):
    if where == "tube":
        return {"flow": (0.3, 0.0, 0.0)}
    return {"gradient": [[0.0, 0.0, 0.2], [0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]}


@pytest.mark.parametrize("where", ["wall", "tube"])
@pytest.mark.parametrize("precision", ["double", "float"])
def test_c_steps_as_python_beside_a_boundary(where, precision):
    one = stepper(where)
    code = Code(where, precision)
    assert np.array(code.y) == pytest.approx(one.start.values, rel=1e-6)
    close = 1e-8 if precision == "double" else 2e-3
    for inputs in (LOADS, LOADS | flows(where), LOADS | {"force": (0.0, 0.0, -3000.0)}):
        state = ms.State.at(AT[where], TURNED, 0.7)
        code.give(one, state, inputs)
        assert code.c.robot_gap(code.y) == pytest.approx(one.gap(state), abs=close)
        twist, torque = one.outputs(state, **inputs)
        found, other = code.outputs()
        assert found == pytest.approx(twist, abs=close * np.abs(twist).max())
        assert other == pytest.approx(torque, rel=10 * close)
        for _ in range(3):
            state = one.step(state, dt=0.07, **inputs)
            code.u[:] = one.held(1, inputs)[0]
            assert code.step(0.07) == 0
        moved = np.abs(state.values - np.append(AT[where], [*TURNED, 0.7])).max()
        assert np.array(code.y)[:7] == pytest.approx(state.values[:7], abs=10 * close * moved)
        assert code.c.robot_gap(code.y) > 0.0


def test_the_gap_of_a_cylinder_in_c_is_that_of_python():
    """Small tilts, at which either end may be nearest."""
    one, code = stepper("tube of a cylinder"), Code("tube of a cylinder")
    rng = np.random.default_rng(3)
    for _ in range(100):
        q = np.append(1.0, rng.normal(size=3) * [1.0, 0.04, 0.04])
        state = ms.State.at((0.0, *rng.uniform(-0.3, 0.3, 2)), q / np.linalg.norm(q), 0.3)
        code.give(one, state, {})
        gap = one.gap(state)
        assert code.c.robot_gap(code.y) == pytest.approx(gap, abs=1e-9)
        if gap > 0.0:
            twist, _ = one.outputs(state)
            found, _ = code.outputs()
            assert found == pytest.approx(twist, abs=1e-8 * np.abs(twist).max())


@pytest.mark.parametrize("where", ["wall", "tube"])
def test_another_viscosity_scales_all_but_the_motor(where):
    """Twice as thick: half the velocity under loads, the same by the motor, twice its torque."""
    one = stepper(where)
    code = Code(where)
    state = ms.State.at((0.0, 0.0, 0.0 if where == "tube" else 3.0), TURNED)
    code.give(one, state, {"motor_rate": 0.0, "force": (0.0, 0.0, 1.0)})
    pulled, _ = code.outputs()
    code.give(one, state, {})
    swum, torque = code.outputs()
    code.p[0] *= 2.0
    more, twice = code.outputs()
    assert more == pytest.approx(swum, rel=1e-6, abs=1e-9)
    assert twice == pytest.approx(2.0 * torque, rel=1e-6)
    code.give(one, state, {"motor_rate": 0.0, "force": (0.0, 0.0, 1.0)})
    assert code.outputs()[0] == pytest.approx(pulled / 2.0, rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("where", ["wall", "tube"])
def test_c_refuses_what_python_refuses(where):
    one = stepper(where)
    code = Code(where)
    code.y[1], code.y[2] = (0.0, 0.1) if where == "wall" else (0.0, 1.2)
    assert b"into the boundary" in code.c.robot_message(code.step(0.1))
    code.give(one, ms.State.at(AT[where]), {})
    code.u[16 + 2] = 0.1  # a shear along x
    status = code.step(0.1)
    assert status == (0 if where == "wall" else 16)


def test_noise_of_c_beside_a_wall_is_that_of_the_mobility():
    """``z = sqrt(2 k_B T M dt) n + k_B T div M dt``: the drift alone without a kick."""
    one = stepper("wall")
    code = Code("wall")
    place, energy, dt = np.array([0.0, 0.0, 0.56]), 1e-3, 1e-3

    def mobility(x, q):
        return np.linalg.inv(one.poses.at(x, q, 0.0)[0])

    q, h, drift = np.array([1.0, 0, 0, 0]), 1e-4, np.zeros(6)
    for j in range(6):
        for sense in (-1.0, 1.0):
            way, x, turned = sense * h * np.eye(3)[j % 3], place, q
            if j < 3:
                x = place + rotation_matrix(q) @ way
            else:
                turned = np.append(1.0, way / 2.0) / np.linalg.norm(np.append(1.0, way / 2.0))
            drift += sense * mobility(x, turned)[:, j] / (2.0 * h)
    code.give(one, ms.State.at(place), {})
    normals = (code.number * 6)(*np.zeros(6))
    number = code.number
    assert code.c.robot_scatter(code.p, number(energy), number(dt), normals, code.y) == 0
    moved = np.array(code.y[:3]) - place
    assert moved == pytest.approx(energy * dt * drift[:3], rel=1e-2, abs=1e-13)
    M, spread = mobility(place, q), []
    for i in range(6):
        code.give(one, ms.State.at(place), {})
        normals = (code.number * 6)(*np.eye(6)[i])
        assert code.c.robot_scatter(code.p, number(energy), number(dt), normals, code.y) == 0
        spread.append(np.array(code.y[:3]) - place - moved)
    covariance = np.array(spread).T @ np.array(spread) / (2.0 * energy * dt)
    assert covariance == pytest.approx(M[:3, :3], rel=1e-3, abs=1e-3 * M[0, 0])


@pytest.mark.parametrize("where", ["wall", "tube"])
def test_the_fmu_starts_where_the_spec_says_and_steps_as_python(tmp_path, where):
    one, path = stepper(where), tmp_path / "robot.fmu"
    ms.export_fmu(one, path, name="robot")
    assert not validate_fmu(str(path))
    found = fmpy.simulate_fmu(
        str(path), stop_time=0.4, step_size=0.1, output_interval=0.1,
        start_values={"force_z": -3.0}, output=["x", "y", "z", "gap"],
    )  # fmt: skip
    state = one.start
    for _ in range(4):
        state = one.step(state, dt=0.1, force=(0.0, 0.0, -3.0))
    assert [float(found[-1][a]) for a in "xyz"] == pytest.approx(state.position, abs=1e-8)
    assert float(found[-1]["gap"]) == pytest.approx(one.gap(state), abs=1e-8)


def test_the_heads_of_the_files_say_where_the_boundary_is():
    assert "plane z = 0" in ms.c_model(stepper("wall"), "robot").banner
    assert "x axis of the lab" in " ".join(ms.c_model(stepper("tube"), "robot").banner.split())


def test_the_command_exports_a_spec_with_a_wall(tmp_path, monkeypatch):
    asked = []

    def made_up(swimmer, **options):
        asked.append(options["level"])
        return replace(beside(swimmer), expected_error={"us": 0.02, "how": "made up"})

    monkeypatch.setattr("microswim.control.posed_stepper.around", made_up)
    args = ["export", "--preset", "tabak/helix", "--set", "wall.distance=0.9", "--format", "c"]
    done = CliRunner().invoke(main, [*args, "--name", "robot", "--out", str(tmp_path), "--json"])
    assert done.exit_code == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["poses_error"]["us"] == 0.02
    assert asked == [None]
    said = " ".join((tmp_path / "robot.h").read_text("utf-8").split())
    assert "Poses are met within us 2 %" in said
