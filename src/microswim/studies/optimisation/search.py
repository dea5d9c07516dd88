"""The search for the best design: Sobol points screen, SLSQP polishes with exact gradients.

Sobol points over the whole range screen for the best feasible starts, SLSQP with complex-step
derivatives takes each to a local optimum, the best of these wins
(docs/decisions/0009-optimisers.md).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.optimize import minimize as descend
from scipy.stats import qmc

from microswim import checks
from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.everywhere import Everywhere
from microswim.calibration.atlas.expected import expected_error
from microswim.errors import MicroswimError, SpecError
from microswim.gait.gait import Gait
from microswim.gait.portrait import Printed, Rows
from microswim.gait.quantities import OLD, Named
from microswim.gait.readable import percent, significant
from microswim.numerics.array import read_only
from microswim.numerics.plain import plain
from microswim.spec.describe import describe
from microswim.studies.optimisation.limits import limit_said
from microswim.studies.optimisation.merits import of_gait
from microswim.studies.optimisation.problem import Problem
from microswim.studies.optimisation.remark import Remark
from microswim.studies.optimisation.sensitivity import Sensitivity, sensitivities
from microswim.swimmer.parts import replaced
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import vary

STARTS = 4
APART = 0.1  # least distance of two starts in the unit cube
LARGE = 0.05  #: expected error from which on the outcome says so
FEASIBLE = 1e-7  # relative margin that counts as holding


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
@read_only
class Optimum(Printed):
    """The best design and what to know about it.

    Parameters
    ----------
    swimmer
        The design.
    values
        What varied, by dotted name.
    objective, sense
        What was wanted, and whether large (+1) or small (-1).
    value
        The objective at the optimum.
    quantities
        Every quantity of its gait and of its shape (docs/quantities.md).
    margins
        Constraint to relative margin; zero is active.
    sensitivity
        Dotted name to `Sensitivity`, the most important first.
    expected_error
        Of u_s at the optimum, relative; None if it is not known.
    inside
        Whether it lies in the calibrated neighbourhood; None if there is none.
    evaluations, seconds
        What the search cost.
    ranges
        What each number was allowed.
    history
        Rounds of verification by a reference solver, see `verify`.
    model
        What answered: ``"atlas"`` or ``"rft"``.
    remarks
        How the error is known, whether it is large here, and where the model did not hold; the
        ``kind`` of each says which.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix")
    >>> best = ms.design(robot, {"tail.waves": (1, 4)}, maximize="swimming_speed", samples=64)
    >>> best.swimmer.tail.waves == best.values["tail.waves"]
    True
    """

    swimmer: Swimmer
    values: dict[str, Any]
    objective: str
    sense: float
    value: float
    quantities: dict[str, float]
    margins: dict[str, float]
    sensitivity: dict[str, Sensitivity]
    expected_error: float | None = None
    inside: bool | None = None
    evaluations: int = 0
    seconds: float = 0.0
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    history: tuple[dict[str, Any], ...] = ()
    model: str = "rft"
    remarks: tuple[Remark, ...] = ()

    def _portrait(self) -> tuple[str, Rows]:
        off = percent(self.expected_error)
        found = [
            (n, significant(v) if isinstance(v, float) else str(v)) for n, v in self.values.items()
        ]
        most = "largest" if self.sense > 0 else "least"
        return f"Optimum by {self.model}, {self.swimmer.units}", [
            *found,
            (f"{most} {self.objective}", significant(self.value)),
            ("error", f"{off}, of u_s"),
            ("more", "swimmer is the design, as_dict() has every number"),
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain numbers and words."""
        found = {
            "values": self.values,
            "objective": ("maximize " if self.sense > 0 else "minimize ") + self.objective,
            "value": self.value,
            "quantities": self.quantities | {old: self.quantities[new] for old, new in OLD.items()},
            "margins": self.margins,
            "sensitivity": {k: s.as_dict() for k, s in self.sensitivity.items()},
            "model": self.model,
            "expected_error": self.expected_error,
            "remarks": list(self.remarks),
            "inside_calibrated_neighbourhood": self.inside,
            "verification": list(self.history),
            "evaluations": self.evaluations,
            "wall_seconds": self.seconds,
            "spec": describe(self.swimmer),
        }
        return plain(found)


def search(
    problem: Problem, seed: int = 0, samples: int | None = None, begun: float | None = None
) -> Optimum:
    """Return the best design over all choices; see `design`."""
    begun = time.perf_counter() if begun is None else begun
    found, count = [], 0
    tried = list(problem.variants())
    for picked, variant in tried:
        points, n = _screen(variant, seed, samples)
        count += n
        for x in points:
            candidate, n = _polish(variant, x)
            count += n
            if candidate is not None:
                found.append((*candidate, picked, variant))
    for _, x, picked, variant in sorted(found, key=lambda f: -f[0]):
        try:
            best = outcome(variant, x, picked, count, time.perf_counter() - begun)
            return replace(best, remarks=(*best.remarks, *_of_choices(tried)))
        except SpecError:  # the checks of construction know more than the constraints
            continue
    if problem.model == "auto" and any(variant.covered < 1.0 for _, variant in tried):
        return search(replace(problem, model="rft"), seed, samples, begun)
    raise SpecError(
        "design: no design in these ranges meets the constraints; widen the ranges or relax "
        + (_limits(problem) or "what must hold")
    )


def _limits(problem: Problem) -> str:
    return ", ".join(limit_said(c.text, problem.swimmer.units) for c in problem.limits)


