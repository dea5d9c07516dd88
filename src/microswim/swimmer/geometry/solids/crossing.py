"""Where triangles pass through each other, and whether a point lies within them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import FAST, compiled

Indices = NDArray[np.int64]

#: Share of a surface's size by which its points are moved before it is searched for crossings.
JITTER = 1e-8


def winding(at: Array, points: Array, faces: Indices) -> float:
    """Return the winding number of a closed surface about a point: solid angles over 4 pi.

    tan(w/2) = a . (b x c) / (abc + (a.b) c + (b.c) a + (c.a) b)   [van Oosterom, Strackee 1983]
    """
    a, b, c = (points[faces[:, k]] - at for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = la * lb * lc + np.einsum("ij,ij->i", a, b) * lc
    below += np.einsum("ij,ij->i", b, c) * la + np.einsum("ij,ij->i", c, a) * lb
    return float(np.arctan2(above, below).sum() / (2.0 * np.pi))


@compiled(always=True, fastmath=FAST, nogil=True)
def windings(at, points, faces, out):
    """Write the winding number of a closed surface about each point (n, 3) to out (n,)."""
    d, size = np.empty((3, 3)), np.empty(3)
    for n in range(at.shape[0]):
        total = 0.0
        for m in range(faces.shape[0]):
            for k in range(3):
                square = 0.0
                for c in range(3):
                    d[k, c] = points[faces[m, k], c] - at[n, c]
                    square += d[k, c] * d[k, c]
                size[k] = np.sqrt(square)
            ab = d[0, 0] * d[1, 0] + d[0, 1] * d[1, 1] + d[0, 2] * d[1, 2]
            bc = d[1, 0] * d[2, 0] + d[1, 1] * d[2, 1] + d[1, 2] * d[2, 2]
            ca = d[2, 0] * d[0, 0] + d[2, 1] * d[0, 1] + d[2, 2] * d[0, 2]
            above = d[0, 0] * (d[1, 1] * d[2, 2] - d[1, 2] * d[2, 1])
            above += d[0, 1] * (d[1, 2] * d[2, 0] - d[1, 0] * d[2, 2])
            above += d[0, 2] * (d[1, 0] * d[2, 1] - d[1, 1] * d[2, 0])
            below = size[0] * size[1] * size[2] + ab * size[2] + bc * size[0] + ca * size[1]
            total += np.arctan2(above, below)
        out[n] = total / (2.0 * np.pi)


def first_crossing(points: Array, faces: Indices) -> Array | None:
    """Return a place where an edge of one triangle passes through another, None if nowhere.

    Triangles that share a point are left aside. Points are moved by `JITTER`, so that no edge meets
    another edge exactly, as those of parts that are mirror images of one another do.
    """
    size = float(np.ptp(points, axis=0).max())
    moved = np.random.default_rng(1).uniform(-JITTER, JITTER, points.shape) * size
    P = (points + moved)[faces]
    low, high = P.min(axis=1), P.max(axis=1)
    for one, other in _near(low, high):
        apart = (faces[one][:, :, None] != faces[other][:, None, :]).all(axis=(1, 2))
        one, other = one[apart], other[apart]
        for a, b in ((one, other), (other, one)):
            place = _pierced(P[a], P[b])
            if place is not None:
                return place
    return None


def _near(low: Array, high: Array) -> Iterator[tuple[Indices, Indices]]:
    """Pairs of boxes that overlap, some at a time: swept along the longest axis."""
    axis = int(np.argmax(high.max(axis=0) - low.min(axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    starts = low[order, axis]
    ends = np.searchsorted(starts, high[order, axis], side="right")
    count = ends - np.arange(len(order)) - 1
    step = max(1, int(2e6 // max(1, count.mean())))
    for start in range(0, len(order), step):
        some = np.arange(start, min(start + step, len(order)))
        first = np.repeat(some, count[some])
        within = np.arange(first.size) - np.repeat(
            np.cumsum(count[some]) - count[some], count[some]
        )
        a, b = order[first], order[first + 1 + within]
        meet = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
        yield a[meet].astype(np.int64), b[meet].astype(np.int64)


def _pierced(P: Array, Q: Array) -> Array | None:
    """A place where an edge of P passes through the inside of Q, both (n, 3, 3)."""
    e1, e2 = Q[:, 1] - Q[:, 0], Q[:, 2] - Q[:, 0]
    for k in range(3):
        start, d = P[:, k], P[:, (k + 1) % 3] - P[:, k]
        h = np.cross(d, e2)
        det = np.einsum("ij,ij->i", e1, h)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            s = start - Q[:, 0]
            u = np.einsum("ij,ij->i", s, h) / det
            q = np.cross(s, e1)
            v = np.einsum("ij,ij->i", d, q) / det
            t = np.einsum("ij,ij->i", e2, q) / det
        eps = 1e-9
        met = np.isfinite(u) & np.isfinite(v) & np.isfinite(t)
        u, v, t = (np.where(met, x, -1.0) for x in (u, v, t))
        hit = (u > eps) & (v > eps) & (u + v < 1 - eps) & (t > eps) & (t < 1 - eps)
        if hit.any():
            n = int(np.argmax(hit))
            return start[n] + t[n] * d[n]
    return None
