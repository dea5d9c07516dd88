"""Many jobs on a Dask cluster: a scheduler's address, or jobs of Slurm."""

from __future__ import annotations

import contextlib
import pickle
import shutil
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from microswim import __version__
from microswim.errors import MicroswimError
from microswim.jobs.processes import check_portable
from microswim.jobs.worker import Lost, in_words

PATIENCE = "20s"  # for a scheduler to answer


@contextlib.contextmanager
def connected(scheduler: str | None, cluster: str | None, workers: int) -> Iterator[Any]:
    """Give a Dask client at a scheduler's address or on a Slurm cluster.

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
        except (OSError, ValueError):
            raise MicroswimError(f"{scheduler}: no Dask scheduler answers there") from None
        yield client


def _slurm(workers: int) -> Any:
    """Return a Slurm cluster: one job a worker; queue and limits from Dask's own configuration."""
    if shutil.which("sbatch") is None:
        raise MicroswimError("slurm: there is no sbatch on this machine to submit jobs with")
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
