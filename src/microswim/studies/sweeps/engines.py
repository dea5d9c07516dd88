"""Where the rows of a sweep are solved: here, in worker processes, or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from microswim.jobs import cluster, processes
from microswim.jobs.worker import Lost, called
from microswim.studies.sweeps.rows import Job, solve_rows, unsolved
from microswim.studies.sweeps.space import Space

Rows = dict[str, np.ndarray]


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


def solved(
    job: Job, tasks: Iterable[Task], workers: int, client: Any = None
) -> Iterator[tuple[Task, Rows]]:
    """Yield each task with its rows, in whatever order they come.

    Parameters
    ----------
    job, tasks
        What to solve.
    workers
        Local processes, 0 for this one.
    client
        Of a Dask cluster, which then solves instead.
    """
    call = partial(solve_rows, job)
    if workers == 0 and client is None:
        for task in tasks:
            yield task, _rows(job, task, called(call, (task.columns,)))
        return
    tasks = list(tasks)
    asked = [(task.columns,) for task in tasks]
    if client is None:
        found = processes.answers(call, asked, workers)
    else:
        found = cluster.answers(call, asked, client)
    for i, answer in found:
        yield tasks[i], _rows(job, tasks[i], answer)


def _rows(job: Job, task: Task, answer: Rows | Lost) -> Rows:
    if isinstance(answer, Lost):
        return unsolved(job, task.stop - task.start, answer.reason)
    return answer
