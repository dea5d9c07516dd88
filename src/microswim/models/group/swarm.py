"""Many swimmers in one fluid, each seen from afar: velocities of all in one sum.

    V_i = V_i(W_i) + A_i (u, grad u)(x_i),   u of the forces, dipoles and near quadrupoles of others

What each is alone comes from `from_afar`; the flow that comes back is left out, and what is told of
a near neighbour ends with its quadrupole. Motors are out of step: each swimmer meets the others'
averages over their periods. Where a neighbour's centre is nearer than the swimmer is long the terms
say nothing; their share falls with the fifth power of the distance, so that none grows without
bound, and the swimmer counts as one that is not known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from microswim.errors import SpecError
from microswim.models.bem.gait import turns_as_a_whole
from microswim.models.group.from_afar import FromAfar, from_afar
from microswim.models.group.singularities import flow, flow_of_pairs, flow_of_quadrupoles
from microswim.numerics.array import Array
from microswim.swimmer.group import Group
from microswim.swimmer.member import about_s, towards
from microswim.swimmer.surroundings import weight
from microswim.swimmer.swimmer import Swimmer

#: Sizes of a swimmer within which neighbours' quadrupoles count.
NEAR = 8.0
#: Phases that the arm of a weight is averaged over.
OVER = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)


@dataclass(frozen=True, eq=False)
class Swarm:
    """Swimmers of a few kinds, seen from afar.

    Parameters
    ----------
    kinds : sequence of FromAfar
    kind : (n,)
        Which of them each swimmer is.
    wrench : (n, 6)
        External force and torque, in the scene's axes.
    down, levers : (3,), (n, 3)
        Acceleration of gravity, in the scene's axes, and what it pulls at, mass beyond the fluid's
        times its arm, in the swimmers'; the weights are in `wrench`.
    viscosity : float
        Of the fluid.
    signs : (n,)
        In which sense the tails turn as their phases grow.
    """

    kinds: Sequence[FromAfar]
    kind: Array
    wrench: Array
    down: Array
    levers: Array
    viscosity: float
    signs: Array

    @cached_property
    def rates(self) -> Array:
        """Phase rates of the motors (n,)."""
        return self._each([k.rate for k in self.kinds])

    def _each(self, of_kinds: Sequence[Any]) -> Array:
        """Return what is given for each kind for each swimmer."""
        return np.asarray(of_kinds)[self.kind.astype(int)]

    def along_paths(self, Q: Array, phases: Array) -> Array:
        """Return rotations (n, 3, 3) with s along the mean paths of swimmers at rotations Q.

        The axis of a helix' screw turns with its phase.
        """
        axes = self._each([k.axis for k in self.kinds])
        turned = [about_s(a) @ n for a, n in zip(self.signs * phases, axes, strict=True)]
        return Q @ np.array([towards(n) for n in turned])

    @cached_property
    def size(self) -> float:
        """Size of the largest swimmer."""
        return max(k.size for k in self.kinds)

    def velocity(self, X: Array, Q: Array) -> tuple[Array, Array, float]:
        """Return velocities (n, 6) in the swimmers' axes, errors (n,), the smallest distance.

        An error is a share of the swimmer's speed: of what the last term kept gives.

        Parameters
        ----------
        X, Q
            Bodies' centres (n, 3) and rotations (n, 3, 3) to the scene's axes.
        """
        V, F, D, quadrupoles = self._alone(Q)
        pairs = KDTree(X).query_pairs(NEAR * self.size, output_type="ndarray")
        apart = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
        close, share = apart < self.size, np.minimum(apart / self.size, 1.0) ** 5
        u, g = flow(X, F, D, self.viscosity)
        over = flow_of_pairs(X, F, D, pairs[close], share[close] - 1.0, self.viscosity)
        ends = self._answer(Q, *flow_of_quadrupoles(X, quadrupoles, pairs, share, self.viscosity))
        error = self._errors(V, ends)
        error[pairs[close]] = 1.0
        nearest = float(apart.min()) if len(apart) else float("inf")
        return V + self._answer(Q, u + over[0], g + over[1]) + ends, error, nearest

    def _errors(self, V: Array, ends: Array) -> Array:
        """Return of which share of each velocity the last term kept is (n,)."""
        own = np.linalg.norm(V[:, :3], axis=1)
        speed = np.where(own > 0.0, own, own.max())
        moved = np.linalg.norm(ends[:, :3], axis=1)
        turned = self.size * np.linalg.norm(ends[:, 3:], axis=1)
        off = np.maximum(moved, turned)
        return np.divide(off, speed, out=np.zeros_like(off), where=speed > 0.0)

    def _alone(self, Q: Array) -> tuple[Array, ...]:
        """Return velocities in the swimmers' axes, forces, dipoles and quadrupoles in the scene's,
        of swimmers without neighbours.
        """
        n = len(Q)
        V, F, D, last = np.zeros((n, 6)), *(np.zeros((n, *m * (3,))) for m in (1, 2, 3))
        load = np.ones((n, 7))
        load[:, :3] = np.einsum("nji,nj->ni", Q, self.wrench[:, :3])
        load[:, 3:6] = np.einsum("nji,nj->ni", Q, self.wrench[:, 3:])
        load[:, 3:6] += np.cross(self.levers, self.down @ Q)
        for k, one in enumerate(self.kinds):
            r = self.kind == k
            q, w = Q[r], load[r]
            V[r] = w @ one.motion.T
            F[r] = np.einsum("nja,aw,nw->nj", q, one.force, w, optimize=True)
            D[r] = np.einsum("nja,nkb,abw,nw->njk", q, q, one.dipole, w, optimize=True)
            own = np.einsum("abcw,nw->nabc", one.quadrupole, w)
            last[r] = np.einsum("nja,nkb,nlc,nabc->njkl", q, q, q, own, optimize=True)
        return V, F, D, last

    def _answer(self, Q: Array, u: Array, g: Array) -> Array:
        """Return velocities (n, 6) in the swimmers' axes in a flow of the scene."""
        seen = np.empty((len(Q), 3, 4))
        seen[:, :, 0] = np.einsum("nij,ni->nj", Q, u)
        seen[:, :, 1:] = np.einsum("nia,nik,nkb->nab", Q, g, Q, optimize=True)
        out = np.empty((len(Q), 6))
        for k, one in enumerate(self.kinds):
            r = self.kind == k
            out[r] = np.einsum("sjk,njk->ns", one.response, seen[r])
        return out


