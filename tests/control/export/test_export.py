"""What is exported computes what Python computes: compiled here, called, simulated, provoked."""

import ctypes
import json
import shutil
import subprocess
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import microswim as ms
from microswim.cli import main
from microswim.control.export import compiler
from microswim.spec import presets

ALL = {
    "motor_rate": 4.0,
    "force": [3.0, -20.0, 10.0],
    "torque": [5.0, 30.0, -20.0],
    "field": [0.0, 50.0, 20.0],
    "field_rate": [2.0, 0.5, 0.0],
    "flow": [0.1, 0.2, -0.3],
    "gradient": [[0.1, 0.3, 0.0], [0.0, 0.0, -0.2], [0.1, 0.0, -0.1]],
}
MOMENT = (0.0, 1.0, 0.5)
KINDS = ["tabak/helix", "tabak/plane_wave"]


@cache
def stepper(name="tabak/helix", **options):
    return ms.Stepper.of(ms.Swimmer.preset(name), moment=MOMENT, **options)


def vector(n):
    return ctypes.c_double * n


class State(ctypes.Structure):
    _fields_ = [("values", vector(8))]


class Inputs(ctypes.Structure):
    _fields_ = [("values", vector(37))]


class Parameters(ctypes.Structure):
    _fields_ = [("viscosity", ctypes.c_double), ("moment", vector(3)), ("soft", vector(6))]


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """Compile the C of a stepper; a machine without a compiler fails here, and says so."""

    @cache
    def built(one, name="robot"):
        folder = tmp_path_factory.mktemp("c")
        _, source = compiler.write(ms.c_model(one, name), folder)
        compiler.shared_library([source], folder / "model.so")
        library = ctypes.CDLL(str(folder / "model.so"))
        library.robot_step.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_double, ctypes.c_void_p]
        library.robot_message.restype = ctypes.c_char_p
        return library

    return built


def contents(library, start, inputs=ALL, one=None):
    y, u, p = State(), Inputs(), Parameters()
    library.robot_defaults(ctypes.byref(y), ctypes.byref(u), ctypes.byref(p))
    y.values[:] = start.values
    u.values[:] = (one or stepper()).held(1, inputs)[0]
    return y, u, p


START = ms.State.at([0.2, -0.1, 0.3], np.array([0.5, -0.5, 0.7, 0.1]) / 1.0, 0.4)


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("inputs", [{}, ALL], ids=["free", "all inputs"])
def test_c_steps_as_python(build, name, inputs):
    one = stepper(name)
    library = build(one)
    y, u, p = contents(library, START, inputs, one)
    state = START
    for _ in range(20):
        before = state
        state = one.step(state, dt=0.3, **inputs)
        assert library.robot_step(ctypes.byref(p), ctypes.byref(u), 0.3, ctypes.byref(y)) == 0
        assert np.array(y.values) == pytest.approx(state.values, rel=1e-12, abs=1e-12)
    assert np.abs(state.values[:3] - before.values[:3]).max() > 1e-3
    twist, torque = vector(6)(), ctypes.c_double()
    library.robot_outputs(*map(ctypes.byref, (p, u, y, twist, torque)))
    V, wanted = one.outputs(state, **inputs)
    assert np.array(twist) == pytest.approx(V, rel=1e-11, abs=1e-12)
    assert torque.value == pytest.approx(float(wanted), rel=1e-11)


def test_viscosity_of_the_c_is_that_of_the_spec(build):
    """Twice the viscosity in C: the swimmer that was made with twice the viscosity."""
    thick = ms.Swimmer.preset("tabak/helix", {"fluid.viscosity": 200.0})
    one = ms.Stepper.of(thick, moment=MOMENT)
    library = build(stepper())
    y, u, p = contents(library, START)
    p.viscosity = 200.0
    library.robot_step(ctypes.byref(p), ctypes.byref(u), 0.3, ctypes.byref(y))
    state = one.step(START, dt=0.3, **ALL)
    assert np.array(y.values) == pytest.approx(state.values, rel=1e-9, abs=1e-9)
    torque = ctypes.c_double()
    library.robot_outputs(*map(ctypes.byref, (p, u, y, vector(6)(), torque)))
    assert torque.value == pytest.approx(float(one.outputs(state, **ALL)[1]), rel=1e-9)


