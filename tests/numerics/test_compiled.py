"""Kernels as Python and compiled: the same numbers, and which way depends on the work alone."""

import json
import os
import shutil
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import microswim as ms
from microswim.models.rft import helix as rigidhelix
from microswim.models.rft import plane_wave as planarwave
from microswim.models.rft import segment as kernels
from microswim.models.rft.segment import HELIX, PLANE_WAVE
from microswim.numerics.compiling.code_cache import digest
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.quadrature import gauss
from microswim.swimmer.drag import lighthill
from microswim.swimmer.fields import lifted

HEAVY = {"numba", "scipy", "xarray", "pandas", "matplotlib", "pint", "rich"}
WAVE = np.array([2.0, 0.1, 9.0, 0.2, -1.0, 2.1, 3.4, 0.02, 0.6, 1.0, 0.3])
STEP = WAVE + 1e-3j * np.arange(WAVE.size)
NODES = np.random.default_rng(3).normal(size=(3, 20, 3))


def python(code, **environment):
    """What a fresh interpreter prints."""
    command, environment = [sys.executable, "-c", code], os.environ | environment
    run = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave-constant", "goto/C"])
def test_one_gait_on_the_command_line_waits_for_no_heavy_library(preset):
    """Shapes of all kinds, with units and without; the numbers are those of compiled kernels."""
    code = f"""
import sys
from microswim.cli import main
main(["run", "--preset", "{preset}", "--json"], standalone_mode=False)
print(*sorted({{m.split(".")[0] for m in sys.modules}}))
"""
    printed, loaded = python(code).splitlines()
    assert not HEAVY & set(loaded.split())
    with settled(True):
        gait = ms.Swimmer.preset(preset).gait()
    assert json.loads(printed)["mean_velocity"] == pytest.approx(gait.mean_velocity, rel=1e-12)


CALLS = {
    "nodes": (kernels.node_numbers, (PLANE_WAVE, 3.0, 0.9, 0.2)),
    "nodes of a ramp": (rigidhelix.ramp_nodes, (0.3, 0.9, 12.0)),
    "law": (lighthill._thick, (0.8, 0.2, lighthill._table(), *lighthill._GAUSS)),
    "plain": (kernels.wave_tail, (HELIX, True, WAVE, 0.4, gauss(9), gauss(20))),
    "helix": (rigidhelix.helix_tail, (True, WAVE, 0.4, gauss(12))),
    "helix, complex": (rigidhelix.helix_tail, (True, STEP, 0.4, gauss(12))),
    "wave": (planarwave.in_a_row, (True, WAVE, np.arange(5.0), gauss(9), gauss(20))),
    "wave, complex": (planarwave.in_a_row, (True, STEP, np.arange(5.0), gauss(9), gauss(20))),
    "any": (kernels.centreline_tail, (*NODES, np.ones(20), True, (2.1, 3.4, 0.02), 1.0)),
}


@pytest.mark.parametrize("name", CALLS)
def test_as_python_and_compiled_they_agree(name):
    kernel, arguments = CALLS[name]
    results = kernel.written(*arguments), kernel.dispatcher(*arguments)
    pairs = zip(*results) if isinstance(results[0], tuple) else [results]
    for one, other in pairs:
        assert np.allclose(one, other, rtol=1e-12, atol=1e-12 * np.abs(other).max())


