"""Many reference gaits: solved in worker processes, one thread each, and kept as they come.

A folder keeps one file per design, named by a digest of swimmer, model and options: a killed run
loses at most the solves in flight, and a later one finds what it needs.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pickle
import queue
import subprocess
import sys
import threading
import warnings
import zipfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.gait.gait import Gait
from microswim.swimmer.swimmer import Swimmer

Progress = Callable[[int, int], None]
THREADS = ("OMP", "OPENBLAS", "MKL", "NUMBA", "NUMEXPR")
_SERIES = (
    "resistance_series",
    "propulsion_series",
    "activity_series",
    "body_resistance_series",
    "body_propulsion_series",
)


def gaits(
    swimmers: Sequence[Swimmer],
    model: str = "bem",
    *,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> list[Gait | str]:
    """Gaits of many swimmers by a reference model.

    Parameters
    ----------
    swimmers
        The designs.
    model
        ``"bem"``, ``"fem"`` (or ``"rft"``).
    folder
        Where solves are kept and looked for; nowhere by default.
    workers
        Processes; all cores by default, 0 to solve in this process.
    progress
        Called with (solved, all).
    options
        What the model takes, such as ``level``.

    Returns
    -------
    list
        A `Gait` for each swimmer, or the reason why there is none.
    """
    paths = [None if folder is None else _path(Path(folder), s, model, options) for s in swimmers]
    found: list[Gait | str | None] = [None if p is None else load(p) for p in paths]
    left = [i for i, gait in enumerate(found) if gait is None]
    done = len(swimmers) - len(left)
    if progress:
        progress(done, len(swimmers))
    engine = _here if workers == 0 or len(left) < 2 else _processes
    jobs = [(i, swimmers[i], model, options) for i in left]
    for i, result in engine(jobs, workers or cores()):
        found[i] = result
        if paths[i] is not None:
            store(paths[i], result)
        done += 1
        if progress:
            progress(done, len(swimmers))
    return [g if g is not None else "not solved" for g in found]


def cores() -> int:
    """Cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)
    return len(usable(0)) if usable else os.cpu_count() or 1


def solve(swimmer: Swimmer, model: str, options: dict[str, Any]) -> Gait | str:
    """One gait, or the reason why there is none."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made = swimmer.gait(model, **options)
    except (SpecError, MicroswimError) as error:
        return str(error)
    except Exception as error:  # a lost solve must not lose the others
        return f"{type(error).__name__}: {error}"
    return made if np.all(np.isfinite(made.mean_velocity)) else "the result is not finite"


def _path(folder: Path, swimmer: Swimmer, model: str, options: dict[str, Any]) -> Path:
    """File of a solve: what the reference sees of the swimmer decides the name."""
    seen = (
        swimmer.body,
        swimmer.tail,
        swimmer.fluid,
        swimmer.motion,
        model,
        sorted(options.items()),
        *(around for around in (swimmer.wall, swimmer.channel) if around is not None),
    )
    return folder / f"{hashlib.sha256(repr(seen).encode()).hexdigest()[:20]}.npz"


def store(path: Path, result: Gait | str) -> None:
    """Write a solve, at once or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    with part.open("wb") as file:
        if isinstance(result, str):
            np.savez_compressed(file, reason=result)
        else:
            arrays = {n: v for n in _SERIES if (v := getattr(result, n)) is not None}
            about = {"rate": float(result.rate), "free": list(map(bool, result.free))}
            about |= {"model": result.model, "units": result.units, "info": _plain(result.info)}
            np.savez_compressed(file, about=json.dumps(about), **arrays)
    part.replace(path)


def load(path: Path) -> Gait | str | None:
    """Read a solve; None if there is none, or none that can be read."""
    try:
        with np.load(path, allow_pickle=False) as file:
            if "reason" in file:
                return str(file["reason"])
            about = json.loads(str(file["about"]))
            arrays = {name: file[name] for name in _SERIES if name in file}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    about["free"] = tuple(about["free"])
    return Gait(**arrays, **about)


def _plain(value: Any) -> Any:
    """The part of a model's notes that JSON can hold."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)


def _here(jobs: Iterable[Any], workers: int) -> Any:
    for i, *job in jobs:
        yield i, solve(*job)


class Worker:
    """A process that solves one design at a time on one thread; it ends with its parent."""

    def __init__(self) -> None:
        environment = os.environ | {f"{name}_NUM_THREADS": "1" for name in THREADS}
        environment["PYTHONPATH"] = os.pathsep.join(p or os.getcwd() for p in sys.path)
        command = [sys.executable, "-c", f"from {__name__} import serve; serve()"]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe)
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.jobs, self.results = self.process.stdin, self.process.stdout

    def __call__(self, job: Any) -> Gait | str:
        """Result of a job; EOFError if the process died over it."""
        pickle.dump(job, self.jobs)
        self.jobs.flush()
        return pickle.load(self.results)

    def stop(self) -> None:
        """End the process now."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.jobs, self.results):
            with contextlib.suppress(OSError):
                pipe.close()


def serve() -> None:
    """Loop of a worker process: jobs on stdin, results on stdout."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints must not end up among the answers
    with contextlib.suppress(EOFError, KeyboardInterrupt, BrokenPipeError):
        while True:
            pickle.dump(solve(*pickle.load(sys.stdin.buffer)), answers)
            answers.flush()


def _processes(jobs: Sequence[Any], workers: int) -> Any:
    """Solve in worker processes; results in whatever order they come."""
    waiting: queue.SimpleQueue = queue.SimpleQueue()
    done: queue.SimpleQueue = queue.SimpleQueue()
    for job in jobs:
        waiting.put(job)
    pool = [Worker() for _ in range(min(workers, len(jobs)))]
    threads = [
        threading.Thread(target=_drive, args=(worker, waiting, done), daemon=True)
        for worker in pool
    ]
    for thread in threads:
        thread.start()
    try:
        for _ in jobs:
            item = done.get()
            if isinstance(item, BaseException):
                raise item
            yield item
    finally:
        while not waiting.empty():
            with contextlib.suppress(queue.Empty):
                waiting.get_nowait()
        for worker in pool:
            worker.stop()
        for thread in threads:
            thread.join()


def _drive(worker: Worker, waiting: Any, done: Any) -> None:
    """Feed a worker until nothing waits; a worker that dies costs its design, not the run."""
    while True:
        try:
            i, *job = waiting.get_nowait()
        except queue.Empty:
            return
        try:
            done.put((i, worker(tuple(job))))
        except (OSError, EOFError, pickle.UnpicklingError, ValueError):
            status = worker.process.poll()
            done.put(MicroswimError(f"a worker process died (exit status {status}); run it again"))
            return
