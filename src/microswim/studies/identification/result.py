"""What the identification of a swimmer from its track gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.calibration.identifiability import Direction
from microswim.gait.readable import significant
from microswim.numerics.array import read_only
from microswim.studies.identification.fitting.branches import Branch
from microswim.swimmer.swimmer import Swimmer


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False)
@read_only
class Identification:
    """Outcome of `identify_swimmer`.

    Parameters
    ----------
    swimmer
        The swimmer with the values found.
    names, values
        Unknowns and their values.
    covariance
        Of the values; infinite along what the track does not determine.
    residual
        Root mean square distance of path and track, per coordinate.
    degrees
        Degrees of freedom left, for the intervals.
    directions
        Combinations of the unknowns, best determined first.
    warnings
        What cannot be determined, and what does not fit.
    path
        Fitted positions, of the track's shape.
    branches
        The designs that fit alike (within chi-squared 9), those nearest to what the spec says
        first, each with its values and its `interval`; none if the model does not hold.
    alternatives
        Values of those after the first.
    withheld
        Why there is no single interval, or nothing. Where several designs fit alike the values
        are those of the first.
    model
        The model whose gaits were fitted.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> t = np.linspace(0, 6, 90)
    >>> path = ms.trajectory(swimmer.gait(), t).position.values
    >>> track = ms.Track(time=t, position=path)
    >>> found = ms.identify_swimmer(swimmer, track, ["tail.amplitude"], start={})
    >>> found.interval(0.95).shape
    (1, 2)
    """

    swimmer: Swimmer
    names: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray
    residual: float
    degrees: int
    directions: tuple[Direction, ...]
    warnings: tuple[str, ...]
    path: np.ndarray
    branches: tuple[Branch, ...] = ()
    alternatives: tuple[np.ndarray, ...] = ()
    withheld: str = ""
    model: str = "rft"

    @property
    def uncertainty(self) -> np.ndarray:
        """Standard uncertainty of each value; infinite where the track does not tell."""
        known = np.sqrt(np.diag(self.covariance))
        return np.full_like(known, np.inf) if self.withheld else known

    def interval(self, level: float = 0.95) -> np.ndarray:
        """Return the confidence interval of each value, shape (n, 2): of normal noise and the
        model's error.

        It is infinite where the track does not tell and where it is withheld.
        """
        if not self.withheld and self.branches:
            return self.branches[0].interval(level)
        return np.tile([-np.inf, np.inf], (len(self.values), 1))

    def _branch(self, branch: Branch) -> dict[str, Any]:
        return {
            "values": dict(zip(self.names, map(float, branch.values))),
            "interval_95": dict(zip(self.names, _bounds(branch.interval()))),
            "chi_squared_behind": branch.behind,
        }

    def as_dict(self) -> dict[str, Any]:
        """Return what there is to print or to store as JSON."""
        u = [float(x) if np.isfinite(x) else None for x in self.uncertainty]
        bounds = _bounds(self.interval())
        return {
            "values": dict(zip(self.names, map(float, self.values))),
            "uncertainty": dict(zip(self.names, u)),
            "interval_95": dict(zip(self.names, bounds)),
            "residual": self.residual,
            "model": self.model,
            "directions": [d.as_dict() for d in self.directions],
            "branches": [self._branch(branch) for branch in self.branches],
            "alternatives": [dict(zip(self.names, map(float, v))) for v in self.alternatives],
            "warnings": list(self.warnings),
        }


def _bounds(interval: np.ndarray) -> list[list[float | None]]:
    """Ends for JSON: none where they are infinite."""
    return [[float(x) if np.isfinite(x) else None for x in row] for row in interval]


def remarks(
    names: tuple[str, ...],
    directions: tuple[Direction, ...],
    covariance: np.ndarray,
    others: int,
    misfit: float | None,
) -> tuple[str, ...]:
    """Return what cannot be determined, and whether the given noise explains the misfit."""
    out = []
    blind = [n for n, v in zip(names, np.diag(covariance)) if not np.isfinite(v)]
    if blind:
        out.append(f"the track does not depend on {', '.join(blind)}: it cannot be determined")
    vague = [d for d in directions if not d.determined and d.singular_value > 0]
    out += [f"not determined by this track: {str(d).rpartition(':')[0]}" for d in vague]
    if others:
        out.append(f"{others} other design(s) fit as well: see branches")
    if misfit is not None and misfit > 2.0:
        out.append(
            f"chi-squared per degree of freedom is {significant(misfit, 3)}: the noise is larger "
            "than sigma, or the model does not hold"
        )
    return tuple(out)
