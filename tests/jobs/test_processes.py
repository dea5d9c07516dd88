"""The pool of worker processes: it survives its workers, and they do not survive it."""

import importlib
import os
import signal
import subprocess
import sys
import time

import pytest

import microswim as ms
from microswim.errors import MachineError
from microswim.jobs import processes
from microswim.jobs.worker import Lost, Worker

CALLS = """
import os, signal, time

def twice(x):
    return 2 * x

def deadly(x):
    if x == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return x

def once_deadly(x, mark):
    if x == 1 and not os.path.exists(mark):
        open(mark, "w").close()
        os.kill(os.getpid(), signal.SIGKILL)
    return x

def hungry(x):
    raise MemoryError

def full(x):
    raise OSError(28, "No space left on device")

def wrong(x):
    raise ZeroDivisionError("of no use")

def printing(x):
    print("noise", flush=True)
    os.write(1, b"more noise")
    return os.environ["OMP_NUM_THREADS"]

def telling(x, tell):
    tell("half")
    return x

def asleep(x):
    os.write(1, b"%d\\n" % os.getpid())
    time.sleep(600)
"""


@pytest.fixture
def calls(tmp_path, monkeypatch):
    (tmp_path / "calls_of_a_user.py").write_text(CALLS)
    monkeypatch.syspath_prepend(tmp_path)
    sys.modules.pop("calls_of_a_user", None)
    return importlib.import_module("calls_of_a_user")


def found(call, jobs, workers=2):
    return dict(processes.answers(call, jobs, workers))


@pytest.mark.parametrize("workers", [0, 1, 3])
def test_answers_are_those_of_the_call_wherever_it_runs(calls, workers):
    assert found(calls.twice, [(i,) for i in range(5)], workers) == {i: 2 * i for i in range(5)}
    assert found(calls.twice, [], workers) == {}


def test_a_worker_that_dies_costs_its_job_alone(calls):
    answers = found(calls.deadly, [(i,) for i in range(6)])
    assert answers.pop(3) == Lost("its worker process died twice (exit status -9)")
    assert answers == {i: i for i in (0, 1, 2, 4, 5)}


def test_a_job_that_killed_its_worker_once_is_tried_again(calls, tmp_path):
    mark = str(tmp_path / "killed")
    assert found(calls.once_deadly, [(i, mark) for i in range(3)], 1) == {0: 0, 1: 1, 2: 2}
    assert os.path.exists(mark)


@pytest.mark.parametrize("workers", [0, 1])
@pytest.mark.parametrize(
    ("name", "says"), [("hungry", "not enough memory"), ("full", "No space left on device")]
)
def test_what_the_machine_cannot_do_is_lost_not_answered(calls, workers, name, says):
    (answer,) = found(getattr(calls, name), [(1,)], workers).values()
    assert isinstance(answer, Lost)
    assert says in answer.reason


def test_an_error_of_the_call_is_raised_here(calls):
    with pytest.raises(ms.MicroswimError, match="ZeroDivisionError: of no use"):
        found(calls.wrong, [(1,)])


def test_what_a_worker_prints_is_no_answer_and_it_has_one_thread(calls, capfd):
    assert found(calls.printing, [(1,)], 1) == {0: "1"}
    assert "noise" in capfd.readouterr().err


def test_a_worker_tells_how_far_it_is(calls):
    worker = Worker(calls.telling, tells=True)
    worker.ask(7)
    heard = [worker.heard.get(timeout=60)[1:] for _ in range(3)]
    worker.stop()
    assert heard == [("ready", None), ("told", "half"), ("done", 7)]
    assert worker.heard.get(timeout=60)[1] == "died"


def test_workers_that_cannot_start_end_the_run(calls, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(MachineError, match="cannot start here"):
        found(calls.twice, [(1,)])


def test_a_function_that_cannot_be_imported_is_refused_before_anything_starts():
    with pytest.raises(ms.SpecError, match="a function in a module"):
        found(lambda x: x, [(1,)])


@pytest.mark.parametrize("workers", [-1, 1.5, True, "2", float("nan"), 10**6, [1]])
def test_a_count_of_workers_that_makes_no_sense_is_refused(workers, tmp_path):
    helix = ms.Swimmer.preset("tabak/helix")
    for call in (
        lambda: ms.sweep(helix, {"tail.waves": [1.0]}, workers=workers),
        lambda: ms.validate(helix, {"tail.waves": [1.0]}, "rft", workers=workers),
        lambda: ms.calibrate_region(helix, {"tail.waves": (1.0, 2.0)}, "rft", workers=workers),
    ):
        with pytest.raises(ms.SpecError, match=r"workers = .*: must be a whole number from 0"):
            call()


PARENT = """
import sys
from functools import partial
from microswim.jobs import processes
import {module}

if __name__ == "__main__":
    list(processes.answers({module}.{call}, [(i,) for i in range(2)], 2))
"""
BUSY = """
import os, numba

@numba.njit
def endless(n):
    s = 0.0
    while s >= 0.0:
        for i in range(n):
            s += i % 7
        s = s % 1000.0
    return s

def busy(x):
    endless.compile("float64(int64)")
    os.write(1, b"%d\\n" % os.getpid())
    return endless(1000)
"""


def alive(pid):
    """Whether a process runs; one that ended and waits to be fetched does not."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
@pytest.mark.parametrize("call", ["asleep", "busy"])
def test_workers_end_with_a_parent_that_was_killed(calls, tmp_path, how, call):
    """Also those in the middle of compiled code, which lets no other thread run."""
    (tmp_path / "busy_of_a_user.py").write_text(BUSY)
    module = "calls_of_a_user" if call == "asleep" else "busy_of_a_user"
    (tmp_path / "parent.py").write_text(PARENT.format(module=module, call=call))
    parent = subprocess.Popen(
        [sys.executable, tmp_path / "parent.py"], stderr=subprocess.PIPE, text=True
    )
    try:
        workers = [int(parent.stderr.readline()) for _ in range(2)]
        assert all(map(alive, workers))
        time.sleep(0.2)
    finally:
        parent.send_signal(how)
        parent.wait()
        parent.stderr.close()
    for _ in range(100):
        if not any(map(alive, workers)):
            break
        time.sleep(0.1)
    assert not any(map(alive, workers))
