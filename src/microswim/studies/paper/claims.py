"""The claims of the paper, judged: ``claims.toml`` says where, what, how exact and our verdict.

A verdict is one of

- ``agrees``: ours lies within the tolerance of the paper's value,
- ``agrees under reading X``: ours, computed under the reading that is named, does,
- ``differs, because ...``: ours does not; the sentence names the cause, `evidence` its number,
- ``cannot be checked, because ...``.

`Judgement.holds` compares the verdict with the numbers of today. The tolerance of a claim comes
from the digits that the paper prints (and the rounding of what goes in), never from our result.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from importlib import import_module
from importlib.resources import files
from typing import Any

import numpy as np

from microswim.studies.paper.context import Context

KINDS = ("agrees under reading", "agrees", "differs, because", "cannot be checked, because")


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One statement of the paper.

    Parameters
    ----------
    id, where, says
        Name, place in the paper, the statement in our words.
    value
        The paper's number or numbers.
    unit
        Their unit.
    tolerance
        Greatest difference that the printed digits allow: one number, or one per value.
    reason
        Why that tolerance.
    ours
        ``"module.function"`` of this package that computes our value; empty: none can be.
    arguments
        What it is called with, besides the context.
    verdict
        One of the four, in a sentence; may hold ``{ours}`` and ``{evidence}``.
    evidence, evidence_arguments
        Function whose value shows the cause of a difference.
    shows
        What the evidence must do: ``"matches"`` the paper's value within the tolerance, or
        ``"brackets"`` it along its first axis; empty: it is printed only.
    reference
        Whether it needs our reference solver.
    slow
        Whether it takes more than a few reference solutions.
    """

    id: str
    where: str
    says: str
    value: Any
    unit: str
    tolerance: Any
    reason: str
    verdict: str
    ours: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)
    evidence: str = ""
    evidence_arguments: dict[str, Any] = field(default_factory=dict)
    shows: str = ""
    reference: bool = False
    slow: bool = False

    @property
    def kind(self) -> str:
        """Which of the four verdicts."""
        return next(k for k in KINDS if self.verdict.startswith(k))

    @property
    def item(self) -> str:
        """Table or figure whose module computes it."""
        return self.ours.partition(".")[0]


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """A claim beside our number."""

    claim: Claim
    ours: Any = None
    evidence: Any = None

    @property
    def within(self) -> bool:
        """Whether ours lies within the tolerance."""
        return _within(self.claim, self.ours)

    @property
    def holds(self) -> bool:
        """Whether the verdict still matches the numbers."""
        kind = self.claim.kind
        if kind.startswith("agrees"):
            return self.within
        if kind.startswith("differs"):
            return not self.within and self._evidence_shows()
        return True

    def _evidence_shows(self) -> bool:
        if self.claim.shows == "matches":
            return _within(self.claim, self.evidence)
        if self.claim.shows == "brackets":
            low, high = np.min(self.evidence, axis=0), np.max(self.evidence, axis=0)
            value = np.asarray(self.claim.value, float)
            return bool(np.all((low <= value) & (value <= high)))
        return True

    @property
    def sentence(self) -> str:
        """The verdict with its numbers filled in."""
        return self.claim.verdict.replace("{ours}", shown(self.ours)).replace(
            "{evidence}", shown(self.evidence)
        )


def load() -> tuple[Claim, ...]:
    """All claims, in the order of the paper."""
    text = files(__package__).joinpath("claims.toml").read_text(encoding="utf-8")
    return tuple(Claim(**entry) for entry in tomllib.loads(text)["claim"])


def judge(claim: Claim, context: Context) -> Judgement:
    """Compute our side of a claim."""
    mine = _call(claim.ours, claim.arguments, context) if claim.ours else None
    evidence = None
    if claim.evidence:
        evidence = _call(claim.evidence, claim.evidence_arguments, context)
    return Judgement(claim=claim, ours=mine, evidence=evidence)


def judge_all(context: Context, claims: Iterable[Claim] | None = None) -> list[Judgement]:
    """Judge all claims; without circles, those that need no reference."""
    chosen = load() if claims is None else claims
    return [judge(c, context) for c in chosen if context.circles or not c.reference]


def _call(name: str, arguments: dict[str, Any], context: Context) -> Any:
    module, _, function = name.partition(".")
    made = getattr(import_module(f".{module}", __package__), function)
    key = ("claim", name, arguments)
    return context.once(key, lambda: made(context, **arguments))


def _within(claim: Claim, ours: Any) -> bool:
    value, mine = np.asarray(claim.value, float), np.asarray(ours, float)
    if mine.shape != value.shape:
        return False
    return bool(np.all(np.abs(mine - value) <= np.asarray(claim.tolerance, float) * (1 + 1e-12)))


def shown(value: Any) -> str:
    """A number or array for people."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    flat = np.ravel(np.asarray(value, float))
    return ", ".join(f"{x:.4g}" for x in flat)
