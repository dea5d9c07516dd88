"""The trade-off between two or three wishes: Pareto front by NSGA-II on the batched kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.numerics.array import sealed
from microswim.numerics.compiling.compiled import settled
from microswim.spec.describe import spec_json
from microswim.studies.optimisation.limits import with_units
from microswim.studies.optimisation.merits import MERITS, of_many
from microswim.studies.optimisation.problem import Problem
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

WORST = 1e30


@checks.given(
    swimmer=checks.swimmer,
    over=checks.mapping,
    maximize=checks.words,
    minimize=checks.words,
    subject_to=checks.words,
    model=checks.one_of("auto", "rft", "atlas"),
    population=checks.at_least(2),
    generations=checks.at_least(1),
    seed=checks.at_least(0),
)
@settled(True)
def pareto(
    swimmer: Swimmer,
    over: Any,
    maximize: Any = (),
    minimize: Any = (),
    *,
    subject_to: Any = "",
    model: Literal["auto", "rft", "atlas"] = "auto",
    population: int = 100,
    generations: int = 80,
    seed: int = 0,
) -> xr.Dataset:
    """Return designs that cannot be improved in one objective without losing in another.

    Parameters
    ----------
    swimmer, over, subject_to, model
        As in `design`.
    maximize, minimize
        Expressions, two or three together.
    population, generations, seed
        Of NSGA-II, for every combination of choices.

    Returns
    -------
    xarray.Dataset
        Over ``design``, sorted by the first objective: the objectives, what varied, every merit,
        and the ``expected_error`` of u_s where atlas or a region answered. The attribute
        ``objectives`` lists them with their sense.

    Raises
    ------
    SpecError
        If there is one objective only, or no design meets the constraints.
    MicroswimError
        If pymoo is not installed.

    Examples
    --------
    >>> import microswim as ms
    >>> front = ms.pareto(
    ...     ms.Swimmer.preset("tabak/helix"),
    ...     {"tail.amplitude": (0.02, 0.2), "tail.waves": (1, 4)},
    ...     maximize="swimming_speed",
    ...     minimize="mean_torque",
    ...     generations=5,
    ... )
    >>> bool((front.swimming_speed.diff("design") >= 0).all())
    True
    """
    problem = Problem.of(swimmer, over, maximize, minimize, subject_to, model)
    if not 2 <= len(problem.objectives) <= 3:
        raise SpecError(
            "pareto: two or three objectives, such as maximize swimming_speed, minimize mean_torque"
        )
    found = []
    for picked, variant in problem.variants():
        x = _front(variant, population, generations, seed)
        if len(x):
            found.append((picked, variant, x, variant.many(x, 1e-8)[0]))
    if not found:
        raise SpecError("pareto: no design in these ranges meets the constraints")
    keep = undominated(np.concatenate([F for *_, F in found]))
    tables, start = [], 0
    for picked, variant, x, F in found:
        chosen = keep[start : start + len(x)]
        start += len(x)
        if chosen.any():
            tables.append(_table(problem, picked, variant, x[chosen], F[chosen]))
    import xarray as xr

    front: Any = xr.concat(tables, "design", data_vars="all", join="outer", coords="all")
    order = np.argsort(np.asarray(front[problem.objectives[0][0].text]), kind="stable")
    made = front.isel(design=order).assign_attrs(
        objectives=[
            f"{'maximize' if s > 0 else 'minimize'} {o.text}" for o, s in problem.objectives
        ],
        spec=spec_json(swimmer),
        units=swimmer.units,
    )
    return sealed(with_units(made, swimmer.units))


def undominated(F: np.ndarray) -> np.ndarray:
    """Return which rows are not beaten in every column (all to be large) by another row."""
    keep = np.ones(len(F), dtype=bool)
    for i, row in enumerate(F):
        gain = F - row
        better = (gain >= 0).all(axis=1) & (gain > 0).any(axis=1)
        keep[i] = not better.any()
    return keep


def _front(problem: Problem, population: int, generations: int, seed: int) -> np.ndarray:
    """Feasible undominated points of the unit cube."""
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.problem import Problem as Base
        from pymoo.optimize import minimize
    except ModuleNotFoundError:
        raise MicroswimError(
            'pymoo is not installed; install it with: pip install "microswim[design]"'
        ) from None

    class Batched(Base):
        def _evaluate(self, x: np.ndarray, out: dict, *args: Any, **kwargs: Any) -> None:
            F, G = problem.many(x)
            out["F"] = np.where(np.isfinite(F), -F, WORST)
            out["G"] = np.where(np.isfinite(G), -G, WORST)

    d = len(problem.ranges)
    if d == 0:
        x = np.zeros((1, 0))
        return x if np.all(problem.many(x)[1] >= 0) else x[:0]
    batched = Batched(
        n_var=d,
        n_obj=len(problem.objectives),
        n_ieq_constr=len(problem.limits),
        xl=np.zeros(d),
        xu=np.ones(d),
    )
    result = minimize(batched, NSGA2(pop_size=population), ("n_gen", generations), seed=seed)
    return np.empty((0, d)) if result.X is None else np.unique(np.atleast_2d(result.X), axis=0)


def _table(problem: Problem, picked: Any, variant: Problem, x: np.ndarray, F: np.ndarray) -> Any:
    import xarray as xr

    from microswim.models.rft.batch import expected_errors

    numbers = variant.numbers(x)
    merits = of_many(variant.swimmer, numbers) if numbers else {}
    n = len(x)
    data = {name: ("design", merits[name]) for name in MERITS if name in merits}
    if variant.swimmer.region is not None and numbers:
        data["expected_error"] = ("design", expected_errors(variant.swimmer, numbers))
    for i, (objective, sense) in enumerate(problem.objectives):
        data[objective.text] = ("design", sense * F[:, i])
    coords: dict[str, Any] = {name: ("design", v) for name, v in numbers.items()}
    coords |= {name: ("design", np.array([value] * n)) for name, value in picked.items()}
    return xr.Dataset(data, coords)
