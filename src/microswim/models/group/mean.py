"""Velocities of a group averaged over the phases of its motors, at its pose.

Motors of one rate keep their differences of phase: the mean runs over their common period. Motors
of different rates come by every pair of phases: the mean runs over all of them, as it does in time
unless one rate is a small multiple of the other and the phases lock; a lattice rule takes it,

    mean ~ 1/N sum_i V(2 pi i z / N),

exact for all harmonics h of the phases but those with h . z = 0 mod N   [Korobov 1959]; z is the
generator (1, a, a^2, ...) whose first such harmonic is the highest.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.gait.units import unit
from microswim.models.bem.levels import Level, coarser, get_level
from microswim.models.group.blocks import prepare
from microswim.models.group.far_field import FarField
from microswim.models.group.solution import GroupSolution, solve
from microswim.numerics.array import Array
from microswim.swimmer.group import Group
from microswim.swimmer.in_units import in_its_units

#: Rates that differ by less than this share are one; the most that differ; phases of each further
#: one (even: every other phase gives the error); harmonics looked at for the generator.
ALIKE, MOST_RATES, PHASES, HIGHEST = 1e-9, 3, 34, 4
#: Share of the fastest motion below which a velocity is rounding.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class GroupMotion:
    """How a group swims at its pose, averaged over the phases of its motors.

    Parameters
    ----------
    solution : GroupSolution
        At the members' own phases: resistance, propulsion, flow.
    mean_velocity : (n, 6)
        Of each swimmer in its own axes.
    mean_wrench : (n, 6)
        Force and torque by the fluid on each swimmer, its own axes.
    expected_error : dict
        ``us`` to ``or``: a list over the swimmers, relative to the speed, linear or angular, of
        that swimmer; ``resistance``; ``how``.
    error_of_velocity : (n, 6)
        The same errors in the units of the velocities.
    far_field : tuple of FarField
        Of each swimmer alone, averaged over its phases.
    phases : int
        Number of phases averaged over.
    seconds : float

    Examples
    --------
    >>> import microswim as ms
    >>> still = ms.Swimmer.preset("tabak/helix", {"tail.frequency": 0.0})
    >>> pulled = ms.Member(swimmer=still, force=(1.0, 0.0, 0.0))
    >>> ms.Group((pulled,)).swim(level="coarse").phases
    1
    """

    solution: GroupSolution
    mean_velocity: Array
    mean_wrench: Array
    expected_error: dict[str, Any]
    error_of_velocity: Array
    far_field: tuple[FarField, ...]
    phases: int
    seconds: float

    @property
    def group(self) -> Group:
        """The group, at its pose."""
        return self.solution.group

    @property
    def units(self) -> str:
        """``"SI"`` or ``"dimensionless"``."""
        return self.group.units

    @property
    def resistance(self) -> Array:
        """R (6n, 6n) at the members' own phases, in the swimmers' axes."""
        return self.solution.resistance

    @property
    def mean_velocity_scene(self) -> Array:
        """Mean velocity (n, 6) of each swimmer in the scene's axes."""
        return (self.solution.turn @ self.mean_velocity.reshape(-1)).reshape(-1, 6)

    def as_dict(self) -> dict[str, Any]:
        """Return what the command prints."""
        here = self.solution
        return {
            "mean_velocity": self.mean_velocity,
            "mean_velocity_scene": self.mean_velocity_scene,
            "mean_wrench": self.mean_wrench,
            "resistance": here.resistance,
            "resistance_scene": here.resistance_scene,
            "propulsion": here.propulsion,
            "about": [m.position for m in self.group.members],
            "resistance_order": [
                f"{name} of swimmer {k}" for k in range(here.number) for name in DEGREES_OF_FREEDOM
            ],
            "resistance_units": _units(self.units),
            "far_field": [far.as_dict() for far in self.far_field],
            "position": [m.position for m in self.group.members],
            "rotation": [m.rotation for m in self.group.members],
            "expected_error": self.expected_error,
            "units": self.units,
            "gap": here.gap,
            "phases": self.phases,
            "level": here.level,
            "unknowns": here.unknowns,
            "asymmetry": here.asymmetry,
            "remarks": here.remarks,
            "wall_seconds": self.seconds,
        }


@lru_cache(maxsize=8)
def generator(dimension: int, number: int) -> tuple[int, ...]:
    """Return the generator (1, a, a^2, ...) of the best lattice of so many points.

    The best one integrates all harmonics h up to the largest product of max(1, |h_i|).
    """
    h = np.array(list(product(range(-HIGHEST, HIGHEST + 1), repeat=dimension)))
    h = h[np.any(h != 0, axis=1)]
    merit = np.prod(np.maximum(1.0, np.abs(h)), axis=1)
    best, found = -1.0, (1,) * dimension
    for a in range(1, number):
        z = tuple(pow(a, k, number) for k in range(dimension))
        missed = (h @ np.array(z)) % number == 0
        least = float(merit[missed].min(initial=float("inf")))
        if least > best:
            best, found = least, z
    return found