def _of_choices(tried: list[tuple[dict[str, Any], Problem]]) -> list[Remark]:
    """Say which choices were answered by the atlas, where others were not."""
    by_atlas = [isinstance(variant.swimmer.region, Everywhere) for _, variant in tried]
    if all(by_atlas) or not any(by_atlas):
        return []
    known = [" ".join(map(str, picked.values())) for (picked, _), by in zip(tried, by_atlas) if by]
    said = (
        f"compared by two models: the atlas for {', '.join(known)}, rft for the others, whose "
        "error may decide; --reference bem judges the best, --model rft compares by one"
    )
    return [Remark(said, "choices")]


def _screen(problem: Problem, seed: int, samples: int | None) -> tuple[list[np.ndarray], int]:
    """The best points of a Sobol sequence, apart from each other; feasible ones first."""
    d = len(problem.ranges)
    if d == 0:
        return [np.zeros(0)], 0
    n = 1 << (int(samples or min(8192, 1024 * (d + 1))) - 1).bit_length()
    x = qmc.Sobol(d, rng=np.random.default_rng(seed)).random(n)
    F, G = problem.many(x)
    violation = np.maximum(-G, 0.0).sum(axis=1)
    order = np.lexsort((-F[:, 0], np.where(np.isfinite(violation), violation, np.inf)))
    chosen: list[np.ndarray] = []
    for i in order:
        if not np.isfinite(F[i, 0]) or len(chosen) == STARTS:
            break
        if all(np.linalg.norm(x[i] - y) > APART for y in chosen):
            chosen.append(x[i])
    return chosen, n


def _polish(problem: Problem, x: np.ndarray) -> tuple[tuple[float, np.ndarray] | None, int]:
    """Local optimum from a start, and what it cost; None if it is not feasible."""
    seen: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}
    try:
        first = problem.one(x)
    except MicroswimError:
        return None, 1
    seen[x.tobytes()] = first
    size = max(abs(first[0][0]), 1e-300)

    def at(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = x.tobytes()
        if key not in seen:
            try:
                seen[key] = problem.one(x)
            except MicroswimError:  # a wall for the line search
                seen[key] = np.full_like(first[0], -1e3 * size), np.zeros_like(first[1])
        return seen[key]

    if len(x):
        limit = {
            "type": "ineq",
            "fun": lambda x: at(x)[0][1:],
            "jac": lambda x: at(x)[1][1:],
        }
        result = descend(
            lambda x: -at(x)[0][0] / size,
            x,
            jac=lambda x: -at(x)[1][0] / size,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(x),
            constraints=[limit] if problem.limits else [],
            options={"ftol": 1e-12, "maxiter": 100},
        )
        at(np.clip(result.x, 0.0, 1.0))
    feasible = [
        (float(values[0]), np.clip(np.frombuffer(key), 0.0, 1.0))
        for key, (values, _) in seen.items()
        if np.all(values[1:] >= -FEASIBLE)
    ]
    return (max(feasible, key=lambda f: f[0]) if feasible else None), len(seen) * max(1, len(x))


def outcome(
    problem: Problem, x: np.ndarray, picked: dict[str, Any], count: int, seconds: float
) -> Optimum:
    """Return the optimum at a point of the unit cube, with its sensitivity."""
    numbers = {k: float(v) for k, v in problem.numbers(x).items()}
    swimmer = vary(problem.swimmer, numbers) if numbers else problem.swimmer
    gait = swimmer.gait()
    if gait.model == "atlas":
        swimmer = replaced(swimmer, "region", None)
    values = {k: float(np.real(v)) for k, v in of_gait(swimmer, gait).items()}
    expression, sense = problem.objectives[0]
    error, how = trusted(swimmer, gait)
    return Optimum(
        swimmer=swimmer,
        values={**picked, **numbers},
        objective=expression.text,
        sense=sense,
        value=float(np.real(expression(values))),
        quantities=Named({k: v for k, v in values.items() if "." not in k}),
        margins={c.text: float(np.real(c.margin(values))) for c in problem.limits},
        sensitivity=sensitivities(problem, x),
        expected_error=error,
        inside=None if "outside" not in gait.info else not gait.info["outside"],
        evaluations=count,
        seconds=seconds,
        ranges=dict(problem.ranges),
        model=gait.model,
        remarks=tuple(_remarks(problem, swimmer, gait.model, error, how)),
    )


def trusted(swimmer: Swimmer, gait: Gait) -> tuple[float | None, str]:
    """Return the expected relative error of u_s, None where it is not known, and how it is known.

    Over a region the calibration's own: one standard deviation.
    """
    if swimmer.region is None:
        found = expected_error(swimmer, gait)
        return found["us"], str(found["how"])
    error = gait.info["expected_error"]
    known = error if np.isfinite(error) else None
    return known, "one standard deviation of the calibration over a region"


def _remarks(problem: Problem, swimmer: Swimmer, model: str, error: Any, how: str) -> list[Remark]:
    """Say how the error is known, where it is large, and what the atlas left out."""
    out = [Remark(how, "how known")]
    if error is None or error > LARGE:
        off = "is not known" if error is None else f"is large, {percent(error)}"
        said = f"the error at the optimum {off}: reference bem judges it"
        out.append(Remark(said, "unsure"))
    if model == "atlas" and problem.covered < 1.0:
        share = percent(problem.covered)
        said = f"searched where the atlas holds, {share} of the ranges; model rft knows all"
        out.append(Remark(said, "atlas"))
    edges = coordinates.edges(swimmer) if model == "atlas" else []
    if edges:
        said = f"at the edge of the atlas ({', '.join(edges)}): better ones may lie beyond"
        out.append(Remark(said, "atlas"))
    return out
