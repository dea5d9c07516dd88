"""The pool of worker processes: told what to call, one thread each.

A worker that dies is replaced, and the job that it held tried once more; a second death makes that
job `Lost`, and the others go on. Not a pool of the standard library or of loky, which one dead
worker breaks: docs/decisions/0008-sweep-store.md.
"""

from __future__ import annotations

import os
import pickle
import queue
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from microswim.errors import MachineError, SpecError
from microswim.jobs.worker import Heard, Lost, Worker, called

TRIES = 2
MOST = 1024  #: worker processes


def cores() -> int:
    """Return the number of cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)
    return len(usable(0)) if usable else os.cpu_count() or 1


def counted(workers: int | None) -> int:
    """Return the number of worker processes: all cores for None, 0 for this process alone.

    Raises
    ------
    SpecError
        If `workers` is no whole number from 0 to 1024.
    """
    if workers is None:
        return cores()
    whole = hasattr(workers, "__index__") and not hasattr(workers, "__len__")
    if isinstance(workers, bool) or not whole or not 0 <= int(workers) <= MOST:
        raise SpecError(
            "workers", workers, f"a whole number from 0 (solve in this process) to {MOST}"
        )
    return int(workers)


def check_portable(*things: Any) -> None:
    """Refuse what another process cannot load.

    Raises
    ------
    SpecError
        If it holds a function that is not in a module.
    """
    try:
        there = b"__main__" not in pickle.dumps(things, protocol=4)
    except (pickle.PicklingError, AttributeError, TypeError):
        there = False
    if not there:
        raise SpecError(
            "tail.shape: must be a function in a module, for other processes to import; "
            "move it out of the script into a module of its own"
        )


def answers(
    call: Callable[..., Any], jobs: Iterable[tuple], workers: int
) -> Iterator[tuple[int, Any]]:
    """Yield the number of each job and ``call(*job)``, or `Lost`, as they come.

    Parameters
    ----------
    call
        A function of a module, or a partial of one.
    jobs
        Its arguments, a tuple each.
    workers
        Processes; 0 to call it here, one job after the other.

    Raises
    ------
    SpecError
        If another process cannot load the call.
    MachineError
        If no worker process can start.
    """
    if workers == 0:
        for i, job in enumerate(jobs):
            yield i, called(call, job)
    elif jobs := list(jobs):
        check_portable(call, jobs[0])
        yield from _pooled(call, jobs, workers)


def answers_by_name(
    call: Callable[..., Any],
    jobs: Mapping[str, tuple],
    workers: int,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Return ``call(*job)`` of each named job, in their order.

    Parameters
    ----------
    call, workers
        As for `answers`.
    jobs
        Arguments by name.
    progress
        Called with the number of jobs done and in all.

    Raises
    ------
    SpecError
        If another process cannot load the call.
    MachineError
        If worker processes cannot start, or a job is `Lost`.
    """
    found: dict[str, Any] = {}
    order = list(jobs)
    for i, answer in answers(call, jobs.values(), workers):
        if isinstance(answer, Lost):
            raise MachineError(f"{order[i]}: {answer.reason}")
        found[order[i]] = answer
        if progress is not None:
            progress(len(found), len(order))
    return {name: found[name] for name in order}


def _pooled(call: Any, jobs: Sequence[tuple], workers: int) -> Iterator[tuple[int, Any]]:
    waiting = deque((i, 1) for i in range(len(jobs)))
    heard: Heard = queue.SimpleQueue()
    busy: dict[Worker, tuple[int, int]] = {}

    def employ(worker: Worker) -> None:
        busy[worker] = waiting.popleft()
        worker.ask(*jobs[busy[worker][0]])

    try:
        for _ in range(min(workers, len(jobs))):
            employ(Worker(call, heard))
        while busy:
            worker, what, value = heard.get()
            if what == "ready" or worker not in busy:  # or it was stopped, and ended
                continue
            i, attempt = busy.pop(worker)
            if what == "died":
                worker.stop()
                if not worker.ready:
                    raise MachineError(f"worker processes cannot start here ({value})")
                if attempt < TRIES:
                    waiting.appendleft((i, attempt + 1))
                if waiting:
                    employ(Worker(call, heard))
                if attempt == TRIES:
                    yield i, Lost(f"its worker process died twice ({value})")
                continue
            if what == "failed":
                worker.stop()
                raise value
            if waiting:
                employ(worker)
            else:
                worker.stop()
            yield i, value
    finally:
        for worker in busy:
            worker.stop()
