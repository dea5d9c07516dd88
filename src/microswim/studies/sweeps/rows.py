"""Solve the rows of a sweep: the same function in this process, a worker or a Dask cluster.

A design that cannot be solved becomes a row with its reason; one that this machine could not solve
stays unsolved, with the machine's reason.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from microswim.calibration.atlas.everywhere import Everywhere, errors_of_law, everywhere
from microswim.calibration.atlas.expected import expected_error
from microswim.errors import MachineError, MicroswimError, SpecError
from microswim.gait.basis import Basis
from microswim.gait.quantities import QUANTITIES
from microswim.gait.turning.driven import driven
from microswim.jobs.worker import in_words
from microswim.numerics.compiling.compiled import much, settled
from microswim.studies.sweeps.layout import DONE, FAILED, NUMBERS, VECTORS, blank, numbers_of
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import vary

#: Models that answer many designs side by side.
BATCHED = ("rft", "auto", "atlas")


@dataclass(frozen=True)
class Job:
    """What every row of a sweep shares: base swimmer, model, its options, and the rows in all."""

    swimmer: Swimmer
    model: str = "rft"
    options: dict[str, Any] = field(default_factory=dict)
    rows: int = 0

    @property
    def pays(self) -> bool:
        """Whether to compile for it. The same in every process, and after an interruption."""
        from microswim.models.rft.batch import as_python

        return much(as_python(self.swimmer, self.rows))


def solve_rows(job: Job, columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return results of designs, one a row: the batched kernel for the surrogate, else one by one.

    Parameters
    ----------
    job
        Base swimmer, model, options.
    columns
        Dotted name to values, all of one length.

    Returns
    -------
    dict
        As `microswim.studies.sweeps.layout.blank`: every row solved, failed or, for the machine's
        sake, left unsolved.
    """
    with settled(job.pays):
        return _solved(job, columns)


def _solved(job: Job, columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    out = blank(len(next(iter(columns.values()))), numbers_of(job.swimmer))
    left: Iterable[int] = range(len(out["status"]))
    alone = drive_of(job.swimmer) is not None  # what a field does is asked of each gait
    if job.model in BATCHED and not job.options and not alone:
        for choices, rows in groups(columns):
            numbers = {k: v[rows] for k, v in columns.items() if k not in choices}
            _solve_batched(job, job.model, choices, numbers, out, rows)
        left = np.flatnonzero(out["status"] != DONE).tolist()
    for i in left:
        _solve_one(job, {name: column[i] for name, column in columns.items()}, out, i)
    return out


def _solve_batched(
    job: Job,
    model: str,
    choices: dict[str, Any],
    numbers: Any,
    out: dict[str, np.ndarray],
    rows: Any,
) -> None:
    """Rows of equal choices by the batched kernel; what it cannot solve is left to one by one.

    Of what the atlas does not cover, ``auto`` takes a second batch, by the surrogate as it comes.
    """
    from microswim.models.rft.batch import evaluate, expected_errors

    if not numbers:
        return
    try:
        swimmer = _by_model(vary(job.swimmer, choices), model, numbers)
        results = evaluate(swimmer, numbers)
    except SpecError:
        return
    if swimmer.region is not None:
        results["expected_error"] = expected_errors(swimmer, numbers)
    elif job.model == "auto":
        forward = results["mean_velocity"][:, 0]
        results["expected_error"] = errors_of_law(swimmer, numbers, forward)
    good = np.isfinite(results["mean_velocity"]).all(axis=1) & np.isfinite(results["mean_power"])
    for name, values in results.items():
        if name in out:
            out[name][rows[good]] = values[good]
    out["status"][rows[good]] = DONE
    if model == "auto" and isinstance(swimmer.region, Everywhere):
        left = np.isnan(results["expected_error"])
        if left.any():
            there = {name: values[left] for name, values in numbers.items()}
            _solve_batched(job, "rft", choices, there, out, rows[left])


def _by_model(swimmer: Swimmer, model: str, numbers: Any) -> Swimmer:
    """Return the swimmer that answers batches by a model: with the atlas, where it serves."""
    found = None if model == "rft" else everywhere(swimmer, numbers)
    in_lab = model == "auto" and swimmer.motion.frequency_frame == "lab"
    if found is None and (model == "atlas" or in_lab):
        raise SpecError("model", model, "one by one, each with its reason")
    return found or swimmer


def _solve_one(job: Job, values: dict[str, Any], out: dict[str, np.ndarray], row: int) -> None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            swimmer = vary(job.swimmer, values)
            gait = swimmer.gait(job.model, **job.options)
            results = outputs(gait) | driven(gait, drive_of(swimmer))
            if np.isnan(results["expected_error"]):
                told = expected_error(swimmer, gait)["us"]
                results["expected_error"] = np.nan if told is None else told
    except (MachineError, MemoryError, OSError) as error:  # not the design's fault: row unsolved
        out["reason"][row] = in_words(error)
    except (SpecError, MicroswimError) as error:
        _fail(out, row, str(error))
    except Exception as error:  # a lost solve must not lose the sweep
        _fail(out, row, f"{type(error).__name__}: {error}")
    else:
        for name, value in results.items():
            out[name][row] = value
        out["status"][row] = DONE
        if not np.all(np.isfinite(out["mean_velocity"][row])):
            _fail(out, row, "the result is not finite")


def unsolved(job: Job, rows: int, why: str) -> dict[str, np.ndarray]:
    """Return rows that are left for another time, and why."""
    out = blank(rows, numbers_of(job.swimmer))
    out["reason"][:] = why
    return out


def _fail(out: dict[str, np.ndarray], row: int, reason: str) -> None:
    for name in out.keys() - {"status", "reason"}:
        out[name][row] = np.nan
    out["status"][row] = FAILED
    out["reason"][row] = " ".join(reason.split()) or "failed without a word"


def outputs(gait: Any) -> dict[str, Any]:
    """Return the numbers of a row from a gait."""
    basis = Basis(gait)
    found = {
        name: QUANTITIES[name].of(basis) for name in (*VECTORS, *NUMBERS) if name in QUANTITIES
    }
    error = gait.info.get("expected_error", np.nan)
    error = error["us"] if isinstance(error, dict) else error
    return found | {"expected_error": np.nan if error is None else error}


def groups(columns: Mapping[str, np.ndarray]) -> list[tuple[dict[str, Any], np.ndarray]]:
    """Return rows by their discrete choices: ``(choices, indices of the rows)``."""
    rows = len(next(iter(columns.values())))
    words = [name for name, column in columns.items() if column.dtype.kind in "USOb"]
    if not words:
        return [({}, np.arange(rows))]
    keys = list(zip(*(columns[name].tolist() for name in words)))
    found: dict[tuple, list[int]] = {}
    for i, key in enumerate(keys):
        found.setdefault(key, []).append(i)
    return [(dict(zip(words, key)), np.array(index)) for key, index in found.items()]