def test_a_locked_motor_is_locked_in_c(build):
    one = stepper(locked=True)
    library = build(one)
    inputs = {k: v for k, v in ALL.items() if k != "motor_rate"}
    y, u, p = contents(library, START, inputs, one)
    assert library.robot_step(ctypes.byref(p), ctypes.byref(u), 0.3, ctypes.byref(y)) == 0
    state = one.step(START, dt=0.3, **inputs)
    assert np.array(y.values) == pytest.approx(state.values, rel=1e-12, abs=1e-12)
    u.values[0] = 1.0
    status = library.robot_step(ctypes.byref(p), ctypes.byref(u), 0.3, ctypes.byref(y))
    assert b"locked" in library.robot_message(status)


@pytest.mark.parametrize(
    ("where", "value", "word"),
    [
        ("viscosity", 0.0, b"viscosity"),
        ("viscosity", np.nan, b"viscosity"),
        ("moment", np.inf, b"moment"),
        ("field", np.nan, b"field"),
        ("gradient", 3.0, b"gradient"),
        ("position", np.nan, b"position"),
        ("quaternion", 2.0, b"quaternion"),
        ("dt", -0.1, b"dt"),
    ],
)
def test_c_refuses_and_leaves_the_state_alone(build, where, value, word):
    library = build(stepper())
    y, u, p = contents(library, START)
    dt = value if where == "dt" else 0.3
    spots = {"moment": (p.moment, 1), "field": (u.values, 8), "gradient": (u.values, 16)}
    spots |= {"position": (y.values, 0), "quaternion": (y.values, 3)}
    if where == "viscosity":
        p.viscosity = value
    elif where in spots:
        array, i = spots[where]
        array[i] = value
    before = np.array(y.values)
    status = library.robot_step(ctypes.byref(p), ctypes.byref(u), dt, ctypes.byref(y))
    assert word in library.robot_message(status)
    assert np.array_equal(np.array(y.values), before, equal_nan=True)


def test_c_needs_libm_alone(build, tmp_path):
    """No memory, no files, no other library: functions of math.h and string.h, one type."""
    model = ms.c_model(stepper(), "robot")
    includes = {line for line in model.source.splitlines() if line.startswith("#include")}
    assert includes == {
        '#include "robot.h"',
        *(f"#include <{h}.h>" for h in ("math", "stdint", "string")),
    }
    assert "malloc" not in model.source
    for word in ("qw, qx, qy, qz", "body to lab", "microswim " + ms.__version__, "sha256:"):
        assert word in model.header
        assert word in model.source


