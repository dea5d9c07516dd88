"""Exports under inputs that make no sense: bounded time, no NaN with a good status."""

import ctypes
import json
import os
import shutil
import subprocess
import tomllib
import zipfile
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

import microswim as ms
from microswim.cli import main
from microswim.control.export import compiler
from microswim.spec.file import from_dict
from microswim.swimmer.fields import lifted

ROBOT = """
[fluid]
viscosity = "100 mPa s"
[body]
shape = "sphere"
radius = "0.5 mm"
[tail]
kind = "helix"
length = "3 mm"
amplitude = "0.3 mm"
waves = 2
radius = "0.05 mm"
frequency = "5 Hz"
[coefficients]
law = "gray_hancock"
"""
MOMENT = (0.0, 2e-5, 0.0)
START = ms.State.at([1e-3, 0.0, 2e-3], [0.5, -0.5, 0.7, 0.1], 0.4)
FLOATS = {"double": ctypes.c_double, "float": ctypes.c_float}


def robot(text=ROBOT):
    return from_dict(tomllib.loads(text))


@cache
def stepper(**options):
    return ms.Stepper.of(robot(), **{"moment": MOMENT, **options})


class Library:
    """The compiled C of a stepper, with its three records."""

    def __init__(self, folder, one, precision="double", flags=()):
        self.number, self.one = FLOATS[precision], one
        _, source = compiler.write(ms.c_model(one, "robot", precision=precision), folder)
        target = folder / "robot.so"
        cc, thing = compiler.required(), folder / "robot.o"
        subprocess.run([*cc, *compiler.FLAGS, *flags, "-c", "-o", thing, source], check=True)
        # linked without -ffast-math, or the whole process would lose its smallest numbers
        subprocess.run([*cc, "-shared", "-o", target, thing, "-lm"], check=True)
        self.code = ctypes.CDLL(str(target))
        self.code.robot_message.restype = ctypes.c_char_p
        self.parameters = (self.number * 10)()
        self.inputs = (self.number * 37)()
        self.state = (self.number * 8)()
        self.code.robot_defaults(self.state, self.inputs, self.parameters)

    def begin(self, state=START, **inputs):
        self.state[:] = state.values
        self.inputs[:] = self.one.held(1, inputs)[0]

    def step(self, dt):
        return self.code.robot_step(self.parameters, self.inputs, self.number(dt), self.state)

    def outputs(self):
        found, torque = (self.number * 6)(), self.number()
        args = (self.parameters, self.inputs, self.state, found, ctypes.byref(torque))
        return self.code.robot_outputs(*args), np.array(found), torque.value

    def message(self, status):
        return self.code.robot_message(status).decode()


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    @cache
    def built(one=None, precision="double", flags=()):
        return Library(tmp_path_factory.mktemp("c"), one or stepper(), precision, flags)

    return built


@pytest.mark.parametrize("field", [4e3, 4e5, 1e30, 1e300])
def test_a_glitch_of_the_field_is_an_error_not_an_hour(build, field):
    """A step of one millisecond at 400 kT would take 60 s, at 1e30 T a count overflows."""
    library = build()
    library.begin(field=[0.0, 0.0, field])
    before = list(library.state)
    status = library.step(1e-3)
    assert "too far in one step" in library.message(status)
    assert list(library.state) == before
    with pytest.raises(ms.SpecError, match="must be short enough"):
        stepper().step(START, dt=1e-3, field=[0.0, 0.0, field])
    with pytest.raises(ms.SpecError, match="internal steps"):
        stepper().derivatives(START, dt=1e-3, field=[0.0, 0.0, field])


def test_the_bound_is_where_it_is_told():
    """And what lies below it is followed, by C and Python alike."""
    one = stepper(most_steps=50)
    turn = 50 * 2 * np.pi / one.resolution
    rate = 1000.0
    one.step(START, dt=0.999 * turn / rate, motor_rate=rate)
    with pytest.raises(ms.SpecError, match="50 internal steps"):
        one.step(START, dt=1.001 * turn / rate, motor_rate=rate)