def sampled_phases(own: Array, rates: Array, level: Level) -> Array:
    """Return the phases (N, n) of all motors that a mean is taken over, their `own` (n,) first.

    Raises
    ------
    SpecError
        If more than three rates differ.
    """
    size, clock = np.abs(rates), np.full(rates.size, -1)
    distinct: list[float] = []
    for n in np.flatnonzero(size > 0):
        near = [k for k, r in enumerate(distinct) if abs(size[n] - r) <= ALIKE * r]
        if not near:
            distinct.append(float(size[n]))
        clock[n] = near[0] if near else len(distinct) - 1
    if len(distinct) > MOST_RATES:
        raise SpecError(
            f"tail.frequency: {len(distinct)} different rates in one group; at most {MOST_RATES} "
            "may differ"
        )
    if not distinct:
        return own[None, :]
    number = level.phases if len(distinct) == 1 else PHASES * (len(distinct) - 1)
    z = np.array(generator(len(distinct), number))
    turns = np.arange(number)[:, None] * z / number
    ahead = np.where(clock >= 0, turns[:, clock], 0.0) * np.sign(rates)
    return own + 2.0 * np.pi * ahead


@in_its_units
def swim(
    group: Group,
    level: str = "standard",
    progress: Callable[[int, int], None] | None = None,
) -> GroupMotion:
    """Return how a group swims at its pose, averaged over the phases of its motors.

    Raises
    ------
    SpecError
        As `solution.solve`; if more than three rates differ, or a field changes in time.
    MachineError
        If the system does not fit into memory.
    """
    if group.field is not None and group.field.rate:
        raise SpecError(
            "field: changes in time, so that nothing has a mean at one pose; follow the swimmers, "
            "by --time 1s or ms.group_path"
        )
    start = time.perf_counter()
    chosen = get_level(level)
    blocks = prepare(group, chosen)
    first = solve(group, blocks=blocks)
    own = np.array([m.phase for m in group.members])
    phases = sampled_phases(own, first.rates, chosen)
    velocity, wrench, moments = [first.velocity], [first.wrench], [_moments(first)]
    for n, row in enumerate(phases[1:], start=1):
        if progress is not None:
            progress(n, len(phases) + 1)
        found = solve(group.moved(phases=row.tolist()), blocks=blocks)
        velocity.append(found.velocity)
        wrench.append(found.wrench)
        moments.append(_moments(found))
    V = np.array(velocity)
    rough = _rougher(first, level)
    error, off = _expected(first, V, rough)
    far = np.mean(moments, axis=0)
    doubt = np.abs(_moments(first) - _moments(rough))
    return GroupMotion(
        solution=first,
        mean_velocity=_without_rounding(V.mean(axis=0), first),
        mean_wrench=np.mean(wrench, axis=0),
        expected_error=error,
        error_of_velocity=off,
        far_field=tuple(
            FarField.of(m, e, held=not own.swimmer.motion.mask[0], units=group.units)
            for own, m, e in zip(group.members, far, doubt, strict=True)
        ),
        phases=len(phases),
        seconds=time.perf_counter() - start,
    )


def _units(units: str) -> dict[str, str]:
    """Return the units of the blocks of R (and, per phase rate, of F) by what they relate."""
    N, m, s = (unit(units, kind) for kind in ("force", "length", "time"))
    return {
        "force per velocity": f"{N} {s}/{m}",
        "force per rate, torque per velocity": f"{N} {s}",
        "torque per rate": f"{N} {m} {s}",
    }


def _without_rounding(V: Array, found: GroupSolution) -> Array:
    """Return velocities (n, 6) with zeros for those that are rounding beside the others."""
    felt = np.abs(V) * np.sqrt(found.resistance.diagonal()).reshape(-1, 6)  # of one unit
    return np.where(felt > ROUNDING * felt.max(), V, 0.0)


def _moments(found: GroupSolution) -> Array:
    return np.array([own.moments for own in found.alone])


def _rougher(first: GroupSolution, level: str) -> GroupSolution:
    """Return the solution of the next coarser level, of order 1 below coarse."""
    below = coarser(level)
    rough = get_level(below) if below else replace(get_level("coarse", 1), name="coarse, order 1")
    return solve(first.group, blocks=prepare(first.group, rough))


def _expected(first: GroupSolution, V: Array, other: GroupSolution) -> tuple[dict[str, Any], Array]:
    """Return the error of each mean, relative and not.

    It is that of the level, the difference from the next coarser one at the first phase, and that
    of the phases, the difference from the mean over every other phase.
    """
    off = np.abs(first.velocity - other.velocity) + np.abs(V.mean(0) - V[::2].mean(0))
    speed = np.sqrt(np.mean(np.sum(V.reshape(*V.shape[:2], 2, 3) ** 2, axis=-1), axis=0))
    scale = np.repeat(speed, 3, axis=1)
    scale = _without_rounding(scale, first)
    if np.array_equal(first.density, other.density):  # a file of triangles has no coarser patches
        off[:] = np.nan
    share = np.divide(off, scale, out=np.full_like(off, np.nan), where=scale > 0)
    free = first.group.free.reshape(-1, 6)
    errors = [[_known(x, f) for x, f in zip(row, mask)] for row, mask in zip(share.T, free.T)]
    root = np.sqrt(first.resistance.diagonal())
    miss = np.abs(first.resistance - other.resistance) / np.outer(root, root)
    how = (
        f"difference from level {other.level} at the first phase, and of "
        "the mean over half of the phases; of each swimmer's speed, linear or angular; of "
        "resistance: of sqrt(R_ii R_jj)"
    )
    known = dict(zip(DEGREES_OF_FREEDOM, errors))
    if np.isnan(off).any():
        how = "not known: there are no coarser patches to compare with; take a finer level"
    return {**known, "resistance": _known(float(miss.max()) or np.nan, True), "how": how}, off


def _known(share: float, free: bool) -> float | None:
    if not free:
        return 0.0
    return float(share) if np.isfinite(share) else None