@pytest.fixture(scope="module", params=["3.0", "2.0"])
def unit(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "robot.fmu"
    one = stepper(resolution=200.0)
    ms.export_fmu(one, path, name="robot", fmi=request.param)
    folder = fmpy.extract(str(path))
    yield path, fmpy.read_model_description(str(path)), folder
    shutil.rmtree(folder)


@pytest.fixture
def instances(unit):
    """Instances of the unit; freed afterwards."""
    _, about, folder = unit
    made = []

    def new(**start):
        kind = FMU3Slave if about.fmiVersion == "3.0" else FMU2Slave
        slave = kind(
            guid=about.guid or about.instantiationToken,
            unzipDirectory=folder,
            modelIdentifier="robot",
            instanceName=f"robot{len(made)}",
        )
        slave.instantiate()
        made.append(slave)
        slave.set = lambda **v: write(slave, about, v)
        slave.get = lambda *names: read(slave, about, names)
        slave.set(**start)
        if about.fmiVersion == "2.0":
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
        else:
            slave.enterInitializationMode(startTime=0.0)
        slave.exitInitializationMode()
        return slave

    yield new
    for slave in made:
        slave.terminate()
        slave.freeInstance()


def references(about, names):
    table = {v.name: v.valueReference for v in about.modelVariables}
    return [table[n] for n in names]


def write(slave, about, values):
    setter = slave.setFloat64 if about.fmiVersion == "3.0" else slave.setReal
    setter(references(about, values), list(values.values()))


def read(slave, about, names):
    getter = slave.getFloat64 if about.fmiVersion == "3.0" else slave.getReal
    return np.array(getter(references(about, names)))


@pytest.mark.parametrize("fmi", ["3.0", "2.0"])
def test_a_unit_in_si_declares_its_units(tmp_path, fmi):
    """And a cell swims as `trajectory` says, at its own scale of micrometres."""
    cell = ms.Swimmer.preset("goto/C")
    found = ms.export_fmu(ms.Stepper.of(cell), tmp_path / "cell.fmu", name="cell", fmi=fmi)
    assert validate_fmu(found["path"]) == []
    about = fmpy.read_model_description(found["path"])
    units = {v.name: v.unit for v in about.modelVariables}
    assert (units["x"], units["force_x"], units["viscosity"]) == ("m", "N", "Pa.s")
    T = cell.gait().period
    run = fmpy.simulate_fmu(found["path"], stop_time=20 * T, output_interval=T, output=["x"])
    path = ms.trajectory(cell.gait(), [0.0, 20 * T])
    assert run["x"][-1] == pytest.approx(float(path.position[-1, 0]), rel=1e-6)


POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")


def test_the_unit_is_valid_and_says_its_conventions(unit):
    path, about, folder = unit
    assert validate_fmu(str(path)) == []
    assert "qw, qx, qy, qz" in about.description
    for file in Path(folder).rglob("*"):
        if file.is_file() and file.suffix not in (".so", ".dll", ".dylib"):
            assert "body to lab" in " ".join(file.read_text().split()), file
    page = (Path(folder) / "documentation" / "index.html").read_text()
    assert "body to lab" in page
    assert "qw, qx, qy, qz" in (Path(folder) / "sources" / "fmu.c").read_text()


def test_the_unit_agrees_with_trajectory(unit):
    path, _, _ = unit
    times = np.linspace(0.0, 2.0, 41)
    loads = {"field": [10.0, 30.0, 0.0], "force": [5.0, 0.0, -4.0], "torque": [0.0, 3.0, 1.0]}
    start = {f"{k}_{i}": x for k, v in loads.items() for i, x in zip("xyz", v)}
    found = fmpy.simulate_fmu(
        str(path), stop_time=2.0, output_interval=0.05, start_values=start, output=[*POSE, "phase"]
    )
    gait = ms.Swimmer.preset("tabak/helix").gait()
    path_ = ms.trajectory(gait, times, moment=MOMENT, max_step=1e-3, **loads)
    for i, name in enumerate(("x", "y", "z")):
        assert np.abs(np.asarray(found[name]) - path_.position[:, i].values).max() < 1e-8
    for i, name in enumerate(("qw", "qx", "qy", "qz")):
        assert np.abs(np.asarray(found[name]) - path_.quaternion[:, i].values).max() < 1e-8
    assert abs(path_.position.values).max() > 0.05


def test_inputs_that_change_reach_the_unit(unit, instances):
    """Motor reversed half-way, force applied: as the stepper does it."""
    slave, one, state = instances(), stepper(resolution=200.0), ms.State.at()
    for i in range(10):
        rate, force = (5.0, 2.0) if i < 5 else (-3.0, -1.0)
        slave.set(motor_rate=rate, force_y=force)
        slave.doStep(currentCommunicationPoint=0.1 * i, communicationStepSize=0.1)
        state = one.step(state, dt=0.1, motor_rate=rate, force=[0, force, 0])
        assert slave.get(*POSE) == pytest.approx(state.values[:7], abs=1e-12)
    V, torque = one.outputs(state, motor_rate=-3.0, force=[0, -1.0, 0])
    assert slave.get("us", "uq", "ur", "os", "oq", "or") == pytest.approx(V, abs=1e-10)
    assert slave.get("motor_torque")[0] == pytest.approx(float(torque), rel=1e-10)


def test_two_instances_at_once_do_not_know_each_other(instances):
    a, b = instances(motor_rate=5.0), instances(motor_rate=5.0, viscosity=200.0, start_x=1.0)
    alone = instances(motor_rate=5.0)
    for i in range(5):
        for slave in (a, b):
            slave.set(force_x=30.0)
            slave.doStep(0.1 * i, 0.1)
    for i in range(5):
        alone.set(force_x=30.0)
        alone.doStep(0.1 * i, 0.1)
    assert (a.get(*POSE) == alone.get(*POSE)).all()
    assert abs(b.get("x")[0] - 1.0 - a.get("x")[0]) > 1e-3


def test_a_state_can_be_kept_and_returned_to(unit, instances):
    three = unit[1].fmiVersion == "3.0"
    slave = instances(motor_rate=5.0)
    slave.doStep(0.0, 0.1)
    kept = slave.getFMUState() if three else slave.getFMUstate()
    slave.doStep(0.1, 0.1)
    first = slave.get(*POSE, "phase")
    (slave.setFMUState if three else slave.setFMUstate)(kept)
    slave.doStep(0.1, 0.1)
    assert (slave.get(*POSE, "phase") == first).all()
    packed = (slave.serializeFMUState if three else slave.serializeFMUstate)(kept)
    again = (slave.deserializeFMUState if three else slave.deSerializeFMUstate)(packed)
    other = instances()
    (other.setFMUState if three else other.setFMUstate)(again)
    other.doStep(0.1, 0.1)
    assert (other.get(*POSE, "phase") == first).all()
    (slave.freeFMUState if three else slave.freeFMUstate)(kept)
    (other.freeFMUState if three else other.freeFMUstate)(again)
    slave.reset()


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [
        ("viscosity", 0.0, "viscosity"),
        ("viscosity", -1.0, "viscosity"),
        ("viscosity", np.nan, "finite"),
        ("moment_q", np.inf, "finite"),
        ("start_qw", 0.5, "quaternion"),
        ("motor_rate", np.nan, "finite"),
        ("gradient_xx", 1.0, "gradient"),
    ],
)
def test_a_wrong_parameter_is_an_error_not_a_nan(unit, name, value, word, capsys):
    with pytest.raises(Exception, match=r"[Ss]tatus|error|failed"):
        fmpy.simulate_fmu(str(unit[0]), stop_time=0.1, start_values={name: value}, output=["x"])
    assert word in capsys.readouterr().out


