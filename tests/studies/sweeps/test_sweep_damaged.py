"""Stores of sweeps that were damaged, moved, filled up or taken away: never a wrong number."""

import shutil

import numpy as np
import pytest
import xarray as xr

import microswim as ms
from microswim.errors import MachineError
from microswim.jobs import lock
from microswim.studies.sweeps import sweep as sweeps

HELIX = ms.Swimmer.preset("tabak/helix")
OVER = {
    "tail.amplitude": np.linspace(0.05, 0.1, 4),
    "tail.handedness": ["left", "right"],
    "tail.waves": [1.0, -1.0, 3.0],
}


def values(result):
    return {n: result[n].values.tolist() for n in (*result.data_vars, *result.coords)}


def same(one, other):
    return repr(values(one)) == repr(values(other))  # NaN equals NaN


@pytest.fixture
def blocks(monkeypatch):
    monkeypatch.setitem(sweeps.BLOCK, "auto", 3)


@pytest.fixture
def whole(blocks, tmp_path):
    path = tmp_path / "whole.zarr"
    return path, ms.sweep(HELIX, OVER, out=path).load()


def spoilt(raw, rng):
    """A file as a disk, a copy or a hand may leave it."""
    wrong = bytearray(raw)
    how = rng.integers(6)
    if how == 0 or not wrong:
        return None  # gone
    if how == 1:
        return bytes(wrong[: rng.integers(len(wrong))])
    if how == 2:
        return bytes(len(wrong))
    if how == 3:
        return bytes(wrong) + b"more"
    wrong[rng.integers(len(wrong))] ^= 1 << int(rng.integers(8))
    return bytes(wrong)