@pytest.mark.parametrize("p", [WAVE, STEP], ids=["real", "complex"])
def test_phases_side_by_side_are_those_in_a_row(p):
    arguments = True, p, np.arange(7.0), gauss(9), gauss(20)
    for one, other in zip(planarwave.side_by_side(*arguments), planarwave.in_a_row(*arguments)):
        assert np.allclose(one, other, rtol=1e-12, atol=1e-12 * np.abs(other).max())


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_few_designs_side_by_side_are_those_of_the_compiled_loops(preset):
    """Of several ramps and numbers of nodes, and designs that are none."""
    swimmer = ms.Swimmer.preset(preset, {"coefficients.tip": True})
    designs = {
        "tail.amplitude": np.linspace(0.02, 0.15, 37),
        "tail.waves": np.linspace(0.01, 4.0, 37),
        "tail.ramp": np.repeat([0.0, 0.3, 1.0, -1.0], 10)[:37],
    }
    results = []
    for compile_it in (False, True):
        with settled(compile_it):
            results.append(ms.evaluate(swimmer, designs))
    for name, values in results[0].items():
        size = np.nanmax(np.abs(values)) or 1.0
        assert values == pytest.approx(results[1][name], rel=1e-12, abs=1e-14 * size, nan_ok=True)
    speed = results[0]["swimming_speed"]
    assert np.isfinite(speed[1:30]).all()
    assert np.isnan(speed[30:]).all()


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_the_screw_of_a_period_is_the_same_side_by_side_and_in_a_row(preset):
    """With an odd number of steps too; and its exact derivative."""
    swimmer = lifted(ms.Swimmer.preset(preset), {"tail.amplitude": 0.1 + 1e-30j})
    for gait in (ms.Swimmer.preset(preset).gait(), swimmer.gait()):
        for steps in (256, 77):
            beside = ms.screw(gait, steps)
            with settled(True):
                in_a_row = ms.screw(gait, steps)
            for name in ("displacement", "quaternion"):
                one, other = getattr(beside, name), getattr(in_a_row, name)
                assert np.allclose(one.real, other.real, rtol=0, atol=1e-13)
                assert np.allclose(one.imag, other.imag, rtol=0, atol=1e-13 * 1e-30)


def test_a_custom_tail_at_all_phases_at_once_is_the_compiled_one():
    def beat(s, phase):
        q = 0.1 * s * np.cos(3 * s - phase)
        return np.stack([s + 0 * q, q, 0.5 * q], axis=-1)

    tail = ms.CustomTail(shape=beat, length=2.0, radius=0.02, wavelength=2.0)
    fluid = ms.Fluid(viscosity=1.0)
    swimmer = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=fluid)
    beside = swimmer.gait().resistance_series
    with settled(True):
        one_by_one = swimmer.gait().resistance_series
    assert np.allclose(beside, one_by_one, rtol=0, atol=1e-12 * np.abs(beside).max())


def answers():
    """Bits of what a user may ask, of all kinds of tails and a few sizes of work."""
    helix, wave = (ms.Swimmer.preset(f"tabak/{kind}") for kind in ("helix", "plane_wave"))
    gaits = [s.gait(**o) for s in (helix, wave) for o in ({}, {"nodes": 12})]
    found = [g.mean_velocity for g in gaits] + [ms.screw(g).displacement for g in gaits]
    for s in (helix, wave):
        batch = ms.evaluate(s, {"tail.amplitude": np.linspace(0.05, 0.1, 40)})
        found += [batch["velocity_amplitude"], batch["swimming_speed"]]
        found.append(s.gradient("efficiency", "tail.amplitude")["tail.amplitude"])
    return [np.asarray(x).tobytes() for x in found]


def test_an_answer_does_not_depend_on_what_was_asked_before():
    """To the last bit; and no call wakes the compiler for the calls to come."""
    first = answers()
    swimmer = ms.Swimmer.preset("tabak/helix")
    for _ in range(30):
        swimmer.gait()
    ms.evaluate(swimmer, {"tail.amplitude": np.linspace(0.05, 0.1, 9000)})
    ms.trajectory(swimmer.gait(), [0.0, 0.3])
    ms.calibrate(swimmer, swimmer.gait(), ["translation.s"])
    assert answers() == first


