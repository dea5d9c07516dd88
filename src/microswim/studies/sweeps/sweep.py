"""Many solves: a grid or a list of designs into one Dataset, on disk if wanted."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np

from microswim import __version__, checks
from microswim.calibration.region.text import digest
from microswim.errors import MachineError, SpecError
from microswim.gait import doors
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.jobs import cluster as clusters
from microswim.jobs.lock import locked
from microswim.jobs.processes import counted
from microswim.numerics.array import sealed
from microswim.spec.describe import spec_json
from microswim.spec.values import all_from_python
from microswim.studies.sweeps.engines import Rows, Task, solved
from microswim.studies.sweeps.layout import (
    FORMAT,
    VECTORS,
    WAITING,
    blank,
    numbers_of,
    said,
)
from microswim.studies.sweeps.rows import BATCHED, Job
from microswim.studies.sweeps.space import Space
from microswim.studies.sweeps.store import SweepStore
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import check_names

if TYPE_CHECKING:
    import xarray as xr

BLOCK = {
    "rft": 65536,
    "auto": 65536,
    "atlas": 65536,
    "elastic": 64,
    "custom": 64,
    "bem": 64,
    "fem": 16,
}  # designs in a chunk of the store
IN_MEMORY = 2**30  #: bytes of a store below which its result is read at once
HOPELESS = 20  # designs left unsolved with none solved, and a sweep ends
Progress = Callable[[int, int], None]
Engine = Callable[[Iterable[Task]], Iterator[tuple[Task, Rows]]]


@checks.given(
    swimmer=checks.swimmer,
    model=checks.one_of(*(m for m in doors.MODELS if m in BLOCK)),
    out=checks.place,
    resume=checks.truth,
    scheduler=checks.text,
    cluster=checks.one_of("slurm"),
    progress=checks.function,
)
def sweep(
    swimmer: Swimmer,
    over: Any,
    model: Literal["rft", "auto", "atlas", "elastic", "bem", "fem"] = "auto",
    *,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    cluster: Literal["slurm"] | None = None,
    progress: Progress | None = None,
    **options: Unpack[doors.ModelOptions],
) -> xr.Dataset:
    """Solve many designs.

    Parameters
    ----------
    swimmer
        What does not vary.
    over
        Dotted name to values: the grid of all combinations. Or a list of designs: a list of
        mappings of dotted names to values, or a table with such columns. Values are numbers or,
        for choices such as ``tail.handedness`` and ``tail.kind``, words.
    model
        ``"auto"`` (the atlas where it covers a design and nobody chose a law or coefficients, else
        ``"rft"``; each with its expected error), ``"rft"`` (batched kernel), ``"atlas"``,
        ``"elastic"``, ``"bem"`` or ``"fem"``.
    out
        Zarr store to write as results come; killed at any moment it loses at most the solves in
        flight.
    resume
        Go on with the store at `out` if it is there.
    workers
        Local processes, each with one thread, or 0 to solve in this process; by default all cores
        for the reference solvers and 0 for the surrogate, whose kernel uses all cores itself. Jobs
        with `cluster`.
    scheduler, cluster
        Address of a Dask scheduler, or ``"slurm"``.
    progress
        Called with the number of solved designs and of all.
    options
        What the model takes, such as ``level="fine"``.

    Returns
    -------
    xarray.Dataset
        ``mean_velocity``, ``velocity_amplitude`` (with dimension ``component``),
        ``swimming_speed``, ``mean_power``, ``mean_torque``, ``efficiency``, ``expected_error``,
        ``status`` and ``reason`` over the dotted names (or ``design`` for a list). A failed
        design is NaN with its reason. Provenance in the attributes. A design that this machine
        could not solve (not enough memory, a worker process killed twice) stays unsolved, with the
        machine's reason. `plots.design_map` draws it.

    Raises
    ------
    SpecError
        If a name is no field of the swimmer, or `out` is there and is not to be resumed, or holds
        another sweep.
    MachineError
        If another sweep is writing `out`, `out` cannot be written, or designs were left unsolved in
        it; `resume` takes them up.
    MicroswimError
        If no cluster answers.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> result = ms.sweep(swimmer, {"tail.amplitude": [0.05, 0.1], "tail.waves": [1, 2, 3]})
    >>> dict(result.swimming_speed.sizes)
    {'tail.amplitude': 2, 'tail.waves': 3}
    """
    doors.check_options(model, options)
    clusters.check(scheduler, cluster)
    count = counted(workers)
    if count == 0 and (scheduler is not None or cluster is not None):
        raise SpecError("workers", workers, "at least 1 on a cluster")
    space = Space.of(
        all_from_python(over, swimmer.units),
        BLOCK[model if swimmer.tail.in_batches else "custom"],
    )
    check_names(swimmer, space.names)
    job = Job(swimmer, model, dict(options), space.size)
    attributes = _provenance(job, space)

    here = model in BATCHED and workers is None  # its kernel uses all cores itself

    def engine(tasks: Iterable[Task]) -> Iterator[tuple[Task, Rows]]:
        if scheduler is not None or cluster is not None:
            with clusters.connected(scheduler, cluster, count) as client:
                yield from solved(job, tasks, count, client)
        else:
            yield from solved(job, tasks, 0 if here else count)

    if out is None:
        return _in_memory(job, space, engine, attributes, progress)
    path = Path(out).resolve()
    with locked(path):
        store = _open(path, space, attributes, resume)
        _fill(job, space, engine, store, progress)
    return _read(path)


def _read(path: Path) -> xr.Dataset:
    """Return what a store holds: in memory, where nobody writes into it, or each time from disk."""
    import xarray as xr

    found = xr.open_dataset(path, engine="zarr", chunks=None, cache=False)
    return sealed(found.load()) if found.nbytes < IN_MEMORY else found


def _open(path: Path, space: Space, attributes: dict[str, Any], resume: bool) -> SweepStore:
    if not path.exists():
        return SweepStore.create(path, space, attributes)
    if not resume:
        raise SpecError(f"{path}: it is there already; --resume goes on with it, or remove it")
    return SweepStore.resume(path, space, attributes)


def _provenance(job: Job, space: Space) -> dict[str, Any]:
    """Where the results come from: version, spec, model, resolution, designs, machine."""
    over = {name: v.tolist() for name, v in zip(space.names, space.values) if v.size <= 10_000}
    return {
        "title": f"sweep of {space.size} designs over {', '.join(space.names)}",
        "microswim_version": __version__,
        "store_format": FORMAT,
        "model": job.model,
        "options": json.dumps(job.options, sort_keys=True, default=str),
        "units": job.swimmer.units,
        "outputs": json.dumps(numbers_of(job.swimmer)),
        "spec": spec_json(job.swimmer),
        "calibration": _calibration(job.swimmer),
        "over": json.dumps(over | {"digest": _digest(space)}, sort_keys=True),
        "created": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "machine": f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}",
        "libraries": f"numpy {np.__version__}, zarr {version('zarr')}",
    }


def _calibration(swimmer: Swimmer) -> str:
    """A fingerprint of the region calibration that the swimmer carries, if any."""
    region = getattr(swimmer, "region", None)
    return "none" if region is None else digest(region)


def _digest(space: Space) -> str:
    whole = hashlib.sha256(repr((space.names, space.grid, space.chunks)).encode())
    for values in space.values:
        whole.update(np.ascontiguousarray(values).tobytes() + str(values.dtype).encode())
    return whole.hexdigest()


def _tasks(job: Job, space: Space, rows: np.ndarray) -> Iterator[Task]:
    """Rows of a block as tasks: together for the batched kernel, else one by one."""
    if job.model not in BATCHED or not job.swimmer.tail.in_batches:
        yield from (Task(space, int(i), int(i) + 1) for i in rows)
    elif len(rows):
        yield Task(space, int(rows[0]), int(rows[-1]) + 1)


class UnsolvedWarning(UserWarning):
    """Some designs are not solved, and nothing is wrong with them: the machine could not."""


@dataclass
class Left:
    """Rows that were left unsolved for the machine's sake, and the first reason."""

    solved: int = 0
    rows: int = 0
    why: str = ""

    def count(self, results: Rows) -> None:
        """Take note of results as they come.

        Raises
        ------
        MachineError
            If nothing at all can be solved here.
        """
        waiting = results["status"] == WAITING
        self.solved += int(np.sum(~waiting))
        self.rows += int(np.sum(waiting))
        if waiting.any():
            self.why = self.why or str(results["reason"][waiting][0])
        if not self.solved and self.rows >= HOPELESS:
            raise MachineError(f"nothing can be solved here: {self.why}")