def test_a_damaged_store_is_refused_or_solved_again(whole, tmp_path):
    """Every file of a store is spoilt once: the same numbers as before, or a sentence."""
    path, before = whole
    rng, refused = np.random.default_rng(2), 0
    files = sorted(p.relative_to(path) for p in path.rglob("*") if p.is_file())
    for some in np.array_split(np.array(files, dtype=object), len(files) // 8):
        copy = tmp_path / "copy.zarr"
        shutil.copytree(path, copy)
        for file in some:
            wrong = spoilt((copy / file).read_bytes(), rng)
            (copy / file).unlink() if wrong is None else (copy / file).write_bytes(wrong)
        try:
            after = ms.sweep(HELIX, OVER, out=copy, resume=True)
        except ms.SpecError:
            refused += 1
        else:
            assert same(after, before), some
        shutil.rmtree(copy)
    assert refused <= 1  # the files that say what the store is


def test_results_in_the_wrong_place_or_from_elsewhere_are_solved_again(whole, tmp_path):
    """Whole files, their checksums true, of another block, another sweep, another time."""
    path, before = whole
    other = tmp_path / "other.zarr"
    ms.sweep(HELIX.with_({"body.radius": 0.6}), OVER, out=other)
    for source, target in [
        (path / "mean_power/0.0.0", "mean_power/1.1.0"),
        (other / "mean_power/0.0.0", "mean_power/0.0.0"),
        (other / "mean_velocity/3.0.0.0", "mean_velocity/3.0.0.0"),
        (path / "status/0.0.0", "status/2.1.0"),
        (other / "tail.amplitude/0", "tail.amplitude/0"),
        (path / "reason/0.0.0", "reason/1.0.0"),
    ]:
        copy = tmp_path / "copy.zarr"
        shutil.copytree(path, copy)
        shutil.copy(source, copy / target)
        assert same(ms.sweep(HELIX, OVER, out=copy, resume=True), before)
        shutil.rmtree(copy)


def test_a_status_alone_is_not_believed(whole):
    """Rows said to be solved, with nothing in them."""
    import zarr

    path, before = whole
    group = zarr.open_group(path, mode="r+")
    group["mean_velocity"][...] = np.nan
    group["status"][...] = 1
    assert same(ms.sweep(HELIX, OVER, out=path, resume=True), before)


def test_what_is_whole_is_not_solved_again(whole, monkeypatch):
    from microswim.studies.sweeps import engines

    path, before = whole
    shutil.copy(path / "mean_power/0.0.0", path / "mean_power/1.1.0")
    solved = []
    solve = engines.solve_rows
    monkeypatch.setattr(engines, "solve_rows", lambda job, c: solved.append(c) or solve(job, c))
    assert same(ms.sweep(HELIX, OVER, out=path, resume=True), before)
    assert sum(len(c["tail.waves"]) for c in solved) == 3


def test_a_store_that_vanishes_while_it_is_written_leaves_no_stub(blocks, tmp_path):
    path = tmp_path / "a.zarr"
    calls = []

    def take_away(done, of):
        calls.append(done)
        if len(calls) == 3:
            path.rename(elsewhere)

    elsewhere = tmp_path / "elsewhere"
    with pytest.raises(MachineError, match="vanished while the sweep wrote it"):
        ms.sweep(HELIX, OVER, out=path, progress=take_away)
    assert list(tmp_path.iterdir()) == [elsewhere]


def test_a_full_disk_keeps_what_is_there_and_resume_goes_on(blocks, whole, tmp_path, monkeypatch):
    from microswim.studies.sweeps.store import SweepStore

    path, write, count = tmp_path / "a.zarr", SweepStore._require, []

    def full(self):
        count.append(1)
        if len(count) == 5:
            raise OSError(28, "No space left on device", str(self.path))
        write(self)

    with monkeypatch.context() as patch:
        patch.setattr(SweepStore, "_require", full)
        with pytest.raises(MachineError, match=r"a\.zarr: cannot be written: No space left"):
            ms.sweep(HELIX, OVER, out=path)
    assert 0 < int((xr.open_zarr(path).status > 0).sum()) < 24
    assert same(ms.sweep(HELIX, OVER, out=path, resume=True), whole[1])


def test_a_store_that_cannot_be_begun_leaves_nothing(tmp_path, monkeypatch):
    import zarr

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(zarr, "consolidate_metadata", full)
    with pytest.raises(MachineError, match="No space left"):
        ms.sweep(HELIX, OVER, out=tmp_path / "a.zarr")
    assert list(tmp_path.iterdir()) == []


def test_no_memory_is_not_a_designs_fault(tmp_path, monkeypatch):
    path, gait = tmp_path / "a.zarr", ms.Swimmer.gait
    over = {"tail.amplitude": [0.05, 0.1, 0.15]}

    def hungry(self, model="rft", **options):
        if self.tail.amplitude > 0.12:
            raise MemoryError
        return gait(self, "rft")

    with monkeypatch.context() as patch:
        patch.setattr(ms.Swimmer, "gait", hungry)
        with pytest.raises(MachineError, match=r"1 of 3 designs are not solved \(not enough mem"):
            ms.sweep(HELIX, over, "bem", out=path, workers=0)
        assert xr.open_zarr(path).status.values.tolist() == [1, 1, 0]
    monkeypatch.setattr(ms.Swimmer, "gait", lambda self, model, **o: gait(self, "rft"))
    assert (ms.sweep(HELIX, over, "bem", out=path, workers=0, resume=True).status == 1).all()


def test_where_nothing_can_be_solved_the_sweep_ends(tmp_path, monkeypatch):
    def hungry(*_, **__):
        seen.append(1)
        raise MemoryError

    seen = []
    monkeypatch.setattr(ms.Swimmer, "gait", hungry)
    over = {"tail.amplitude": np.linspace(0.05, 0.1, 100)}
    with pytest.raises(MachineError, match="nothing can be solved here: not enough memory"):
        ms.sweep(HELIX, over, "bem", out=tmp_path / "a.zarr", workers=0)
    assert len(seen) == sweeps.HOPELESS


@pytest.mark.parametrize("number", ["ENOLCK", "ENOSYS", "EOPNOTSUPP"])
def test_a_file_system_without_locks_is_said_and_used(number, tmp_path, monkeypatch):
    import errno
    import fcntl

    def none(*_):
        raise OSError(getattr(errno, number), "no locks")

    monkeypatch.setattr(fcntl, "flock", none)
    with pytest.warns(lock.NoLockWarning, match="has no locks"):
        result = ms.sweep(HELIX, {"tail.waves": [1.0, 2.0]}, out=tmp_path / "a.zarr")
    assert (result.status == 1).all()


def test_a_read_only_place_is_said(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(MachineError, match=r"a\.zarr: cannot be written: File exists"):
        ms.sweep(HELIX, {"tail.waves": [1.0]}, out=tmp_path / "file" / "a.zarr")


def test_what_a_killed_beginning_left_is_removed(tmp_path):
    (tmp_path / "a.zarr.123.new").mkdir()
    ms.sweep(HELIX, {"tail.waves": [1.0]}, out=tmp_path / "a.zarr")
    assert [p.name for p in tmp_path.iterdir()] == ["a.zarr"]
