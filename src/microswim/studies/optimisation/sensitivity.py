"""Which number of an optimal design matters, and by how much.

At an optimum the objective's first derivatives vanish along what is free to move; what matters is
how far each may move before the objective loses one per cent, and how the *optimal* value answers
to everything that was held: ``dJ*/dp = dJ/dp + sum_i lambda_i dg_i/dp`` with the multipliers of
the active constraints (envelope theorem).
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import nnls

from microswim.errors import MicroswimError
from microswim.numerics.plain import plain
from microswim.studies.optimisation.problem import Problem

ACTIVE = 1e-5
LOSS = 0.01
NUDGE = 1e-4


@dataclass(frozen=True)
class Sensitivity:
    """What one number does to the optimum.

    Parameters
    ----------
    value
        The number at the optimum.
    varied
        Whether it was free to choose.
    elasticity
        Per cent of the optimal objective per per cent of this number, held there.
    bound
        ``"low"`` or ``"high"`` if it lies at its bound.
    room
        Change of this number alone that costs one per cent of the objective; None if not varied.
    """

    value: float
    varied: bool
    elasticity: float
    bound: str | None = None
    room: float | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return its numbers and words as plain Python."""
        found = {"value": self.value, "varied": self.varied, "elasticity": self.elasticity}
        return plain(found | {"bound": self.bound, "one_percent_range": self.room})

    @property
    def weight(self) -> float:
        """How much it matters: per cent of loss for one per cent off."""
        if self.room:
            return LOSS * min(1.0, (LOSS * abs(self.value) / self.room) ** 2) + abs(self.elasticity)
        return abs(self.elasticity)


def sensitivities(problem: Problem, x: np.ndarray) -> dict[str, Sensitivity]:
    """Return sensitivity to every number of the spec that is not zero, the most important first."""
    numbers = {k: float(v) for k, v in problem.numbers(x).items()}
    values, slopes = problem.one(x)
    if values[0] == 0:
        return {}
    multipliers = _multipliers(x, values, slopes)
    out = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, value in (problem.swimmer.numbers | numbers).items():
            if value == 0 or name == "fluid.density":
                continue
            try:
                slope = problem.derivative(numbers, name)
            except MicroswimError:
                continue
            total = slope[0] + multipliers @ slope[1:]
            varied, bound, room = name in numbers, None, None
            if varied:
                i = problem.names.index(name)
                bound = "low" if x[i] < ACTIVE else "high" if x[i] > 1 - ACTIVE else None
                low, high = problem.ranges[name]
                room = _room(problem, x, i, values[0]) * (high - low)
            out[name] = Sensitivity(value, varied, float(total * value / values[0]), bound, room)
    return dict(sorted(out.items(), key=lambda item: -abs(item[1].elasticity)))


def _multipliers(x: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Multipliers of the active constraints: ``grad J + sum lambda grad g = 0`` off the bounds."""
    out = np.zeros(len(values) - 1)
    active = np.flatnonzero(values[1:] < ACTIVE)
    inside = (x > ACTIVE) & (x < 1 - ACTIVE)
    if len(active) and inside.any():
        out[active], _ = nnls(slopes[1:][active][:, inside].T, -slopes[0][inside])
    return out


def _room(problem: Problem, x: np.ndarray, i: int, value: float) -> float:
    """Least step of one variable, either way, that costs `LOSS` of the objective (unit cube).

    From slope and curvature there: ``|slope| h + |curvature| h^2 / 2 = LOSS |J|``.
    """
    step = np.zeros_like(x)
    step[i] = NUDGE if x[i] < 0.5 else -NUDGE
    try:
        here, there = problem.one(x)[1][0, i], problem.one(x + step)[1][0, i]
    except MicroswimError:
        return float("nan")
    bend = abs(there - here) / NUDGE
    slope, loss = abs(here), LOSS * abs(value)
    root = np.sqrt(slope**2 + 2.0 * bend * loss)
    return float(2.0 * loss / (slope + root)) if slope + root > 0 else float("inf")
