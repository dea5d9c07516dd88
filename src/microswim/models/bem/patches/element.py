"""Reference square [-1, 1]^2 of the boundary elements: nodes, interpolation, Duffy rules.

A patch holds its geometry as a polynomial through q x q Chebyshev nodes of the exact map, and its
density as a polynomial through p x p Gauss nodes, which are the collocation points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from microswim.numerics.array import Array

GEOMETRY_NODES = 8
MAX_LEVEL = 7


def chebyshev_nodes(q: int = GEOMETRY_NODES) -> Array:
    """Return Chebyshev nodes of the first kind, ascending."""
    return -np.cos((np.arange(q) + 0.5) * np.pi / q)


def lagrange(nodes: np.ndarray, x: np.ndarray) -> tuple[Array, Array]:
    """Return Lagrange polynomials through `nodes` and their derivatives at x, each (x.size,
    nodes.size).
    """
    x = np.atleast_1d(x)
    n = nodes.size
    value, slope = np.ones((x.size, n)), np.zeros((x.size, n))
    for j in range(n):
        for m in range(n):
            if m == j:
                continue
            scale = 1.0 / (nodes[j] - nodes[m])
            slope[:, j] = slope[:, j] * (x - nodes[m]) * scale + value[:, j] * scale
            value[:, j] *= (x - nodes[m]) * scale
    return value, slope


@dataclass(frozen=True)
class CellTables:
    """Interpolation from a patch to its dyadic cells, one direction; index 2^level - 1 + place.

    value, slope: (cells, g, q) geometry at the g Gauss points; middle, middle_slope: (cells, q) at
    the cell's centre; basis: (cells, g, p) density; weight: (cells, g) Gauss weights of the cell;
    half: (cells,) half width.
    """

    value: Array
    slope: Array
    middle: Array
    middle_slope: Array
    basis: Array
    weight: Array
    half: Array


@lru_cache(maxsize=16)
def cell_tables(p: int, g: int) -> CellTables:
    """Return tables of all cells down to MAX_LEVEL for order p and g Gauss points a side."""
    geometry, density = chebyshev_nodes(), np.polynomial.legendre.leggauss(p)[0]
    x, w = np.polynomial.legendre.leggauss(g)
    levels = np.repeat(np.arange(MAX_LEVEL + 1), 2 ** np.arange(MAX_LEVEL + 1))
    half = np.asarray(0.5**levels, float)
    centre = -1.0 + (2 * (np.arange(levels.size) + 1 - 2**levels) + 1) * half
    points = (centre[:, None] + half[:, None] * x).ravel()
    shape = (levels.size, g, -1)
    value, slope = lagrange(geometry, points)
    middle, middle_slope = lagrange(geometry, centre)
    return CellTables(
        value=value.reshape(shape),
        slope=slope.reshape(shape),
        middle=middle,
        middle_slope=middle_slope,
        basis=lagrange(density, points)[0].reshape(shape),
        weight=half[:, None] * w,
        half=half,
    )


def _fan(u0: float, v0: float, aspect: float, skew: float, radial: int, angular: int) -> Array:
    """Duffy points (u, v, weight) of the four triangles with apex (u0, v0).

    With d the apex's parameter distance from an edge and t along it, the distance on the patch is

        r^2 ~ (t - t_0)^2 + h^2,   t_0 = -a c d,   h = a sqrt(1 - c^2) |d|

    a the length of a step in d over that of a step in t, c the cosine between them (`skew`).
    Along each edge the substitution t = t_0 + h sinh(tau) takes out the nearby pole of 1/r.
    """
    xr, wr = np.polynomial.legendre.leggauss(radial)
    rho, wr = 0.5 * (xr + 1), 0.5 * wr
    xa, wa = np.polynomial.legendre.leggauss(angular)
    points = []
    for axis, end in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)):
        apex, along = (u0, v0) if axis == 0 else (v0, u0)
        stretch = aspect if axis == 0 else 1.0 / aspect
        height = abs(end - apex)
        h = height * stretch * np.sqrt(1.0 - skew**2)
        foot = -skew * stretch * (end - apex)
        low, high = (np.arcsinh((side - along - foot) / h) for side in (-1.0, 1.0))
        tau = 0.5 * (low + high) + 0.5 * (high - low) * xa
        t = foot + h * np.sinh(tau)
        weight = 0.5 * (high - low) * wa * h * np.cosh(tau)
        first = apex + np.outer(rho, np.full(angular, end - apex))
        second = along + np.outer(rho, t)
        both = np.outer(wr * rho, weight) * height
        u, v = (first, second) if axis == 0 else (second, first)
        points.append(np.stack([u.ravel(), v.ravel(), both.ravel()], axis=-1))
    return np.concatenate(points)


@dataclass(frozen=True)
class OwnRule:
    """Singular rule of every collocation node of a patch with a given aspect ratio.

    value, along_u, along_v: (nodes * m, q^2) geometry; basis: (nodes, m, p^2); weight: (nodes, m).
    """

    value: Array
    along_u: Array
    along_v: Array
    basis: Array
    weight: Array


@lru_cache(maxsize=64)
def own_rule(p: int, shape: tuple[int, int], radial: int, angular: int) -> OwnRule:
    """Return rule for patches of a shape: length in u over that in v, and angle between u and v.

    shape : (m, n) stands for a ratio of 2^(m/2) and an angle of 90 - 10 n degrees.
    """
    geometry, nodes = chebyshev_nodes(), np.polynomial.legendre.leggauss(p)[0]
    aspect, skew = 2.0 ** (0.5 * shape[0]), np.sin(np.radians(10.0 * shape[1]))
    fans = [_fan(u, v, aspect, skew, radial, angular) for u in nodes for v in nodes]
    fan = np.stack(fans)
    m = fan.shape[1]
    u, v = fan[..., 0].ravel(), fan[..., 1].ravel()
    (Lu, Du), (Lv, Dv) = lagrange(geometry, u), lagrange(geometry, v)
    Bu, Bv = lagrange(nodes, u)[0], lagrange(nodes, v)[0]

    def product(a: Array, b: Array) -> Array:
        return np.einsum("xi,xj->xij", a, b).reshape(a.shape[0], -1)

    return OwnRule(
        value=product(Lu, Lv),
        along_u=product(Du, Lv),
        along_v=product(Lu, Dv),
        basis=product(Bu, Bv).reshape(p * p, m, p * p),
        weight=fan[..., 2],
    )


@lru_cache(maxsize=16)
def patch_matrix(p: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the geometry (value, d/du, d/dv) at the p x p Gauss nodes from q x q nodes: (p^2,
    q^2) each.
    """
    nodes = np.polynomial.legendre.leggauss(p)[0]
    L, D = lagrange(chebyshev_nodes(), nodes)
    return np.kron(L, L), np.kron(D, L), np.kron(L, D)
