"""The dense system of the single layer and what its densities integrate to.

    1/(8 pi mu) int G f dS = u,   int f . n dS = 0,   int p_k f . n dS = 0

Collocation leaves one null vector, the constant pressure f = n of the fluid inside, and in a thin
or flat tail nearly more: a pressure p_k that varies along it drives next to no flow. Forces do not
feel them, but they answer to the smallest error of quadrature, so the system is bordered against
them all, which also takes up the small net flux of a waving tail. Forces and torques are integrals
of the density.
"""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from microswim.models import memory
from microswim.models.bem.assembly import layer_blocks, own_blocks, stress_sums
from microswim.models.bem.mirrors import Mirrors, Parity, mirrors
from microswim.models.bem.patches.element import cell_tables, own_rule
from microswim.models.bem.patches.near_wall import over, refined
from microswim.models.bem.patches.surface import Surface
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import numba


@dataclass(frozen=True)
class Quadrature:
    """Rules of the assembly.

    Parameters
    ----------
    points : int
        Gauss points a side of a cell.
    near, far : float
        A cell is whole from `near` half lengths away; from `far` on the density's own Gauss nodes
        serve.
    radial, angular : int
        Points of the singular rule, per triangle.
    """

    points: int = 4
    near: float = 2.2
    far: float = 10.0
    radial: int = 6
    angular: int = 8


