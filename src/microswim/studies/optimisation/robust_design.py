"""The design whose unlucky robots are best, and of which enough meet the constraints.

Differential evolution on the batched kernel, every candidate with the same sample of deviations.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from scipy.optimize import differential_evolution

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.compiling.compiled import settled
from microswim.studies.optimisation.merits import of_many
from microswim.studies.optimisation.problem import Problem
from microswim.studies.optimisation.robustness import sobol_points, spec_numbers, uncertainties
from microswim.studies.optimisation.search import Optimum, outcome
from microswim.swimmer.swimmer import Swimmer


@checks.given(
    swimmer=checks.swimmer,
    over=checks.mapping,
    maximize=checks.text,
    uncertain=checks.mapping,
    minimize=checks.text,
    subject_to=checks.words,
    model=checks.one_of("auto", "rft", "atlas"),
    quantile=checks.share,
    least_yield=checks.share,
    samples=checks.at_least(1),
    seed=checks.at_least(0),
)
@settled(True)
def robust_design(
    swimmer: Swimmer,
    over: Any,
    maximize: str | None = None,
    *,
    uncertain: Mapping[str, Any],
    minimize: str | None = None,
    subject_to: Any = "",
    model: Literal["auto", "rft", "atlas"] = "auto",
    quantile: float = 0.1,
    least_yield: float = 0.95,
    samples: int = 128,
    seed: int = 0,
) -> Optimum:
    """Return the design whose unlucky robots are best, and of which enough meet the constraints.

    Maximizes the `quantile` of the objective over robots that differ by chance (for `minimize`
    the upper one), by differential evolution with the same samples for every design.

    Parameters
    ----------
    swimmer, over, maximize, minimize, subject_to, model
        As in `design`; relative spreads are about each candidate's own numbers.
    uncertain
        As in `robustness`.
    quantile
        Fraction of robots that may be worse than the objective says.
    least_yield
        Fraction of robots that must meet `subject_to`.
    samples, seed
        Robots a design, and seed.

    Returns
    -------
    Optimum
        The nominal design; ``history[0]`` holds ``quantile``, its value and the ``yield``.

    Raises
    ------
    SpecError
        If no design reaches the yield.

    Examples
    --------
    >>> import microswim as ms
    >>> best = ms.robust_design(
    ...     ms.Swimmer.preset("tabak/helix"),
    ...     {"tail.amplitude": (0.05, 0.15)},
    ...     maximize="swimming_speed",
    ...     uncertain={"tail.amplitude": "5%"},
    ...     samples=8,
    ... )
    >>> best.history[0]["yield"]
    1.0
    """
    begun = time.perf_counter()
    if any(name.startswith(("interaction.", "coefficients.")) for name in uncertain):
        model = "rft"  # the atlas knows none
    problem = Problem.of(swimmer, over, maximize, minimize, subject_to, model)
    if len(problem.objectives) != 1 or not problem.ranges:
        raise SpecError("robust design: one objective and at least one range")
    best: tuple | None = None
    count = 0
    for picked, variant in problem.variants():
        spreads = uncertainties(variant.swimmer, uncertain)
        u = sobol_points(len(spreads), samples, seed)
        x, count = _evolve(variant, spreads, u, (quantile, least_yield), seed, count)
        J, good = (float(v[0]) for v in _worth(variant, x[None], spreads, u, quantile))
        if good >= least_yield and (best is None or best[0] < J):
            best = (J, good, x, picked, variant)
    if best is None:
        raise SpecError(
            f"robust design: no design reaches a yield of {least_yield:g}; relax what must hold, "
            "lower the yield or tighten the tolerances"
        )
    J, good, x, picked, variant = best
    sense = problem.objectives[0][1]
    found = outcome(variant, x, picked, count, time.perf_counter() - begun)
    return replace(found, history=({"quantile": quantile, "value": sense * J, "yield": good},))


def _evolve(
    problem: Problem,
    spreads: Any,
    u: np.ndarray,
    wanted: tuple[float, float],
    seed: int,
    count: int,
) -> tuple[np.ndarray, int]:
    """Best point of the unit cube; a design short of the yield is worse than any that has it."""
    quantile, least = wanted

    def cost(x: np.ndarray) -> np.ndarray:
        J, good = _worth(problem, np.atleast_2d(x.T), spreads, u, quantile)
        worth = np.arctan(J / scale)  # between -2 and 2, whatever the unit
        return np.where(good < least, 4.0 + least - good, -worth)

    d = len(problem.ranges)
    first = np.random.default_rng(seed).random((32, d))
    sizes = np.abs(_worth(problem, first, spreads, u, quantile)[0])
    sizes = sizes[(sizes > 0) & (sizes < 1e29)]
    scale = float(np.median(sizes)) if len(sizes) else 1.0
    result = differential_evolution(
        cost,
        [(0.0, 1.0)] * d,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=np.random.default_rng(seed),
        popsize=10,
        maxiter=40,
        tol=1e-6,
    )
    return result.x, count + int(result.nfev) * len(u)


def _worth(
    problem: Problem, x: np.ndarray, spreads: Any, u: np.ndarray, quantile: float
) -> tuple[np.ndarray, np.ndarray]:
    """Quantile of the objective and yield of n designs, (n,) each."""
    n, m = len(x), len(u)
    numbers = {k: np.repeat(v, m) for k, v in problem.numbers(x).items()}
    nominal = spec_numbers(problem.swimmer)
    for i, (name, spread) in enumerate(spreads.items()):
        centre = numbers.get(name, nominal[name])
        numbers[name] = np.broadcast_to(spread.sample(np.tile(u[:, i], n), centre), (n * m,))
    values = of_many(problem.swimmer, numbers, 1e-5)
    objective, sense = problem.objectives[0]
    J = np.broadcast_to(sense * objective(values), (n * m,))
    good = np.isfinite(J) & np.isfinite(values["swimming_speed"])
    J = np.where(good, J, -1e30)
    for limit in problem.limits:
        good = good & (np.nan_to_num(limit.margin(values), nan=-1.0) >= 0.0)
    return np.quantile(J.reshape(n, m), quantile, axis=1), good.reshape(n, m).mean(axis=1)
