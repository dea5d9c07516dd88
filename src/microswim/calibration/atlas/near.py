"""How far off an answer is: what designs nearby missed, measured, tails and all.

Each design of a campaign has been left out in turn and its answer compared with boundary elements.
The error to expect at another design is the quantile of what those around it missed, weighted by a
Gaussian in scaled coordinates. No distribution is assumed: errors have heavier tails than a normal.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

SHARE = 0.96  #: of the designs around that lie within; of new ones 95 in 100 then do, corners too
WIDTH = 0.5  #: of the Gaussian, in spreads of the coordinates
AT_ONCE = 64  #: designs side by side
QUANTITIES = ("us", "u_lateral", "os", "o_lateral")


@dataclass(frozen=True, eq=False)
class Misses:
    """Errors of designs whose truth is known.

    Parameters
    ----------
    spots
        Scaled coordinates (n, f).
    missed
        Size of the error of each of `QUANTITIES`, (n, 4), NaN where it is not known.
    factor
        By which the quantiles are widened, (4,), so that `SHARE` hold also where designs are few.
    """

    spots: np.ndarray
    missed: np.ndarray
    factor: np.ndarray

    def __call__(self, z: np.ndarray) -> np.ndarray:
        """Return the error to expect at designs z (m, f), shape (m, 4)."""
        return self.factor * np.array([self._around(row) for row in z])

    def of_many(self, z: np.ndarray, quantity: int = 0) -> np.ndarray:
        """Return the error to expect of one quantity at many designs z (m, f), shape (m,)."""
        order = self._orders[quantity]
        spots, values = self.spots[order], self.missed[order, quantity]
        squares, out = np.sum(spots * spots, axis=1), np.empty(len(z))
        for i in range(0, len(z), AT_ONCE):
            rows = z[i : i + AT_ONCE]
            far = (squares - 2.0 * (rows @ spots.T)) / (2.0 * WIDTH**2)
            total = np.cumsum(np.exp(far.min(axis=1, keepdims=True) - far), axis=1)
            at = np.sum(total < SHARE * total[:, -1:], axis=1)
            out[i : i + AT_ONCE] = values[np.minimum(at, len(values) - 1)]
        return self.factor[quantity] * out

    @cached_property
    def _orders(self) -> list[np.ndarray]:
        return [ranked(column) for column in self.missed.T]

    def _around(self, z: Any, without: int | None = None) -> np.ndarray:
        far = self.far(z)
        if without is not None:
            far[without] = np.inf
        weight = np.exp(far.min() - far)
        columns = zip(self.missed.T, self._orders)
        return np.array([quantile(column, weight, order=order) for column, order in columns])

    def far(self, z: Any) -> np.ndarray:
        """Return the exponent of each design's weight at a design z (f,), shape (n,)."""
        return np.sum((self.spots - z) ** 2, axis=1) / (2.0 * WIDTH**2)

    def left_out(self) -> np.ndarray:
        """Return what the rule says at each design from all others, (n, 4)."""
        return self.factor * np.array([self._around(z, i) for i, z in enumerate(self.spots)])

    def held(self) -> np.ndarray:
        """Return the share of designs within the error that all others let expect, (4,)."""
        return np.mean(self.missed <= self.left_out(), axis=0)


def ranked(values: np.ndarray) -> np.ndarray:
    """Return the places of values from small to large; NaN ones do not count."""
    order = np.argsort(values)
    return order[: np.count_nonzero(np.isfinite(values))]


def quantile(
    values: np.ndarray, weight: np.ndarray, share: float = SHARE, order: Any = None
) -> float:
    """Return the weighted quantile of values; NaN ones do not count.

    order : what `ranked` says of the values, where it is known.
    """
    order = ranked(values) if order is None else order
    if not len(order):
        return float("nan")
    total = np.cumsum(weight[order])
    at = min(int(np.searchsorted(total, share * total[-1])), len(order) - 1)
    return float(values[order[at]])


def measured(spots: np.ndarray, missed: np.ndarray) -> Misses:
    """Return the errors of designs with factors that let `SHARE` of the lonelier half hold.

    At the edges of the range the designs around are few and lie to one side.
    """
    plain = Misses(spots, missed, np.ones(missed.shape[1]))
    ratio = missed / np.maximum(plain.left_out(), 1e-300)
    company = np.array([np.exp(-plain.far(z)).sum() for z in spots])
    lonely = company <= np.median(company)
    factor = np.nanquantile(ratio[lonely], SHARE, axis=0)
    return Misses(spots, missed, np.maximum(factor, 1.0))
