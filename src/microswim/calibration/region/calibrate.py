"""Region calibration: designs chosen, solved by the reference, and a smooth correction fitted.

First designs fill the region (scrambled Sobol points), then each batch goes where it lowers the
doubt over the region most. What is fitted, in which coordinates and why:
docs/decisions/0015-region-calibration.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Unpack

import numpy as np

from microswim import checks
from microswim.calibration import record
from microswim.calibration.region import kriging
from microswim.calibration.region.beats import SAMPLES
from microswim.calibration.region.correction import Correction, features, fixed_numbers, words
from microswim.calibration.region.fit import (
    Solved,
    columns_of,
    fit_groups,
    groups_of,
    left_out_errors,
    one_thread,
    scaled,
    set_aside,
)
from microswim.calibration.region.kriging import Kriging
from microswim.calibration.region.outcome import RegionCalibration
from microswim.calibration.region.surfaces import Surfaces
from microswim.errors import MachineError, MicroswimError, SpecError
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.readable import percent
from microswim.jobs import references
from microswim.jobs.processes import counted
from microswim.numerics.sobol import points
from microswim.spec.values import all_from_python
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import unchosen

POOL = 512  #: Sobol points of a region
CANDIDATES = 300  #: of them, those among which the next designs are chosen
FLOOR = 0.03  #: variance, relative to the mean one, below which nothing is to be gained
ASYMMETRY = 2e-3  #: of the reference's R, relative; beyond, its mesh does not resolve the design
FIRST = 0.7  #: share of the solves that fill the region
Region = dict[str, tuple[float, float]]


@checks.given(
    swimmer=checks.swimmer,
    region=checks.mapping,
    reference=checks.one_of("bem", "fem", "rft"),
    solves=checks.at_least(1),
    folder=checks.place,
    seed=checks.at_least(0),
    progress=checks.function,
)
def calibrate_region(
    swimmer: Swimmer,
    region: Region,
    reference: Literal["bem", "fem", "rft"] = "bem",
    *,
    solves: int = 100,
    folder: Any = None,
    workers: int | None = None,
    seed: int = 1,
    progress: Callable[[int, int], None] | None = None,
    **options: Unpack[doors.ModelOptions],
) -> RegionCalibration:
    """Calibrate the surrogate over a region of designs.

    Parameters
    ----------
    swimmer
        What the designs have in common; a wave tail and a body.
    region
        Dotted name of a number of the spec to its bounds.
    reference
        ``"bem"`` or ``"fem"`` (or ``"rft"``).
    solves
        Designs to solve.
    folder
        Where solves are kept, so that a killed run goes on where it was.
    workers
        Processes, each with one thread; all cores by default, 0 to solve in this process.
    seed
        Of the choice of designs.
    progress
        Called with (solved, all).
    options
        What the reference takes, such as ``level``.

    Returns
    -------
    RegionCalibration
        Its ``swimmer`` is the same swimmer, whose surrogate gaits now hold over the region; its
        law of local resistance and interaction coefficients are gone, as the region replaces them.

    Raises
    ------
    SpecError
        If the region makes no sense.
    MicroswimError
        If too few designs could be solved.
    MachineError
        If the machine could not solve a design: not enough memory, a process killed.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> region = {"tail.amplitude": (0.08, 0.12)}
    >>> fitted = ms.calibrate_region(swimmer, region, "rft", solves=8, workers=0)
    >>> fitted.swimmer.gait().info["outside"]
    []
    """
    doors.check_options(reference, options)
    region = all_from_python(region, swimmer.units)
    _check(swimmer, region, solves)
    counted(workers)
    campaign = _Campaign(_pool(swimmer, region, seed), solves, max(6, len(region) + 2))
    chosen = list(range(min(max(8, round(FIRST * solves)), solves, len(campaign.pool))))
    solver = _phases(swimmer, reference, dict(options))
    fitted: tuple[Kriging, ...] = ()
    while chosen:
        found = references.gaits(
            [campaign.pool[i] for i in chosen],
            reference,
            folder=folder,
            workers=workers,
            progress=_shifted(progress, len(campaign.solved), solves),
            **solver,
        )
        campaign.take(chosen, found)
        with one_thread():
            chosen, fitted = campaign.chosen_next(fitted)
    solved, refused, unresolved = campaign.solved, campaign.refused, campaign.unresolved
    if len(solved) < campaign.fewest:
        why = refused[0][1] if refused else "the region holds no more"
        raise MicroswimError(f"only {len(solved)} designs could be solved: {why}")
    about: dict[str, Any] = {"reference": reference, "solves": len(solved), "seed": seed}
    about["options"] = {k: getattr(v, "name", v) for k, v in solver.items()}
    with one_thread():
        solved, doubtful = set_aside(solved, fitted)
        about["set_aside"] = [_values_of(s.swimmer, region) for s in doubtful]
        about["refused"] = [_values_of(s, region) | {"reason": why} for s, why in refused]
        made = _correction(swimmer, region, solved, doubtful + unresolved, fitted, about)
    bare = unchosen(replace(swimmer, region=None))
    told = replace(bare, region=made, calibration=record.of_region(made))
    return RegionCalibration(swimmer=told)


@dataclass
class _Campaign:
    """The designs of a region: what came of those that were tried, and which to try next."""

    pool: list[Swimmer]
    solves: int
    fewest: int
    solved: list[Solved] = field(default_factory=list)
    refused: list[tuple[Swimmer, str]] = field(default_factory=list)
    unresolved: list[Solved] = field(default_factory=list)
    tried: set[int] = field(default_factory=set)

    def take(self, chosen: list[int], found: list[Gait | str]) -> None:
        """Sort what the reference answered."""
        _require_machine(found)
        for i, g in zip(chosen, found):
            reason = _doubt(g)
            if isinstance(g, Gait) and not reason:
                self.solved.append(Solved(self.pool[i], g))
                continue
            self.refused.append((self.pool[i], reason))
            if isinstance(g, Gait):
                self.unresolved.append(Solved(self.pool[i], g))
        self.tried |= set(chosen)

    def chosen_next(self, fitted: tuple[Kriging, ...]) -> tuple[list[int], tuple[Kriging, ...]]:
        """Return the designs where the fits are least sure, with these fits; none at the end."""
        left = self.solves - len(self.solved)
        if left <= 0 or len(self.tried) >= min(2 * self.solves, len(self.pool)):
            return [], fitted
        if len(self.solved) < self.fewest:
            return [i for i in range(len(self.pool)) if i not in self.tried][:left], fitted
        fitted = fit_groups(self.solved, fitted)
        count = min(left, max(4, self.solves // 8))
        known = [s.swimmer for s in self.solved] + [s for s, _ in self.refused]
        return _least_sure(self.pool, fitted, known, self.tried, count), fitted


def _require_machine(found: list[Gait | str]) -> None:
    """Refuse to go on without designs that the machine, not the reference, could not solve."""
    unsolved = [g for g in found if isinstance(g, references.Unsolved)]
    if unsolved:
        raise MachineError(
            f"{len(unsolved)} of {len(found)} designs could not be solved here ({unsolved[0]}); "
            "what is solved is kept where a folder is given: run it again"
        )


def _doubt(gait: Gait | str) -> str:
    """Why a reference gait is not used: it was refused, or its R is not symmetric; else empty."""
    if isinstance(gait, str):
        return gait
    asymmetry = float(gait.info.get("asymmetry") or 0.0)
    resolved = asymmetry < ASYMMETRY
    return "" if resolved else f"not resolved: R is asymmetric by {percent(asymmetry)}"


def _check(swimmer: Swimmer, region: Region, solves: int) -> None:
    if not region:
        raise SpecError("region: empty; name what varies, such as tail.amplitude, and its bounds")
    if not swimmer.tail.in_batches or swimmer.body.is_absent:
        raise SpecError("region: a body and one helix or plane wave at the joint are needed")
    if not swimmer.body.is_ellipsoid:
        raise SpecError("body.shape", swimmer.body.shape, "an ellipsoid for a region",
                        "calibrate one design at a time, or take model bem")  # fmt: skip
    if swimmer.tail.is_rigid and not swimmer.body.is_axisymmetric:
        raise SpecError(
            "body.shape", swimmer.body.shape, "a body of revolution for a helix's region"
        )
    if swimmer.motion.line_element != "arc":
        raise SpecError("motion.line_element", "apparent", '"arc" for a region')
    if solves < max(6, len(region) + 2):
        raise SpecError("solves", solves, f"at least {max(6, len(region) + 2)}")
    for name, bounds in region.items():
        low, high = bounds if len(bounds) == 2 else (np.nan, np.nan)
        if name.startswith(("wall.", "channel.")):
            raise SpecError(
                "region", name, "a number of tail or body, in free fluid",
                f"design and boundary vary together in microswim path --over {name}=LOW:HIGH:N,"
                "tail.waves=... (ms.starts), which solves the poses of each design once, and at "
                "single poses in microswim sweep --model bem",
            )  # fmt: skip
        if not (np.isfinite([low, high]).all() and 0 < low < high):
            raise SpecError(f"region {name}", bounds, "two positive numbers, the lower one first")
        if not name.startswith(("tail.", "body.")) or name == "tail.frequency":
            raise SpecError("region", name, "a number of tail or body that decides the flow")
        swimmer.with_({name: low})


def _phases(swimmer: Swimmer, reference: str, options: dict[str, Any]) -> dict[str, Any]:
    """Boundary elements sample a plane wave at as few phases as the corrections need."""
    if reference != "bem" or swimmer.tail.is_rigid:
        return options
    from microswim.models.bem.levels import get_level

    level = options.get("level", "standard")
    chosen = get_level(level) if isinstance(level, str) else level
    return options | {"level": replace(chosen, phases=SAMPLES)}


def _shifted(progress: Any, before: int, all_: int) -> Any:
    return None if progress is None else lambda done, _: progress(min(before + done, all_), all_)


def _pool(swimmer: Swimmer, region: Region, seed: int) -> list[Swimmer]:
    """Scrambled Sobol points of the region that make sense, in their order."""
    low, high = np.array(list(region.values()), dtype=float).T
    out = []
    for x in low + (high - low) * points(POOL, len(region), seed):
        try:
            out.append(swimmer.with_(dict(zip(region, map(float, x)))))
        except SpecError:
            continue
    if len(out) < 6:
        raise SpecError("region", region, "a region with designs that make sense")
    return out


def _least_sure(
    pool: list[Swimmer], fitted: tuple[Kriging, ...], known: list[Swimmer], tried: set, count: int
) -> list[int]:
    """Designs that lower the doubt over the whole region most, one after the other as if solved.

    With C the covariance given what is known, a design c takes ``|C_xc|^2 / C_cc`` off the
    variance at x; the mean over the region counts, for thrust, invariant parts and lateral vectors
    alike. Designs that the reference refused count as known, so that it is not asked next to them.
    """
    columns = columns_of(np.array([features(s) for s in known], dtype=float))
    open_ = [i for i in range(len(pool)) if i not in tried][:CANDIDATES]
    Z, N = scaled([pool[i] for i in open_], columns)
    At, Nt = scaled(known, columns)
    posteriors = []
    for g in fitted[:3]:
        kernel = (g.lengths, g.phasors, g.real)
        K = kriging.covariance(At, Nt, At, Nt, *kernel) + g.noise * np.eye(len(At))
        half = np.linalg.solve(np.linalg.cholesky(K), kriging.covariance(At, Nt, Z, N, *kernel))
        C = kriging.covariance(Z, N, Z, N, *kernel) - half.conj().T @ half
        posteriors.append(C / np.real(np.diag(C)).mean())
    chosen: list[int] = []
    for _ in range(min(count, len(open_))):
        gain = np.zeros(len(open_))
        for C in posteriors:
            gain += np.mean(np.abs(C) ** 2, axis=0) / (np.real(np.diag(C)) + FLOOR)
        gain[chosen] = -1.0
        c = int(np.argmax(gain))
        chosen.append(c)
        posteriors = [C - np.outer(C[:, c], C[c]) / (C[c, c].real + FLOOR) for C in posteriors]
    return [open_[c] for c in chosen]


def _values_of(swimmer: Swimmer, region: Region) -> dict[str, float]:
    return {name: float(swimmer.numbers[name]) for name in region}


def _correction(
    swimmer: Swimmer,
    region: Region,
    solved: list[Solved],
    doubtful: list[Solved],
    former: Any,
    about: dict[str, Any],
) -> Correction:
    groups = fit_groups(solved, former)
    columns = columns_of(np.array([features(s.swimmer) for s in solved], dtype=float))
    order = sorted(range(len(groups)), key=lambda i: groups_of(swimmer.tail.is_rigid)[i][0].start)
    surfaces = Surfaces(tuple(groups[i] for i in order))
    errors, spots, ratios = left_out_errors(surfaces, columns, solved, doubtful)
    return Correction(
        low={name: float(b[0]) for name, b in region.items()},
        high={name: float(b[1]) for name, b in region.items()},
        fixed=fixed_numbers(swimmer, region),
        choices=words(swimmer),
        surfaces=surfaces,
        columns=columns,
        errors=errors,
        spots=spots,
        ratios=ratios,
        about=about,
    )
