"""Taylor-Hood discretisation of the (unsteady) Stokes equations on the displaced mesh.

    a(u, v) = int c u.v + 2 mu D(u):D(v) dx,   b(u, q) = -int q div u dx,     K = [a b'; b 0]

with velocity given on swimmer and walls. Forces are consistent residuals, not integrals of stress:
the force of the surface on the fluid along a test motion w is w' (K u - f), w taken on the surface
alone, which is five to ten times more accurate. In a closed vessel one pressure unknown is pinned,
surface velocities are made free of net flux and the mean pressure is set to zero.
"""

from __future__ import annotations

import time
from typing import Any

import ngsolve as ngs
import numpy as np

from microswim.errors import MicroswimError
from microswim.models import memory
from microswim.models.fem.nodes import Nodes

SWIMMER = "body|tail"
AXES = np.eye(3)
FOLDED = 0.05  # smallest Jacobian that is still taken


class Stokes:
    """Spaces, matrix and factorisation on a mesh whose nodes move.

    Parameters
    ----------
    mesh
        Straight mesh with boundaries body, tail, wall and, if open, end.
    order
        Order of the velocity; the pressure has one less.
    """

    def __init__(self, mesh: ngs.Mesh, order: int) -> None:
        self.mesh, self.order = mesh, order
        self.seconds = {"assembly": 0.0, "factorisation": 0.0, "solve": 0.0}
        names = set(mesh.GetBoundaries())
        self.closed = "end" not in names
        self.velocity_space = ngs.VectorH1(mesh, order=order, dirichlet=f"{SWIMMER}|wall")
        self.pressure_space = ngs.H1(mesh, order=order - 1)
        self.space = self.velocity_space * self.pressure_space
        self.nodes = Nodes(ngs.H1(mesh, order=order))
        self.size, self.unknowns = 3 * len(self.nodes.points), self.space.ndof
        self.deformation = ngs.GridFunction(self.velocity_space)
        self.free = ngs.BitArray(self.space.FreeDofs())
        if self.closed:
            self.free[self.velocity_space.ndof] = False
        self._held = ~np.array([self.velocity_space.FreeDofs()[i] for i in range(self.size)])
        self._masks(names)
        self.position = self.nodes.coefficients(self.nodes.points)
        self._straight = self.position.copy()
        self._viscosity, self._inertia = ngs.Parameter(1.0), ngs.Parameter(0.0)
        self._form, self.inverse, self._is_factorised = self._bilinear(), None, False

    def _bilinear(self) -> ngs.BilinearForm:
        (u, p), (v, q) = self.space.TnT()
        strain = ngs.InnerProduct(ngs.Sym(ngs.Grad(u)), ngs.Sym(ngs.Grad(v)))
        form = 2.0 * self._viscosity * strain - p * ngs.div(v) - q * ngs.div(u)
        form = form + self._inertia * ngs.InnerProduct(u, v)
        matrix = ngs.BilinearForm(self.space, symmetric=True)
        matrix += form * ngs.dx(bonus_intorder=self.order - 1)
        return matrix

    def _masks(self, names: set[str]) -> None:
        """Coefficients and nodes that belong to the body, and to the tail without its joint."""
        dofs, self.on = {}, {}
        for name in ("body", "tail"):
            there = name in names
            region = self.mesh.Boundaries(name)
            bits: Any = self.velocity_space.GetDofs(region) if there else [False] * self.size
            dofs[name] = np.fromiter(bits, bool, self.size)
            none = np.zeros(len(self.nodes.points), bool)
            self.on[name] = self.nodes.on(name) if there else none
        dofs["tail"] &= ~dofs["body"]
        self.on["tail"] &= ~self.on["body"]
        self.dofs = dofs

    @property
    def places(self) -> np.ndarray:
        """Nodal positions (n, 3) on the moved mesh."""
        return self.nodes.values(self.position)

    def move(self, places: np.ndarray) -> None:
        """Put the nodes at `places` (n, 3); refuse a mesh that folds."""
        if (smallest := self.smallest_jacobian(places)) <= FOLDED:
            raise MicroswimError(
                f"the mesh around the tail folds (smallest Jacobian {smallest:.2g}); "
                "lower the wave, use fewer waves or a finer level"
            )
        self.mesh.SetDeformation(self.deformation)

    def smallest_jacobian(self, places: np.ndarray) -> float:
        """Return the smallest det(1 + grad d) at quadrature points with the nodes at `places`."""
        return float(np.min(self.jacobians(places)))

    def jacobians(self, places: np.ndarray) -> np.ndarray:
        """Return the smallest det(1 + grad d) of each element with the nodes at `places`."""
        self.position = self.nodes.coefficients(places)
        self.mesh.UnsetDeformation()
        self.deformation.vec.FV().NumPy()[:] = (self.position - self._straight).T.ravel()
        rule = ngs.IntegrationRule(ngs.TET, 2 * self.order)
        points = self.mesh.MapToAllElements(rule, ngs.VOL)
        jacobian = ngs.Det(ngs.Id(3) + ngs.Grad(self.deformation))
        return np.asarray(jacobian(points)).reshape(self.mesh.ne, -1).min(axis=1)

    def assemble(self, viscosity: float, inertia: float = 0.0) -> None:
        """Assemble K where the mesh now is; `inertia` is the coefficient c of the mass term.

        Refused where the memory foreseen for its factors is not there.
        """
        if self.inverse is None:
            need = memory.of_sparse(self.unknowns, self.order)
            mend = "take a coarser level, a smaller channel or a larger machine"
            memory.require(need, self.unknowns, mend)
        self._viscosity.Set(viscosity)
        self._inertia.Set(inertia)
        start = time.perf_counter()
        self._form.Assemble()
        self.matrix, self._is_factorised = self._form.mat, False
        self.seconds["assembly"] = time.perf_counter() - start
        ones = ngs.LinearForm(self.space.TestFunction()[1] * ngs.dx).Assemble()
        self._mean = ones.vec.FV().NumPy()[self.size :].copy()
        self._flux = self.apply(self._constant_pressure())[: self.size]

    def factorise(self, viscosity: float, inertia: float = 0.0) -> None:
        """Assemble K and factorise it."""
        self.assemble(viscosity, inertia)
        self.renew_factors()

    def renew_factors(self) -> None:
        """Make the factors of K; its symbolic analysis is kept from one position to the next."""
        start = time.perf_counter()
        if self.inverse is None:
            self.inverse = factorised(self.matrix, self.free)
        else:
            self.inverse.Update()
        self._is_factorised = True
        self.seconds["factorisation"] = time.perf_counter() - start

    def _constant_pressure(self) -> np.ndarray:
        one = np.zeros(self.unknowns)
        one[self.size : self.size + self.mesh.nv] = 1.0
        return one

    def apply(self, vector: np.ndarray) -> np.ndarray:
        """Return ``k`` times a vector."""
        x, y = self.matrix.CreateColVector(), self.matrix.CreateColVector()
        x.FV().NumPy()[:] = vector
        y.data = self.matrix * x
        return y.FV().NumPy().copy()

    def given(self, velocity: np.ndarray, where: np.ndarray) -> np.ndarray:
        """Return the boundary data: the nodal velocity (n, 3) at nodes `where`, zero elsewhere."""
        coefficients = self.nodes.coefficients(np.where(where[:, None], velocity, 0.0))
        data = np.zeros(self.unknowns)
        data[: self.size] = np.where(self._held, coefficients.T.ravel(), 0.0)
        return data

    def without_flux(self, data: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Return the boundary data less the multiple of `normal` that carries their net flux."""
        if not self.closed:
            return data
        flux, area = self._flux @ data[: self.size], self._flux @ normal[: self.size]
        return data - flux / area * normal

    def solve(self, data: np.ndarray, load: np.ndarray | None = None) -> np.ndarray:
        """Return the velocity and pressure for boundary data and a load f."""
        right = (0.0 if load is None else load) - self.apply(data)
        if not self._is_factorised:
            self.renew_factors()
        start = time.perf_counter()
        answer = self.by_factors(right)
        self.seconds["solve"] = time.perf_counter() - start
        return self.with_no_mean_pressure(data + answer)

    def by_factors(self, right: np.ndarray) -> np.ndarray:
        """Return the free unknowns by the factors at hand, be they of a former position."""
        vector, answer = self.matrix.CreateColVector(), self.matrix.CreateColVector()
        vector.FV().NumPy()[:] = right
        answer.data = self.inverse * vector
        return answer.FV().NumPy().copy()

    def with_no_mean_pressure(self, solution: np.ndarray) -> np.ndarray:
        """Return a solution in a closed vessel with the constant that its pressure leaves open."""
        if not self.closed:
            return solution
        one = self._constant_pressure()
        mean = self._mean @ solution[self.size :] / (self._mean @ one[self.size :])
        return solution - mean * one

    def rigid_modes(self, centre: np.ndarray, axes: np.ndarray = AXES) -> list[np.ndarray]:
        """Return the boundary data of unit translations and turns about `centre` along axes
        (columns).
        """
        constant = self.nodes.coefficients(np.ones(len(self.nodes.points)))
        arm = self.position - np.outer(constant, centre)
        on_swimmer = self.dofs["body"] | self.dofs["tail"]
        modes = [np.outer(constant, axis) for axis in axes.T]
        modes += [np.cross(axis, arm) for axis in axes.T]
        data = np.zeros((6, self.unknowns))
        data[:, : self.size] = [np.where(on_swimmer, mode.T.ravel(), 0.0) for mode in modes]
        return list(data)

    def forces(self, reaction: np.ndarray, modes: list[np.ndarray], part: str) -> np.ndarray:
        """Return force and torque (6,) of the part (body or tail) on the fluid from ``K u - f``."""
        held = self.dofs[part]
        return np.array([mode[: self.size][held] @ reaction[: self.size][held] for mode in modes])


def factorised(matrix: Any, free: ngs.BitArray) -> Any:
    """Return the direct factorisation: MKL's PARDISO (metis ordering, symmetric), else UMFPACK."""
    flags = {"ordering": "metis", "symmetric": True}
    try:
        return matrix.Inverse(free, inverse="pardiso", flags=flags)
    except Exception as without_mkl:
        try:
            return matrix.Inverse(free, inverse="umfpack")
        except Exception:
            raise MicroswimError(
                "neither PARDISO nor UMFPACK can be had; pip install microswim[fem]"
            ) from without_mkl
