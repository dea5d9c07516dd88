"""Single layers of several surfaces in one system, solved by what each solves alone.

    sum_j 1/(8 pi mu) int_j G f_j dS = u_i  on surface i

Alone, surface i has the block B_i (`bem.system`, bordered against its own pressures), which turns
and moves with it: u -> Q u, f -> Q f. It is factorised once; at a new pose only the reach C_ij of
each surface at the nodes of the others is new,

    f_i + B_i^-1 sum_(j /= i) C_ij f_j = B_i^-1 u_i,

and GMRES takes few steps, since apart from the coupling the system is the identity. Beside a wall
C_ij holds the image of surface j [Blake 1971], also where i is j.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.bem.patches.surface import Surface
from microswim.models.bem.system import Factors, Layer
from microswim.numerics.array import Array
from microswim.numerics.gmres import gmres

#: Residual of the densities, and the most steps; spheres a hundredth of their radius apart
#: take 54.
TOLERANCE, STEPS = 1e-6, 60


@dataclass(frozen=True, eq=False)
class Block:
    """A surface by itself, in its own frame, with its factorised system.

    Parameters
    ----------
    layer : Layer
        The surface in free fluid.
    factors : Factors
        Of that layer.
    centre : (3,)
        Reference point, which is put at the pose's position.
    """

    layer: Layer
    factors: Factors
    centre: Array


@dataclass(frozen=True, eq=False)
class Placed:
    """A block at a pose: turned by `rotation` (3, 3) about its centre, which lies at `position`."""

    block: Block
    rotation: Array
    position: Array

    @cached_property
    def layer(self) -> Layer:
        """The layer in the frame of the scene."""
        own, Q = self.block.layer, self.rotation
        s = own.surface
        moved = replace(
            s,
            controls=np.ascontiguousarray((s.controls - self.block.centre) @ Q.T + self.position),
            motion=np.ascontiguousarray(s.motion @ Q.T),
        )
        return replace(own, surface=moved)

    @property
    def surface(self) -> Surface:
        return self.layer.surface

    @property
    def unknowns(self) -> int:
        return self.block.layer.surface.unknowns

    def alone(self, velocities: Array) -> Array:
        """Return the densities (n, k) of this surface alone for velocities (n, k), scene's axes."""
        Q = self.rotation
        return _turned(self.block.factors.solve(_turned(velocities, Q.T)), Q)


def _turned(values: Array, Q: Array) -> Array:
    """Return vectors (3 m, k) turned by Q."""
    return np.einsum("ab,nbk->nak", Q, values.reshape(-1, 3, values.shape[-1])).reshape(
        values.shape
    )


def couplings(placed: Sequence[Placed], wall: Array | None) -> list[list[Array | None]]:
    """Return C_ij, the reach of surface j at the nodes of surface i.

    Where i is j what a wall (point and normal, (6,)) sends back, None without one.
    """
    nodes = [np.ascontiguousarray(p.surface.nodes.reshape(-1, 3)) for p in placed]
    layers = [replace(p.layer, wall=wall) for p in placed]
    return [
        [
            None if i == j and wall is None else layer.reach(x, image_alone=i == j)
            for j, layer in enumerate(layers)
        ]
        for i, x in enumerate(nodes)
    ]


def solve_coupled(
    placed: Sequence[Placed], velocities: Sequence[Array], wall: Array | None = None
) -> tuple[Array, int]:
    """Solve for the densities of all surfaces.

    Parameters
    ----------
    placed : sequence of Placed
    velocities : sequence of (n_i, k)
        At the nodes of each surface, in the scene's axes.
    wall : (6,), optional
        Point and unit normal of a wall.

    Returns
    -------
    tuple
        Densities (sum n_i, k) in the scene's axes, surface after surface, and the steps it took.

    Raises
    ------
    MicroswimError
        If the steps do not suffice.
    """
    C = couplings(placed, wall)
    cuts = np.cumsum([p.unknowns for p in placed])[:-1]

    coupled = len(placed) > 1 or wall is not None

    def alone(parts: Sequence[Array]) -> Array:
        return np.concatenate([p.alone(u) for p, u in zip(placed, parts, strict=True)])

    def apply(x: Array) -> Array:
        f = np.split(x, cuts)
        pushed = [
            np.sum([c @ g for c, g in zip(row, f, strict=True) if c is not None], axis=0)
            for row in C
        ]
        return x + alone(pushed) if coupled else x

    density, steps, left = gmres(apply, alone(velocities), TOLERANCE, STEPS)
    if left > 100 * TOLERANCE:
        raise MicroswimError(
            f"the flow between the swimmers is not resolved: after {steps} steps a share of "
            f"{left:.1g} is left; they are too near each other for this level"
        )
    return density, steps
