"""Nearest points on the curved triangles of a surface.

Newton's method on the few triangles that are nearest as flat ones, and along their sides for points
whose foot lies beyond them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.swimmer.geometry.solids.triangles import Indices, Triangles

#: Triangles that are tried, the nearest as flat ones; steps of Newton's method.
TRIED, STEPS = 4, 6


def six_shapes(b: Any, c: Any) -> Any:
    """Return the shape functions (..., 6) of a triangle with corners and side middles ab, bc, ca.

    b, c
        Barycentric coordinates of the second and third corner.
    """
    a = 1.0 - b - c
    return np.stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c,
                     4 * c * a], axis=-1)  # fmt: skip


def _slopes(b: Array, c: Array) -> tuple[Array, Array]:
    """Derivatives of `six_shapes` by b and by c."""
    a, zero = 1.0 - b - c, np.zeros_like(b)
    by_b = [1 - 4 * a, 4 * b - 1, zero, 4 * (a - b), 4 * c, -4 * c]
    by_c = [1 - 4 * a, zero, 4 * c - 1, -4 * b, 4 * b, 4 * (a - c)]
    return np.stack(by_b, axis=-1), np.stack(by_c, axis=-1)


@dataclass(frozen=True, eq=False)
class Nearest:
    """The points of a surface that are nearest to others.

    Parameters
    ----------
    surface
        Its triangles, curved between their corners.
    """

    surface: Triangles

    @cached_property
    def _six(self) -> Array:
        """Corners and middles of the sides of every triangle, (m, 6, 3)."""
        own = self.surface
        return np.concatenate([own.points[own.faces], own.middles[own.edges[2]]], axis=1)

    @cached_property
    def _balls(self) -> tuple[Array, Array]:
        """Middle and radius of a ball about the corners of every triangle."""
        P = self._six[:, :3]
        middle = P.mean(axis=1)
        return middle, np.linalg.norm(P - middle[:, None], axis=2).max(axis=1)

    def __call__(self, X: Array) -> Array:
        """Return the nearest points (..., 3) to points (..., 3)."""
        flat = np.ascontiguousarray(X, float).reshape(-1, 3)
        face = np.full((len(flat), TRIED), -1)
        nearest_faces(flat, np.ascontiguousarray(self._six[:, :3]), *self._balls, face)
        best, least = flat.copy(), np.full(len(flat), np.inf)
        for k in range(TRIED):
            rows = np.flatnonzero(face[:, k] >= 0)
            at = self._on(flat[rows], face[rows, k])
            away = np.sum((at - flat[rows]) ** 2, axis=1)
            nearer = away < least[rows]
            best[rows[nearer]], least[rows[nearer]] = at[nearer], away[nearer]
        return best.reshape(X.shape)

    def _on(self, X: Array, face: Indices) -> Array:
        """Nearest points on one triangle each."""
        P = self._six[face]
        b = c = np.full(len(X), 1.0 / 3.0)
        for _ in range(STEPS):
            miss = X - _at(P, b, c)
            u, v = (np.einsum("nk,nkc->nc", s, P) for s in _slopes(b, c))
            E, F, G = (np.sum(p * q, axis=1) for p, q in ((u, u), (u, v), (v, v)))
            p, q = np.sum(u * miss, axis=1), np.sum(v * miss, axis=1)
            det = np.maximum(E * G - F * F, 1e-300)
            b = np.clip(b + (G * p - F * q) / det, -0.5, 1.5)
            c = np.clip(c + (E * q - F * p) / det, -0.5, 1.5)
        within = (b >= 0.0) & (c >= 0.0) & (b + c <= 1.0)
        out = _at(P, b, c)
        out[~within] = _on_sides(X[~within], P[~within])
        return out


def _at(P: Array, b: Array, c: Array) -> Array:
    return np.einsum("nk,nkc->nc", six_shapes(b, c), P)


def _on_sides(X: Array, P: Array) -> Array:
    """Nearest points on the sides of triangles (n, 6, 3)."""
    best, least = X.copy(), np.full(len(X), np.inf)
    for start, middle, end in ((0, 3, 1), (1, 4, 2), (2, 5, 0)):
        a, m, z = P[:, start], P[:, middle], P[:, end]
        first, second = 4 * m - 3 * a - z, 2 * (a + z - 2 * m)
        t = np.full(len(X), 0.5)
        for _ in range(STEPS):
            t_ = t[:, None]
            slope = first + 2 * t_ * second
            miss = X - (a + t_ * first + t_ * t_ * second)
            step = np.sum(slope * miss, axis=1) / np.maximum(np.sum(slope**2, axis=1), 1e-300)
            t = np.clip(t + step, 0.0, 1.0)
        t_ = t[:, None]
        at = a + t_ * first + t_ * t_ * second
        away = np.sum((at - X) ** 2, axis=1)
        nearer = away < least
        best[nearer], least[nearer] = at[nearer], away[nearer]
    return best


@compiled(always=True, fastmath=FAST, nogil=True)
def nearest_faces(at, corners, middle, radius, out):
    """Write the nearest flat triangles (m, 3, 3) of each point (n, 3) to out (n, k), -1 for none.

    The search begins with those of the point before. middle, radius: balls that hold them.
    """
    count = out.shape[1]
    least = np.empty(count)
    for n in range(at.shape[0]):
        least[:] = np.inf
        out[n, :] = -1
        before = count if n > 0 else 0
        for turn in range(before + corners.shape[0]):
            m = out[n - 1, turn] if turn < before else turn - before
            if m < 0:
                continue
            x, y, z = at[n, 0] - middle[m, 0], at[n, 1] - middle[m, 1], at[n, 2] - middle[m, 2]
            reach = radius[m] + np.sqrt(least[count - 1])
            if x * x + y * y + z * z > reach * reach:
                continue
            known = False
            for k in range(count):
                known = known or out[n, k] == m
            away = np.inf if known else square_distance(at[n], corners[m])
            if away >= least[count - 1]:
                continue
            k = count - 1
            while k > 0 and least[k - 1] > away:
                least[k], out[n, k] = least[k - 1], out[n, k - 1]
                k -= 1
            least[k], out[n, k] = away, m


@compiled(always=True, fastmath=FAST, nogil=True)
def square_distance(at, corners):
    """Return the square of the distance of a point (3,) from a flat triangle (3, 3)."""
    least = np.inf
    o, p, q = corners[0], corners[1], corners[2]
    nx = (p[1] - o[1]) * (q[2] - o[2]) - (p[2] - o[2]) * (q[1] - o[1])
    ny = (p[2] - o[2]) * (q[0] - o[0]) - (p[0] - o[0]) * (q[2] - o[2])
    nz = (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
    normal = (nx, ny, nz)
    size = nx * nx + ny * ny + nz * nz
    within = True
    for k in range(3):
        a, b = corners[k], corners[(k + 1) % 3]
        along, long, turn = 0.0, 0.0, 0.0
        for c in range(3):
            i, j = (c + 1) % 3, (c + 2) % 3
            side, d = b[c] - a[c], at[c] - a[c]
            along += d * side
            long += side * side
            across = (b[i] - a[i]) * (at[j] - a[j]) - (b[j] - a[j]) * (at[i] - a[i])
            turn += normal[c] * across
        within = within and turn >= 0.0
        t = min(1.0, max(0.0, along / long)) if long > 0.0 else 0.0
        away = 0.0
        for c in range(3):
            away += (at[c] - a[c] - t * (b[c] - a[c])) ** 2
        least = min(least, away)
    if within and size > 0.0:
        height = 0.0
        for c in range(3):
            height += normal[c] * (at[c] - corners[0, c])
        least = height * height / size
    return least
