"""Boundary elements at phases of each tail's own, for motors that give a torque: solved, kept.

What they say is a sum of harmonics of all phases (`numerics.series.harmonics`), of so many as meet
phases that had no part in it. Solves are kept in a file of the user's cache as they come: a path
that was stopped, other torques and reversed motors find them there.
"""

from __future__ import annotations

import hashlib
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from microswim import __version__
from microswim.errors import MicroswimError, SpecError
from microswim.jobs import store
from microswim.jobs.processes import answers, counted
from microswim.jobs.worker import Lost
from microswim.models.bem.levels import Level, coarser, named
from microswim.models.bem.own_phases import at_own_phases, with_phases
from microswim.numerics import archive
from microswim.numerics.array import Array
from microswim.numerics.files import cache_folder, write
from microswim.numerics.series.harmonics import Harmonics, fitted, harmonics, phases
from microswim.swimmer.swimmer import Swimmer

#: Largest sum of the harmonics' orders, the share of a velocity that is left at phases left out at
#: which no more are taken, or of what the next coarser level misses (that error keeps its sign as
#: phases go round, what harmonics leave averages out), and the share of the error before that must
#: be left for more to pay.
DEGREES, LEFT, OF_LEVEL, PAYS = range(2, 9), 1e-3, 2.0, 0.5
#: Phases left out, and those that the next coarser level is solved at.
JUDGED, ROUGH = 8, 3
OFTEN = 5.0  #: seconds between two times that the file is written

Progress = Callable[[int, int], None]
Parts = tuple[Array, Array, Array]  # R (6, 6), F (6, n), G (n, n)
Missed = Callable[[Parts, Parts], Array]


@dataclass(frozen=True, eq=False)
class MotorPhases:
    """R (6, 6), F (6, n) and G (n, n) of a swimmer at any phases of its n tails.

    Parameters
    ----------
    series : Harmonics
    tails : int
    solved : int
        Phases that it was made of.
    missed : (8, k)
        By how much phases left out are missed.
    rough : (3, k)
        By how much the next coarser level misses this one.
    """

    series: Harmonics
    tails: int
    solved: int
    missed: Array
    rough: Array

    def at(self, phase: Array) -> tuple[Array, Array, Array]:
        """Return R, F and G at the phases (n,) of the tails."""
        return unpacked(self.series.at(phase), self.tails)


def packed(R: Array, F: Array, G: Array) -> Array:
    """Return R, F and G as one row."""
    six, n = np.triu_indices(6), np.triu_indices(len(G))
    return np.concatenate([R[six], F.ravel(), G[n]])


def unpacked(row: Array, n: int) -> tuple[Array, Array, Array]:
    """Return R (6, 6), F (6, n) and G (n, n) of a row."""
    R, F, G = np.split(row, [21, 21 + 6 * n])
    return _symmetric(R, 6), F.reshape(6, n), _symmetric(G, n)


def _symmetric(upper: Array, n: int) -> Array:
    out, i = np.zeros((n, n)), np.triu_indices(n)
    out[i] = upper
    out.T[i] = upper
    return out


def motor_phases(
    swimmer: Swimmer,
    missed: Missed,
    *,
    level: str | Level = "standard",
    workers: int | None = None,
    progress: Progress | None = None,
) -> MotorPhases:
    """Return what boundary elements say of a swimmer at all phases of its tails.

    Parameters
    ----------
    swimmer
        In free fluid.
    missed
        By which shares (k,) one R, F and G miss the true ones.
    level
        ``"coarse"``, ``"standard"``, ``"fine"`` or one of one's own.
    workers
        Processes; all cores by default, 0 for this one.
    progress
        Called with (solves done, solves foreseen).

    Raises
    ------
    MicroswimError
        If tails touch at some phases, or a solve fails.
    """
    n = len(swimmer.tail.each)
    chosen, rough = _levels(swimmer, level)
    before = np.inf
    with _Solves(swimmer, n, workers, progress) as solves:
        first = _needed(n, DEGREES[0]) + JUDGED
        others = solves.first(ROUGH, rough, first)
        rows = solves.first(first, chosen, ROUGH, done=ROUGH)
        pairs = zip(others, rows, strict=False)
        levels = np.array([missed(unpacked(a, n), unpacked(b, n)) for a, b in pairs])
        enough_left = max(LEFT, OF_LEVEL * float(levels.max()))
        for degree in DEGREES:
            enough = _needed(n, degree)
            rows = solves.first(enough + JUDGED, chosen, ROUGH, done=ROUGH)
            where = phases(len(rows), n)
            series = fitted(where[:enough], rows[:enough], degree)
            pairs = zip(where[enough:], rows[enough:], strict=True)
            off = np.array(
                [missed(unpacked(series.at(p), n), unpacked(row, n)) for p, row in pairs]
            )
            left = float(off.max())
            if left < enough_left or left > PAYS * before:
                break
            before = left
    return MotorPhases(series, n, len(rows), off, levels)