def test_the_bound_of_the_c_is_that_of_python(build):
    one = stepper(most_steps=50)
    library, dt = build(one), 50 * 2 * np.pi / one.resolution / 1000.0
    library.begin(motor_rate=1000.0)
    assert library.step(0.999 * dt) == 0
    assert library.step(1.001 * dt) == 9


def test_steps_that_are_fixed_are_fixed_in_c(build):
    one = stepper(steps=3)
    library = build(one)
    inputs = {"motor_rate": 30.0, "field": [1e-3, 2e-3, 0.0], "field_rate": [40.0, 0.0, 0.0]}
    library.begin(**inputs)
    state = START
    for _ in range(20):
        assert library.step(0.01) == 0
        state = one.step(state, dt=0.01, **inputs)
    assert np.array(library.state) == pytest.approx(state.values, rel=1e-11, abs=1e-12)
    fine = stepper(steps=60).step(START, dt=0.2, **inputs)
    assert np.abs(state.values - fine.values).max() > 1e-9  # three steps are not sixty
    wide = 3 * np.pi / 2 / 30.0
    library.begin(motor_rate=30.0)
    assert library.step(0.99 * wide) == 0
    assert library.step(1.01 * wide) == 9
    with pytest.raises(ms.SpecError, match="3 internal steps"):
        one.step(START, dt=1.01 * wide, motor_rate=30.0)


