"""A design problem: what may vary, what must hold, what is wanted; solved over the unit cube.

The objective and the margins of the constraints come from the batched kernel for many designs,
and with exact derivatives (complex step) for one.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from microswim import checks
from microswim.calibration.atlas.everywhere import everywhere
from microswim.errors import MicroswimError, SpecError
from microswim.models.rft.batch_of_waves import PHASES
from microswim.numerics.complex_step import STEP, derivative_from
from microswim.numerics.sobol import points
from microswim.spec.values import all_from_python
from microswim.studies.optimisation.expressions import Constraint, Expression, constraints, parse
from microswim.studies.optimisation.limits import in_si
from microswim.studies.optimisation.merits import known, of_gait, of_many
from microswim.swimmer.fields import in_terms_of, lifted
from microswim.swimmer.geometry.tails.kinds import TAILS, WaveTail
from microswim.swimmer.physical_sense import require_drag
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import KINDS, check_names, vary

MODELS = ("auto", "rft", "atlas")
PROBES = 256  #: designs that tell whether the atlas holds in the ranges
COARSE = 1e-5  # tolerance of the kernel while searching


@dataclass(frozen=True)
class Problem:
    """A design problem. Make it with `Problem.of`.

    Parameters
    ----------
    swimmer
        What does not vary.
    ranges
        Dotted name of a number to its bounds.
    choices
        Dotted name to the allowed words or numbers.
    objectives
        What is to be made large, each with its sense (+1 large, -1 small).
    limits
        The constraints, those of buildability included.
    model
        ``"auto"``: the atlas where it serves, else the surrogate; or one of the two.
    covered
        Share of the ranges in which the model holds.
    """

    swimmer: Swimmer
    ranges: Mapping[str, tuple[float, float]]
    choices: Mapping[str, tuple[Any, ...]]
    objectives: tuple[tuple[Expression, float], ...]
    limits: tuple[Constraint, ...]
    model: str = "auto"
    covered: float = 1.0

    @classmethod
    def of(
        cls,
        swimmer: Swimmer,
        over: Any,
        maximize: Any,
        minimize: Any,
        subject_to: Any,
        model: str = "auto",
    ) -> Problem:
        """Return the problem from what a user says.

        Raises
        ------
        SpecError
            If a name is unknown, a range is empty, or there is nothing to make large or small.
        """
        checks.choice("model", model, MODELS)
        check_names(swimmer, over)
        over = all_from_python(over, swimmer.units)
        ranges, choices = {}, {}
        for name, values in over.items():
            if isinstance(values, tuple) and len(values) == 2 and name not in KINDS:
                low, high = (float(v) for v in values)
                if not low < high:
                    raise SpecError(f"over {name}", values, "a lower and a higher bound")
                ranges[name] = (low, high)
            else:
                choices[name] = tuple(values)
        wanted = [(t, 1.0) for t in _texts(maximize)] + [(t, -1.0) for t in _texts(minimize)]
        if not wanted or not over:
            raise SpecError("design: it needs something that varies and something to maximize")
        if not any(name.startswith("interaction") for name in over):
            require_drag(swimmer)
        names = known(swimmer)
        text = subject_to if isinstance(subject_to, str) else ", ".join(subject_to)
        return cls(
            swimmer,
            ranges,
            choices,
            tuple((parse(t, names), sense) for t, sense in wanted),
            constraints(in_si(text, swimmer), names),
            model,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers that vary."""
        return tuple(self.ranges)

    @property
    def needs(self) -> frozenset[str]:
        """Quantities that objectives and constraints use."""
        parts = [o.names for o, _ in self.objectives] + [c.names for c in self.limits]
        return frozenset().union(*parts)

    def variants(self) -> Iterator[tuple[dict[str, Any], Problem]]:
        """Yield the problem for every combination of choices, constraints of buildability added."""
        found, complaint = False, None
        for combination in product(*self.choices.values()):
            picked = dict(zip(self.choices, combination))
            if self._repeats(picked):
                continue
            try:
                swimmer = vary(self.swimmer, picked)
            except SpecError as error:
                complaint = error
                continue
            found = True
            swimmer = in_terms_of(swimmer, self.ranges)
            yield picked, replace(self, swimmer=swimmer, choices={}).by_model()
        if not found and complaint is not None:
            raise complaint

    def by_model(self) -> Problem:
        """Return the problem as its model answers it, constraints of buildability added.

        The atlas serves where it holds for some of the ranges, and keeps to those.

        Raises
        ------
        SpecError
            If the atlas is asked for and does not serve.
        """
        plain = replace(self, limits=self.limits + _buildable(self.swimmer))
        served = None if self.model == "rft" else everywhere(self.swimmer, self.ranges)
        if served is not None:
            made = replace(self, swimmer=served, limits=self.limits + _buildable(served))
            goals, _ = made.many(points(PROBES, max(1, len(self.ranges)), 0))
            covered = float(np.isfinite(goals).all(axis=1).mean())
            if covered > 0.0:
                return replace(made, covered=covered)
        if self.model == "atlas":
            raise SpecError("model", "atlas", "another one: it holds nowhere in these ranges")
        return plain

    def _repeats(self, picked: dict[str, Any]) -> bool:
        """A plane wave has no hand: one of the two is enough."""
        hands = self.choices.get("tail.handedness", ())
        kind = picked.get("tail.kind")
        tail = self.swimmer.tail if kind is None else TAILS[kind]
        return bool(hands) and not tail.turns_whole and picked["tail.handedness"] != hands[0]

    def numbers(self, x: np.ndarray) -> dict[str, Any]:
        """Return numbers of the spec at points of the unit cube, (d,) or (n, d)."""
        x = np.asarray(x)
        return {
            name: low + (high - low) * x[..., i]
            for i, (name, (low, high)) in enumerate(self.ranges.items())
        }

    def many(self, x: np.ndarray, tolerance: float = COARSE) -> tuple[np.ndarray, np.ndarray]:
        """Return objectives (n, o), all to be made large, and margins (n, m); -inf where
        impossible.
        """
        values = of_many(self.swimmer, self.numbers(x), tolerance, self.needs)
        n = len(x)
        goals = [np.broadcast_to(s * o(values), (n,)) for o, s in self.objectives]
        margins = [np.broadcast_to(c.margin(values), (n,)) for c in self.limits]
        F = np.stack(goals, axis=1)
        G = np.stack(margins, axis=1) if margins else np.zeros((n, 0))
        bad = ~np.isfinite(F).all(axis=1) | ~np.isfinite(values["swimming_speed"])
        F, G = np.where(bad[:, None], -np.inf, F), np.where(bad[:, None], -np.inf, G)
        return F, np.where(np.isnan(G), -np.inf, G)

    def one(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the first objective and margins at a point, stacked (1 + m,), and their
        derivatives in x.

        Raises
        ------
        SpecError
            If the design is impossible.
        """
        numbers = self.numbers(np.clip(x, 0.0, 1.0))
        if not self.ranges:
            value = self.values(numbers)
            return value, np.zeros((len(value), 0))
        at = lifted(self.swimmer, numbers)
        stepped = np.stack(
            [self._stack(lifted(at, {k: v + 1j * STEP})) for k, v in numbers.items()], axis=1
        )
        widths = np.array([high - low for low, high in self.ranges.values()])
        return np.real(stepped[:, 0]), derivative_from(stepped) * widths

    def values(self, numbers: Mapping[str, Any]) -> np.ndarray:
        """Return the first objective and margins for numbers of the spec."""
        return self._stack(lifted(self.swimmer, numbers))

    def derivative(self, numbers: Mapping[str, Any], name: str) -> np.ndarray:
        """Return the exact derivative of `values` with respect to any number of the spec."""
        at = lifted(self.swimmer, numbers)
        value = numbers[name] if name in numbers else at.numbers[name]
        return derivative_from(self._stack(lifted(at, {name: value + 1j * STEP})))

    def _stack(self, swimmer: Swimmer) -> np.ndarray:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            plain = swimmer.tail.is_rigid or swimmer.region is not None
            phases: dict[str, Any] = {} if plain else {"phases": PHASES}
            values = of_gait(swimmer, swimmer.gait(**phases), self.needs)
            objective, sense = self.objectives[0]
            out = [sense * objective(values), *(c.margin(values) for c in self.limits)]
        stacked = np.array([np.asarray(v).item() for v in out])
        if not np.all(np.isfinite(stacked)):
            raise MicroswimError("not a swimmer")
        return stacked


def _texts(wanted: Any) -> list[str]:
    return [] if wanted is None else [wanted] if isinstance(wanted, str) else list(wanted)


def _buildable(swimmer: Swimmer) -> tuple[Constraint, ...]:
    """The tail must exist and not touch itself, and Lighthill's coefficients mean something."""
    tail = swimmer.tail
    if not isinstance(tail, WaveTail):
        return ()
    texts = []
    if tail.may_touch_itself:
        texts.append("crowding <= 0.999")
    if tail.length_measure == "arc" and tail.waves is not None:
        texts.append("winding <= 0.999")
    if np.isfinite(swimmer.coefficients.thickest) and swimmer.region is None:
        texts.append(f"slenderness <= {swimmer.coefficients.thickest:g}")
    return constraints(", ".join(texts), known(swimmer))
