"""The multi-fidelity loop: the reference judges the surrogate's optimum until both agree.

Search on the surrogate; solve its optimum with the reference; where they differ by more than the
tolerance, calibrate the surrogate at that very design and search again. Every round costs one
reference solve.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from microswim.calibration.atlas.expected import expected_error
from microswim.calibration.calibrate import calibrate
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.gait.readable import percent
from microswim.numerics.plain import plain
from microswim.studies.optimisation.limits import for_people
from microswim.studies.optimisation.merits import of_gait
from microswim.studies.optimisation.problem import Problem
from microswim.studies.optimisation.remark import OF_THE_ERROR, Remark
from microswim.studies.optimisation.search import Optimum, search
from microswim.swimmer.swimmer import Swimmer

ROUNDS = 6
# What the reference is asked, and what of the surrogate answers for it.
RIGID = {
    "asked": ("tail_propulsion.us", "tail_propulsion.os", "mean.us", "mean.os"),
    "unknown": {"tail.t": "", "tail.n": "", "translation.s": "us", "rotation.s": "os"},
}
BEATING = {
    "asked": ("tail_propulsion.us", "mean.us", "amplitude.or"),
    "unknown": {"tail.t": "", "tail.n": "", "rotation.r": "or"},
}


def verified(
    problem: Problem,
    reference: str,
    search_with: dict[str, Any],
    *,
    tolerance: float,
    progress: Callable[[str], None] | None,
    options: dict[str, Any],
) -> Optimum:
    """Find the optimum on which surrogate and reference agree, or the best the latter has seen.

    Parameters
    ----------
    problem
        What to search.
    reference
        Name of the reference solver, with its `options`.
    search_with
        Seed and samples of a search.
    tolerance
        Relative miss of the objective that is accepted.
    progress
        Called with a sentence about each step.
    options
        Of the reference solver.

    Returns
    -------
    Optimum
        ``history`` holds a dict a round: ``values``, ``surrogate`` and ``reference`` (the
        objective), ``miss`` (relative), ``holds`` (whether the constraints hold for the
        reference), ``agreed``, ``miss_us`` (of the forward velocity), ``own_error`` (of the
        reference, None if it is not known).
    """
    begun = time.perf_counter()
    say = progress or (lambda text: None)
    rounds: list[dict[str, Any]] = []
    tried: list[Optimum] = []
    for number in range(1, ROUNDS + 1):
        say(f"round {number}: searching on the surrogate")
        best = search(problem, **search_with)
        say(f"round {number}: solving the optimum with {reference}")
        judged = best.swimmer.gait(reference, **options)
        rounds.append(_verdict(problem, best, judged, tolerance))
        tried.append(best)
        name, units, there = best.objective, best.swimmer.units, rounds[-1]["reference"]
        found, known = (for_people(name, value, units) for value in (best.value, there))
        say(
            f"round {number}: {name} {found} by the surrogate, {known} by {reference}: "
            f"{percent(rounds[-1]['miss'])} off"
        )
        if rounds[-1]["agreed"]:
            break
        if number < ROUNDS:
            problem = replace(problem, swimmer=_calibrated(problem.swimmer, best.swimmer, judged))
    i = len(rounds) - 1 if rounds[-1]["agreed"] else _best_judged(rounds, tried[0].sense)
    told = _judged(tried[i], rounds[i], tolerance)
    return replace(told, history=tuple(rounds), seconds=time.perf_counter() - begun)


def _judged(best: Optimum, verdict: dict[str, Any], tolerance: float) -> Optimum:
    """The optimum with what the reference says of it, in place of how far off it might be.

    u_s of what searched is off by its miss, and by what the reference itself may be off.
    """
    by, off, own = verdict["model"], percent(verdict["miss"]), verdict["own_error"]
    said = f"judged by {by} at this very design, {best.objective} is {off} off"
    if verdict["miss"] > tolerance:
        said += f", more than {percent(tolerance)}"
    if not verdict["holds"]:
        said += f"; {by} finds the constraints broken"
    if own is not None:
        said += f"; {by} itself is good to {percent(own)}"
    known = None if own is None else verdict["miss_us"] + own
    others = [r for r in best.remarks if r.kind not in OF_THE_ERROR]
    return replace(best, expected_error=known, remarks=(Remark(said, "judged"), *others))


def _verdict(problem: Problem, best: Optimum, judged: Any, tolerance: float) -> dict[str, Any]:
    expression, _ = problem.objectives[0]
    values = {k: float(np.real(v)) for k, v in of_gait(best.swimmer, judged).items()}
    reference = float(expression(values))
    miss = _apart(best.value, reference)
    holds = all(float(c.margin(values)) >= -tolerance for c in problem.limits)
    return {
        "values": plain(best.values),
        "surrogate": best.value,
        "reference": reference,
        "miss": miss,
        "miss_us": _apart(best.quantities["forward_velocity"], values["forward_velocity"]),
        "own_error": expected_error(best.swimmer, judged)["us"],
        "holds": holds,
        "agreed": bool(miss <= tolerance and holds),
        "model": judged.model,
    }


def _apart(value: float, reference: float) -> float:
    return abs(value - reference) / max(abs(reference), 1e-300)


def _best_judged(rounds: list[dict[str, Any]], sense: float) -> int:
    return max(
        range(len(rounds)), key=lambda i: (rounds[i]["holds"], sense * rounds[i]["reference"])
    )


def _calibrated(base: Swimmer, at: Swimmer, judged: Any) -> Swimmer:
    """The base swimmer with coefficients that agree with the reference at one design."""
    free: dict[str, bool] = dict(zip(DEGREES_OF_FREEDOM, at.motion.mask))
    names = RIGID if at.tail.is_rigid else BEATING
    unknowns = [u for u, needs in names["unknown"].items() if free.get(needs, True)]
    asked = [q for q in names["asked"] if free[q.split(".")[1]] or "propulsion" in q]
    fit = calibrate(at, judged, unknowns, quantities=asked)
    found = fit.swimmer
    return replace(base, interaction=found.interaction, calibration=found.calibration)