HUNDRED = """
import sys
import numpy as np, microswim as ms
for preset in ("tabak/helix", "tabak/plane_wave", "goto/C"):
    swimmer = ms.Swimmer.preset(preset)
    for _ in range(100 if preset == "tabak/helix" else 12):
        ms.summary(swimmer.gait())
print("numba" in sys.modules)
ms.evaluate(ms.Swimmer.preset("tabak/helix"), {"tail.amplitude": np.linspace(0.05, 0.1, 5000)})
print("numba" in sys.modules)
"""


def test_a_hundred_gaits_in_a_row_never_stop_for_the_compiler_and_a_large_batch_does_at_once():
    assert python(HUNDRED).split() == ["False", "True"]


WARM = """
import sys
import numpy as np, microswim as ms
from microswim.models.rft import helix, plane_wave, segment
from microswim.gait import stepping
ms.warm_up()
kernels = [helix.helix_tail, plane_wave.in_a_row, segment.centreline_tail, stepping.integrate]
before = [len(k.dispatcher.signatures) for k in kernels]
def beat(s, phase):
    return np.stack([s + 0 * phase, 0.1 * s * np.cos(3 * s - phase), 0 * (s + phase)], axis=-1)
tail = ms.CustomTail(shape=beat, length=2.0, radius=0.02, wavelength=2.0)
own = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0))
for swimmer in (ms.Swimmer.preset("tabak/helix"), ms.Swimmer.preset("tabak/plane_wave"), own):
    ms.summary(swimmer.gait())
    swimmer.gradient("swimming_speed", "fluid.viscosity")
print(min(before), before == [len(k.dispatcher.signatures) for k in kernels])
"""


def test_after_warming_up_nothing_is_left_to_compile():
    """Numbers and complex steps: two kinds of each kernel, and no more afterwards."""
    assert python(WARM).split() == ["2", "True"]


AT_ONCE = """
from microswim.numerics.compiling.compiled import njit

def double(x):
    return 2 * x

one, other, later = (njit(cache=True)(double) for _ in range(3))
file, list_it = one._cache._cache_file, one._cache._cache_file._save_index
other._cache._cache_file._load_index = dict  # it looked before there was anything

def list_and_wait(overloads):  # the other does all between the two writes of the one
    list_it(overloads)
    other(1j)

file._save_index = list_and_wait
one(1.0)
print(later(1j), *later.stats.cache_hits.values())
"""


def test_processes_that_compile_at_once_leave_a_cache_that_serves(tmp_path):
    """For different types, at the moment at which numba's own names would collide."""
    script = tmp_path / "at_once.py"
    script.write_text(AT_ONCE)
    code = f"import runpy; runpy.run_path({str(script)!r})"
    assert python(code, NUMBA_CACHE_DIR=str(tmp_path)).split() == ["2j", "1"]


TOLD = """
import sys
from microswim.numerics.compiling import compiled, first_time
first_time.tell_once(lambda: print("told"))

def double(x):
    return 2 * x

compiled.njit(cache=True)(double)(1.0)
compiled.njit(cache=True)(double)(1j)
"""


def test_who_asks_is_told_once_that_code_is_compiled_and_not_that_it_is_loaded(tmp_path):
    script = tmp_path / "told.py"
    script.write_text(TOLD)
    code = f"import runpy; runpy.run_path({str(script)!r})"
    assert python(code, NUMBA_CACHE_DIR=str(tmp_path)).split() == ["told"]
    assert python(code, NUMBA_CACHE_DIR=str(tmp_path)).split() == []


EDITED = """
import numpy as np
from microswim.models.rft.plane_wave import fill_nodes
nodes, none = np.empty((6, 4)), (np.ones(0), np.ones(0))
rule = np.linspace(0.1, 0.9, 4), np.ones(4)
fill_nodes.dispatcher(nodes, np.full(11, 0.5), none, rule)
print(nodes[4, 0])
"""