@dataclass(frozen=True)
class Layer:
    """A surface with its quadrature and, if any, a wall (point, normal): applies the single
    layer.
    """

    surface: Surface
    viscosity: float
    rule: Quadrature = field(default_factory=Quadrature)
    wall: Array | None = None

    @cached_property
    def mirrors(self) -> Mirrors:
        """Mirrors that leave surface and wall as they are."""
        return mirrors(self.surface, self.wall)

    def _fill(self, targets: Array, own: NDArray[np.int64], out: Array) -> None:
        s, r = self.surface, self.rule
        t = cell_tables(s.order, r.points)
        wall = np.zeros(6) if self.wall is None else np.asarray(self.wall, float)
        common = (
            np.ascontiguousarray(targets), own, wall, int(self.wall is not None), r.near, r.far,
            s.controls, s.nodes, s.areas, t.value, t.slope, t.middle, t.middle_slope, t.basis,
            t.weight, t.half, out,
        )  # fmt: skip
        threads = min(numba().get_num_threads(), s.patches)
        if threads == 1:
            layer_blocks(0, 1, *common)
            return
        with ThreadPoolExecutor(threads) as pool:
            work = [pool.submit(layer_blocks, n, threads, *common) for n in range(threads)]
            for done in work:
                done.result()

    def rows(self, border: int = 1) -> Array:
        """Return the rows of the collocation matrix of the nodes that stand for all, (3 o, 3 n).

        With `border` further rows and columns of zeros, Fortran order.
        """
        s, nodes = self.surface, self.mirrors.nodes
        A = np.zeros((3 * nodes.size + border, s.unknowns + border), order="F")
        self._fill(s.nodes.reshape(-1, 3)[nodes], nodes // s.order**2, A)
        row = np.full(s.nodes[..., 0].size, -1)
        row[nodes] = np.arange(nodes.size)
        for some, points, areas, basis in self._own_points:
            own_blocks(some, row, s.nodes[some], points, areas, basis, s.order**2, A)
        A *= 1.0 / (8.0 * np.pi * self.viscosity)
        return A

    @cached_property
    def _own_points(self) -> list[tuple[NDArray[np.int64], Array, Array, Array]]:
        """Singular rules on the own patches: patches, points (n, p*p, m, 3), areas, basis.

        Of the patches with nodes that stand for all.
        """
        s, p2, found = self.surface, self.surface.order**2, []
        q2 = s.controls.shape[1] ** 2
        flat, wanted = s.controls.reshape(s.patches, q2, 3), np.unique(self.mirrors.nodes // p2)
        shapes = s.shapes[wanted]
        for ratio, angle in np.unique(shapes, axis=0).tolist():
            r = own_rule(s.order, (ratio, angle), self.rule.radial, self.rule.angular)
            alike = wanted[np.all(shapes == (ratio, angle), axis=1)]
            for some in np.array_split(alike, 1 + alike.size // 64):
                C = flat[some].transpose(1, 0, 2).reshape(q2, -1)
                shape = (p2, -1, some.size, 3)
                X, U, V = ((m @ C).reshape(shape) for m in (r.value, r.along_u, r.along_v))
                J = np.linalg.norm(np.cross(U, V), axis=-1) * r.weight[:, :, None]
                points = np.ascontiguousarray(X.transpose(2, 0, 1, 3))
                found.append((some, points, np.ascontiguousarray(J.transpose(2, 0, 1)), r.basis))
        return found

    def outer_traction(self, density: Array) -> Array:
        """Return the part of a density (e, p*p, 3) that acts on the fluid outside, (e, p*p, 3).

        f = f_out + f_in, the rest drives the fluid that fills the surface;
        f_out = f/2 + 3/(4 pi) int r (r . f) (r . n) / r^5 dS,  r = x - y     (principal value)
        """
        values, out = density.reshape(-1, 3, 1), np.zeros_like(density)
        for parity in self.mirrors.parities:
            own = parity.part(values)
            if np.abs(own).max() > 1e-12 * np.abs(density).max():
                half = np.ascontiguousarray(parity.spread(own).reshape(density.shape))
                at = self._outer_traction(half)[parity.own]
                out += parity.spread(at[:, None]).reshape(density.shape)
        return out

    def _outer_traction(self, density: Array) -> Array:
        """Return it at the nodes that stand for all, (o, 3)."""
        s, r, nodes = self.surface, self.rule, self.mirrors.nodes
        t = cell_tables(s.order, r.points)
        x, n = s.nodes.reshape(-1, 3)[nodes], s.normals.reshape(-1, 3)[nodes]
        owner = nodes // s.order**2
        threads = min(numba().get_num_threads(), s.patches)
        sums = np.zeros((threads, *x.shape))
        tables = (t.value, t.slope, t.middle, t.middle_slope, t.basis, t.weight, t.half)
        common = (x, n, owner, r.near, r.far, s.controls, s.nodes, s.areas, density, *tables)
        with ThreadPoolExecutor(threads) as pool:
            work = [pool.submit(stress_sums, k, threads, *common, sums[k]) for k in range(threads)]
            for done in work:
                done.result()
        own = np.zeros_like(density)
        for some, points, areas, basis in self._own_points:
            d = s.nodes[some][:, :, None, :] - points
            f = np.einsum("imb,nbc->nimc", basis, density[some], optimize=True)
            weight = areas * np.einsum("nimc,nic->nim", d, s.normals[some]) * np.sum(d * f, axis=-1)
            weight /= np.sum(d * d, axis=-1) ** 2.5
            own[some] += np.einsum("nim,nimc->nic", weight, d)
        total = sums.sum(axis=0) + own.reshape(-1, 3)[nodes]
        return 0.5 * density.reshape(-1, 3)[nodes] + 3 / (4 * np.pi) * total

    def reach(self, points: Array, image_alone: bool = False) -> Array:
        """Return the velocity (3 t, 3 e p^2) at points (t, 3) of the fluid for each density.

        With `image_alone` only what the wall sends back.
        """
        out = np.zeros((3 * len(points), self.surface.unknowns), order="F")
        self._fill(points, np.full(len(points), -2 if image_alone else -1), out)
        out *= 1.0 / (8.0 * np.pi * self.viscosity)
        return out

    def velocity(self, points: Array, density: Array) -> Array:
        """Return the velocity (t, 3) at points of the fluid for densities (3 e p^2,)."""
        points = np.atleast_2d(np.asarray(points, float))
        result = np.empty_like(points)
        step = max(1, int(2e7 // self.surface.unknowns))
        for start in range(0, len(points), step):
            part = points[start : start + step]
            result[start : start + step] = (self.reach(part) @ density).reshape(-1, 3)
        return result


def require_memory(unknowns: int) -> None:
    """Refuse a system that does not fit."""
    need = memory.of_dense(unknowns)
    memory.require(need, unknowns, "choose a coarser level or a smaller order")


def rigid_modes(points: Array, centre: Array) -> Array:
    """Return velocities (..., 3, 6) of unit translations and unit rotations about `centre`."""
    x = points - centre
    modes = np.zeros((*points.shape, 6))
    for i in range(3):
        e = np.eye(3)[i]
        modes[..., i] = e
        modes[..., 3 + i] = np.cross(e, x)
    return modes


@dataclass(frozen=True)
class Factors:
    """The bordered systems of a layer, factorised: densities for any velocities of its surface.

    One system for each parity of the layer's mirrors, with LAPACK's factors.
    """

    parts: tuple[tuple[Parity, tuple[Array, NDArray[np.int32]]], ...]
    unknowns: int

    def solve(self, velocities: Array) -> Array:
        """Return the densities (3 e p^2, k) for velocities (3 e p^2, k) at the nodes."""
        values = velocities.reshape(-1, 3, velocities.shape[-1])
        parts = [p.spread(_solved(lu, p.part(values))) for p, lu in self.parts]
        return np.sum(parts, axis=0).reshape(velocities.shape)


def _solved(lu: tuple[Array, NDArray[np.int32]], own: Array) -> Array:
    """Return the unknowns but those of the border for right sides (m, k)."""
    matrix, pivots = lu
    rhs = np.zeros((len(matrix), own.shape[-1]), dtype=matrix.dtype, order="F")
    rhs[: len(own)] = own
    mine = pivots.copy()  # LAPACK's wrapper counts them from one meanwhile: threads would meet
    return lu_solve((matrix, mine), rhs, overwrite_b=True, check_finite=False)[: len(own)]


@dataclass(frozen=True)
class Densities:
    """Solved densities (3 e p^2, k) for k surface velocities, with the seconds spent."""

    density: Array
    seconds: dict[str, float]
    factors: Factors


def solve_density(layer: Layer, velocities: Array, single: bool = False) -> Densities:
    """Return densities for surface velocities (e, p*p, 3, k): one factorisation for all k.

    `single`: in single precision, half the time and six digits.
    """
    start = time.perf_counter()
    A, pressures = _bordered(layer)
    assembled = time.perf_counter()
    factors = _factors(layer, A, pressures, np.float32 if single else np.float64)
    density = factors.solve(velocities.reshape(factors.unknowns, -1))
    solved = time.perf_counter()
    seconds = {"assembly": assembled - start, "solve": solved - assembled}
    return Densities(density, seconds, factors)


def factorised(layer: Layer) -> Factors:
    """Return the factorised system of a layer."""
    return _factors(layer, *_bordered(layer))


def _factors(layer: Layer, rows: Array, pressures: Array, kind: type = np.float64) -> Factors:
    parts = []
    for parity in layer.mirrors.parities:
        column = parity.part(pressures)
        last = np.abs(column).max(axis=0) > 1e-9 * np.abs(pressures).max()
        A = parity.folded(rows, last)
        A[: len(column), len(column) :] = column[:, last]
        A = np.asarray(A, dtype=kind, order="F")
        parts.append((parity, lu_factor(A, overwrite_a=True, check_finite=False)))
    return Factors(tuple(parts), layer.surface.unknowns)


def _bordered(layer: Layer) -> tuple[Array, Array]:
    """Return rows of a layer's matrix with the pressures' fluxes below, and these (n, 3, b).

    The pressures are further columns, which each parity has of its own.
    """
    s = layer.surface
    require_memory(s.unknowns)
    n, pressures = s.unknowns, s.node_pressures
    A = layer.rows(border=len(pressures))
    nodes = layer.mirrors.nodes
    own = (3 * nodes[:, None] + np.arange(3)).ravel()
    scale = np.abs(A[np.arange(own.size), own]).mean()
    flux = s.moments[2] * (scale / np.abs(s.moments[2]).mean())
    A[own.size :, :n] = (flux * pressures[..., None]).reshape(len(pressures), -1)
    columns = (s.normals * pressures[..., None]).reshape(len(pressures), -1, 3) * scale
    return A, np.moveaxis(columns, 0, -1)


def wrench_rows(surface: Surface, centre: Array, patches: NDArray[np.bool_] | None = None) -> Array:
    """Return rows (6, 3 e p^2) that integrate a density to force and torque about `centre`.

    patches : (e,) bool restricts the integral, to the body say.
    """
    area, moment = surface.moments[0], surface.moments[1]
    arm = moment - area[..., None] * centre
    rows = np.zeros((6, *arm.shape))
    for i in range(3):
        rows[i, ..., i] = area
        # (x - c) x f: component i takes x_j f_k - x_k f_j
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[3 + i, ..., k] = arm[..., j]
        rows[3 + i, ..., j] = -arm[..., k]
    if patches is not None:
        rows *= patches[:, None, None]
    return rows.reshape(6, -1)


def resistance(
    surface: Surface,
    viscosity: float,
    centre: Array | None = None,
    rule: Quadrature | None = None,
    wall: Array | None = None,
) -> Array:
    """Return the resistance matrix (6, 6) of a rigid closed surface about `centre`.

    By default about the origin. Next to a wall (point and normal, (6,)) the patches are made small
    enough for the gap.
    """
    surface = surface if wall is None else refined(surface, over(np.asarray(wall, float)))
    centre = np.zeros(3) if centre is None else np.asarray(centre, float)
    layer = Layer(surface, viscosity, rule or Quadrature(), wall)
    solved = solve_density(layer, rigid_modes(surface.nodes, centre))
    return wrench_rows(surface, centre) @ solved.density
