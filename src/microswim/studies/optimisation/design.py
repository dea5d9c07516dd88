"""Find the best design: what is asked, checked; the search is in `optimisation.search`."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any, Literal, Unpack

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.numerics.compiling.compiled import settled
from microswim.studies.optimisation.problem import Problem
from microswim.studies.optimisation.search import Optimum, search
from microswim.swimmer.swimmer import Swimmer

MISS = "a relative miss above 0 and at most 1"


@checks.keyword_was("verify", "reference")
@checks.given(
    swimmer=checks.swimmer,
    over=checks.mapping,
    maximize=checks.text,
    minimize=checks.text,
    subject_to=checks.words,
    model=checks.one_of("auto", "rft", "atlas"),
    seed=checks.at_least(0),
    samples=checks.at_least(1),
    reference=checks.one_of("bem", "fem"),
    tolerance=partial(checks.number, allowed=MISS, above=0.0, most=1.0),
    progress=checks.function,
)
@settled(True)  # gaits and their derivatives by the hundred
def design(
    swimmer: Swimmer,
    over: Any,
    maximize: str | None = None,
    *,
    minimize: str | None = None,
    subject_to: Any = "",
    model: Literal["auto", "rft", "atlas"] = "auto",
    seed: int = 0,
    samples: int | None = None,
    reference: Literal["bem", "fem"] | None = None,
    tolerance: float = 0.05,
    progress: Callable[[str], None] | None = None,
    **options: Unpack[doors.ModelOptions],
) -> Optimum:
    """Find the design that makes a quantity as large (or small) as it can be.

    Parameters
    ----------
    swimmer
        What does not vary.
    over
        Dotted name to ``(low, high)`` for a number, or to a list of choices (words such as
        ``["left", "right"]`` for ``tail.handedness``, ``tail.kind``, or a few numbers).
    maximize, minimize
        One of the two: a quantity (see `optimisation.merits`) or arithmetic on quantities and
        numbers of the spec, such as ``"swimming_speed / mean_torque"``.
    subject_to
        Constraints: ``"mean_torque <= 300, 0.1 <= body_rate <= 0.5"``.
    model
        What searches: the atlas where it serves, else the surrogate (``"auto"``), or one of them.
        The atlas is searched where it holds; ``remarks`` of the outcome say if that is not all.
    seed
        Of the random starts.
    samples
        Designs to screen for each combination of choices; by default 1024 for each variable and
        one more 1024, at most 8192.
    reference
        ``"bem"`` or ``"fem"``: let the reference solver judge the optimum, calibrate the
        surrogate there where it misses by more than `tolerance`, and search again until both
        agree.
    tolerance
        Relative miss of the objective that is accepted.
    progress
        Called with a sentence about each step.
    options
        What the reference solver takes, such as ``level="fine"``.

    Returns
    -------
    Optimum

    Raises
    ------
    SpecError
        If names or expressions make no sense, or no design meets the constraints.

    Examples
    --------
    >>> import microswim as ms
    >>> best = ms.design(
    ...     ms.Swimmer.preset("tabak/helix"),
    ...     {"tail.amplitude": (0.02, 0.2)},
    ...     maximize="swimming_speed",
    ...     subject_to="mean_torque <= 100",
    ... )
    >>> round(best.quantities["mean_torque"], 3)
    100.0
    """
    begun = time.perf_counter()
    _check_options(reference, dict(options))
    problem = Problem.of(swimmer, over, maximize, minimize, subject_to, model)
    if len(problem.objectives) != 1:
        raise SpecError("design: one objective; for a trade-off of several use pareto")
    if reference is not None:
        from microswim.studies.optimisation.verify import verified

        search_with = {"seed": seed, "samples": samples}
        more = {"tolerance": tolerance, "progress": progress, "options": options}
        return verified(problem, reference, search_with, **more)
    return search(problem, seed, samples, begun)


def _check_options(reference: str | None, options: dict[str, Any]) -> None:
    """Refuse options that the reference solver does not take, or that nobody would take."""
    if reference is not None:
        doors.check_options(reference, options)
        return
    for name, value in options.items():
        mend = "options of a solver go with reference="
        raise SpecError(name, value, "an option of design", mend)
