"""Where calibrated coefficients come from: by what, at which designs, when, and what they match.

The table [calibration] of a spec file. It travels with the swimmer, so that whoever computes with
the coefficients can say how far his design lies from the one they were made for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.readable import percent

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer

REFERENCES = ("bem", "fem", "rft", "measurements")
SAME = 1e-6  #: relative difference of a number that is the same
#: Tables whose numbers decide the flow around a swimmer.
DECIDE = ("body.", "tail.", "wall.", "channel.")
_SOLVERS = {"bem": "boundary elements", "fem": "finite elements", "rft": "the surrogate"}
_WORDS = {
    "mean_power": "power and torque of the motor", "efficiency": "efficiency",
    "mobility.us.us": "response to a force along s",
    "mobility.uq.uq": "response to a force across s",
    "mobility.os.os": "response to a torque about s",
    "mobility.or.or": "response to a torque across s",
    "mean.us": "speed", "mean.os": "body rate", "amplitude.uq": "lateral amplitude",
    "amplitude.or": "amplitude of turning",
}  # fmt: skip


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Provenance:
    """By what, where and when coefficients were calibrated.

    Parameters
    ----------
    reference
        ``"bem"``, ``"fem"``, ``"rft"`` or ``"measurements"``.
    level
        Resolution of the reference; empty if it has none.
    date, version
        Day, and version of microswim.
    design
        Numbers of body and tail (and walls) where it holds, by dotted names.
    region
        Numbers that vary over the designs it was made of, with their least and largest value.
    law, found
        Law of local resistance, and the coefficients as they were found, by dotted names; empty
        for a region.
    matched, unmatched
        Quantities that were made to agree and others that were compared, each with the relative
        difference that is left; over a region the median of the designs left out.

    Raises
    ------
    SpecError
        If a number or a word makes no sense.

    Examples
    --------
    >>> import microswim as ms
    >>> cell = ms.Swimmer.preset("goto/C")
    >>> fit = ms.calibrate(cell, {"swimming_speed": 6.23e-6}, ["translation.s"])
    >>> fit.swimmer.calibration.reference
    'measurements'
    """

    reference: str
    level: str = ""
    date: str = ""
    version: str = ""
    law: str = ""
    design: Mapping[str, float] = field(default_factory=dict)
    region: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    found: Mapping[str, float] = field(default_factory=dict)
    matched: Mapping[str, float] = field(default_factory=dict)
    unmatched: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        checks.choice("calibration.reference", self.reference, REFERENCES)
        for name in ("design", "found", "matched", "unmatched"):
            for key, value in getattr(self, name).items():
                checks.number(f'calibration.{name}."{key}"', value, "a finite number")
        for key, ends in self.region.items():
            where = f'calibration.region."{key}"'
            checks.numbers(where, ends, 2, "two finite numbers")
            if not ends[0] <= ends[1]:
                raise SpecError(where, list(ends), "the lower number first")

    @property
    def by(self) -> str:
        """What it agrees with, in words."""
        solver = _SOLVERS.get(self.reference, "measurements")
        return f"{solver} ({self.level})" if self.level else solver

    def as_tables(self) -> dict[str, Any]:
        """Return the table of a spec file; what is empty is left out."""
        plain = {n: getattr(self, n) for n in ("reference", "level", "date", "version", "law")}
        maps = {n: dict(getattr(self, n)) for n in ("design", "found", "matched", "unmatched")}
        ends = {"region": {name: list(pair) for name, pair in self.region.items()}}
        return {k: v for k, v in (plain | maps | ends).items() if v}

    def away(self, swimmer: Swimmer) -> dict[str, float]:
        """Return the numbers of a swimmer that are others, with the relative change.

        From the design, or from the nearer end of a range; infinite where one of both is zero or
        missing.
        """
        own, out = swimmer.numbers, {}
        for name, held in self.design.items():
            out[name] = _change(own.get(name), held, held)
        for name, (low, high) in self.region.items():
            out[name] = _change(own.get(name), low, high)
        return {name: change for name, change in out.items() if abs(change) > SAME}

    def changed(self, swimmer: Swimmer) -> list[str]:
        """Return the coefficients that are no longer as they were found."""
        own = swimmer.numbers
        law = ["law"] if self.law and self.law != swimmer.coefficients.law else []
        return law + [n for n, v in self.found.items() if abs(_change(own.get(n), v, v)) > SAME]

    def lines(self, swimmer: Swimmer) -> list[str]:
        """Return what there is to say about a swimmer, a sentence each."""
        where = "over a region of designs" if self.region else "at one design"
        made = f"{' on ' + self.date if self.date else ''}"
        version = f" with microswim {self.version}" if self.version else ""
        out = [f"calibrated by {self.by} {where}{made}{version}; {self._far(swimmer)}"]
        changed = self.changed(swimmer)
        if changed:
            out.append(f"{', '.join(changed)} changed since then: it holds no longer")
        if self.unmatched:
            off = (f"{words} {percent(v, signed=True)}" for words, v in self.missed.items())
            out.append(f"not matched where it was calibrated: {', '.join(off)}")
        elif self.reference == "measurements" and self.matched:
            out.append(f"nothing was compared but {', '.join(self.matched)}")
        return out

    @property
    def missed(self) -> dict[str, float]:
        """Relative differences of what does not agree, in words, the largest first."""
        most = sorted(self.unmatched.items(), key=lambda item: -abs(item[1]))
        return {_WORDS.get(name, name): value for name, value in most}

    def _far(self, swimmer: Swimmer) -> str:
        away = self.away(swimmer)
        if not away:
            return "this design lies inside" if self.region else "this is that design"
        worst = sorted(away.items(), key=lambda item: -abs(item[1]))
        few = ", ".join(f"{n} {_per_cent(v)}" for n, v in worst[:3])
        more = f" and {len(worst) - 3} more" if len(worst) > 3 else ""
        return f"this design is another: {few}{more}"


def _per_cent(change: float) -> str:
    return percent(change, signed=True) if np.isfinite(change) else "is new or gone"


def _change(value: Any, low: float, high: float) -> float:
    """Return the relative change of a number from a range, 0 within it."""
    if value is None:
        return float("inf")
    value = float(np.real(value))
    end = min(max(value, low), high)
    if value == end:
        return 0.0
    return (value - end) / abs(end) if end else float("inf")


def told(swimmer: Swimmer, gait: Gait) -> Gait:
    """Return a gait by the surrogate that says where its coefficients come from."""
    if swimmer.calibration is None:
        return gait
    return replace(gait, info={**gait.info, "calibration": swimmer.calibration.lines(swimmer)})


def deciding(swimmer: Swimmer) -> dict[str, float]:
    """Return the numbers of a swimmer that decide the flow around it, by dotted names."""
    return {
        name: float(value)
        for name, value in swimmer.numbers.items()
        if name.startswith(DECIDE) and name != "tail.frequency"
    }