def swarm(group: Group, level: str = "standard") -> Swarm:
    """Return the swimmers of a group seen from afar.

    Raises
    ------
    SpecError
        Beside a wall.
    """
    if group.wall is not None:
        raise SpecError('wall: model = "far" knows free fluid alone; remove the wall')
    swimmers = {id(m.swimmer): m.swimmer for m in group.members}
    order = {key: k for k, key in enumerate(swimmers)}
    heavy = [s.gravity.vector for s in swimmers.values() if s.gravity is not None]
    pulls = [weight.pull(s) for s in swimmers.values()]
    levers = [_lever(s) for s in swimmers.values()]
    kind = np.array([order[id(m.swimmer)] for m in group.members])
    wrench = np.array([[*m.force, *m.torque] for m in group.members])
    wrench[:, :3] += np.array(pulls)[kind]
    return Swarm(
        kinds=[from_afar(s, level) for s in swimmers.values()],
        kind=kind,
        wrench=wrench,
        down=heavy[0] if heavy else np.zeros(3),
        levers=np.array(levers)[kind],
        viscosity=float(group.viscosity),
        signs=np.array([m.swimmer.tail.sign for m in group.members]),
    )


def _lever(swimmer: Swimmer) -> Array:
    """Return what a weight pulls at (3,), on average: of what turns about s, along s alone."""
    mean = weight.arm(swimmer, OVER).mean(axis=0)
    return mean * [1.0, 0.0, 0.0] if turns_as_a_whole(swimmer) else mean
