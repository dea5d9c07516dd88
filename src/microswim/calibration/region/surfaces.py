"""Several groups of targets over the same designs, and their answers in compiled loops.

Nearly all the time of an answer goes into the kernel between the design asked and those that were
solved, so all groups share its distances, in tiles that stay near the processor.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.calibration.region.kriging import Kriging
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.matern import matern

TILE = 128  #: solved designs whose kernels are taken at once, at most


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Several groups over the same designs, packed for the compiled evaluation."""

    groups: tuple[Kriging, ...]

    def __call__(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Targets (k, columns) at other designs, complex ones as pairs."""
        return np.concatenate([interleaved(g(Z, N)) for g in self.groups], axis=1)

    def doubt(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Return the variance (k,) at other designs over that of a design left out, mean of the
        groups.
        """
        each = [g.doubt(Z, N) / typical for g, typical in zip(self.groups, self._typical)]
        return np.mean(each, axis=0)

    def doubt_of_one(self, z: np.ndarray, waves: float) -> float:
        """Return `doubt` at one design, its features z (f,), at the cost of one evaluation."""
        Z, tips, lengths, phasors, *_ = self.packed
        cross = crossings(z, waves, Z, tips, lengths, phasors)
        each = [
            g.doubt_of((c.real if g.real else c)[None])[0] / typical
            for c, g, typical in zip(cross, self.groups, self._typical)
        ]
        return float(np.mean(each))

    def left_out_doubt(self) -> np.ndarray:
        """Return `variance` (n,) at each design when it is left out."""
        each = [g.left_out()[1] / typical for g, typical in zip(self.groups, self._typical)]
        return np.mean(each, axis=0)

    @cached_property
    def _typical(self) -> list[float]:
        return [float(np.mean(g.left_out()[1])) for g in self.groups]

    @cached_property
    def in_lengths(self) -> list[np.ndarray]:
        """Features (f, n) of the designs in lengths of each group's kernel."""
        return [np.ascontiguousarray((g.Z / g.lengths).T) for g in self.groups]

    @cached_property
    def packed(self) -> tuple[np.ndarray, ...]:
        """Arguments of `predict` after the number of waves, and the means."""
        first = self.groups[0]
        tips = np.stack([np.cos(2.0 * np.pi * first.N), np.sin(2.0 * np.pi * first.N)])
        lengths = np.array([1.0 / g.lengths for g in self.groups])
        phasors = np.array([[*g.phasors, 0.0 if g.real else 1.0] for g in self.groups])
        columns = [interleaved(g.alpha) for g in self.groups]
        cut = np.cumsum([0, *(c.shape[1] for c in columns)])
        mean = np.concatenate([interleaved(g.mean[None])[0] for g in self.groups])
        alpha = np.ascontiguousarray(np.concatenate(columns, axis=1).T)
        return np.array(first.Z.T, order="C"), tips, lengths, phasors, cut, alpha, mean


def interleaved(values: np.ndarray) -> np.ndarray:
    """Return the complex columns as pairs of real ones."""
    if not np.iscomplexobj(values):
        return values
    return np.stack([np.real(values), np.imag(values)], axis=-1).reshape(len(values), -1)


@compiled(always=True)
def scratch(z: Any, Z: Any) -> Any:
    """Return the scratch of `predict`, as wide as even tiles over the designs Z (f, n)."""
    n = max(1, Z.shape[1])
    tiles = (n + TILE - 1) // TILE
    return np.empty((len(Z) + 4, (n + tiles - 1) // tiles), dtype=z.dtype)


@compiled(always=True, fastmath=FAST, error_model="numpy")
def predict(
    out: Any,
    z: Any,
    waves: Any,
    Z: Any,
    tips: Any,
    lengths: Any,
    phasors: Any,
    cut: Any,
    alpha: Any,
    mean: Any,
    work: Any,
) -> None:
    """Write the targets of some designs to `out` (d, m).

    `z` (d, f), `waves` (d,). Group g has the rows ``cut[g] .. cut[g + 1]`` of `alpha` (m, n);
    complex targets take two rows each, real and imaginary parts, and are told by
    ``phasors[g, 3] > 0``. `Z` (f, n); `tips` (2, n) are cosine and sine of ``2 pi N``; `work`
    (4 + f, at most n) is `scratch`. The inner loops run over the designs that were solved, several
    at once, as many as `work` is wide for all of `out` while they lie near the processor.
    """
    for d in range(len(out)):
        out[d] = mean
    (features, n), last, tile = Z.shape, len(alpha) - 1, work.shape[1]
    for start in range(0, n, tile):
        stop = min(n, start + tile)
        c1, s1, even, odd = work[0], work[1], work[2], work[3]
        for d in range(len(out)):
            for f in range(features):
                squares_from(work[4 + f], z[d, f], Z[f, start:stop])
            turn = 2.0 * np.pi * waves[d]
            angles_from(
                c1, s1, np.cos(turn), np.sin(turn), tips[0, start:stop], tips[1, start:stop]
            )
            for g in range(len(lengths)):
                weighted(even, lengths[g], work)
                covariances(even, odd, c1, s1, phasors[g])
                j, pairs = cut[g], phasors[g, 3] > 0.0
                while j < cut[g + 1]:
                    row, next_row = alpha[j, start:stop], alpha[min(j + 1, last), start:stop]
                    if pairs:
                        real, imag = complex_product(row, next_row, even, odd)
                    else:
                        real, imag = products(row, next_row, even)
                    out[d, j] += real
                    if pairs or j + 1 < cut[g + 1]:
                        out[d, j + 1] += imag
                    j += 2


@compiled(always=True, fastmath=FAST)
def squares_from(out: Any, z: Any, Z: Any) -> None:
    """Write the squared distances of z from Z (n,)."""
    for t in range(len(Z)):
        out[t] = (z - Z[t]) * (z - Z[t])


@compiled(always=True, fastmath=FAST)
def angles_from(c1: Any, s1: Any, c0: Any, s0: Any, c: Any, s: Any) -> None:
    """Write cosine and sine of the angle between a tip and others (n,)."""
    for t in range(len(c)):
        c1[t] = c0 * c[t] + s0 * s[t]
        s1[t] = s0 * c[t] - c0 * s[t]


@compiled(always=True, fastmath=FAST)
def weighted(out: Any, lengths: Any, work: Any) -> None:
    """Write the sum over features of squared distances, rows of `work` from 4 on, in lengths; five
    at a time, as sums that lie in memory cost more than their terms.
    """
    out[:] = 0.0
    count = len(lengths)
    f = 0
    while f + 5 <= count:
        a, b, c = lengths[f] ** 2, lengths[f + 1] ** 2, lengths[f + 2] ** 2
        d, e = lengths[f + 3] ** 2, lengths[f + 4] ** 2
        u, v, w, x, y = work[4 + f], work[5 + f], work[6 + f], work[7 + f], work[8 + f]
        for t in range(len(out)):
            out[t] += a * u[t] + b * v[t] + c * w[t] + d * x[t] + e * y[t]
        f += 5
    for i in range(f, count):
        a, u = lengths[i] ** 2, work[4 + i]
        for t in range(len(out)):
            out[t] += a * u[t]


@compiled(always=True, fastmath=FAST)
def products(a: Any, b: Any, k: Any) -> Any:
    """Return the scalar products of a and b (n,) with as many of k, which is loaded once."""
    first, second = 0 * k[0], 0 * k[0]
    for t in range(len(a)):
        first += a[t] * k[t]
        second += b[t] * k[t]
    return first, second


@compiled(always=True, fastmath=FAST)
def complex_product(real: Any, imag: Any, even: Any, odd: Any) -> Any:
    """Return real and imaginary part of the product of ``real + i imag`` with ``even - i odd``."""
    x, y = 0 * even[0], 0 * even[0]
    for t in range(len(real)):
        x += real[t] * even[t] + imag[t] * odd[t]
        y += imag[t] * even[t] - real[t] * odd[t]
    return x, y


@compiled(always=True, fastmath=FAST, error_model="numpy")
def covariances(even: Any, odd: Any, c1: Any, s1: Any, phasors: Any) -> None:
    """Make of squared distances in `even` the kernel: its parts even and odd in the angle."""
    for t in range(len(even)):
        even[t] = matern(even[t])
    a, b, c = phasors[0], phasors[1], phasors[2]
    if a == 0.0 and b == 0.0 and c == 0.0:
        odd[:] = 0.0
        return
    if b == 0.0 and c == 0.0:
        for t in range(len(even)):
            odd[t] = even[t] * a * s1[t]
            even[t] = even[t] * (1.0 + a * c1[t])
        return
    for t in range(len(even)):
        c2, s2 = c1[t] * c1[t] - s1[t] * s1[t], 2.0 * s1[t] * c1[t]
        odd[t] = even[t] * (a * s1[t] + b * s2 + c * (s2 * c1[t] + c2 * s1[t]))
        even[t] = even[t] * (1.0 + a * c1[t] + b * c2 + c * (c2 * c1[t] - s2 * s1[t]))


@compiled(always=True)
def crossings(z: Any, waves: Any, Z: Any, tips: Any, lengths: Any, phasors: Any) -> Any:
    """Return the prior covariance (groups, n) of one design with those solved, as in `predict`."""
    out = np.empty((lengths.shape[0], Z.shape[1]), dtype=np.complex128)
    c0, s0 = np.cos(2.0 * np.pi * waves), np.sin(2.0 * np.pi * waves)
    for t in range(Z.shape[1]):
        c1 = c0 * tips[0, t] + s0 * tips[1, t]
        s1 = s0 * tips[0, t] - c0 * tips[1, t]
        c2, s2 = c1 * c1 - s1 * s1, 2.0 * s1 * c1
        c3, s3 = c2 * c1 - s2 * s1, s2 * c1 + c2 * s1
        for g in range(lengths.shape[0]):
            r2 = 0.0
            for f in range(Z.shape[0]):
                d = (z[f] - Z[f, t]) * lengths[g, f]
                r2 += d * d
            a, b, c = phasors[g, 0], phasors[g, 1], phasors[g, 2]
            even, odd = 1.0 + a * c1 + b * c2 + c * c3, a * s1 + b * s2 + c * s3
            out[g, t] = matern(r2) * complex(even, -odd)
    return out
