"""Kernels that run as Python at first: the same numbers, and nothing heavy for a single gait."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import microswim as ms
from microswim.gait.stepping import step
from microswim.models.rft import helix as rigidhelix
from microswim.models.rft import plane_wave as planarwave
from microswim.models.rft import segment as kernels
from microswim.models.rft.segment import HELIX, PLANE_WAVE
from microswim.numerics.compiled import compiled
from microswim.numerics.quadrature import gauss
from microswim.spec.units import _COMMON, _registry
from microswim.swimmer.drag import lighthill

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
    swimmer = ms.Swimmer.preset(preset)
    for _ in range(40):
        gait = swimmer.gait()
    assert json.loads(printed)["mean_velocity"] == pytest.approx(gait.mean_velocity, rel=1e-12)


CALLS = {
    "nodes": (kernels.node_numbers, (PLANE_WAVE, 3.0, 0.9, 0.2)),
    "nodes of a ramp": (rigidhelix.ramp_nodes, (0.3, 0.9, 12.0)),
    "law": (lighthill._at, (0.8, 0.2, lighthill._table(), *lighthill._GAUSS)),
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


@pytest.mark.parametrize(
    ("preset", "kernel"),
    [("tabak/helix", rigidhelix.helix_tail), ("tabak/plane_wave", planarwave.in_a_row)],
)
def test_few_designs_side_by_side_are_those_of_the_compiled_loops(preset, kernel, monkeypatch):
    """Of several ramps and numbers of nodes, and designs that are none."""
    swimmer = ms.Swimmer.preset(preset, {"coefficients.tip": True})
    designs = {
        "tail.amplitude": np.linspace(0.02, 0.15, 37),
        "tail.waves": np.linspace(0.01, 4.0, 37),
        "tail.ramp": np.repeat([0.0, 0.3, 1.0, -1.0], 10)[:37],
    }
    results = []
    for left in (1, 0):
        monkeypatch.setattr(kernel, "left", left)
        results.append(ms.evaluate(swimmer, designs))
    for name, values in results[0].items():
        size = np.nanmax(np.abs(values)) or 1.0
        assert values == pytest.approx(results[1][name], rel=1e-12, abs=1e-14 * size, nan_ok=True)
    speed = results[0]["swimming_speed"]
    assert np.isfinite(speed[1:30]).all()
    assert np.isnan(speed[30:]).all()


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_the_screw_of_a_period_is_the_same_side_by_side_and_in_a_row(preset, monkeypatch):
    """With an odd number of steps too; and its exact derivative."""
    swimmer = ms.Swimmer.preset(preset).lifted({"tail.amplitude": 0.1 + 1e-30j})
    for gait in (ms.Swimmer.preset(preset).gait(), swimmer.gait()):
        for steps in (256, 77):
            monkeypatch.setattr(step, "left", 1)
            beside, in_a_row = ms.screw(gait, steps), ms.screw(gait, steps)
            assert step.left == -1
            for name in ("displacement", "quaternion"):
                one, other = getattr(beside, name), getattr(in_a_row, name)
                assert np.allclose(one.real, other.real, rtol=0, atol=1e-13)
                assert np.allclose(one.imag, other.imag, rtol=0, atol=1e-13 * 1e-30)


def test_a_kernel_is_compiled_when_it_is_called_often():
    @compiled(first=2)
    def double(x):
        return 2.0 * x

    assert [double(1.0) for _ in range(2)] == [2.0, 2.0]
    assert "dispatcher" not in vars(double)
    assert double(1.0) == 2.0
    assert double.dispatcher.signatures


AT_ONCE = """
from microswim.numerics.compiled import njit

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


@pytest.mark.parametrize("unit", _COMMON)
def test_units_known_without_pint_are_what_pint_says(unit):
    for text, factor in _COMMON[unit].items():
        assert _registry().Quantity(1.0, text).to(unit).magnitude == pytest.approx(
            factor, rel=1e-15
        )