def test_an_edited_kernel_gives_new_numbers_where_a_kernel_of_another_file_calls_it(tmp_path):
    package = tmp_path / "microswim"
    shutil.copytree(Path(ms.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    where = {"PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    before = float(python(EDITED, **where))
    assert float(python(EDITED, **where)) == before
    callee = package / "models/rft/segment.py"
    text, last = callee.read_text(), "    return c, s\n"
    assert text.count(last) == 1
    callee.write_text(text.replace(last, "    return 2.0 * c, s\n"))
    assert float(python(EDITED, **where)) == 2.0 * before


def test_numba_still_names_its_files_as_the_cache_expects():
    """The private parts that `code_cache` renames: when this fails, read that module."""
    stored = kernels.add_tip.dispatcher._cache._cache_file
    known = digest(kernels.add_tip.py_func, kernels.add_tip.options | {"cache": True})
    assert stored._index_name.endswith(f".{known}.nbi")
    assert stored._index_path.endswith(stored._index_name)
    assert callable(stored._data_name)
    assert callable(type(stored).save)
    assert hasattr(kernels.add_tip, "_numba_type_")


def test_a_digest_knows_constants_options_and_callees_and_where_they_stand():
    def digest_of(scale, options=(), callee=1.0, room="here"):
        inner = eval(f"lambda x: {callee}")
        inner.__module__ = room
        space = {"SCALE": scale, "inner": types.SimpleNamespace(py_func=inner)}
        exec("def kernel(x):\n    return SCALE * inner(x)", space)
        return digest(space["kernel"], dict(options))

    whole = {
        digest_of(1.0), digest_of(2.0), digest_of(1.0, {"fastmath": {"nsz"}}),
        digest_of(1.0, callee=2.0), digest_of(1.0, room="there"),
    }  # fmt: skip
    assert len(whole) == 5
    assert digest_of(2.0) in whole


READ_ONLY = """
import os, warnings
import numpy as np
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    from microswim.calibration.region.surfaces import matern
    from microswim.numerics.solve6 import solve
    solve.dispatcher(np.eye(6), np.ones(6), np.ones(6, dtype=bool))
    matern(0.5)
kept = [str(w.message) for w in said if "cannot be kept" in str(w.message)]
print(len(kept), os.environ["NUMBA_CACHE_DIR"], os.listdir(os.environ["NUMBA_CACHE_DIR"]) != [])
"""


def test_a_package_and_a_home_that_cannot_be_written_still_compile(tmp_path):
    """Said once, and the temporary folder is gone afterwards."""
    package, home = tmp_path / "microswim", tmp_path / "home"
    shutil.copytree(Path(ms.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    home.write_text("a file: no folder can be made in it")
    for folder in [package, *(p for p in package.rglob("*") if p.is_dir())]:
        (folder / "__pycache__").write_text("a file: no folder can be made here")
    where = {"PYTHONPATH": str(tmp_path), "HOME": str(home), "XDG_CACHE_HOME": str(home)}
    said, folder, full = python(READ_ONLY, NUMBA_CACHE_DIR="", **where).split()
    assert (said, full) == ("1", "True")
    assert not Path(folder).exists()


@pytest.mark.parametrize("threads", ["0", "-1", "two"])
def test_a_number_of_threads_that_is_none_is_named(threads):
    code = """
import numpy as np, microswim as ms
try:
    ms.warm_up()
except ms.MicroswimError as error:
    print(error)
"""
    assert f"NUMBA_NUM_THREADS = {threads}: must be" in python(code, NUMBA_NUM_THREADS=threads)


def test_without_the_compiler_all_runs_as_python():
    code = """
import numpy as np, microswim as ms
swimmer = ms.Swimmer.preset("tabak/helix")
print(ms.evaluate(swimmer, {"tail.amplitude": np.full(4000, 0.1)})["swimming_speed"][0])
"""
    speed = ms.screw(ms.Swimmer.preset("tabak/helix").gait()).speed
    assert float(python(code, NUMBA_DISABLE_JIT="1")) == pytest.approx(speed, rel=1e-8)
