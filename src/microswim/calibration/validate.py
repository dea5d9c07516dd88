"""The surrogate against a reference over a map of designs, stage by stage.

With reference ``R, F_p`` and surrogate ``R', F_p'`` at each phase, in the reference's measure of
dissipation (``|V|^2 = V'RV``, ``|F|^2 = F'R^-1 F``), root mean square over the period:

    resistance   |R^-1/2 (R' - R) R^-1/2|_2           largest relative error of any dissipation
    propulsion   |F_p' - F_p| / |F_p|                 error of the propulsive wrench
    velocity     |V' - V| / |V|                       what the two make together
    of which     V(R', F_p) and V(R, F_p') alone      so that a disagreement has an address

Lateral velocities nearly cancel at some designs: they are judged against their scale over the map
(the largest value of the reference).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Unpack

import numpy as np

from microswim import checks
from microswim.calibration import observations as observe
from microswim.errors import MicroswimError, SpecError
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.observed import parse
from microswim.jobs import references
from microswim.numerics.array import read_only
from microswim.spec.describe import unit_of
from microswim.swimmer import physical_sense
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import check_names

STAGES = (
    "resistance",
    "propulsion",
    "velocity",
    "velocity_by_resistance",
    "velocity_by_propulsion",
)
LIMITS = (0.05, 0.10)


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False)
@read_only
class Validation:
    """Errors of a surrogate over a map.

    Parameters
    ----------
    over
        Dotted name to values of every axis; the map is their grid.
    quantities
        Names of the velocities compared, as in `microswim.calibration.observations`.
    reference, surrogate
        Their values, name to array of the grid's shape; NaN where a design has no solution.
    stages
        Errors by stage, name to array.
    reasons
        Index of a design to the reason why it has no solution.
    against
        Name of the reference model.
    at
        Dotted name to the swimmer's own value, for the axes it has one of.
    axis_units
        Dotted name to the SI unit of an axis; empty for a dimensionless swimmer.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> result = ms.validate(swimmer, {"tail.waves": [2, 3]}, "rft", workers=0)
    >>> result.reference["mean.us"].shape
    (2,)
    """

    over: dict[str, np.ndarray]
    quantities: tuple[str, ...]
    reference: dict[str, np.ndarray]
    surrogate: dict[str, np.ndarray]
    stages: dict[str, np.ndarray]
    reasons: dict[int, str]
    against: str = "bem"
    at: dict[str, float] = field(default_factory=dict)
    axis_units: dict[str, str] = field(default_factory=dict)

    limits = LIMITS

    def error(self, quantity: str) -> np.ndarray:
        """Return the relative error; of a lateral velocity relative to its scale over the map."""
        reference, surrogate = self.reference[quantity], self.surrogate[quantity]
        scale = np.abs(reference)
        if quantity.startswith("amplitude"):
            scale = np.nanmax(scale)
        return np.abs(surrogate - reference) / scale

    def statistics(self) -> dict[str, dict[str, float]]:
        """Return median, 90 % quantile, worst error and share of the map within 5 % and 10 %."""
        return {
            name: _statistics(values)
            for name, values in (
                *((q, self.error(q)) for q in self.quantities),
                *self.stages.items(),
            )
        }

    def rows(self) -> list[dict[str, Any]]:
        """Return one row per design: its numbers, both values and the errors."""
        out = []
        for i, point in enumerate(itertools.product(*self.over.values())):
            row: dict[str, Any] = {name: float(v) for name, v in zip(self.over, point)}
            for q in self.quantities:
                row[q] = float(self.surrogate[q].flat[i])
                row[f"{q} {self.against}"] = float(self.reference[q].flat[i])
                row[f"{q} error"] = float(self.error(q).flat[i])
            row |= {name: float(values.flat[i]) for name, values in self.stages.items()}
            row["reason"] = self.reasons.get(i, "")
            out.append(row)
        return out

    def as_dict(self) -> dict[str, Any]:
        """Return its content for JSON: axes, statistics, every array, failures."""
        return {
            "against": self.against,
            "over": {name: values.tolist() for name, values in self.over.items()},
            "statistics": self.statistics(),
            "reference": {q: v.tolist() for q, v in self.reference.items()},
            "surrogate": {q: v.tolist() for q, v in self.surrogate.items()},
            "error": {q: self.error(q).tolist() for q in self.quantities},
            "stages": {name: v.tolist() for name, v in self.stages.items()},
            "failed": [{"design": i, "reason": r} for i, r in sorted(self.reasons.items())],
        }


def _statistics(values: np.ndarray) -> dict[str, float]:
    good = values[np.isfinite(values)]
    if good.size == 0:
        return dict.fromkeys(("median", "p90", "worst", "within_5", "within_10"), float("nan"))
    within = {f"within_{round(100 * x)}": float(np.mean(good <= x)) for x in LIMITS}
    numbers = {"median": np.median(good), "p90": np.quantile(good, 0.9), "worst": good.max()}
    return {k: float(v) for k, v in numbers.items()} | within


@checks.keyword_was("against", "reference")
@checks.given(
    swimmer=checks.swimmer,
    over=checks.mapping,
    reference=checks.one_of("bem", "fem", "rft"),
    quantities=checks.words,
    folder=checks.place,
    progress=checks.function,
)
def validate(
    swimmer: Swimmer,
    over: dict[str, Any],
    reference: Literal["bem", "fem", "rft"] = "bem",
    *,
    quantities: Iterable[str] = (),
    folder: Any = None,
    workers: int | None = None,
    progress: references.Progress | None = None,
    **options: Unpack[doors.ModelOptions],
) -> Validation:
    """Compare the surrogate with a reference over a grid of designs.

    Parameters
    ----------
    swimmer
        The calibrated (or plain) swimmer.
    over
        Dotted name to values of each axis.
    reference
        ``"bem"`` or ``"fem"``.
    quantities
        Velocities to compare; by default forward, lateral amplitude and rate of rotation.
    folder
        Where the reference solves are kept, so that a killed run goes on.
    workers, progress, options
        As `microswim.jobs.references.gaits`.

    Returns
    -------
    Validation

    Raises
    ------
    SpecError
        If an axis is unknown or empty.
    MicroswimError
        If no design could be solved.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> result = ms.validate(swimmer, {"tail.amplitude": [0.1]}, "rft", workers=0)
    >>> float(result.error("mean.us")[0])
    0.0
    """
    doors.check_options(reference, options)
    physical_sense.require_tail(swimmer, "a map of errors")
    check_names(swimmer, over)
    axes = {name: _axis(name, values) for name, values in over.items()}
    if not axes or any(v.size == 0 for v in axes.values()):
        raise SpecError("over", over, "at least one axis with values")
    for name in axes:
        if name not in swimmer.numbers:
            swimmer.with_({name: float(axes[name][0])})
    designs, reasons = _designs(swimmer, axes)
    names = tuple(quantities) or observe.usual_quantities(swimmer)
    for name in names:
        parse(name)  # before anything is solved
    built = {i: s for i, s in enumerate(designs) if s is not None}
    solved = references.gaits(
        list(built.values()),
        reference,
        folder=folder,
        workers=workers,
        progress=progress,
        **options,
    )
    found = _compare(axes, names, dict(zip(built, solved)), built, reasons, reference)
    own = {n: float(swimmer.numbers[n]) for n in axes if n in swimmer.numbers}
    units = {name: unit_of(name, swimmer.units) for name in axes}
    return replace(found, at=own, axis_units=units)


def _axis(name: str, values: Any) -> np.ndarray:
    try:
        return np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise SpecError(f"over {name}", values, "numbers, or a grid of them") from None


def _designs(swimmer: Swimmer, axes: dict[str, np.ndarray]) -> tuple[list, dict[int, str]]:
    """Swimmers of the grid, None where one cannot be built, with the reasons."""
    designs: list[Swimmer | None] = []
    reasons = {}
    for i, point in enumerate(itertools.product(*axes.values())):
        try:
            designs.append(swimmer.with_(dict(zip(axes, map(float, point)))))
        except SpecError as error:
            designs.append(None)
            reasons[i] = str(error)
    return designs, reasons


def _compare(
    axes: dict[str, np.ndarray],
    names: tuple[str, ...],
    solved: dict[int, Gait | str],
    built: dict[int, Swimmer],
    reasons: dict[int, str],
    against: str,
) -> Validation:
    shape = tuple(v.size for v in axes.values())
    tables = {
        kind: {name: np.full(shape, np.nan) for name in wanted}
        for kind, wanted in (("reference", names), ("surrogate", names), ("stages", STAGES))
    }
    for i, truth in solved.items():
        own = truth if isinstance(truth, str) else references.solve(built[i], "rft", {})
        if isinstance(truth, str) or isinstance(own, str):
            reasons[i] = str(own)
            continue
        for q in names:
            tables["reference"][q].flat[i] = observe.observed(truth, q)
            tables["surrogate"][q].flat[i] = observe.observed(own, q)
        for name, value in stages(truth, own).items():
            tables["stages"][name].flat[i] = value
    if len(reasons) == np.prod(shape):
        raise MicroswimError(f"no design of the map could be solved; the first: {reasons[0]}")
    held: dict[str, Any] = tables
    return Validation(over=axes, quantities=names, **held, reasons=reasons, against=against)


def stages(reference: Gait, surrogate: Gait, samples: int = 16) -> dict[str, float]:
    """Return errors of a surrogate's gait by stage, root mean square over the period.

    Examples
    --------
    >>> import microswim as ms
    >>> gait = ms.Swimmer.preset("tabak/helix").gait()
    >>> round(stages(gait, gait)["resistance"], 12)
    0.0
    """
    phase = 2.0 * np.pi * np.arange(samples) / samples
    f = np.flatnonzero(reference.free)
    R, S = (g.resistance(phase)[:, f[:, None], f] for g in (reference, surrogate))
    F, H = (g.propulsion(phase)[:, f] * g.rate for g in (reference, surrogate))
    L = np.linalg.cholesky(R)
    whitened = np.linalg.solve(L, np.swapaxes(np.linalg.solve(L, S - R), 1, 2))
    spread = np.abs(np.linalg.eigvalsh(whitened)).max(axis=1)

    def size(wrench: np.ndarray) -> float:
        return float(
            np.sqrt(np.mean(np.sum(np.linalg.solve(L, wrench[..., None])[..., 0] ** 2, -1)))
        )

    def off(A: np.ndarray, wrench: np.ndarray) -> float:
        V = -np.linalg.solve(A, wrench[..., None])[..., 0]
        true = -np.linalg.solve(R, F[..., None])[..., 0]
        return size(np.einsum("nij,nj->ni", R, V - true)) / max(size(F), 1e-300)

    return {
        "resistance": float(np.sqrt(np.mean(spread**2))),
        "propulsion": size(H - F) / max(size(F), 1e-300),
        "velocity": off(S, H),
        "velocity_by_resistance": off(S, F),
        "velocity_by_propulsion": off(R, H),
    }
