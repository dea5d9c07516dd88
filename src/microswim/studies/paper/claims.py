"""The claims of the paper, judged: ``claims.toml`` says where, what, how exact and our verdict.

A verdict is one of

- ``agrees``: ours lies within the tolerance of the paper's value,
- ``agrees under reading X``: ours, computed under the reading that is named, does,
- ``sign agrees``: the statement has no number; ours lies on the stated `side` of a bound,
- ``arithmetic``: numbers of the paper follow from others of its numbers; nothing of ours is in it,
- ``transcription``: our copy of the paper's numbers is what it prints,
- ``differs, because ...``: ours does not; the sentence names the cause, `evidence` its number,
- ``cannot be checked, because ...``.

`Judgement.holds` compares the verdict with the numbers of today. A claim whose tolerance is finer
than what the coarse level of the reference reaches is not judged there, and says so. The tolerance
of a claim comes from the digits that the paper prints (and the rounding of what goes in), never
from our result.
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

KINDS = (
    "agrees under reading",
    "agrees",
    "sign agrees",
    "arithmetic",
    "transcription",
    "differs, because",
    "cannot be checked, because",
)
OPEN = "not judged"


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
        One of `KINDS`, in a sentence; may hold ``{ours}`` and ``{evidence}``.
    evidence, evidence_arguments
        Function whose value shows the cause of a difference.
    side
        Of a ``sign agrees``: ours lies ``"above"`` or ``"below"`` the value.
    shows
        What the evidence must do: ``"matches"`` the paper's value within the tolerance, or
        ``"brackets"`` it along its first axis; empty: it is printed only.
    reference
        Whether it needs our reference solver.
    slow
        Whether it takes more than a few reference solutions.
    fine
        Whether the coarse level of the reference is too coarse for the tolerance.
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
    side: str = ""
    shows: str = ""
    reference: bool = False
    slow: bool = False
    fine: bool = False

    @property
    def kind(self) -> str:
        """Which of the verdicts."""
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
    too_coarse: bool = False

    @property
    def kind(self) -> str:
        """Which of the verdicts; `OPEN` where the level cannot decide."""
        return OPEN if self.too_coarse else self.claim.kind

    @property
    def within(self) -> bool:
        """Whether ours lies within the tolerance."""
        return _within(self.claim, self.ours)

    @property
    def holds(self) -> bool:
        """Whether the verdict still matches the numbers."""
        if self.kind.startswith("differs"):
            return not self.within and self._evidence_shows()
        return self.within or self.kind in (OPEN, "cannot be checked, because")

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
        if self.too_coarse:
            return "not judged at the coarse level, which does not reach the tolerance of the claim"
        return self.claim.verdict.replace("{ours}", shown(self.ours)).replace(
            "{evidence}", shown(self.evidence)
        )


def load() -> tuple[Claim, ...]:
    """Return all claims, in the order of the paper."""
    text = files("microswim.studies.paper").joinpath("claims.toml").read_text(encoding="utf-8")
    return tuple(Claim(**entry) for entry in tomllib.loads(text)["claim"])


def judge(claim: Claim, context: Context) -> Judgement:
    """Compute our side of a claim."""
    mine = _call(claim.ours, claim.arguments, context) if claim.ours else None
    evidence = None
    if claim.evidence:
        evidence = _call(claim.evidence, claim.evidence_arguments, context)
    too_coarse = claim.fine and context.quick
    return Judgement(claim=claim, ours=mine, evidence=evidence, too_coarse=too_coarse)


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
    if claim.side:
        return bool(np.all(mine > value if claim.side == "above" else mine < value))
    return bool(np.all(np.abs(mine - value) <= np.asarray(claim.tolerance, float) * (1 + 1e-12)))


def shown(value: Any) -> str:
    """Return a number or array for people."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    flat = np.ravel(np.asarray(value, float))
    return ", ".join(f"{x:.4g}" for x in flat)
