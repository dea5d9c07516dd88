"""Where the rows of a sweep are solved: here, in local processes, or on a Dask cluster.

An engine is a generator: tasks in, ``(task, results)`` out, in whatever order they come. A worker
that dies costs the design it held one more try, then that design's row says so.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import __version__
from microswim.errors import MicroswimError, SpecError
from microswim.studies.sweeps.rows import Job, solve_rows
from microswim.studies.sweeps.space import Space
from microswim.studies.sweeps.store import FAILED, blank

Rows = dict[str, np.ndarray]
THREADS = ("OMP", "OPENBLAS", "MKL", "NUMBA", "NUMEXPR")
TRIES = 2
PATIENCE = "20s"  # for a scheduler to answer


@dataclass(frozen=True, eq=False)
class Task:
    """Designs to solve in one go: a run of rows of a space."""

    space: Space
    start: int
    stop: int

    @property
    def rows(self) -> np.ndarray:
        """Row numbers."""
        return np.arange(self.start, self.stop)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Value of everything that varies."""
        return self.space.columns(self.rows)


def here(job: Job, tasks: Iterable[Task]) -> Iterator[tuple[Task, Rows]]:
    """Solve in this process, one task after the other."""
    for task in tasks:
        yield task, solve_rows(job, task.columns)


def check_portable(job: Job) -> None:
    """Refuse a swimmer that another process cannot load.

    Raises
    ------
    SpecError
        If it holds a function that is not in a module.
    """
    try:
        there = b"__main__" not in pickle.dumps(job, protocol=4)
    except (pickle.PicklingError, AttributeError, TypeError):
        there = False
    if not there:
        raise SpecError(
            "tail.shape: must be a function in a module, for other processes to import; "
            "move it out of the script into a module of its own"
        )


def lost(task: Task, why: str) -> Rows:
    """Rows of a task that no worker could finish."""
    out = blank(task.stop - task.start)
    out["status"][:] = FAILED
    out["reason"][:] = why
    return out


