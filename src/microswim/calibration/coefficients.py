"""Outcome of a calibration at one design: coefficients, how sure they are, what they predict."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.stats import norm

from microswim import checks
from microswim.calibration.calibration import Calibration
from microswim.calibration.identifiability import Direction
from microswim.calibration.observations import ASSUMED, Observation
from microswim.gait.portrait import Rows
from microswim.gait.readable import significant
from microswim.numerics.array import kept, read_only


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
@read_only
class CoefficientCalibration(Calibration):
    """Outcome of a calibration at one design, or at several that share their coefficients.

    Parameters
    ----------
    swimmer
        The swimmer with the fitted numbers.
    names, values, covariance
        Unknowns, fitted values and their covariance; infinite along what the data do not tell.
    observations
        The data.
    predicted
        What the calibrated surrogate says for each entry of the data.
    directions, warnings
        Combinations of the unknowns, best determined first; what is odd, in physical words.
    method
        ``"least squares"`` or ``"ratios"``.

    Examples
    --------
    >>> import microswim as ms
    >>> cell = ms.Swimmer.preset("goto/C")
    >>> ms.calibrate(cell, {"swimming_speed": 6.23e-6}, ["translation.s"]).rank
    1
    """

    names: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray
    observations: tuple[Observation, ...]
    predicted: np.ndarray
    directions: tuple[Direction, ...]
    method: str = "least squares"

    def _found(self) -> Rows:
        fitted = zip(self.names, self.values, self.uncertainty)
        known = [
            (n, f"{significant(v)} ± {significant(u, 2)}" if np.isfinite(u) else significant(v))
            for n, v, u in fitted
        ]
        return [("by", f"{self.method}, {self.predicted.size} numbers"), *known]

    @property
    def coefficients(self) -> dict[str, float]:
        """Fitted values by name."""
        return dict(zip(self.names, map(float, self.values)))

    @property
    def uncertainty(self) -> np.ndarray:
        """Standard uncertainty of each value; infinite where the data do not tell."""
        return np.sqrt(np.diag(self.covariance))

    @cached_property
    def residuals(self) -> np.ndarray:
        """(measured - predicted) / sigma, entry by entry."""
        missed = values_of(self.observations) - self.predicted
        return kept(missed / sigmas_of(self.observations))

    @property
    def rank(self) -> int:
        """Number of combinations that the data determine."""
        return sum(d.determined for d in self.directions)

    def interval(self, level: float = 0.95) -> np.ndarray:
        """Return the confidence interval of each value, shape (n, 2), for normal errors of size
        sigma.
        """
        half = norm.ppf(0.5 + level / 2.0) * self.uncertainty
        return np.stack([self.values - half, self.values + half], axis=-1)

    def as_dict(self) -> dict[str, Any]:
        """Return what there is to print or to store as JSON (infinite uncertainties as None)."""
        finite = [float(u) if np.isfinite(u) else None for u in self.uncertainty]
        measured = values_of(self.observations)
        labels = [o.quantity for o in self.observations for _ in range(np.size(o.value))]
        return {
            "method": self.method,
            "coefficients": self.coefficients,
            "uncertainty": dict(zip(self.names, finite)),
            "assumed_uncertainty": {o.quantity: ASSUMED for o in self.observations if o.assumed},
            "rank": self.rank,
            "singular_values": [d.singular_value for d in self.directions],
            "directions": [d.as_dict() for d in self.directions],
            "covariance": np.where(np.isfinite(self.covariance), self.covariance, 0.0).tolist(),
            "data": [
                {"quantity": q, "measured": float(m), "predicted": float(p)}
                for q, m, p in zip(labels, measured, self.predicted)
            ],
            "chi_squared": float(np.sum(self.residuals**2)),
            **super().as_dict(),
        }


def values_of(observations: Iterable[Observation]) -> np.ndarray:
    """Return all values in one array."""
    return np.concatenate([np.atleast_1d(np.asarray(o.value, float)) for o in observations])


def sigmas_of(observations: Iterable[Observation]) -> np.ndarray:
    """Return the uncertainty of each of them."""
    return np.concatenate(
        [
            np.broadcast_to(np.asarray(o.sigma, float), np.shape(o.value) or (1,))
            for o in observations
        ]
    )
