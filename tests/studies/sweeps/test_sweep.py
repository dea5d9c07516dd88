"""Sweeps: what is computed, what becomes of failures, and the store on disk."""

import importlib
import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import xarray as xr

import microswim as ms
from microswim.studies.sweeps import engines as sweepengines
from microswim.swimmer.drag.coefficients import Unchosen

HELIX = ms.Swimmer.preset("tabak/helix")
GRID = {"tail.amplitude": [0.05, 0.1, 0.2], "tail.waves": [1.0, 2.5]}


class Interrupted(Exception):
    pass


def after(calls):
    """Progress that interrupts the sweep after so many calls."""

    def progress(done, total):
        progress.calls += 1
        if progress.calls > calls:
            raise Interrupted

    progress.calls = 0
    return progress


def data(result):
    return {name: result[name].values for name in result.data_vars}


def same(one, other):
    """Whether two results agree bit by bit."""
    a, b = data(one), data(other)
    floats = [n for n in a if a[n].dtype.kind == "f"]
    words = set(a) - set(floats)
    return (
        a.keys() == b.keys()
        and all(a[n].tobytes() == b[n].tobytes() for n in floats)
        and all(a[n].tolist() == b[n].tolist() for n in words)
    )


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_a_sweep_does_not_depend_on_what_was_computed_before(preset):
    """Kernels that were called often are compiled, with other last digits; a resumed sweep mends
    rows in another process than the one that began.
    """
    swimmer = ms.Swimmer.preset(preset)
    first = ms.sweep(swimmer, GRID)
    for _ in range(20):
        swimmer.gait()
        ms.evaluate(swimmer, {"tail.amplitude": np.linspace(0.05, 0.1, 300)})
    assert same(first, ms.sweep(swimmer, GRID))


@pytest.fixture
def small_blocks(monkeypatch):
    monkeypatch.setitem(importlib.import_module("microswim.studies.sweeps.sweep").BLOCK, "auto", 4)


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_a_grid_holds_the_gait_of_every_design(preset):
    swimmer = ms.Swimmer.preset(preset)
    result = ms.sweep(swimmer, GRID)
    for b, n in product(*GRID.values()):
        gait = swimmer.with_({"tail.amplitude": b, "tail.waves": n}).gait()
        row = result.sel({"tail.amplitude": b, "tail.waves": n})
        scale = np.abs(gait.mean_velocity).max()
        # the batched kernel promises 1e-8; what is zero by symmetry is zero on this scale
        np.testing.assert_allclose(row.mean_velocity, gait.mean_velocity, atol=3e-8 * scale)
        assert float(row.swimming_speed) == pytest.approx(ms.screw(gait).speed, rel=3e-8)
        assert float(row.mean_power) == pytest.approx(gait.mean_power, rel=3e-8)
        assert float(row.efficiency) == pytest.approx(gait.efficiency, rel=1e-7)


def test_a_failed_design_is_a_row_with_its_reason():
    result = ms.sweep(HELIX, {"tail.amplitude": [0.1, -0.1], "tail.waves": [3.0, 50.0]})
    assert result.status.values.tolist() == [[1, 2], [2, 2]]
    for b, n in [(-0.1, 3.0), (0.1, 50.0)]:
        with pytest.raises(ms.SpecError) as error:
            HELIX.with_({"tail.amplitude": b, "tail.waves": n})
        row = result.sel({"tail.amplitude": b, "tail.waves": n})
        assert str(row.reason.values) == str(error.value)
        assert np.isnan(row.mean_velocity).all()
    assert str(result.reason.values[0, 0]) == ""


def test_choices_are_words_and_kinds_change_the_tail():
    over = {"tail.kind": ["helix", "plane_wave"], "tail.handedness": ["left", "right"]}
    result = ms.sweep(HELIX, over).mean_velocity
    left, right = (
        result.sel({"tail.kind": "helix", "tail.handedness": h}) for h in over["tail.handedness"]
    )
    # mirror images: the same speed, opposite rotation
    np.testing.assert_allclose(left[0], right[0], rtol=1e-12)
    np.testing.assert_allclose(left[3], -right[3], rtol=1e-12)
    wave = ms.Swimmer.preset("tabak/plane_wave").gait().mean_velocity[0]
    np.testing.assert_allclose(result.sel({"tail.kind": "plane_wave"})[:, 0], wave, rtol=1e-7)