class Worker:
    """A process that solves one task at a time, single-threaded; it ends with its parent."""

    def __init__(self, job: Job) -> None:
        environment = os.environ | {f"{name}_NUM_THREADS": "1" for name in THREADS}
        environment["PYTHONPATH"] = os.pathsep.join(p or os.getcwd() for p in sys.path)
        self.process = subprocess.Popen(
            [sys.executable, "-c", "from microswim.studies.sweeps.engines import serve; serve()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        )
        self.job = job
        self.started = False

    def solve(self, task: Task) -> Rows:
        """Results of a task; EOFError if the process died over it."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            for message in (task.columns,) if self.started else (self.job, task.columns):
                pickle.dump(message, self.process.stdin)
                self.process.stdin.flush()
            self.started = True
            answer = pickle.load(self.process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):
            self.stop()
            raise EOFError(f"exit status {self.process.returncode}") from None
        return answer

    def stop(self) -> None:
        """End the process now."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]


def serve() -> None:
    """Loop of a worker process: job, then tasks on stdin, results on stdout."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints must not end up among the answers
    tasks = sys.stdin.buffer
    with contextlib.suppress(EOFError, KeyboardInterrupt, BrokenPipeError):
        job = pickle.load(tasks)
        while True:
            pickle.dump(solve_rows(job, pickle.load(tasks)), answers)
            answers.flush()


def processes(job: Job, tasks: Sequence[Task], workers: int) -> Iterator[tuple[Task, Rows]]:
    """Solve in local processes, each with one thread."""
    check_portable(job)
    waiting: queue.SimpleQueue = queue.SimpleQueue()
    for task in tasks:
        waiting.put(task)
    done: queue.SimpleQueue = queue.SimpleQueue()
    stopped = threading.Event()
    pool: list[Worker] = []
    threads = [
        threading.Thread(target=_drive, args=(job, waiting, done, pool, stopped), daemon=True)
        for _ in range(min(workers, len(tasks)))
    ]
    for thread in threads:
        thread.start()
    try:
        for _ in tasks:
            item = done.get()
            if isinstance(item, BaseException):
                raise item
            yield item
    finally:
        stopped.set()
        for worker in tuple(pool):
            worker.stop()
        for thread in threads:
            thread.join()


def _drive(job: Job, waiting: Any, done: Any, pool: list[Worker], stopped: Any) -> None:
    """Feed one worker process until no task waits; replace it when it dies."""
    worker: Worker | None = None
    while not stopped.is_set():
        try:
            task = waiting.get_nowait()
        except queue.Empty:
            break
        for attempt in range(TRIES):
            try:
                if worker is None:
                    worker = Worker(job)
                    pool.append(worker)
                done.put((task, worker.solve(task)))
                break
            except EOFError as error:
                worker = None
                if stopped.is_set():
                    return
                if attempt == TRIES - 1:
                    done.put((task, lost(task, f"its worker process died twice ({error})")))
            except BaseException as error:
                done.put(error)
                return
    if worker is not None:
        worker.stop()


def dask(job: Job, tasks: Sequence[Task], client: Any) -> Iterator[tuple[Task, Rows]]:
    """Solve on the workers of a `distributed.Client`; Dask moves the tasks of a dead worker."""
    from distributed import as_completed

    check_portable(job)
    other = sorted({v for v in client.run(_version).values() if v != __version__})
    if other:
        raise MicroswimError(
            f"the cluster's workers have microswim {', '.join(other)}, this is {__version__}; "
            "install the same on both"
        )
    sent = pickle.dumps(job)  # as bytes, so that the scheduler need not have the user's modules
    futures = {client.submit(_solve_sent, sent, t.columns, pure=False): t for t in tasks}
    try:
        for future in as_completed(list(futures), loop=client.loop):
            task = futures.pop(future)
            error = future.exception() if future.status == "error" else None
            if future.status == "cancelled":
                raise MicroswimError("the connection to the cluster was lost; --resume goes on")
            if error is None:
                yield task, future.result()
            else:
                yield task, lost(task, f"{type(error).__name__}: {' '.join(str(error).split())}")
            future.release()
    finally:
        client.cancel(list(futures))


def _solve_sent(job: bytes, columns: dict[str, np.ndarray]) -> Rows:
    return solve_rows(pickle.loads(job), columns)


def _version() -> str:
    return __version__


@contextlib.contextmanager
def connected(scheduler: str | None, cluster: str | None, workers: int) -> Iterator[Any]:
    """A Dask client at a scheduler's address or on a Slurm cluster.

    Raises
    ------
    MicroswimError
        If the extra is missing or nobody answers.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise MicroswimError(
            'Dask is not installed; install it with: pip install "microswim[cluster]"'
        ) from None
    with contextlib.ExitStack() as stack:
        address: Any = scheduler
        if cluster is not None:
            address = stack.enter_context(_slurm(workers))
        try:
            client = stack.enter_context(Client(address, timeout=PATIENCE, set_as_default=False))
        except OSError:
            raise MicroswimError(f"{scheduler}: no Dask scheduler answers there") from None
        yield client


def _slurm(workers: int) -> Any:
    """A Slurm cluster: one job a worker; queue and limits from Dask's own configuration."""
    try:
        from dask_jobqueue.slurm import SLURMCluster
    except ModuleNotFoundError:
        raise MicroswimError(
            'dask-jobqueue is not installed; install it with: pip install "microswim[cluster]"'
        ) from None
    from dask import config

    usual = {"cores": 1, "processes": 1, "memory": "4GB"}
    own = {k: v for k in usual if (v := config.get(f"jobqueue.slurm.{k}", None)) is not None}
    made = SLURMCluster(**(usual | own))
    made.scale(jobs=workers)
    return made
