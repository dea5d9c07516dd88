"""A group at a pose by the skeletons of its swimmers, where these are far enough apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from microswim.models.bem.balance import balanced
from microswim.models.group.alone import rotation_of_block
from microswim.models.group.blocks import Blocks, placed
from microswim.models.group.motion import Motion
from microswim.models.group.skeleton import Skeleton, point_forces
from microswim.models.group.solution import GroupSolution, solve
from microswim.numerics.array import Array
from microswim.numerics.gmres import gmres
from microswim.swimmer.group import Group

#: Residual of the velocities at the nodes, the most steps, and the asymmetry of R above which the
#: whole system is solved.
TOLERANCE, STEPS, ASYMMETRY = 1e-6, 60, 1e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class QuickSolution(Motion):
    """How a group moves at a pose and phases, by the skeletons of its swimmers.

    Parameters
    ----------
    group : Group
    resistance : (6n, 6n)
        Symmetric; swimmers' axes.
    propulsion : (6n, n)
    rates : (n,)
    gap : float
    """

    group: Group
    resistance: Array
    propulsion: Array
    rates: Array
    gap: float


def solve_quickly(group: Group, blocks: Blocks) -> QuickSolution | GroupSolution:
    """Solve for a group at a pose, by skeletons where they hold and by all nodes elsewhere.

    Raises
    ------
    SpecError
        As `solution.solve`.
    """
    alone = [blocks.of(m) for m in group.members]
    if group.wall is not None or len(alone) == 1 or not all(blocks.holds(m) for m in group.members):
        return solve(group, blocks=blocks)
    there, gap = placed(group, alone)
    same = all(p.block is own.block for p, own in zip(there, alone, strict=True))
    bones = [own.skeleton for own in alone] if same else []
    known = [b for b in bones if b is not None and gap >= b.distance]
    if len(known) < len(alone):
        return solve(group, blocks=blocks)
    whole = whole_of(group, known)
    n, root = len(alone), np.sqrt(np.abs(whole.diagonal()))
    root = np.where(root > 0.0, root, 1.0)
    rigid = np.arange(7 * n) % 7 < 6
    if (np.abs(whole - whole.T) / np.outer(root, root))[rigid][:, rigid].max() > ASYMMETRY:
        return solve(group, blocks=blocks)
    R, F = resistance_and_propulsion(whole, twists_of(group, known))
    return QuickSolution(
        group=group,
        resistance=R,
        propulsion=F,
        rates=np.array([own.rate for own in alone]),
        gap=gap,
    )


def resistance_and_propulsion(whole: Array, turning: Array) -> tuple[Array, Array]:
    """Return R (6n, 6n), symmetric, and F (6n, n) of wrenches and powers (7n, 7n).

    F by reciprocity from the powers that rigid motions take of the tails, and R in balance with it
    for the twists (6n, m) of the tails, as alone.
    """
    rigid = np.arange(len(whole)) % 7 < 6
    return balanced(whole[rigid][:, rigid], turning), whole[~rigid][:, rigid].T.copy()


def twists_of(group: Group, bones: Sequence[Skeleton]) -> Array:
    """Return the twists (6n, m) of the tails that turn rigidly, swimmers' axes."""
    turns = [m.rotation.T @ rotation_of_block(m) for m in group.members]
    each = [np.kron(np.eye(2), Q) @ b.turning for Q, b in zip(turns, bones, strict=True)]
    return np.asarray(block_diag(*each), dtype=float)


def whole_of(group: Group, bones: Sequence[Skeleton], tolerance: float = TOLERANCE) -> Array:
    """Return wrenches and powers (7n, 7n) of all rigid motions and tails, swimmers' axes."""
    n = len(bones)
    turns = [rotation_of_block(m) for m in group.members]
    cuts = np.cumsum([3 * len(b.nodes) for b in bones])
    G = _between(group, bones, turns)
    driven = [np.zeros((len(b.driven), 7 * n)) for b in bones]
    for i, b in enumerate(bones):
        driven[i][:, 7 * i : 7 * i + 7] = b.driven

    def flow(forces: Sequence[Array]) -> Array:
        return np.concatenate([
            np.sum([G[i, j] @ forces[j] for j in range(n) if j != i], axis=0) for i in range(n)
        ])  # fmt: skip

    def apply(v: Array) -> Array:
        parts = np.split(v, cuts[:-1])
        return v + flow([b.response @ x for b, x in zip(bones, parts, strict=True)])

    v, _, _ = gmres(apply, flow(driven), tolerance, STEPS)
    out, turn = np.zeros((7 * n, 7 * n)), np.eye(7 * n)
    for i, (b, x) in enumerate(zip(bones, np.split(v, cuts[:-1]), strict=True)):
        own = slice(7 * i, 7 * i + 7)
        out[own] = -b.wrench @ x
        out[own, own] += b.alone
        Q = group.members[i].rotation.T @ turns[i]
        turn[7 * i : 7 * i + 3, 7 * i : 7 * i + 3] = Q
        turn[7 * i + 3 : 7 * i + 6, 7 * i + 3 : 7 * i + 6] = Q
    return turn @ out @ turn.T


def _between(
    group: Group, bones: Sequence[Skeleton], turns: Sequence[Array]
) -> dict[tuple[int, int], Array]:
    """Return the flow at the nodes of i of point forces at those of j, each in its own axes."""
    scale = 1.0 / (8.0 * np.pi * group.viscosity)
    places = [np.array(m.position) for m in group.members]
    found = {}
    for i, here in enumerate(bones):
        for j, there in enumerate(bones):
            if i != j:
                Q = turns[i].T @ turns[j]
                y = there.nodes @ Q.T + (places[j] - places[i]) @ turns[i]
                found[i, j] = scale * point_forces(here.nodes, y, Q)
    return found
