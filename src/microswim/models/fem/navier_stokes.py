"""One step of the Navier-Stokes equations on a moving mesh, second order in time.

Arbitrary Lagrangian-Eulerian form at fixed mesh points, w the mesh velocity,

    rho (du/dt|_X + (u - w) . grad u) = -grad p + mu lap u + f,   div u = 0,

by the second backward difference (BDF2, the first step BDF1), u and w of the same nodes:

    du/dt|_X = (3 u' - 4 u + u_old) / (2 dt),    w = (3 x' - 4 x + x_old) / (2 dt).

The convective term is extrapolated, u* = 2 u - u_old, so that a step is one symmetric system; this
is stable while |u|^2 rho dt / mu is well below one. A uniform flow is not disturbed by the mesh's
motion (the form is not conservative).
"""

from __future__ import annotations

from dataclasses import dataclass

import ngsolve as ngs
import numpy as np

from microswim.models.fem.former import FEW, Former
from microswim.models.fem.stokes import Stokes


@dataclass(frozen=True)
class Past:
    """Velocity coefficients (3 n,) and node coefficients (n, 3) of the last one or two steps.

    Newest first; two entries make BDF2, one BDF1.
    """

    velocity: tuple[np.ndarray, ...]
    position: tuple[np.ndarray, ...]

    def then(self, velocity: np.ndarray, position: np.ndarray) -> Past:
        """Return the past one step later."""
        return Past((velocity, self.velocity[0]), (position, self.position[0]))

    @property
    def leading(self) -> float:
        """Coefficient of the new value in dt du/dt."""
        return 1.5 if len(self.velocity) == 2 else 1.0


def known_part(past: tuple[np.ndarray, ...]) -> np.ndarray:
    """Return what the known steps subtract: 2 u - u_old / 2 (BDF2), u (BDF1)."""
    return 2.0 * past[0] - 0.5 * past[1] if len(past) == 2 else past[0]


def extrapolated(past: tuple[np.ndarray, ...]) -> np.ndarray:
    """Return the value at the new step, second order (first on the first step)."""
    return 2.0 * past[0] - past[1] if len(past) == 2 else past[0]


class Step:
    """The system of one time step on the mesh where it now is.

    Parameters
    ----------
    flow
        Stokes discretisation, moved to the new position.
    past
        The steps before.
    dt, density, viscosity
        Time step and fluid.
    force : ngsolve.CoefficientFunction, optional
        Body force per volume at the new time.
    """

    def __init__(
        self,
        flow: Stokes,
        past: Past,
        dt: float,
        *,
        density: float,
        viscosity: float = 1.0,
        force: ngs.CoefficientFunction | None = None,
    ) -> None:
        self.flow, self.past, self.dt = flow, past, dt
        flow.assemble(viscosity, inertia=density * past.leading / dt)
        self.load = self._load(density, force)

    def _field(self, coefficients: np.ndarray) -> ngs.GridFunction:
        field = ngs.GridFunction(self.flow.velocity_space)
        field.vec.FV().NumPy()[:] = coefficients
        return field

    def _load(self, density: float, force: ngs.CoefficientFunction | None) -> np.ndarray:
        """f(v) = int rho (known / dt - (u* - w) . grad u*) . v + force . v."""
        flow, past = self.flow, self.past
        known = self._field(known_part(past.velocity))
        star = self._field(extrapolated(past.velocity))
        moved = past.leading * flow.position - known_part(past.position)
        w = self._field((moved / self.dt).T.ravel())
        total = density * (known / self.dt - ngs.Grad(star) * (star - w))
        if force is not None:
            total = total + force
        v = flow.velocity_space.TestFunction()
        form = ngs.LinearForm(flow.velocity_space)
        form += ngs.InnerProduct(total, v) * ngs.dx(bonus_intorder=2 * flow.order - 1)
        load = np.zeros(flow.unknowns)
        load[: flow.size] = form.Assemble().vec.FV().NumPy()
        return load

    def solve(self, data: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the flow for boundary data with the load, and its reaction K u - f."""
        solution = self.flow.solve(data, self.load)
        return solution, self.flow.apply(solution) - self.load

    def swim(
        self,
        data: np.ndarray,
        modes: list[np.ndarray],
        free: tuple[bool, ...],
        former: Former | None = None,
    ) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray], Former | None]:
        """Return the flow with the twist V for which no force and torque act on the free motions.

        Parameters
        ----------
        data
            Boundary data of the tail's own motion.
        modes
            Boundary data of the six motions.
        free
            Which of them are free.
        former
            Factors of a step before, which serve as long as the mesh is near.

        Returns
        -------
        tuple
            Solution, twist (6,), wrench of the fluid on ``body`` and ``tail`` (6,), and the factors
            for the next step; None where it had better make its own.
        """
        flow, chosen = self.flow, np.array(modes)[list(free)]
        g = self.load - flow.apply(data)
        found = None if former is None else former.refine(g, chosen)
        if found is None:
            former = Former(flow, chosen)
            found = *former.solve(g, chosen @ g), 0
        x, V, steps = found
        solution = flow.with_no_mean_pressure(data + x + V @ chosen)
        reaction = flow.apply(solution) - self.load
        twist = np.zeros(6)
        twist[list(free)] = V
        wrench = {part: -flow.forces(reaction, modes, part) for part in ("body", "tail")}
        return solution, twist, wrench, former if steps <= FEW else None
