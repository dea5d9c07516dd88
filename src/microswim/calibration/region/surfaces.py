"""Several groups of targets over the same designs, and their answers in compiled loops.

Nearly all the time of an answer goes into the kernel between the design asked and those that were
solved, the nodes: distances and kernel are one loop, over tiles of nodes that stay near the
processor for all designs asked.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.calibration.region.kriging import Kriging
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.matern import matern

TILE = 128  #: nodes whose kernels are taken at once, at most


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
        cross = crossings(z, waves, *self.packed[:4])
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
    def packed(self) -> tuple[np.ndarray, ...]:
        """Arguments of `predict` after the number of waves, and the means."""
        first = self.groups[0]
        features = first.Z.shape[1]
        nodes = np.zeros((len(self.groups), -(-features // 5) * 5, len(first.Z)))
        for group, own in zip(self.groups, nodes):
            own[:features] = (group.Z / group.lengths).T
        tips = np.stack([np.cos(2.0 * np.pi * first.N), np.sin(2.0 * np.pi * first.N)])
        lengths = np.array([1.0 / g.lengths for g in self.groups])
        phasors = np.array([[*g.phasors, 0.0 if g.real else 1.0] for g in self.groups])
        columns = [interleaved(g.alpha) for g in self.groups]
        cut = np.cumsum([0, *(c.shape[1] for c in columns)])
        mean = np.concatenate([interleaved(g.mean[None])[0] for g in self.groups])
        alpha = np.ascontiguousarray(np.concatenate(columns, axis=1).T)
        return nodes, tips, lengths, phasors, cut, alpha, mean


def interleaved(values: np.ndarray) -> np.ndarray:
    """Return the complex columns as pairs of real ones."""
    if not np.iscomplexobj(values):
        return values
    return np.stack([np.real(values), np.imag(values)], axis=-1).reshape(len(values), -1)


@compiled(always=True)
def scratch(z: Any, nodes: Any) -> Any:
    """Return the scratch of `predict`, as wide as even tiles over the nodes (groups, f, n)."""
    n = max(1, nodes.shape[2])
    tiles = (n + TILE - 1) // TILE
    return np.empty((4, (n + tiles - 1) // tiles), dtype=z.dtype)


@compiled(always=True, fastmath=FAST, error_model="numpy")
def predict(
    out: Any,
    z: Any,
    waves: Any,
    nodes: Any,
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
    ``phasors[g, 3] > 0``. `nodes` (groups, f, n) are the designs that were solved, in lengths of
    each group's kernel; `tips` (2, n) are cosine and sine of their ``2 pi N``; `work` (4, at most
    n) is `scratch`. The inner loops run over nodes, several at once, as many as `work` is wide for
    all of `out` while they lie near the processor.
    """
    for d in range(len(out)):
        out[d] = mean
    n, last, tile = nodes.shape[2], len(alpha) - 1, work.shape[1]
    scaled = np.zeros((len(nodes), len(out), nodes.shape[1]), dtype=z.dtype)
    for g in range(len(nodes)):
        for f in range(z.shape[1]):
            scaled[g, :, f] = z[:, f] * lengths[g, f]
    for start in range(0, n, tile):
        stop = min(n, start + tile)
        c1, s1 = work[0, : stop - start], work[1, : stop - start]
        even, odd = work[2, : stop - start], work[3, : stop - start]
        for g in range(len(nodes)):
            pairs = phasors[g, 3] > 0.0
            for d in range(len(out)):
                kernels(even, scaled[g, d], nodes, g, start)
                if phasors[g, 0] + phasors[g, 1] + phasors[g, 2] > 0.0:
                    turn = 2.0 * np.pi * waves[d]
                    angles_from(
                        c1, s1, np.cos(turn), np.sin(turn), tips[0, start:stop], tips[1, start:stop]
                    )
                    turned(even, odd, c1, s1, phasors[g])
                elif pairs:
                    odd[:] = 0.0
                j = cut[g]
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


@compiled(always=True, fastmath=FAST, error_model="numpy")
def kernels(out: Any, z: Any, nodes: Any, g: int, start: int) -> None:
    """Write the kernel of group g between z (f,), in its lengths, and nodes from `start` on.

    Features come in fives: sums that lie in memory cost more than their terms.
    """
    stop, last = start + len(out), len(z) - 5
    out[:] = 0.0
    for f in range(0, last + 1, 5):
        u, v, w = nodes[g, f, start:stop], nodes[g, f + 1, start:stop], nodes[g, f + 2, start:stop]
        x, y = nodes[g, f + 3, start:stop], nodes[g, f + 4, start:stop]
        a, b, c, d, e = z[f], z[f + 1], z[f + 2], z[f + 3], z[f + 4]
        if f < last:
            for t in range(len(out)):
                out[t] += squares(u[t] - a, v[t] - b, w[t] - c, x[t] - d, y[t] - e)
        else:
            for t in range(len(out)):
                r2 = out[t] + squares(u[t] - a, v[t] - b, w[t] - c, x[t] - d, y[t] - e)
                out[t] = matern(r2)


@compiled(always=True, fastmath=FAST)
def squares(a: Any, b: Any, c: Any, d: Any, e: Any) -> Any:
    """Return the sum of five squares."""
    return a * a + b * b + c * c + d * d + e * e


@compiled(always=True, fastmath=FAST)
def angles_from(c1: Any, s1: Any, c0: Any, s0: Any, c: Any, s: Any) -> None:
    """Write cosine and sine of the angle between a tip and others (n,)."""
    for t in range(len(c)):
        c1[t] = c0 * c[t] + s0 * s[t]
        s1[t] = s0 * c[t] - c0 * s[t]


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


@compiled(always=True, fastmath=FAST)
def turned(even: Any, odd: Any, c1: Any, s1: Any, phasors: Any) -> None:
    """Make of the kernel in `even` its parts even and odd in the angle between the tips."""
    a, b, c = phasors[0], phasors[1], phasors[2]
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
def crossings(z: Any, waves: Any, nodes: Any, tips: Any, lengths: Any, phasors: Any) -> Any:
    """Return the prior covariance (groups, n) of one design with those solved, as in `predict`."""
    out = np.empty((nodes.shape[0], nodes.shape[2]), dtype=np.complex128)
    c0, s0 = np.cos(2.0 * np.pi * waves), np.sin(2.0 * np.pi * waves)
    for t in range(nodes.shape[2]):
        c1 = c0 * tips[0, t] + s0 * tips[1, t]
        s1 = s0 * tips[0, t] - c0 * tips[1, t]
        c2, s2 = c1 * c1 - s1 * s1, 2.0 * s1 * c1
        c3, s3 = c2 * c1 - s2 * s1, s2 * c1 + c2 * s1
        for g in range(nodes.shape[0]):
            r2 = 0.0
            for f in range(len(z)):
                d = z[f] * lengths[g, f] - nodes[g, f, t]
                r2 += d * d
            a, b, c = phasors[g, 0], phasors[g, 1], phasors[g, 2]
            even, odd = 1.0 + a * c1 + b * c2 + c * c3, a * s1 + b * s2 + c * s3
            out[g, t] = matern(r2) * complex(even, -odd)
    return out