def test_a_list_of_designs_is_one_axis():
    designs = [{"tail.amplitude": b, "tail.waves": n} for b, n in [(0.1, 3), (0.05, 2), (0.2, 1)]]
    result = ms.sweep(HELIX, designs)
    grid = ms.sweep(HELIX, {"tail.amplitude": [0.05, 0.1, 0.2], "tail.waves": [1, 2, 3]})
    assert result.swimming_speed.dims == ("design",)
    picked = [float(grid.swimming_speed.sel(d)) for d in designs]
    np.testing.assert_allclose(result.swimming_speed, picked, rtol=1e-12)
    assert result["tail.waves"].values.tolist() == [3, 2, 1]


def test_entries_of_lists_can_vary():
    name = "interaction.translation[0]"
    result = ms.sweep(HELIX, {name: [1.0, 2.0]})
    doubled = HELIX.with_({"interaction.translation": (2.0, 1.0, 1.0)}).gait()
    np.testing.assert_allclose(
        result.mean_velocity.sel({name: 2.0})[0], doubled.mean_velocity[0], rtol=3e-8
    )


@pytest.mark.parametrize(
    ("over", "says"),
    [
        ({"tail.amplitud": [1.0]}, "tail.amplitude"),
        ({}, "at least one name"),
        ({"tail.amplitude": []}, "at least one value"),
        ([{"tail.amplitude": 1.0}, {"tail.waves": 1.0}], "same fields"),
    ],
)
def test_what_makes_no_sense_is_refused_before_anything_is_solved(over, says, tmp_path):
    with pytest.raises(ms.SpecError, match=says):
        ms.sweep(HELIX, over, out=tmp_path / "a.zarr")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("where", "says"),
    [
        ({"scheduler": "garbage"}, "HOST:PORT"),
        ({"cluster": "slurm"}, "sbatch"),
        ({"cluster": "lsf"}, "slurm"),
        ({"cluster": "slurm", "scheduler": "a:1"}, "one of the two"),
        ({"scheduler": "a:1"}, r"microswim\[cluster\]"),
    ],
)
def test_a_cluster_that_cannot_be_one_leaves_no_store(where, says, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("microswim.jobs.cluster.find_spec", lambda name: None)
    swimmer, path = ms.Swimmer.preset("tabak/helix"), tmp_path / "a.zarr"
    with pytest.raises(ms.MicroswimError, match=says):
        ms.sweep(swimmer, {"tail.waves": [1, 2]}, out=path, **where)
    assert not path.exists()


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("calls", [1, 2, 4])
def test_an_interrupted_sweep_goes_on_to_the_same_bits(calls, tmp_path, monkeypatch):
    over = {"tail.amplitude": [0.05, 0.1, -1.0], "tail.waves": np.linspace(0.5, 4.0, 5)}
    whole = ms.sweep(HELIX, over, out=tmp_path / "whole.zarr")
    path = tmp_path / "parts.zarr"
    with pytest.raises(Interrupted):
        ms.sweep(HELIX, over, out=path, progress=after(calls))
    kept = int((xr.open_zarr(path).status > 0).sum())
    solved = []
    solve = sweepengines.solve_rows
    monkeypatch.setattr(
        sweepengines, "solve_rows", lambda job, c: solved.append(c) or solve(job, c)
    )
    resumed = ms.sweep(HELIX, over, out=path, resume=True)
    assert same(resumed, whole)
    assert sum(len(c["tail.waves"]) for c in solved) == whole.status.size - kept
    assert not list(tmp_path.glob("*.lock"))


def test_plain_xarray_reads_the_store_with_its_provenance(tmp_path):
    path = tmp_path / "a.zarr"
    over = GRID | {"tail.handedness": ["left", "right"]}
    ms.sweep(HELIX, over, out=path)
    result = xr.open_zarr(path)
    assert same(result.compute(), ms.sweep(HELIX, over))
    assert result.sizes == {
        "tail.amplitude": 3,
        "tail.waves": 2,
        "tail.handedness": 2,
        "component": 6,
    }
    speed = result.mean_velocity.sel({"component": "us", "tail.handedness": "left"})
    assert bool((speed < 0).all())
    assert result.attrs["microswim_version"] == ms.__version__
    assert result.attrs["model"] == "auto"
    spec = json.loads(result.attrs["spec"])
    assert spec["tail"]["amplitude"] == HELIX.tail.amplitude
    assert spec["body"] == {"shape": "sphere", "radius": 0.5}


def test_a_store_is_not_overwritten_nor_mixed(tmp_path):
    path = tmp_path / "a.zarr"
    ms.sweep(HELIX, GRID, out=path)
    with pytest.raises(ms.SpecError, match="--resume"):
        ms.sweep(HELIX, GRID, out=path)
    with pytest.raises(ms.SpecError, match=r"body.radius = 0.5 there, 0.4 here"):
        ms.sweep(HELIX.with_({"body.radius": 0.4}), GRID, out=path, resume=True)
    with pytest.raises(ms.SpecError, match="its designs differ"):
        ms.sweep(HELIX, GRID | {"tail.waves": [1.0, 2.0]}, out=path, resume=True)
    (tmp_path / "notes").mkdir()
    with pytest.raises(ms.SpecError, match="not the store of a sweep"):
        ms.sweep(HELIX, GRID, out=tmp_path / "notes", resume=True)


def test_a_store_is_resumed_with_its_own_calibration_only(tmp_path):
    """Another reference, same spec and same designs: the numbers would be a mixture."""
    region, over = {"tail.amplitude": (0.08, 0.12)}, {"tail.amplitude": [0.09, 0.11]}
    taught = HELIX.with_({"interaction.translation": (2.0, 1.3, 1.3)})
    one, other = (
        ms.calibrate_region(s, region, "rft", solves=8, workers=0).swimmer for s in (HELIX, taught)
    )
    path = tmp_path / "a.zarr"
    before = ms.sweep(one, over, out=path).load()
    for swimmer in (other, replace(one, region=None)):
        with pytest.raises(ms.SpecError, match="its calibration"):
            ms.sweep(swimmer, over, out=path, resume=True)
    assert same(ms.sweep(one, over, out=path, resume=True), before)


def test_a_second_sweep_is_refused_while_the_first_writes(tmp_path):
    path = tmp_path / "a.zarr"
    refused = []

    def progress(done, total):
        with pytest.raises(ms.MicroswimError, match="another sweep is writing it") as error:
            ms.sweep(HELIX, GRID, out=path, resume=True)
        refused.append(str(error.value))

    ms.sweep(HELIX, GRID, out=path, progress=progress)
    assert refused
    assert all(text.count("\n") == 0 for text in refused)
    ms.sweep(HELIX, GRID, out=path, resume=True)


def test_a_block_is_a_run_of_rows():
    from microswim.studies.sweeps.space import Space

    for block in (1, 2, 5, 7, 12, 100):
        space = Space.of({"a": range(3), "b": range(4), "c": range(5)}, block)
        rows = np.arange(60).reshape(space.shape)
        seen = []
        for place, start, stop in space.blocks():
            assert rows[place].ravel().tolist() == list(range(start, stop))
            assert stop - start <= block
            seen.append(stop - start)
        assert sum(seen) == 60
        columns = space.columns(np.arange(60))
        assert list(zip(*(columns[k].tolist() for k in "abc"))) == list(
            product(range(3), range(4), range(5))
        )


@pytest.mark.parametrize("preset", ["tabak/helix", "tabak/plane_wave"])
def test_designs_outside_the_atlas_are_answered_side_by_side_with_the_error_of_one(
    preset, monkeypatch
):
    """A map that leaves the range of the atlas costs what one of the surrogate does."""
    rows = importlib.import_module("microswim.studies.sweeps.rows")
    monkeypatch.setattr(rows, "_solve_one", None)
    swimmer = replace(ms.Swimmer.preset(preset), coefficients=Unchosen())
    radii = [0.02, 0.004, 0.001]  # the first lies in the atlas
    result = ms.sweep(swimmer, {"tail.radius": radii})
    for radius in radii:
        gait = swimmer.with_({"tail.radius": radius}).gait("auto")
        row = result.sel({"tail.radius": radius})
        assert (gait.model == "atlas") == (radius == 0.02)
        np.testing.assert_allclose(
            row.mean_velocity, gait.mean_velocity, atol=3e-8 * np.abs(gait.mean_velocity).max()
        )
        assert float(row.expected_error) == pytest.approx(gait.info["expected_error"]["us"])


def test_the_atlas_in_place_of_a_law_of_the_spec_says_its_error():
    """Such designs are solved one by one."""
    result = ms.sweep(HELIX, {"tail.waves": [2.0, 9.0]}, model="atlas")
    inside = HELIX.with_({"tail.waves": 2.0})
    told = ms.expected_error(inside, inside.gait("atlas"))["us"]
    assert float(result.expected_error[0]) == pytest.approx(told)
    assert np.isnan(result.expected_error[1])  # outside
