"""Poses beside a boundary, solved by boundary elements, and how well a table meets others."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from microswim.calibration.poses import alike
from microswim.errors import MicroswimError
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.gait.poses.face import Tabulated
from microswim.gait.poses.table import PoseTable
from microswim.jobs import references
from microswim.models.bem.levels import IN_TUBE, Level, get_level, named
from microswim.models.bem.patches.resolution import Sides
from microswim.numerics.array import Array
from microswim.numerics.files import cache_folder
from microswim.numerics.series.fourier import evaluate
from microswim.swimmer.swimmer import Swimmer

#: Longer patches on the tail than at level coarse: in u_s within half a per cent of level standard.
_COARSE = get_level("coarse")
FEW = replace(
    _COARSE,
    name="few",
    phases=1,
    resolution=replace(
        _COARSE.resolution, panel=5.0, stretch=8.0, bend=1.6, wave=2.0, slender=1.0, around=3
    ),
)
#: In a tube shorter patches on its side than at level coarse: a ball of .3 to .8 of its radius is
#: dragged within 1 % (3 % at coarse), velocities are within .2 % of level standard.
FEW_IN_TUBE = replace(
    IN_TUBE,
    name="few",
    phases=1,
    resolution=replace(IN_TUBE.resolution, vessel=Sides(around=18, along=0.8, change=3.0)),
)


@dataclass(frozen=True, eq=False)
class Solves:
    """What was solved of a swimmer beside a boundary.

    Parameters
    ----------
    free
        In free fluid, with the patches of the poses: what a boundary adds is told from there.
    best
        In free fluid at level standard, to which that is added; `free` where a level was asked.
    poses
        At the poses to interpolate, None where one cannot be solved.
    judged
        At those left out.
    """

    free: Gait
    best: Gait
    poses: list[Gait | None]
    judged: list[Gait | None]

    @property
    def there(self) -> list[Gait]:
        """Those of the poses that were solved."""
        return [gait for gait in self.poses if gait is not None]


SOME = 16  #: phases over which a gait in free fluid is averaged


@dataclass(frozen=True, eq=False)
class SolvedPoses(Tabulated):
    """A gait as a function of the pose beside the wall or in the tube of `gait.poses.face`.

    Parameters
    ----------
    gait
        In free fluid, by boundary elements.
    table
        For the compiled `table.resist`.
    start
        Position and quaternion of the pose that the spec states.
    expected_error
        95 % of the poses left out are interpolated as well as this, in units of the speed and the
        rate of turning in free fluid.
    """

    gait: Gait
    table: PoseTable
    start: tuple[Array, Array]
    expected_error: dict[str, Any]


def kept_in(folder: str | os.PathLike[str] | None) -> AbstractContextManager[Any]:
    """Return where several calls of `solved` find the solves of one another: for a while, if
    neither a folder is given nor the user's cache is to be had.
    """
    place = cache_folder("poses") if folder is None else folder
    return TemporaryDirectory() if place is None else nullcontext(place)


def solved(
    free_swimmer: Swimmer,
    asked: list[Swimmer],
    left_out: int,
    level: str | None,
    *,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    lost: float = 0.0,
    free_phases: int = 1,
) -> Solves:
    """Return the gaits in free fluid, and those of the poses: to interpolate, and left out.

    Parameters
    ----------
    free_swimmer
        Without its boundary.
    asked
        At each pose, the `left_out` last ones at level standard.
    level
        Of the others; by default `FEW`, in a tube `FEW_IN_TUBE`.
    folder
        Where solves are kept; a folder of the user's cache by default.
    workers, progress
        As `references.gaits` has them; one count over all poses.
    lost
        Share of the poses that may be without a solve: None stands for it.
    free_phases
        At which free fluid is solved.

    Raises
    ------
    MicroswimError
        If more poses, or free fluid, cannot be solved.
    """
    on = len(asked) - left_out

    def told(done: int, _: int) -> None:
        if progress is not None:
            progress(done, len(asked) + 1)

    options: dict[str, Any] = {"workers": workers}
    options["folder"] = cache_folder("poses") if folder is None else folder
    of = asked[0] if asked else free_swimmer
    chosen = level_of(of, level)
    whole = replace(chosen, phases=free_phases)
    free = _in_free_fluid(free_swimmer, level=whole, **options)
    finer = named("standard", of)
    best = free
    if level is None:
        best = _in_free_fluid(free_swimmer, level=replace(finer, phases=free_phases), **options)
    finer = replace(finer, phases=1, single=True)
    options["progress"] = lambda done, of: told(1 + done, of)
    found = _all_solved(asked[:on], lost, level=chosen, **options)
    options["progress"] = lambda done, of: told(on + 1 + done, of)
    return Solves(free, best, found, _all_solved(asked[on:], lost, level=finer, **options))


def _in_free_fluid(swimmer: Swimmer, **options: Any) -> Gait:
    (free,) = _all_solved([swimmer], 0.0, **options)
    if free is None:
        raise MicroswimError("the swimmer cannot be solved in free fluid")
    return free


def level_of(swimmer: Swimmer, level: str | None) -> Level:
    """Return the level at which poses of a swimmer are solved: one phase each, in single precision.

    That saves a third of the time; velocities move by less than 1e-4, in a tube by some 1e-6. A
    body alone, whose drag is all that counts, is solved at level standard: with few patches a ball
    sinks 2 % too fast at a gap of a twentieth of its radius.
    """
    if level is None and swimmer.tail.is_absent:
        level = "standard"
    few = FEW if swimmer.channel is None else FEW_IN_TUBE
    return replace(few if level is None else named(level, swimmer), phases=1, single=True)


def _all_solved(swimmers: list[Swimmer], lost: float, **options: Any) -> list[Gait | None]:
    """Return the gaits of all, or say why there is none of too many."""
    made = references.gaits([alike.as_solved(s) for s in swimmers], "bem", **options)
    reasons = [gait for gait in made if isinstance(gait, str)]
    machine = any(isinstance(gait, references.Unsolved) for gait in made)
    if reasons and (machine or len(reasons) > lost * len(made)):
        raise MicroswimError(f"a pose beside the boundary cannot be solved: {reasons[0]}")
    both = zip(made, swimmers, strict=True)
    return [None if isinstance(gait, str) else alike.of(gait, own) for gait, own in both]


def power_of(gait: Gait, phase: float = 0.0) -> float:
    """Return ``G - F_p . R^-1 F_p`` at a phase: what the motor spends where nothing holds it."""
    F = gait.propulsion(phase)
    held = float(evaluate(gait.activity_series, phase))
    return held - float(F @ np.linalg.solve(gait.resistance(phase), F))


def added_power(gait: Gait, free: float) -> float:
    """Return log of `power_of` over that of free fluid; 0 where there is no motor."""
    power = power_of(gait)
    return float(np.log(power / free)) if free > 0.0 and power > 0.0 else 0.0


def scales(free: Gait) -> Array:
    """Return speed and rate of turning in free fluid (6,), root mean square over the phase."""
    speed = free.at_rate(1.0).velocity(2.0 * np.pi * np.arange(SOME) / SOME)
    square = np.mean(speed**2, axis=0)
    return np.repeat(np.sqrt([square[:3].sum(), square[3:].sum()]), 3)


@dataclass(frozen=True, eq=False)
class Table(Tabulated):
    """A table that can be asked."""

    table: PoseTable


def error_of(
    table: PoseTable, free: Gait, starts: list[tuple[Any, ...]], judged: list[Gait | None]
) -> dict[str, Any]:
    """Return by how much poses left out are missed: 95 % of them by no more, each velocity.

    In units of the speed in free fluid, or of its rate of turning; of what has no tail under loads,
    see `_missed_under_loads`. `starts`: position, quaternion and, where it is not 0, phase.
    """
    if not starts:
        return {}
    scale = scales(free)
    swims = bool(scale.max() > 0.0)
    missed = []
    for (x, q, *phase), gait in zip(starts, judged, strict=True):
        if gait is None:
            continue
        R, F = Table(table).at(x, q, *(phase or [0.0]))
        if not swims:
            missed.append(_missed_under_loads(R, gait.resistance(0.0), free.resistance(0.0)))
            continue
        near = replace(gait, resistance_series=R[None], propulsion_series=F[None], rate=1.0)
        missed.append(np.abs(near.velocity(0.0) - gait.at_rate(1.0).velocity(0.0)))
    if not missed:
        return {}
    most = np.quantile(missed, 0.95, axis=0) / np.where(scale > 0, scale, 1.0)
    units = "the speed and of the rate of turning in free fluid"
    if not swims:
        units = "its velocity in free fluid under the same load"
    how = (
        f"95 % of {len(missed)} poses left out are met within this, in units of {units}, against "
        "boundary elements of level standard"
    )
    return {**dict(zip(DEGREES_OF_FREEDOM, most.tolist(), strict=True)), "how": how}


def _missed_under_loads(R: Array, true: Array, free: Array) -> Array:
    """Return how far velocities (6,) are off under the loads that in free fluid give each of them.

    ``|M - M'|_ij / sqrt(M0_ii M0_jj)``, the worst load j of each velocity i, M of R and M' of the
    true one; M0 of free fluid.
    """
    own = np.sqrt(np.diag(np.linalg.inv(free)))
    return np.abs((np.linalg.inv(R) - np.linalg.inv(true)) / np.outer(own, own)).max(axis=1)
