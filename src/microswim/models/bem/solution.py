"""The flow about a swimmer at one phase: densities, wrenches, velocities, traction.

    R = [force; torque] of the six rigid motions,
    F_p,i = int f_i . u_hat dS,  f_i the density of rigid motion i      (Lorentz reciprocity)
    G = int f . u_hat dS,  f the density of the tail's motion at unit phase rate

Force and torque are by the surface on the fluid, about the body's centre. Where the tail turns
against the body the velocity jumps at the joint and f grows there like 1/distance: the resultant
of f converges slowly, the torque and the lateral force *on the body alone* drift with the logarithm
of the mesh size. The densities f_i of rigid motions see no jump, so F_p is taken from them; what
the resultant of f says instead is `raw_propulsion`.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from microswim.models import rooting
from microswim.models.bem import output as flow
from microswim.models.bem.balance import balanced, turning_of
from microswim.models.bem.levels import Level, named
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.patches.near_wall import over, refined
from microswim.models.bem.patches.surface import Surface, positions
from microswim.models.bem.patches.vessel import in_tube
from microswim.models.bem.system import (
    Factors,
    Layer,
    require_memory,
    rigid_modes,
    solve_density,
    wrench_rows,
)
from microswim.numerics.array import Array
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True)
class Solution:
    """Single-layer densities of one swimmer at one phase: six rigid motions and the tail's own.

    Parameters
    ----------
    swimmer : Swimmer
    phase : float
        Phase of the tail (rad).
    layer : Layer
        Surface, viscosity, quadrature, wall.
    density : (3 e p^2, 7)
        Columns: three translations, three rotations about the body's centre, the tail at unit
        phase rate.
    seconds : dict
        Wall time of geometry, assembly, solve.
    remarks : tuple of str
        What is extreme about the geometry.
    factors : Factors, optional
        The factorised system, where it was asked to be kept.
    """

    swimmer: Swimmer
    phase: float
    layer: Layer
    density: Array
    seconds: dict[str, float]
    remarks: tuple[str, ...] = ()
    factors: Factors | None = None

    @property
    def surface(self) -> Surface:
        return self.layer.surface

    @property
    def unknowns(self) -> int:
        return self.surface.unknowns

    @property
    def centre(self) -> Array:
        """Reference point: the body's centre, the joint without a body."""
        return np.asarray(self.swimmer.body.centre, float)

    @cached_property
    def _wrenches(self) -> Array:
        return wrench_rows(self.surface, self.centre, self.surface.on_swimmer) @ self.density

    @cached_property
    def _body_wrenches(self) -> Array:
        on_body = self.surface.on_swimmer & ~self.surface.on_tail
        rows = wrench_rows(self.surface, self.centre, on_body)
        return rows @ self.density

    @property
    def raw_resistance(self) -> Array:
        """R (6, 6) as computed; its asymmetry measures the discretisation."""
        return self._wrenches[:, :6]

    @cached_property
    def resistance(self) -> Array:
        """R (6, 6), symmetric, in balance with `propulsion`."""
        return balanced(self.raw_resistance, turning_of(self.surface, self.centre))

    @property
    def asymmetry(self) -> float:
        """Largest |R_ij - R_ji| over sqrt(R_ii R_jj); infinite where some R_ii is not positive."""
        R = self.raw_resistance
        if R.diagonal().min() <= 0.0:
            return float("inf")
        return float((np.abs(R - R.T) / np.sqrt(np.outer(R.diagonal(), R.diagonal()))).max())

    @cached_property
    def propulsion(self) -> Array:
        """F_p (6,) per unit phase rate, by the reciprocal theorem from the rigid densities."""
        return self.surface.moments[3].reshape(-1) @ self.density[:, :6]

    @cached_property
    def in_poiseuille(self) -> Array | None:
        """Wrench (6,) of Poiseuille's flow in the tube on the swimmer, held; none without a tube.

        Of unit speed on the axis, ``int f_i . u dS`` by the reciprocal theorem.
        """
        channel = self.swimmer.channel
        if channel is None or not channel.is_cylinder:
            return None
        X = self.surface.controls - middle_of(self.swimmer)
        along = channel.axes[:, 0]
        across = X - (X @ along)[..., None] * along
        speed = 1.0 - np.sum(across**2, axis=-1) * (2.0 / channel.diameter) ** 2
        speed = speed * self.surface.on_swimmer[:, None, None]
        flow = replace(self.surface, motion=speed[..., None] * along)
        return flow.moments[3].reshape(-1) @ self.density[:, :6]

    @property
    def raw_propulsion(self) -> Array:
        """F_p (6,) as the resultant of the tail's own density; converges slowly at the joint."""
        return self._wrenches[:, 6]

    @property
    def reciprocity(self) -> float:
        """Largest |raw F_p - F_p| over sqrt(R_ii G): how well the corner at the joint is met.

        Infinite where R_ii or G is not positive, zero for a tail that does not move.
        """
        if not self.surface.motion.any():
            return 0.0
        power = self.surface.moments[3].reshape(-1) @ self.density[:, 6]
        if power <= 0.0 or self.raw_resistance.diagonal().min() <= 0.0:
            return float("inf")
        scale = np.sqrt(self.raw_resistance.diagonal() * power)
        return float((np.abs(self.raw_propulsion - self.propulsion) / scale).max())

    @cached_property
    def _outer(self) -> Array:
        """Densities with the share of the fluid inside the deforming tail taken out (column 6).

        Rigid motions and a rigid tail leave the fluid inside without stress. Beside a wall the
        share is left in: the image's stress is not evaluated.
        """
        density = self.density.copy()
        deforms = self.surface.motion.any() and self.swimmer.tail.surface_motion != "rigid"
        if deforms and self.layer.wall is None:
            own = self.density[:, 6].reshape(self.surface.nodes.shape)
            density[:, 6] = self.layer.outer_traction(np.ascontiguousarray(own)).reshape(-1)
        return density

    @property
    def activity(self) -> float:
        """G = int f . u_hat dS at unit phase rate, body held; f acts on the fluid outside."""
        return float(self.surface.moments[3].reshape(-1) @ self._outer[:, 6])

    @property
    def body_resistance(self) -> Array:
        """Share of the body alone in `raw_resistance`."""
        return self._body_wrenches[:, :6]

    @property
    def body_propulsion(self) -> Array:
        """Share of the body alone in `propulsion`; its torque drifts with the mesh at the joint."""
        return self._body_wrenches[:, 6]

    @property
    def rate(self) -> float:
        return float(self.swimmer.tail.rate)

    @property
    def free(self) -> tuple[bool, ...]:
        return tuple(self.swimmer.motion.mask)

    @cached_property
    def twist(self) -> Array:
        """Velocity V (6,) of the free swimmer at the motor's rate: R V = -F_p rate on the free
        axes.
        """
        free = np.flatnonzero(np.asarray(self.free))
        V = np.zeros(6)
        if free.size:
            R = self.resistance[np.ix_(free, free)]
            V[free] = -np.linalg.solve(R, self.propulsion[free]) * self.rate
        return V

    def combined(self, twist: Array | None = None, rate: float | None = None) -> Array:
        """Return density (3 e p^2,) for a twist (default: the free swimmer's) and a phase rate."""
        V = self.twist if twist is None else np.asarray(twist, float)
        return self.density @ np.append(V, self.rate if rate is None else rate)

    def traction(self, twist: Array | None = None, rate: float | None = None) -> Array:
        """Return the force per area by the surface on the fluid outside, at the collocation
        points, (e, p*p,
        3).

        Up to a constant pressure, which has no resultant.
        """
        V = self.twist if twist is None else np.asarray(twist, float)
        total = self._outer @ np.append(V, self.rate if rate is None else rate)
        return total.reshape(self.surface.nodes.shape)

    def wrench(
        self, part: str = "all", twist: Array | None = None, rate: float | None = None
    ) -> Array:
        """Return the force and torque (6,) by the fluid on `part` = "all", "body" or "tail"."""
        both = np.column_stack([self.raw_resistance, self.propulsion])
        body = self._body_wrenches
        parts = {"all": both, "body": body, "tail": both - body}
        V = self.twist if twist is None else np.asarray(twist, float)
        return -parts[part] @ np.append(V, self.rate if rate is None else rate)

    def stationary_wrench(self) -> tuple[float, float]:
        """Return the thrust and torque [Tabak Sec. 3.2.1] that the turning tail of the held
        swimmer exerts
        on the fluid.

        Returns
        -------
        thrust, torque : float
            Along s, by the tail on the fluid, at the motor's rate. The torque holds a share at the
            joint that grows with the logarithm of the mesh size.
        """
        wrench = -self.wrench("tail", twist=np.zeros(6))
        return float(wrench[0]), float(wrench[3])

    def velocity(
        self, points: Array, twist: Array | None = None, rate: float | None = None
    ) -> Array:
        """Return velocity (..., 3) of the fluid, at rest at infinity, at points of the frame sqr.

        Near the surface the same adaptive quadrature keeps it accurate; inside the swimmer it is
        the flow of the fluid that fills it.
        """
        points = np.asarray(points, float)
        flat = self.layer.velocity(points.reshape(-1, 3), self.combined(twist, rate))
        return flat.reshape(points.shape)

    def surface_velocity(self, twist: Array | None = None, rate: float | None = None) -> Array:
        """Return the velocity of the surface at the collocation points, (e, p*p, 3)."""
        V = self.twist if twist is None else np.asarray(twist, float)
        rate = self.rate if rate is None else rate
        return rigid_modes(self.surface.nodes, self.centre) @ V + self.surface.node_motion * rate

    def to_vtk(self, path: str | Path, side: int = 6) -> Path:
        """Write the surface with traction and velocity for ParaView, ``path`` with ``.vtp``."""
        return flow.write_surface(
            self.surface, self.traction(), self.surface_velocity(), path, side
        )

    def field_to_vtk(
        self, path: str | Path, low: Array, high: Array, counts: tuple[int, int, int]
    ) -> Path:
        """Write the fluid's velocity on a box of points for ParaView, ``path`` with ``.vti``."""
        return flow.write_field(self.velocity, path, low, high, counts)

    def picture(self, plane: str = "sq", **options: Any) -> Any:
        """Return matplotlib figure of the flow in a plane through the joint; see `flow.picture`."""
        units = self.swimmer.units
        return flow.picture(self.surface, self.velocity, units, plane, **options)


