"""Many reference gaits: solved in worker processes, and kept in a folder as they come.

A killed run loses at most the solves in flight, and a later one finds what it needs.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MachineError, MicroswimError, SpecError
from microswim.gait.gait import Gait
from microswim.jobs import store
from microswim.jobs.processes import answers, counted
from microswim.jobs.worker import Lost
from microswim.swimmer.swimmer import Swimmer

Progress = Callable[[int, int], None]


class Unsolved(str):
    """Why a design has no gait though nothing is wrong with it: never kept, solved when asked anew.

    The reason is the machine's: not enough memory, a worker process that was killed.
    """


def gaits(
    swimmers: Sequence[Swimmer],
    model: str = "bem",
    *,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> list[Gait | str]:
    """Return the gaits of many swimmers by a reference model.

    Parameters
    ----------
    swimmers
        The designs.
    model
        ``"bem"``, ``"fem"`` (or ``"rft"``).
    folder
        Where solves are kept and looked for; nowhere by default.
    workers
        Processes, each with one thread; all cores by default, 0 to solve in this process.
    progress
        Called with (solved, all).
    options
        What the model takes, such as ``level``.

    Returns
    -------
    list
        A `Gait` for each swimmer, or the reason why there is none; an `Unsolved` reason where the
        machine is at fault: a worker process that died, for one, costs its design, not the run.

    Raises
    ------
    SpecError
        If `workers` is no number of processes.
    MachineError
        If `folder` cannot be written; what was kept before stays.
    """
    count = counted(workers)
    places = [
        None if folder is None else store.place(Path(folder), s, model, options) for s in swimmers
    ]
    found: list[Gait | str | None] = [None if p is None else store.find(p) for p in places]
    left = [i for i, gait in enumerate(found) if gait is None]
    done = len(swimmers) - len(left)
    if progress:
        progress(done, len(swimmers))
    alone = workers is None and len(left) < 2  # one design: all cores for its solve
    for k, result in answers(
        solve, [(swimmers[i], model, options) for i in left], 0 if alone else count
    ):
        i = left[k]
        found[i] = Unsolved(result.reason) if isinstance(result, Lost) else result
        if (place := places[i]) is not None and not isinstance(result, Lost):
            store.keep(place, result)
        done += 1
        if progress:
            progress(done, len(swimmers))
    return [g if g is not None else Unsolved("not solved") for g in found]


def solve(swimmer: Swimmer, model: str, options: dict[str, Any]) -> Gait | str:
    """Return one gait, or the reason why there is none.

    Raises
    ------
    MachineError, MemoryError, OSError
        If the machine is at fault, not the design.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made = swimmer.gait(model, **options)
    except (MachineError, MemoryError, OSError):
        raise
    except (SpecError, MicroswimError) as error:
        return str(error)
    except Exception as error:  # a lost solve must not lose the others
        return f"{type(error).__name__}: {error}"
    return made if np.all(np.isfinite(made.mean_velocity)) else "the result is not finite"