def _fill(job: Job, space: Space, engine: Engine, store: SweepStore, progress: Any) -> None:
    """Solve what the store does not hold yet, and write it as it comes.

    The surrogate's blocks are solved and written whole, so that rounding cannot depend on when a
    sweep was interrupted; for a reference every design stands for itself.
    """
    places = list(space.blocks())
    starts = np.array([start for _, start, _ in places])
    waiting = [np.flatnonzero(store.status(p) == WAITING) + a for p, a, _ in places]
    solved = space.size - sum(map(len, waiting))
    filling: dict[int, Rows] = {}
    left = Left(solved)
    if progress:
        progress(solved, space.size)
    with ThreadPoolExecutor(1) as writer:  # a whole block is written while the next is solved
        pending: Future[None] | None = None
        for task, results in engine(t for rows in waiting for t in _tasks(job, space, rows)):
            i = int(np.searchsorted(starts, task.start, side="right")) - 1
            place, start, stop = places[i]
            whole = task.stop - task.start == stop - start
            if i not in filling:
                filling[i] = results if whole else store.read(place)
            for name, values in results.items():
                filling[i][name][task.start - start : task.stop - start] = values
            if pending is not None:
                pending.result()
            pending = writer.submit(store.write, place, start, filling[i])
            if not whole:
                pending.result()
            if np.all(filling[i]["status"] != WAITING):
                del filling[i]
            solved += task.stop - task.start
            left.count(results)
            if progress:
                progress(solved, space.size)
        if pending is not None:
            pending.result()
    if left.rows:
        raise MachineError(
            f"{store.path}: {left.rows} of {space.size} designs are not solved ({left.why}); "
            "--resume takes them up"
        )


