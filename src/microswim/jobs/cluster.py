"""Many jobs on a Dask cluster: a scheduler's address, or jobs of Slurm."""

from __future__ import annotations

import contextlib
import pickle
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from importlib.util import find_spec
from typing import Any

from microswim import __version__
from microswim.errors import MicroswimError, SpecError
from microswim.jobs.processes import check_portable
from microswim.jobs.worker import Lost, in_words

#: Of a Dask scheduler: a name or number and a port, with or without a protocol.
ADDRESS = r"(\w+://)?([^\s/:]+|\[[\da-fA-F:]+\]):\d{1,5}"
PATIENCE = "20s"  # for a scheduler to answer


def check(scheduler: str | None, cluster: str | None) -> None:
    """Refuse a scheduler or a cluster that cannot be one, before any work.

    Raises
    ------
    SpecError
        If both are asked for, an address is none, or this machine has no Slurm.
    MicroswimError
        If the extra is missing.
    """
    if scheduler is None and cluster is None:
        return
    if scheduler is not None and cluster is not None:
        raise SpecError("scheduler and cluster: one of the two")
    if scheduler is not None and not re.fullmatch(ADDRESS, scheduler):
        raise SpecError("scheduler", scheduler, "HOST:PORT, such as localhost:8786")
    if cluster not in (None, "slurm"):
        raise SpecError("cluster", cluster, '"slurm"')
    if cluster is not None and shutil.which("sbatch") is None:
        raise SpecError("cluster", cluster, "used where Slurm is", "sbatch is not on the path")
    wanted = {"distributed": "Dask"} | (
        {} if cluster is None else {"dask_jobqueue": "dask-jobqueue"}
    )
    for module, name in wanted.items():
        if find_spec(module) is None:
            how = 'pip install "microswim[cluster]"'
            raise MicroswimError(f"{name} is not installed; install it with: {how}")


@contextlib.contextmanager
def connected(scheduler: str | None, cluster: str | None, workers: int) -> Iterator[Any]:
    """Give a Dask client at a scheduler's address or on a Slurm cluster; `check` comes before.

    Raises
    ------
    MicroswimError
        If nobody answers.
    """
    from distributed import Client

    with contextlib.ExitStack() as stack:
        address: Any = scheduler
        if cluster is not None:
            address = stack.enter_context(_slurm(workers))
        try:
            client = stack.enter_context(Client(address, timeout=PATIENCE, set_as_default=False))
        except (OSError, ValueError):
            raise MicroswimError(f"{scheduler}: no Dask scheduler answers there") from None
        yield client


def _slurm(workers: int) -> Any:
    """Return a Slurm cluster: one job a worker; queue and limits from Dask's own configuration."""
    from dask import config
    from dask_jobqueue.slurm import SLURMCluster

    usual = {"cores": 1, "processes": 1, "memory": "4GB"}
    own = {k: v for k in usual if (v := config.get(f"jobqueue.slurm.{k}", None)) is not None}
    made = SLURMCluster(**(usual | own))
    made.scale(jobs=workers)
    return made


def answers(
    call: Callable[..., Any], jobs: Iterable[tuple], client: Any
) -> Iterator[tuple[int, Any]]:
    """Yield the number of each job and ``call(*job)``, or `Lost`, as they come.

    As `microswim.jobs.processes.answers`, on the workers of a `distributed.Client`; Dask moves
    the jobs of a dead worker.

    Raises
    ------
    MicroswimError
        If the workers have another version, or the connection is lost.
    """
    from distributed import as_completed

    jobs = list(jobs)
    check_portable(call, *jobs[:1])
    other = sorted({v for v in client.run(_version).values() if v != __version__})
    if other:
        raise MicroswimError(
            f"the cluster's workers have microswim {', '.join(other)}, this is {__version__}; "
            "install the same on both"
        )
    sent = pickle.dumps(call)  # as bytes, so that the scheduler need not have the user's modules
    futures = {client.submit(_sent, sent, job, pure=False): i for i, job in enumerate(jobs)}
    try:
        for future in as_completed(list(futures), loop=client.loop):
            i = futures.pop(future)
            error = future.exception() if future.status == "error" else None
            if future.status == "cancelled":
                raise MicroswimError("the connection to the cluster was lost; --resume goes on")
            if error is None:
                yield i, future.result()
            else:
                yield i, Lost(f"{type(error).__name__}: {in_words(error)}")
            future.release()
    finally:
        client.cancel(list(futures))


def _sent(call: bytes, job: tuple) -> Any:
    return pickle.loads(call)(*job)


def _version() -> str:
    return __version__