def foreseen(swimmer: Swimmer, level: str | Level = "standard") -> tuple[int, int]:
    """Return how many solves it takes at least, and of how many unknowns each is."""
    from microswim.models.bem.patches.mesh import swimmer_surface

    n = len(swimmer.tail.each)
    at_rest = with_phases(swimmer, np.zeros(n))
    size = swimmer_surface(at_rest.body, at_rest.tail, 0.0, _levels(swimmer, level)[0].resolution)
    return _needed(n, DEGREES[0]) + JUDGED, size.unknowns


def _levels(swimmer: Swimmer, level: str | Level) -> tuple[Level, Level]:
    """Return the level, and the one that judges it."""
    chosen = level if isinstance(level, Level) else named(level, swimmer)
    below = coarser(chosen.name)
    if below:
        return chosen, named(below, swimmer)
    return chosen, replace(named("coarse", swimmer, 1), name="coarse, order 1")


def _needed(tails: int, degree: int) -> int:
    """Return how many phases a fit takes: twice as many as it has numbers."""
    return 2 * (1 + 2 * len(harmonics(tails, degree)))


class _Solves:
    """Solves of one swimmer in the order of the sequence, kept in a file."""

    def __init__(
        self, swimmer: Swimmer, n: int, workers: int | None, progress: Progress | None
    ) -> None:
        self.swimmer, self.n, self.workers, self.progress = swimmer, n, workers, progress
        self.place = _place(swimmer)
        self.kept = _held(self.place)
        self.written = time.monotonic()

    def __enter__(self) -> _Solves:
        return self

    def __exit__(self, *_: object) -> None:
        self._write()

    def first(self, count: int, level: Level, more: int, done: int = 0) -> Array:
        """Return the rows (count, k) of the first phases at a level.

        `more` of another level are foreseen, `done` of it are done.
        """
        known = self.kept.setdefault(level.name.replace(", ", " "), {})
        left = [k for k in range(count) if k not in known]
        done += count - len(left)
        self._tell(done, count + more)
        alone = self.workers is None and len(left) < 2
        where = phases(count, self.n)
        jobs = [(self.swimmer, where[k], level) for k in left]
        for i, row in answers(_row, jobs, 0 if alone else counted(self.workers)):
            if isinstance(row, (Lost, str)):
                reason = row.reason if isinstance(row, Lost) else row
                raise MicroswimError(f"the tails cannot be solved at all their phases: {reason}")
            known[left[i]] = row
            done += 1
            self._tell(done, count + more)
            if time.monotonic() - self.written > OFTEN:
                self._write()
        return np.array([known[k] for k in range(count)])

    def _tell(self, done: int, of: int) -> None:
        if self.progress is not None:
            self.progress(done, of)

    def _write(self) -> None:
        self.written = time.monotonic()
        arrays = {}
        for name, rows in self.kept.items():
            if rows:
                arrays[f"{name}/numbers"] = np.array(sorted(rows))
                arrays[f"{name}/rows"] = np.array([rows[k] for k in sorted(rows)])
        if self.place is not None and arrays:
            write(self.place, archive.pack({"key": self.place.stem}, arrays))


def _row(swimmer: Swimmer, where: Array, level: Level) -> Array | str:
    """Return R, F and G at phases as a row, or why there is none."""
    try:
        found = at_own_phases(swimmer, where, level)
    except SpecError as error:
        at = ", ".join(f"{p:.3g}" for p in where)
        return f"at phases {at} rad {error}"
    return packed(found.resistance, found.propulsion, found.activity)


def _place(swimmer: Swimmer) -> Path | None:
    """Return the file of a swimmer's solves; None for what has no name that lasts."""
    folder = cache_folder("motors")
    if folder is None:
        return None
    bare = [*with_phases(swimmer, np.zeros(len(swimmer.tail.each))).tail.each]
    seen = [swimmer.body, bare, swimmer.fluid, store.version("bem"), __version__]
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        text = repr(seen)
    if " at 0x" in text:
        return None
    return folder / f"{hashlib.sha256(text.encode()).hexdigest()[:20]}.npz"


def _held(place: Path | None) -> dict[str, dict[int, Any]]:
    """Return the rows that a file holds, by level and number; none of what is no such file."""
    kept: dict[str, dict[int, Any]] = {}
    if place is None:
        return kept
    with suppress(OSError, KeyError, ValueError):
        notes, arrays = archive.unpack(place.read_bytes())
        if notes["key"] == place.stem:
            for name in {key.partition("/")[0] for key in arrays}:
                numbers = arrays[f"{name}/numbers"].tolist()
                kept[name] = dict(zip(numbers, arrays[f"{name}/rows"], strict=True))
    return kept