def solve(
    swimmer: Swimmer,
    phase: float = 0.0,
    *,
    level: str | Level = "standard",
    order: int | None = None,
    keep: bool = False,
) -> Solution:
    """Solve the Stokes equations about a swimmer with its tail at one phase.

    Parameters
    ----------
    swimmer : Swimmer
    phase : float
        Phase of the tail (rad).
    level : str
        "coarse", "standard" or "fine".
    order : int, optional
        Order p of the density on the level's patches.
    keep : bool
        Keep the factorised system, which takes as much memory as the solve.

    Raises
    ------
    SpecError
        If the geometry makes no sense, or the swimmer is in a channel.
    MicroswimError
        If the matrix does not fit into memory.
    """
    chosen = named(level, swimmer, order) if isinstance(level, str) else level
    start = time.perf_counter()
    body, tail = swimmer.body, swimmer.tail
    remarks = [] if tail.is_absent else rooting.check_all(body, tail, phase)
    surface = swimmer_surface(body, tail, phase, chosen.resolution)
    centre = np.asarray(body.centre, float)
    plane = _wall_beside(swimmer, surface, centre)
    if plane is not None:
        surface = refined(surface, over(plane))
    if swimmer.channel is not None:
        sides = chosen.resolution.vessel
        surface = in_tube(surface, swimmer.channel, middle_of(swimmer), sides)
    require_memory(surface.unknowns)
    layer = Layer(surface, float(swimmer.fluid.viscosity), chosen.rule, plane)
    modes = rigid_modes(surface.nodes, centre) * surface.on_swimmer[:, None, None, None]
    velocities = np.concatenate([modes, surface.node_motion[..., None]], axis=-1)
    meshed = time.perf_counter() - start
    solved = solve_density(layer, velocities, chosen.single)
    seconds = {"geometry": meshed, **solved.seconds}
    factors = solved.factors if keep else None
    return Solution(swimmer, phase, layer, solved.density, seconds, tuple(remarks), factors)


def middle_of(swimmer: Swimmer) -> Array:
    """Return the middle (3,) of the channel in the frame sqr."""
    assert swimmer.channel is not None
    tail = swimmer.tail
    tip = 0.0 if tail.is_absent else tail.reach + tail.radius
    nose = 2.0 * swimmer.body.semi_axes3[0] or float(tail.radius)
    own = np.array([0.5 * (tip - nose), 0.0, 0.0])
    return own - swimmer.channel.axes @ np.asarray(swimmer.channel.position)


def _wall_beside(swimmer: Swimmer, surface: Surface, centre: Array) -> Array | None:
    """Point and normal (6,) of the wall, if there is one, clear of the swimmer."""
    if swimmer.wall is None:
        return None
    swimmer.wall.check_clear(positions(surface, 9).reshape(-1, 3), centre)
    return swimmer.wall.plane(centre)
