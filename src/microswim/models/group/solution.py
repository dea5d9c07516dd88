"""The flow about several swimmers at one pose and phase: 6n x 6n resistance, n propulsions.

    R_ij = [force; torque] on swimmer i's frame of the rigid motions of swimmer j,
    F_ik = int_k f_i . u_hat_k dS,  f_i the density of rigid motion i      (Lorentz reciprocity)

Force and torque are by the surface on the fluid, about each body's centre, in each swimmer's axes.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from microswim.errors import SpecError
from microswim.gait.readable import percent
from microswim.models.bem.balance import balanced, turning_of
from microswim.models.bem.levels import get_level
from microswim.models.bem.output import write_surfaces
from microswim.models.bem.system import rigid_modes, wrench_rows
from microswim.models.bem.trust import DOUBTFUL, USELESS
from microswim.models.group.alone import Alone
from microswim.models.group.blocks import Blocks, placed, prepare
from microswim.models.group.coupled import Placed, solve_coupled
from microswim.models.group.motion import Motion, free_motion
from microswim.numerics.array import Array
from microswim.swimmer.group import Group
from microswim.swimmer.in_units import in_its_units


@dataclass(frozen=True, eq=False, kw_only=True)
class GroupSolution(Motion):
    """The flow about a group at its pose and phases.

    Parameters
    ----------
    group : Group
    alone : tuple of Alone
        Each swimmer by itself.
    placed : tuple of Placed
        The surfaces in the scene.
    density : (sum 3 e p^2, 7n)
        Columns: six rigid motions of the first swimmer, of the second, ..., then each tail at unit
        phase rate.
    gap : float
        Smallest distance between two swimmers, infinite for one alone.
    steps : int
        GMRES steps of the coupling.
    level : str
    seconds : float

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> found = ms.Group((ms.Member(swimmer=helix),)).solve(level="coarse")
    >>> found.flow([[50.0, 0.0, 0.0]]).shape, found.gap
    ((1, 3), inf)
    """

    group: Group
    alone: tuple[Alone, ...]
    placed: tuple[Placed, ...]
    density: Array
    gap: float
    steps: int
    level: str
    seconds: float

    @property
    def number(self) -> int:
        """Number of swimmers."""
        return len(self.placed)

    @property
    def rates(self) -> Array:
        """Phase rates (n,) of the motors (rad per time)."""
        return np.array([own.rate for own in self.alone])

    @property
    def unknowns(self) -> int:
        """Of all surfaces together."""
        return len(self.density)

    @cached_property
    def _parts(self) -> list[Array]:
        return np.split(self.density, np.cumsum([p.unknowns for p in self.placed])[:-1])

    @cached_property
    def _wrenches(self) -> Array:
        """Wrenches (6n, 7n) of all columns, scene's axes."""
        rows = [
            wrench_rows(p.surface, p.position) @ part
            for p, part in zip(self.placed, self._parts, strict=True)
        ]
        return np.concatenate(rows)

    @cached_property
    def _raw_resistance(self) -> Array:
        return self.turn.T @ self._wrenches[:, : 6 * self.number] @ self.turn

    @cached_property
    def resistance(self) -> Array:
        """R (6n, 6n), symmetric, in balance with `propulsion`; swimmers' axes."""
        each = [turning_of(p.surface, p.position) for p in self.placed]
        return balanced(self._raw_resistance, self.turn.T @ np.asarray(block_diag(*each)))

    @property
    def resistance_scene(self) -> Array:
        """R (6n, 6n) in the scene's axes."""
        return self.turn @ self.resistance @ self.turn.T

    @cached_property
    def asymmetry(self) -> float:
        """Largest |R_ij - R_ji| over sqrt(R_ii R_jj)."""
        R = self._raw_resistance
        scale = np.sqrt(np.abs(R.diagonal()))
        return float((np.abs(R - R.T) / np.outer(scale, scale)).max())

    @cached_property
    def propulsion(self) -> Array:
        """F (6n, n): wrench on the fluid at unit phase rate of each motor, all bodies held."""
        columns = [
            p.surface.moments[3].reshape(-1) @ part[:, : 6 * self.number]
            for p, part in zip(self.placed, self._parts, strict=True)
        ]
        return self.turn.T @ np.stack(columns, axis=-1)

    @cached_property
    def reciprocity(self) -> float:
        """Largest misfit of F from the tails' own densities, over sqrt(R_ii G_kk)."""
        raw = self.turn.T @ self._wrenches[:, 6 * self.number :]
        power = np.array([
            p.surface.moments[3].reshape(-1) @ part[:, 6 * self.number + k]
            for k, (p, part) in enumerate(zip(self.placed, self._parts, strict=True))
        ])  # fmt: skip
        scale = np.sqrt(np.outer(np.abs(self.resistance.diagonal()), np.abs(power)))
        beats = power != 0
        misfit = np.abs(raw - self.propulsion)[:, beats] / scale[:, beats]
        return float(misfit.max(initial=0.0))

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is extreme about the geometry, and what the solution says of its own error."""
        said = [r for own in self.alone for r in own.remarks]
        worst = max(self.asymmetry, self.reciprocity)
        if worst > DOUBTFUL:
            said.append(
                f"resistances are reciprocal only to {percent(worst)}: expect errors of that "
                "size; level fine tells more"
            )
        return tuple(dict.fromkeys(said))

    @cached_property
    def swimming_density(self) -> Array:
        """Density (sum 3 e p^2,) of the swimmers as they swim, scene's axes.

        At the velocities that leave no resultant of this density but the loads: far away a rest of
        the discretisation would outshine the swimmers' own flow.
        """
        raw = self.turn.T @ self._wrenches[:, 6 * self.number :]
        load = self.group.wrench - raw @ self.rates
        V = free_motion(self._raw_resistance, load, self.group.free)
        return self.density @ np.concatenate([self.turn @ V, self.rates])

    def flow(self, points: Any) -> Array:
        """Return velocity (..., 3) of the fluid, at rest at infinity, at points of the scene."""
        points = np.asarray(points, float)
        flat = np.ascontiguousarray(points.reshape(-1, 3))
        cuts = np.cumsum([p.unknowns for p in self.placed])[:-1]
        parts = np.split(self.swimming_density, cuts)
        total = np.zeros_like(flat)
        for p, f in zip(self.placed, parts, strict=True):
            # the nodes' own rule misses a share of the force that far away is all there is
            exact = replace(p.layer, rule=replace(p.layer.rule, far=np.inf), wall=self.group.plane)
            total += exact.velocity(flat, f)
        return total.reshape(points.shape)

    def to_vtk(self, path: str | Path, side: int = 6) -> Path:
        """Write the surfaces, each swimmer numbered, for ParaView, ``path`` with ``.vtp``."""
        return write_surfaces([p.surface for p in self.placed], path, side)


@in_its_units
def solve(group: Group, level: str = "standard", blocks: Blocks | None = None) -> GroupSolution:
    """Solve for the flow about a group at its pose and phases.

    Raises
    ------
    SpecError
        If swimmers overlap or are too near, or the resistance is not that of passive bodies.
    MachineError
        If the system does not fit into memory.
    """
    start = time.perf_counter()
    get_level(level)
    blocks = prepare(group, level) if blocks is None else blocks
    alone = tuple(blocks.of(m) for m in group.members)
    there, gap = placed(group, alone)
    density, steps = solve_coupled(there, _velocities(there), group.plane)
    seconds = time.perf_counter() - start
    found = GroupSolution(
        group=group,
        alone=alone,
        placed=tuple(there),
        density=density,
        gap=gap,
        steps=steps,
        level=blocks.level.name,
        seconds=seconds,
    )
    _check(found)
    return found


def _velocities(there: list[Placed]) -> list[Array]:
    """Return the velocities (n_i, 7n) at each surface's nodes: rigid motions, then tails."""
    n = len(there)
    columns = []
    for i, p in enumerate(there):
        u = np.zeros((p.unknowns, 7 * n))
        u[:, 6 * i : 6 * i + 6] = rigid_modes(p.surface.nodes, p.position).reshape(-1, 6)
        u[:, 6 * n + i] = p.surface.node_motion.reshape(-1)
        columns.append(u)
    return columns


def _check(found: GroupSolution) -> None:
    """Refuse a resistance that is not symmetric or not positive definite."""
    root = np.sqrt(np.abs(found.resistance.diagonal()))
    least = np.linalg.eigvalsh(found.resistance / np.outer(root, root)).min()
    if not least > 0.0 or max(found.asymmetry, found.reciprocity) > USELESS:
        raise SpecError(
            f"level = {found.level}: the resistance of these swimmers is not that of passive "
            "bodies; move them apart, or take level fine"
        )