def _in_memory(job: Job, space: Space, engine: Engine, attributes: Any, progress: Any) -> Any:
    import xarray as xr

    whole = blank(space.size, numbers_of(job.swimmer))
    blocks = (np.arange(start, stop) for _, start, stop in space.blocks())
    solved, left = 0, Left()
    for task, results in engine(t for rows in blocks for t in _tasks(job, space, rows)):
        for name, values in results.items():
            whole[name][task.start : task.stop] = values
        solved += task.stop - task.start
        left.count(results)
        if progress:
            progress(solved, space.size)
    if left.rows:
        warnings.warn(
            f"{left.rows} of {space.size} designs are not solved: {left.why}",
            UnsolvedWarning,
            stacklevel=3,
        )
    data = {
        name: (
            (*space.dims, "component") if name in VECTORS else space.dims,
            whole[name].reshape(*space.shape, *whole[name].shape[1:]),
            said(name, job.swimmer.units),
        )
        for name in whole
    }
    data["reason"] = (data["reason"][0], data["reason"][1].astype(str), data["reason"][2])
    coords: dict[str, Any] = {"component": list(DEGREES_OF_FREEDOM)}
    for name, values in zip(space.names, space.values):
        dims = name if space.grid else "design"
        coords[name] = (dims, values, said(name, job.swimmer.units))
    return sealed(xr.Dataset(data, coords, attributes))
