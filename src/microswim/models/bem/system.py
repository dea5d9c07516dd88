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
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from microswim.models import memory
from microswim.models.bem.assembly import layer_blocks, own_blocks, stress_sums
from microswim.models.bem.element import cell_tables, own_rule
from microswim.models.bem.near_wall import over, refined
from microswim.models.bem.surface import Surface
from microswim.numerics.array import Array
from microswim.numerics.compiled import numba


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

    def matrix(self, border: int = 1) -> Array:
        """Return the collocation matrix with `border` further rows and columns of zeros, Fortran
        order.
        """
        s = self.surface
        n = s.unknowns + border
        A = np.zeros((n, n), order="F")
        own = np.repeat(np.arange(s.patches), s.order**2)
        self._fill(s.nodes.reshape(-1, 3), own, A)
        self._fill_own(A)
        A *= 1.0 / (8.0 * np.pi * self.viscosity)
        return A

    def _own_points(self) -> Iterator[tuple[NDArray[np.int64], Array, Array, Array]]:
        """Singular rules on the own patches: patches, points (n, p*p, m, 3), areas, basis."""
        s, p2 = self.surface, self.surface.order**2
        q2 = s.controls.shape[1] ** 2
        flat, shapes = s.controls.reshape(s.patches, q2, 3), s.shapes
        for ratio, angle in np.unique(shapes, axis=0).tolist():
            r = own_rule(s.order, (ratio, angle), self.rule.radial, self.rule.angular)
            alike = np.nonzero(np.all(shapes == (ratio, angle), axis=1))[0]
            for some in np.array_split(alike, 1 + alike.size // 64):
                C = flat[some].transpose(1, 0, 2).reshape(q2, -1)
                shape = (p2, -1, some.size, 3)
                X, U, V = ((m @ C).reshape(shape) for m in (r.value, r.along_u, r.along_v))
                J = np.linalg.norm(np.cross(U, V), axis=-1) * r.weight[:, :, None]
                points = np.ascontiguousarray(X.transpose(2, 0, 1, 3))
                yield some, points, np.ascontiguousarray(J.transpose(2, 0, 1)), r.basis

    def _fill_own(self, A: Array) -> None:
        s = self.surface
        for some, points, areas, basis in self._own_points():
            own_blocks(some, s.nodes[some], points, areas, basis, s.order**2, A)

    def outer_traction(self, density: Array) -> Array:
        """Return the part of a density (e, p*p, 3) that acts on the fluid outside, (e, p*p, 3).

        f = f_out + f_in, the rest drives the fluid that fills the surface;
        f_out = f/2 + 3/(4 pi) int r (r . f) (r . n) / r^5 dS,  r = x - y     (principal value)
        """
        s, r = self.surface, self.rule
        t = cell_tables(s.order, r.points)
        x, n = s.nodes.reshape(-1, 3), np.ascontiguousarray(s.normals.reshape(-1, 3))
        owner = np.repeat(np.arange(s.patches), s.order**2)
        threads = min(numba().get_num_threads(), s.patches)
        sums = np.zeros((threads, *x.shape))
        tables = (t.value, t.slope, t.middle, t.middle_slope, t.basis, t.weight, t.half)
        common = (x, n, owner, r.near, r.far, s.controls, s.nodes, s.areas, density, *tables)
        with ThreadPoolExecutor(threads) as pool:
            work = [pool.submit(stress_sums, k, threads, *common, sums[k]) for k in range(threads)]
            for done in work:
                done.result()
        total = sums.sum(axis=0).reshape(density.shape)
        for some, points, areas, basis in self._own_points():
            d = s.nodes[some][:, :, None, :] - points
            f = np.einsum("imb,nbc->nimc", basis, density[some], optimize=True)
            weight = areas * np.einsum("nimc,nic->nim", d, s.normals[some]) * np.sum(d * f, axis=-1)
            weight /= np.sum(d * d, axis=-1) ** 2.5
            total[some] += np.einsum("nim,nimc->nic", weight, d)
        return 0.5 * density + 3 / (4 * np.pi) * total

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
    """The bordered system of a layer, factorised: densities for any velocities of its surface."""

    lu: tuple[Array, NDArray[np.int32]]
    unknowns: int

    def solve(self, velocities: Array) -> Array:
        """Return the densities (3 e p^2, k) for velocities (3 e p^2, k) at the nodes."""
        rhs = np.zeros((len(self.lu[0]), velocities.shape[-1]), order="F")
        rhs[: self.unknowns] = velocities
        matrix, pivots = self.lu
        own = pivots.copy()  # LAPACK's wrapper counts them from one meanwhile: threads would meet
        return lu_solve((matrix, own), rhs, overwrite_b=True, check_finite=False)[: self.unknowns]


@dataclass(frozen=True)
class Densities:
    """Solved densities (3 e p^2, k) for k surface velocities, with the seconds spent."""

    density: Array
    seconds: dict[str, float]
    factors: Factors


def solve_density(layer: Layer, velocities: Array) -> Densities:
    """Return densities for surface velocities (e, p*p, 3, k): one factorisation for all k."""
    start = time.perf_counter()
    A = _bordered(layer)
    assembled = time.perf_counter()
    factors = _factors(A, layer)
    density = factors.solve(velocities.reshape(factors.unknowns, -1))
    solved = time.perf_counter()
    seconds = {"assembly": assembled - start, "solve": solved - assembled}
    return Densities(density, seconds, factors)


def factorised(layer: Layer) -> Factors:
    """Return the factorised system of a layer."""
    return _factors(_bordered(layer), layer)


def _factors(A: Array, layer: Layer) -> Factors:
    return Factors(lu_factor(A, overwrite_a=True, check_finite=False), layer.surface.unknowns)


def _bordered(layer: Layer) -> Array:
    """Return the matrix of a layer with the pressures as further columns, their fluxes as rows."""
    s = layer.surface
    require_memory(s.unknowns)
    n, pressures = s.unknowns, s.node_pressures
    A = layer.matrix(border=len(pressures))
    scale = np.abs(A.diagonal()[:n]).mean()
    flux = s.moments[2] * (scale / np.abs(s.moments[2]).mean())
    for k, pressure in enumerate(pressures[..., None], start=n):
        A[:n, k] = (s.normals * pressure).reshape(-1) * scale
        A[k, :n] = (flux * pressure).reshape(-1)
    return A


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