def test_the_start_pose_is_fixed_once_begun(instances):
    slave = instances()
    slave.doStep(0.0, 0.1)
    with pytest.raises(Exception, match=r"[Ss]tatus|error|failed"):
        slave.set(start_x=1.0)


def call(*args, **more):
    return CliRunner(**more).invoke(main, ["export", *map(str, args)])


def sentence(result, status):
    assert result.exit_code == status, (result.stdout, result.stderr, result.exception)
    (line,) = result.stderr.splitlines()
    return line


@pytest.mark.parametrize("kind", ["c", "fmu"])
def test_the_command_writes_and_prints(tmp_path, kind):
    spec = tmp_path / "my robot.toml"
    spec.write_text(presets.read("tabak/helix"))
    options = ("--format", kind, "--out", tmp_path / "new", "--moment", "[0, 1, 0.5]")
    result = call(spec, *options, "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    names = {"c": {"my_robot.h", "my_robot.c"}, "fmu": {"my_robot.fmu"}}[kind]
    assert {p.name for p in (tmp_path / "new").iterdir()} == names
    assert found["object_bytes"] > 5000
    assert 0 < found["seconds_per_step"] < 1
    assert found["bytes"] == sum(p.stat().st_size for p in (tmp_path / "new").iterdir())
    assert "--force" in sentence(call(spec, *options), 2)
    again = call(spec, *options, "--force")
    assert again.exit_code == 0
    assert "µs per internal step" in again.stdout


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--moment", "[1, 2]"), "--moment"),
        (("--moment", "strong"), "--moment"),
        (("--moment", "[1, nan, 2]"), "moment"),
        (("--name", "7 dwarfs"), "name"),
        (("--resolution", "nan"), "resolution"),
        (("--set", "tail.radius=-1"), "tail.radius"),
    ],
)
def test_mistakes_are_one_sentence_and_write_nothing(tmp_path, options, word):
    result = call("--preset", "tabak/helix", "--format", "c", "--out", tmp_path, *options)
    assert word in sentence(result, 2)
    assert list(tmp_path.iterdir()) == []


def test_without_a_compiler_c_is_written_and_an_fmu_is_one_sentence(tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    result = call("--preset", "tabak/helix", "--format", "c", "--out", tmp_path)
    assert result.exit_code == 0
    assert "no C compiler" in result.stdout
    result = call("--preset", "tabak/helix", "--format", "fmu", "--out", tmp_path / "new")
    assert "no C compiler" in sentence(result, 1)
    assert list((tmp_path / "new").iterdir()) == []


def test_a_compiler_that_fails_is_one_sentence(tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "false")
    result = call("--preset", "tabak/helix", "--format", "fmu", "--out", tmp_path / "new")
    assert "false failed" in sentence(result, 1)


def test_the_c_is_also_cplusplus_by_its_header(tmp_path):
    """A header that C++ programs include."""
    compiler.write(ms.c_model(stepper(), "robot"), tmp_path)
    text = (tmp_path / "robot.h").read_text()
    assert 'extern "C"' in text
    program = tmp_path / "main.c"
    program.write_text('#include "robot.h"\n#include "robot.h"\nint main(void) { return 0; }\n')
    subprocess.run(
        [*compiler.required(), *compiler.FLAGS, "-c", "-o", tmp_path / "m.o", program], check=True
    )


@pytest.mark.parametrize("model", ["rft", "auto"])
def test_the_head_and_the_command_say_how_far_off_the_model_is(tmp_path, model):
    spec = tmp_path / "robot.toml"
    spec.write_text(presets.read("tabak/helix"), encoding="utf-8")
    asked = ["export", str(spec), "--format", "c", "--model", model, "--out", str(tmp_path)]
    run = CliRunner().invoke(main, asked)
    assert run.exit_code == 0, run.output
    for text in (run.stdout, (tmp_path / "robot.c").read_text(encoding="utf-8")):
        assert "expected error of u_s" in text
