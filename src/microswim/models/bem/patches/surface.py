"""A surface of curved quadrilateral patches, and simple closed ones (ellipsoid, torus).

Every patch is a smooth map from [-1, 1]^2, sampled at q x q Chebyshev nodes, with X_u x X_v
pointing into the fluid.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from microswim.models.bem.patches.element import (
    CellTables,
    cell_tables,
    chebyshev_nodes,
    lagrange,
    patch_matrix,
)
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet
from microswim.swimmer.geometry.solids.spheres import cubed_sphere


@dataclass(frozen=True)
class Surface:
    """Patches of a closed surface.

    Parameters
    ----------
    controls : (e, q, q, 3)
        Positions at the geometry nodes.
    motion : (e, q, q, 3)
        Velocity of the tail's surface per unit phase rate at the same nodes; zero on the body.
    of_tail : (e,) int
        Which tail each patch belongs to, counted from 1; 0 on the body.
    order : int
        p, density nodes a side.
    inner : (m, e, q, q), optional
        Pressures that the fluid inside could take at next to no flow (`mesh.inner_pressures`).
    vessel : (e,) bool, optional
        Which patches belong to a tube around the swimmer, which stands still.
    closed : bool
        Whether the tube holds all the fluid.
    is_open : bool
        Whether a tail's root comes out of its body, so that patches there overlap.
    """

    controls: Array
    motion: Array
    of_tail: NDArray[np.int64]
    order: int = 2
    inner: Array | None = None
    vessel: NDArray[np.bool_] | None = None
    closed: bool = False
    is_open: bool = False

    @property
    def on_tail(self) -> NDArray[np.bool_]:
        """Which patches belong to a tail, (e,)."""
        return self.of_tail > 0

    @property
    def on_swimmer(self) -> NDArray[np.bool_]:
        """Which patches belong to the swimmer, (e,)."""
        return np.ones(self.patches, bool) if self.vessel is None else ~self.vessel

    @property
    def patches(self) -> int:
        return self.controls.shape[0]

    @property
    def unknowns(self) -> int:
        return 3 * self.patches * self.order**2

    def _at_nodes(self, which: int, values: Array) -> Array:
        matrix = patch_matrix(self.order)[which]
        q2 = matrix.shape[1]
        return np.einsum("nk,ekc->enc", matrix, values.reshape(self.patches, q2, -1), optimize=True)

    @cached_property
    def nodes(self) -> Array:
        """Collocation points, (e, p*p, 3)."""
        return np.ascontiguousarray(self._at_nodes(0, self.controls))

    @cached_property
    def shapes(self) -> NDArray[np.int64]:
        """Ratio of side lengths and angle between the sides, rounded as `own_rule` takes them."""
        along, across = (self._at_nodes(i, self.controls) for i in (1, 2))
        E, F, G = (np.sum(a * b, axis=(1, 2)) for a, b in
                   ((along, along), (along, across), (across, across)))  # fmt: skip
        steps = np.clip(np.round(np.log2(E / G)), -8, 8)
        tens = np.clip(np.round(np.degrees(np.arcsin(F / np.sqrt(E * G))) / 10), -8, 8)
        return np.stack([steps, tens], axis=-1).astype(np.int64)

    @cached_property
    def area_vectors(self) -> Array:
        """X_u x X_v at the collocation points, (e, p*p, 3)."""
        return np.cross(self._at_nodes(1, self.controls), self._at_nodes(2, self.controls))

    @cached_property
    def normals(self) -> Array:
        """Unit normals into the fluid at the collocation points, (e, p*p, 3)."""
        vector = self.area_vectors
        return vector / np.linalg.norm(vector, axis=-1, keepdims=True)

    @cached_property
    def areas(self) -> Array:
        """Plain Gauss weights of the collocation points, (e, p*p)."""
        w = np.polynomial.legendre.leggauss(self.order)[1]
        return np.linalg.norm(self.area_vectors, axis=-1) * np.outer(w, w).ravel()

    @cached_property
    def node_pressures(self) -> Array:
        """One, and the pressures `inner`, at the collocation points, (1 + m, e, p*p)."""
        one = np.ones((1, *self.nodes.shape[:2])) * self.on_swimmer[:, None]
        if self.closed:
            one = np.concatenate([one, 1.0 - one])
        if self.inner is None or len(self.inner) == 0:
            return one
        rest = [self._at_nodes(0, p[..., None])[..., 0] for p in self.inner]
        return np.concatenate([one, rest])

    @cached_property
    def node_motion(self) -> Array:
        """Tail velocity per unit phase rate at the collocation points, (e, p*p, 3)."""
        return self._at_nodes(0, self.motion)

    @cached_property
    def extent(self) -> tuple[float, float]:
        """Area, and volume within by the divergence theorem; Gauss rule with 8 points a side."""
        t = cell_tables(1, 8)
        L, D, w = t.value[0], t.slope[0], t.weight[0]
        X = self._fine(self.controls, L, L)
        vector = np.cross(self._fine(self.controls, D, L), self._fine(self.controls, L, D))
        weight = np.multiply.outer(w, w)
        area = np.sum(weight * np.linalg.norm(vector, axis=-1))
        return float(area), float(np.sum(weight * np.sum(X * vector, axis=-1)) / 3.0)

    def _fine(self, values: Array, u: Array, v: Array) -> Array:
        return np.einsum("mi,nj,eijc->emnc", u, v, values, optimize=True)

    @cached_property
    def moments(self) -> tuple[Array, Array, Array, Array]:
        """Integrals against each density node: phi, phi X, phi n, phi u_hat; (e, p*p[, 3]).

        Gauss rule with 8 points a side: exact to the accuracy of the geometry.
        """
        t = cell_tables(self.order, 8)
        L, D, B, w = t.value[0], t.slope[0], t.basis[0], t.weight[0]
        X, motion = self._fine(self.controls, L, L), self._fine(self.motion, L, L)
        vector = np.cross(self._fine(self.controls, D, L), self._fine(self.controls, L, D))
        weight = np.einsum("m,n,ma,nb->mnab", w, w, B, B).reshape(w.size, w.size, -1)
        J = np.linalg.norm(vector, axis=-1)
        return (
            np.einsum("mnp,emn->ep", weight, J, optimize=True),
            np.einsum("mnp,emn,emnc->epc", weight, J, X, optimize=True),
            np.einsum("mnp,emnc->epc", weight, vector, optimize=True),
            np.einsum("mnp,emn,emnc->epc", weight, J, motion, optimize=True),
        )


def positions(surface: Surface, side: int) -> Array:
    """Return points of a surface at side x side places of every patch, (e, side, side, 3)."""
    L = lagrange(chebyshev_nodes(), np.linspace(-1, 1, side))[0]
    return np.einsum("mi,nj,eijc->emnc", L, L, surface.controls, optimize=True)


def values_at(surface: Surface, values: Array, side: int) -> Array:
    """Return the density-like values (e, p*p, 3) at side x side points of every patch, (e, side,
    side, 3).
    """
    p = surface.order
    L = lagrange(np.polynomial.legendre.leggauss(p)[0], np.linspace(-1, 1, side))[0]
    return np.einsum("mi,nj,eijc->emnc", L, L, values.reshape(-1, p, p, 3), optimize=True)


def sample_parameters(boxes: Array) -> tuple[Array, Array]:
    """Return the chart coordinates u, v (e, q, q) of the geometry nodes of rectangles (e, 4): u0,
    u1, v0,
    v1.
    """
    x = 0.5 * (chebyshev_nodes() + 1.0)
    u = boxes[:, 0, None] + (boxes[:, 1] - boxes[:, 0])[:, None] * x
    v = boxes[:, 2, None] + (boxes[:, 3] - boxes[:, 2])[:, None] * x
    u, v = np.broadcast_arrays(u[:, :, None], v[:, None, :])
    return u, v


def sample(chart: Callable[[Array, Array], Array], boxes: Array) -> Array:
    """Return positions (e, q, q, 3) of a chart X(u, v) on rectangles."""
    return chart(*sample_parameters(boxes))


def area_misfits(controls: Array) -> tuple[Array, Array]:
    """Return relative error of the area with 4 instead of 8 Gauss points in u and in v, (e,) each.

    The quadrature of a cell sees no more than that of a patch: where the map rushes, at a crease or
    where a generator grazes the body, the patch is too large whatever its length.
    """
    few, many = (cell_tables(1, g) for g in (4, 8))

    def area(u: CellTables, v: CellTables) -> Array:
        along, across = (
            np.einsum("mi,nj,eijc->emnc", a, b, controls[..., :3], optimize=True)
            for a, b in ((u.slope[0], v.value[0]), (u.value[0], v.slope[0]))
        )
        J = np.linalg.norm(np.cross(along, across), axis=-1)
        return u.weight[0] @ J @ v.weight[0]

    whole = area(many, many)
    return np.abs(area(few, many) / whole - 1), np.abs(area(many, few) / whole - 1)


def sample_adapted(
    chart: Callable[[Array, Array], Array], boxes: Array, misfit: float = 3e-3, depth: int = 4
) -> Array:
    """Return what `sample` does; rectangles whose area is missed by `misfit` are halved, at most
    `depth` times.

    Across the direction that is worse, but no patch becomes narrower than a quarter of its length.
    """
    done = []
    for _ in range(depth):
        values = sample(chart, boxes)
        in_u, in_v = area_misfits(values)
        rough = np.maximum(in_u, in_v) > misfit
        done.append(values[~rough])
        if not rough.any():
            return np.concatenate(done)
        X = values[rough][..., :3]
        length = np.linalg.norm(X[:, -1] - X[:, 0], axis=-1).mean(axis=1)
        width = np.linalg.norm(X[:, :, -1] - X[:, :, 0], axis=-1).mean(axis=1)
        slack = np.where(in_u >= in_v, 0.5, 2.0)[rough]
        boxes = _halved(boxes[rough], length > slack * width)
    return np.concatenate([*done, sample(chart, boxes)])


def _halved(boxes: Array, along_u: NDArray[np.bool_]) -> Array:
    """Both halves of rectangles (e, 4), cut across u or across v."""
    low, high = boxes.copy(), boxes.copy()
    start = np.where(along_u, 0, 2)
    row = np.arange(len(boxes))
    middle = 0.5 * (boxes[row, start] + boxes[row, start + 1])
    low[row, start + 1] = middle
    high[row, start] = middle
    return np.concatenate([low, high])


def grid_boxes(u: Array, v: Array) -> Array:
    """Return all rectangles of a tensor grid with edges u and v, (e, 4)."""
    a, b = np.meshgrid(np.arange(u.size - 1), np.arange(v.size - 1), indexing="ij")
    a, b = a.ravel(), b.ravel()
    return np.stack([u[a], u[a + 1], v[b], v[b + 1]], axis=-1)


def sampled(facets: Iterable[Facet]) -> Array:
    """Return positions (e, q, q, 3) of all patches of smooth parts of a surface."""
    return np.concatenate([sample(f.chart, grid_boxes(f.u, f.v)) for f in facets])


def still(controls: Array, order: int = 2) -> Surface:
    """Return the closed surface of patches (e, q, q, 3) that does not move by itself."""
    none = np.zeros(len(controls), int)
    return Surface(np.ascontiguousarray(controls), np.zeros_like(controls), none, order)


def ellipsoid(semi_axes: tuple[float, float, float], splits: int = 2, order: int = 2) -> Surface:
    """Return the closed ellipsoid at the origin: six cube faces of splits x splits patches."""
    return still(sampled(cubed_sphere(splits)) * np.asarray(semi_axes), order)


def torus(ring: float, tube: float, around: int, across: int = 4, order: int = 2) -> Surface:
    """Return the torus about the first axis: ring radius, tube radius, patches along and across."""

    def chart(u: Array, v: Array) -> Array:
        distance = ring + tube * np.cos(u)
        return np.stack([tube * np.sin(u), distance * np.cos(v), distance * np.sin(v)], axis=-1)

    boxes = grid_boxes(np.linspace(0, 2 * np.pi, across + 1), np.linspace(0, 2 * np.pi, around + 1))
    controls = sample(chart, boxes)
    return still(controls[:, :, ::-1], order)
