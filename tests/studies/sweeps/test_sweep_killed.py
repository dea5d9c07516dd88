"""Sweeps survive: kill -9 of the sweep, of a worker process, of a worker of a cluster."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

import microswim as ms
from microswim.errors import MachineError

TAIL = """
import os, signal, sys, time
import numpy as np
import microswim as ms

DEADLY, SLOW = 2.75, float(os.environ.get("SLOW", 0))

def shape(s, phase):
    if np.max(s) > DEADLY and os.environ.get("DEADLY"):
        os.kill(os.getpid(), signal.SIGKILL)
    return np.stack(np.broadcast_arrays(s, 0.1 * s * np.cos(4 * s - phase), 0 * s), axis=-1)

def swimmer():
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5),
        tail=ms.CustomTail(shape=shape, length=1.0, radius=0.05, wavelength=1.5),
        fluid=ms.Fluid(viscosity=1.0),
    )

def over(n):
    return {"tail.length": np.linspace(1.0, 3.0, n)}

if __name__ == "__main__":
    def say(done, total):
        print(done, flush=True)
        time.sleep(SLOW)
    import beating
    ms.sweep(beating.swimmer(), over(int(sys.argv[2])), out=sys.argv[1], resume=True, progress=say)
"""


@pytest.fixture
def beating(tmp_path, monkeypatch):
    """A module of a user with a tail whose longest beats kill whoever computes them, if asked."""
    (tmp_path / "beating.py").write_text(TAIL)
    monkeypatch.syspath_prepend(tmp_path)
    sys.modules.pop("beating", None)
    import beating

    return beating


def bits(result):
    return {
        n: result[n].values.tobytes() if result[n].dtype.kind == "f" else result[n].values.tolist()
        for n in result.data_vars
    }


def run(folder, *arguments, **more):
    return subprocess.Popen(
        [sys.executable, folder / "beating.py", *map(str, arguments)],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {k: str(v) for k, v in more.items()},
    )


def test_a_sweep_killed_at_any_moment_goes_on_to_the_same_bits(beating, tmp_path):
    """kill -9 between two solves and inside one; what is on disk stays, and the lock is free."""
    whole, path = ms.sweep(beating.swimmer(), beating.over(6)), tmp_path / "a.zarr"
    for lines, wait in [(3, 0.0), (2, 0.3)]:
        process = run(tmp_path, path, 6, SLOW=0.2)
        before = int((xr.open_zarr(path).status > 0).sum()) if path.exists() else 0
        for _ in range(lines):
            process.stdout.readline()
        time.sleep(wait)
        process.kill()
        process.wait()
        process.stdout.close()
        kept = int((xr.open_zarr(path).status > 0).sum())
        assert before + lines - 1 <= kept < 6
    resumed = ms.sweep(beating.swimmer(), beating.over(6), out=path, resume=True)
    assert bits(resumed) == bits(whole)


def test_a_second_process_is_refused_until_the_first_dies(beating, tmp_path):
    path = tmp_path / "a.zarr"
    process = run(tmp_path, path, 5, SLOW=60)
    try:
        process.stdout.readline()
        with pytest.raises(ms.MicroswimError, match=f"process {process.pid} on .* since"):
            ms.sweep(beating.swimmer(), beating.over(5), out=path, resume=True)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
    assert list(tmp_path.glob("*.lock"))  # stale: its process is dead
    assert (ms.sweep(beating.swimmer(), beating.over(5), out=path, resume=True).status == 1).all()
    assert not list(tmp_path.glob("*.lock"))


def test_a_worker_that_dies_costs_one_row_which_stays_unsolved(beating, monkeypatch, tmp_path):
    """The design may not be at fault (the system kills for memory): --resume tries again."""
    whole, path = ms.sweep(beating.swimmer(), beating.over(4)), tmp_path / "a.zarr"
    with monkeypatch.context() as patch:
        patch.setenv("DEADLY", "1")
        with pytest.warns(UserWarning, match="1 of 4 designs are not solved: its worker"):
            result = ms.sweep(beating.swimmer(), beating.over(4), workers=2)
        with pytest.raises(MachineError, match=r"1 of 4 .*died twice .exit status -9.*--resume"):
            ms.sweep(beating.swimmer(), beating.over(4), workers=2, out=path)
    for there in (result, xr.open_zarr(path)):
        assert there.status.values.tolist() == [1, 1, 1, 0]
        assert "died twice (exit status -9)" in str(there.reason.values[-1])
        assert np.isnan(there.mean_velocity.values[-1]).all()
        np.testing.assert_array_equal(there.mean_velocity[:-1], whole.mean_velocity[:-1])
    resumed = ms.sweep(beating.swimmer(), beating.over(4), workers=1, out=path, resume=True)
    assert bits(resumed) == bits(whole)


def test_a_function_that_workers_cannot_import_is_said(beating):
    tail = ms.CustomTail(
        shape=lambda s, phase: beating.shape(s, phase), length=1.0, radius=0.05, wavelength=1.5
    )
    swimmer = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0))
    with pytest.raises(ms.SpecError, match="a function in a module"):
        ms.sweep(swimmer, beating.over(2), workers=1)


def dask_worker(address, folder):
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny"]
        + ["--nthreads", "1", "--no-dashboard", "--local-directory", str(folder)],
        env=os.environ | {"PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"},
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")
def test_a_dask_cluster_survives_the_death_of_a_worker(beating, tmp_path):
    """A real scheduler and two workers, one killed on the way: the same bits as without."""
    address = tmp_path / "scheduler.json"
    scheduler = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1"]
        + ["--port", "0", "--no-dashboard", "--scheduler-file", str(address)],
        stderr=subprocess.DEVNULL,
    )
    workers = []
    try:
        for _ in range(300):
            if address.exists() and address.stat().st_size:
                break
            time.sleep(0.1)
        import json

        where = json.loads(address.read_text())["address"]
        workers = [dask_worker(where, tmp_path) for _ in range(2)]
        from distributed import Client

        with Client(where) as client:
            client.wait_for_workers(2, timeout=60)
        seen = []

        def progress(done, total):
            seen.append(done)
            if done >= 10 and workers[0].poll() is None:
                os.killpg(workers[0].pid, signal.SIGKILL)
                workers[0].wait()

        path = tmp_path / "a.zarr"
        result = ms.sweep(
            beating.swimmer(), beating.over(60), out=path, scheduler=where, progress=progress
        )
        assert workers[0].poll() is not None
        assert seen[-1] == 60
        assert (result.status == 1).all()
        assert bits(result) == bits(ms.sweep(beating.swimmer(), beating.over(60), workers=1))
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def test_a_scheduler_that_does_not_answer_is_said(monkeypatch):
    from microswim.jobs import cluster

    monkeypatch.setattr(cluster, "PATIENCE", "1s")
    with pytest.raises(ms.MicroswimError, match="no Dask scheduler answers"):
        ms.sweep(
            ms.Swimmer.preset("tabak/helix"), {"tail.waves": [1.0]}, scheduler="tcp://127.0.0.1:9"
        )