TOO_LARGE = [
    {"force": [1e308, 1e308, 0.0]},
    {"torque": [0.0, 1e308, 0.0]},
    {"flow": [1e308, 1e308, 1e308]},
    {"field": [1e308, 0.0, 0.0], "force": [-1e308, 0, 0]},
    {"motor_rate": 1e308},
    {"field_rate": [1e308, 1e308, 0.0]},
    {"gradient": [[0.0, 1e308, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]},
]


@pytest.mark.parametrize("flags", [(), ("-ffast-math",)], ids=["as it is", "-ffast-math"])
@pytest.mark.parametrize("inputs", TOO_LARGE, ids=lambda d: "+".join(d))
def test_no_result_is_infinite_with_a_good_status(build, inputs, flags):
    library = build(flags=flags)
    library.begin(**inputs)
    for dt in (1e-3, 1e-300, 1e300):
        library.state[:] = START.values
        status = library.step(dt)
        still = list(library.state) == list(START.values)
        assert np.isfinite(np.array(library.state)).all()
        assert status in ((0, 9, 10) if dt < 1 else (9, 10))
        assert still if status else dt < 1e-3 or not still
    status, twist, torque = library.outputs()
    assert status or (np.isfinite(twist).all() and np.isfinite(torque))
    if not flags:
        with pytest.raises(ms.MicroswimError):
            stepper().step(START, dt=1e300, **inputs)
        if status:
            with pytest.raises(ms.MicroswimError, match="finite"):
                stepper().outputs(START, **inputs)


@pytest.mark.parametrize("flags", [(), ("-ffast-math",), ("-Ofast",)], ids=str)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_found_by_its_bits(build, bad, flags):
    library = build(flags=flags)
    for which, n in (("inputs", 37), ("state", 8), ("parameters", 10)):
        for i in range(n):
            library.begin(motor_rate=1.0)
            library.parameters[:] = [0.1, *MOMENT, *np.zeros(6)]
            getattr(library, which)[i] = bad
            assert library.step(1e-3) in range(1, 8), (which, i)
            assert library.outputs()[0] in range(1, 8), (which, i)
    library.parameters[:] = [0.1, *MOMENT, *np.zeros(6)]
    library.begin(motor_rate=1.0)
    assert library.step(bad) == 8
    assert library.step(1e-3) == 0


def test_a_viscosity_next_to_zero_is_refused(build):
    library = build()
    library.begin(motor_rate=1.0)
    library.parameters[0] = 1e-320
    assert "viscosity" in library.message(library.step(1e-3))
    library.parameters[0] = 0.1
    thin = lifted(ms.Swimmer.preset("tabak/helix"), {"fluid.viscosity": 1e-320})
    with pytest.raises(ms.MicroswimError, match="finite"):
        ms.Stepper(thin.gait()).step(ms.State.at(), dt=0.1)


STRICT = ("-Wdouble-promotion", "-Wconversion", "-Wno-sign-conversion")


def test_float_follows_double_to_its_own_precision(build):
    """Two hundred steps, all inputs; with a compiler that complains of any double."""
    library = build(precision="float", flags=STRICT)
    inputs = {
        "motor_rate": 30.0,
        "force": [1e-8, 0.0, -2e-8],
        "torque": [0.0, 1e-11, 0.0],
        "field": [1e-3, 2e-3, 0.0],
        "field_rate": [10.0, 0.0, 0.0],
        "flow": [1e-4, 0.0, 2e-4],
        "gradient": [[0.1, 0.3, 0.0], [0.0, 0.0, -0.2], [0.1, 0.0, -0.1]],
    }
    library.begin(**inputs)
    state = START
    for _ in range(200):
        assert library.step(0.01) == 0
        state = stepper().step(state, dt=0.01, **inputs)
    moved = np.linalg.norm(state.position - START.position)
    assert moved > 2e-4
    assert np.abs(np.array(library.state)[:3] - state.position).max() < 1e-3 * moved
    assert np.array(library.state)[3:7] == pytest.approx(state.quaternion, abs=1e-3)
    assert library.state[7] == pytest.approx(float(state.phase) % (2 * np.pi), abs=1e-3)
    _, twist, torque = library.outputs()
    V, wanted = stepper().outputs(state, **inputs)
    assert twist == pytest.approx(V, rel=1e-2, abs=1e-3 * np.abs(V[3:]).max())
    assert torque == pytest.approx(float(wanted), rel=1e-3)


def test_a_phase_of_float_stays_where_it_has_digits(build):
    """After an hour of 5 Hz an unwrapped phase of 1e5 has no more than a hundredth of a radian."""
    library = build(precision="float", flags=STRICT)
    library.begin(motor_rate=2 * np.pi * 5)
    for _ in range(3000):
        assert library.step(0.2) == 0  # one turn each
        assert 0 <= library.state[7] <= 2 * np.pi
    assert np.cos(library.state[7] - 0.4) > np.cos(0.05)


def test_a_model_beyond_a_float_is_refused():
    thin = lifted(ms.Swimmer.preset("tabak/helix"), {"fluid.viscosity": 1e-33})
    tiny = ms.Stepper.of(thin)
    with pytest.raises(ms.SpecError, match="beyond those of a float"):
        ms.c_model(tiny, precision="float")
    with pytest.raises(ms.SpecError, match="precision"):
        ms.c_model(tiny, precision="half")


def test_the_loop_of_the_docs_runs(tmp_path):
    page = (Path(__file__).parents[3] / "docs" / "control.md").read_text(encoding="utf-8")
    (main_,) = [part.split("```")[0] for part in page.split("```c\n")[1:]]
    _, source = compiler.write(ms.c_model(stepper(), "robot"), tmp_path)
    (tmp_path / "main.c").write_text(main_)
    program = tmp_path / "loop"
    command = [*compiler.required(), *compiler.FLAGS, "-o", program, tmp_path / "main.c", source]
    subprocess.run([*command, "-lm"], check=True)
    done = subprocess.run([program], check=True, capture_output=True, text=True)
    state = ms.State.at()
    for _ in range(1000):
        force = [0.0, 0.0, -1e-9 if state.position[2] > 0 else 1e-9]
        state = stepper().step(state, dt=1e-3, force=force)
    assert [float(x) for x in done.stdout.split()] == pytest.approx(state.position, rel=1e-4)


def test_the_c_is_also_that_of_gnu(tmp_path):
    """Whose math.h has more names than the standard's."""
    for precision in FLOATS:
        _, source = compiler.write(ms.c_model(stepper(), "robot", precision=precision), tmp_path)
        flags = [f for f in compiler.FLAGS if not f.startswith(("-std", "-pedantic"))]
        command = [*compiler.required(), "-std=gnu11", *flags, "-c", source]
        subprocess.run([*command, "-o", tmp_path / "robot.o"], check=True)


@pytest.mark.parametrize("name", ["int", "double", "Class", "main", "math", "string", "fmu"])
def test_words_of_c_are_no_names(name, tmp_path):
    with pytest.raises(ms.SpecError, match="no word of C"):
        ms.c_model(stepper(), name)
    spec = tmp_path / f"{name}.toml"
    spec.write_text(ROBOT)
    done = call(spec, "--format", "c", "--out", tmp_path / "new")
    assert done.exit_code == 0, done.stderr
    assert (tmp_path / "new" / f"{name}_swimmer.h").exists()
    refused = call(spec, "--format", "c", "--out", tmp_path / "new", "--name", name)
    assert refused.exit_code == 2
    assert refused.stderr.count("\n") == 1


@pytest.fixture(scope="module", params=["3.0", "2.0"])
def units(request, tmp_path_factory):
    """FMUs of two robots of the same kind, unpacked."""
    found = []
    for name, one in (("robot", stepper()), ("other", stepper(resolution=100.0))):
        path = tmp_path_factory.mktemp("fmu") / f"{name}.fmu"
        ms.export_fmu(one, path, name=name, fmi=request.param)
        found.append((path, fmpy.read_model_description(str(path)), fmpy.extract(str(path))))
    yield found
    for _, _, folder in found:
        shutil.rmtree(folder)


@pytest.fixture
def instance():
    made = []

    def begun(unit):
        _, about, folder = unit
        three = about.fmiVersion == "3.0"
        slave = (FMU3Slave if three else FMU2Slave)(
            guid=about.guid or about.instantiationToken,
            unzipDirectory=folder,
            modelIdentifier=about.modelName,
            instanceName=f"one{len(made)}",
        )
        slave.instantiate()
        made.append(slave)
        if not three:
            slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        return slave

    yield begun
    for slave in made:
        slave.freeInstance()


def names(slave):
    """FMI 3 writes State, FMI 2 state."""
    if isinstance(slave, FMU3Slave):
        return slave.getFMUState, slave.serializeFMUState, slave.deserializeFMUState
    return slave.getFMUstate, slave.serializeFMUstate, slave.deSerializeFMUstate


def test_a_serialized_state_of_another_robot_is_refused(units, instance, capsys):
    first, second = (instance(u) for u in units)
    get, pack, _ = names(first)
    packed = pack(get())
    names(first)[2](packed)
    with pytest.raises(Exception, match=r"[Ss]tatus|error|failed"):
        names(second)[2](packed)
    damaged = bytearray(packed)
    damaged[48:56] = b"\xff" * 8
    with pytest.raises(Exception, match=r"[Ss]tatus|error|failed"):
        names(first)[2](bytes(damaged))
    with pytest.raises(Exception, match=r"[Ss]tatus|error|failed"):
        names(first)[2](packed[:-8])


@pytest.mark.parametrize("start", [{"force_x": 1e308}, {"viscosity": 1e-320}, {"field_z": 4e5}])
def test_a_unit_has_no_infinite_output(units, start):
    path, _, _ = units[0]
    with pytest.raises(Exception, match=r"[Ss]tatus|error|failed"):
        fmpy.simulate_fmu(
            str(path), stop_time=0.01, output_interval=0.001, start_values=start, output=["x", "us"]
        )


def test_a_unit_is_built_anew_from_its_sources(units, tmp_path):
    """As on another platform: by the CMakeLists.txt inside; it swims to the same bits."""
    path, _, _ = units[0]
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(path) as z:
        z.extractall(folder)
    (binary,) = (folder / "binaries").rglob("robot.*")
    binary.unlink()
    cmake = shutil.which("cmake")
    assert cmake, "cmake builds the sources of an FMU; install it"
    env = {**os.environ, "CC": compiler.required()[0], "CFLAGS": "-ffp-contract=off"}
    build, source = tmp_path / "build", folder / "sources"
    for command in (
        [cmake, "-S", source, "-B", build, "-DCMAKE_BUILD_TYPE=Release"],
        [cmake, "--build", build],
    ):
        subprocess.run(command, env=env, check=True, capture_output=True)
    (build / binary.name).replace(binary)
    ends = [
        fmpy.simulate_fmu(str(p), stop_time=0.2, output_interval=0.05, output=["x", "us"])
        for p in (path, folder)
    ]
    for name in ("x", "us"):
        assert np.asarray(ends[0][name]) == pytest.approx(np.asarray(ends[1][name]), rel=1e-9)
    listed = (folder / "sources" / "buildDescription.xml", folder / "modelDescription.xml")
    text = next(p for p in listed if p.exists()).read_text()
    assert 'name="robot.c"' in text
    assert 'name="fmu.c"' in text


def call(*args):
    return CliRunner().invoke(main, ["export", *map(str, args)])


def test_out_may_name_the_unit(tmp_path):
    spec = tmp_path / "robot.toml"
    spec.write_text(ROBOT)
    target = tmp_path / "new" / "swim.fmu"
    done = call(spec, "--format", "fmu", "--out", target, "--json")
    assert done.exit_code == 0, done.stderr
    assert target.is_file()
    assert json.loads(done.stdout)["files"] == [str(target)]
    assert "--force" in call(spec, "--format", "fmu", "--out", target).stderr
    for wrong in ("robot.c", "robot.fmu"):
        refused = call(spec, "--format", "c", "--out", tmp_path / wrong)
        assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
        assert not (tmp_path / wrong).exists()


@pytest.mark.parametrize(
    "text",
    [
        "[0, 2e-5, 0]",
        "0 2e-5 0",
        "0, 0.02 mA m^2, 0",
        "0 0.02 mA m^2 0",
        "0, 2e-5 J/T, 0",
        '["0 A m^2", "20 uA m^2", "0 A m^2"]',
    ],
)
def test_a_moment_takes_units(tmp_path, text):
    spec = tmp_path / "robot.toml"
    spec.write_text(ROBOT)
    done = call(spec, "--format", "c", "--out", tmp_path, "--moment", text)
    assert done.exit_code == 0, done.stderr
    (line,) = [
        x for x in (tmp_path / "robot.c").read_text().splitlines() if "robot_parameters own" in x
    ]
    found = [float(x) for x in line.split("{")[2].split("}")[0].split(",")]
    assert found == pytest.approx([0.0, 2e-5, 0.0], rel=1e-12)


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--moment", "0, 1 mT, 0"), "--moment"),
        (("--moment", "0, 1 A m^2"), "--moment"),
        (("--steps", "0"), "steps"),
        (("--most-steps", "1000000000000"), "most-steps"),
        (("--format", "fmu", "--precision", "float"), "--precision"),
    ],
)
def test_mistakes_of_options_are_one_sentence(tmp_path, options, word):
    spec = tmp_path / "robot.toml"
    spec.write_text(ROBOT)
    done = call(spec, "--format", "c", "--out", tmp_path / "new", *options)
    assert done.exit_code == 2, done.stdout
    assert word in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "new").exists()


def test_a_moment_with_a_unit_needs_a_spec_with_units(tmp_path):
    args = ("--preset", "tabak/helix", "--format", "c", "--out", tmp_path)
    done = call(*args, "--moment", "0, 1 A m^2, 0")
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    assert list(Path(tmp_path).iterdir()) == []


def test_the_command_writes_what_was_asked(tmp_path):
    spec = tmp_path / "robot.toml"
    spec.write_text(ROBOT)
    done = call(spec, "--format", "c", "--out", tmp_path, "--steps", 4, "--precision", "float")
    assert done.exit_code == 0, done.stderr
    source = (tmp_path / "robot.c").read_text()
    assert "#define FIXED_STEPS 4" in source
    assert "double" not in (tmp_path / "robot.h").read_text()
