"""A swimmer's answer to the flow of others, by a skeleton of its nodes.

A flow whose sources are a distance d away or more is on a surface nearly what some of its nodes say
of it, u = T v, and the surface's own flow out there nearly that of point forces g = W f at these
nodes [Ho Greengard 2012]. Alone f = B^-1 u; so of the coupled system (`coupled`) is left

    v_i - sum_(j /= i) G_ij (D_j - S_j v_j) = 0,   S = W B^-1 T,  D = W B^-1 U
    [R; F]_i = A_i - O_i v_i,                      O = L B^-1 T,  A = L B^-1 U

with U the six rigid motions and the tail's, L what integrates a density to force, torque and the
tail's power. S, D, O and A are made once; at a pose only G_ij, point forces between the nodes, is
new: a fifth of the cost of the whole system at `standard`. At 120 random poses from .13 extents on
R was within 1.2e-4 of that of all nodes, velocities within 1.3e-3 of the speeds (median 1e-4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq, qr
from scipy.spatial import KDTree

from microswim.models.bem.balance import turning_of
from microswim.models.bem.patches.surface import positions
from microswim.models.bem.system import rigid_modes, wrench_rows
from microswim.models.group.coupled import Block
from microswim.models.group.nearness import SIDE, Cloud
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import njit

#: The distance d from which a skeleton holds, of the swimmer's largest extent; the spacing of the
#: points around it that stand for all others, of d.
NEAREST, SPACING = 0.125, 0.45
#: Share of the largest flow that the nodes may leave out, smallest singular value of the fit of
#: point forces, and the misfit of those above which there is no skeleton.
LEFT_OUT, SMALLEST, MISFIT = 3e-4, 1e-5, 0.05
#: The same of a skeleton of few nodes.
FEW_LEFT_OUT, FEW_MISFIT = 0.06, 0.3
#: Sums of point forces that the nodes are chosen by, at most.
SUMS = 1200


@dataclass(frozen=True, eq=False)
class Skeleton:
    """What a swimmer answers to flows whose sources are at least so far from its surface.

    Parameters
    ----------
    distance : float
    nodes : (k, 3)
        From the block's centre, in the block's axes.
    response : (3k, 3k)
        S, of point forces to velocities at the nodes.
    driven : (3k, 7)
        D, point forces of the swimmer as it moves alone.
    wrench : (7, 3k)
        O, of force, torque and power to velocities at the nodes.
    alone : (7, 7)
        A.
    turning : (6, m)
        Twist at unit phase rate of a tail that turns rigidly, the block's axes; m is 1 or 0.
    """

    distance: float
    nodes: Array
    response: Array
    driven: Array
    wrench: Array
    alone: Array
    turning: Array


def skeleton_of(block: Block, few: bool = False) -> Skeleton | None:
    """Return the skeleton of a block, of `few` nodes; None if its nodes do not hold its flow."""
    left_out, misfit = (FEW_LEFT_OUT, FEW_MISFIT) if few else (LEFT_OUT, MISFIT)
    layer, s = block.layer, block.layer.surface
    nodes = s.nodes.reshape(-1, 3)
    distance = NEAREST * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    around = _around(Cloud(positions(s, SIDE)), distance)
    inward = point_forces(nodes, around) / (8.0 * np.pi * layer.viscosity)
    chosen, T = _chosen(inward, left_out)
    reach = layer.reach(around)
    outward = point_forces(around, nodes[chosen]) / (8.0 * np.pi * layer.viscosity)
    W = _fitted(outward, reach, SMALLEST)
    if np.abs(outward @ W - reach).max() > misfit * np.abs(reach).max():
        return None
    U = np.concatenate(
        [rigid_modes(s.nodes, block.centre).reshape(-1, 6), s.node_motion.reshape(-1, 1)], axis=1
    )
    L = np.concatenate([wrench_rows(s, block.centre), s.moments[3].reshape(1, -1)])
    density = block.factors.solve(np.concatenate([T, U], axis=1))
    k = T.shape[1]
    return Skeleton(
        distance=distance,
        nodes=nodes[chosen] - block.centre,
        response=W @ density[:, :k],
        driven=W @ density[:, k:],
        wrench=L @ density[:, :k],
        alone=L @ density[:, k:],
        turning=turning_of(s, block.centre),
    )


def _around(cloud: Cloud, distance: float) -> Array:
    """Return points (m, 3) all around a surface at a distance."""
    on = cloud.patches.reshape(-1, 3)
    off = on + distance * cloud.normals.reshape(-1, 3)
    off = off[KDTree(on).query(off)[0] > 0.95 * distance]
    off = off[np.random.default_rng(0).permutation(len(off))]
    tree, kept = KDTree(off), np.ones(len(off), bool)
    for n, point in enumerate(off):
        if kept[n]:
            near = np.array(tree.query_ball_point(point, SPACING * distance))
            kept[near[near > n]] = False
    return np.ascontiguousarray(off[kept])


def _chosen(inward: Array, left_out: float) -> tuple[NDArray[np.int64], Array]:
    """Return nodes (k,) that say most of flows (3n, m), and how all follow from them, (3n, 3k)."""
    if inward.shape[1] > SUMS:
        mixed = np.random.default_rng(1).normal(size=(inward.shape[1], SUMS))
        inward = inward @ (mixed / np.sqrt(SUMS))
    made: Any = qr(inward.T, mode="r", pivoting=True)
    size, order = np.abs(made[0].diagonal()), made[1]
    chosen = np.unique(order[: int((size > left_out * size[0]).sum())] // 3)
    rows = (3 * chosen[:, None] + np.arange(3)).ravel()
    return chosen, _fitted(inward[rows].T, inward.T, 1e-10).T


def _fitted(A: Array, b: Array, smallest: float) -> Array:
    """Return x with the least ``|A x - b|``, without what A drives less than that share of."""
    found: Any = lstsq(A, b, cond=smallest, lapack_driver="gelsy")
    return np.asarray(found[0])


def point_forces(x: Array, y: Array, turn: Array | None = None) -> Array:
    """Return velocities (3n, 3m) at x (n, 3) of forces at y (m, 3), without 1/(8 pi mu).

    The forces' axes are turned by `turn` (3, 3) against those of x, y and the velocities.
    """
    out = np.empty((3 * len(x), 3 * len(y)))
    _fill(x, y, np.eye(3) if turn is None else np.ascontiguousarray(turn), out)
    return out


@njit(cache=True, nogil=True)
def _fill(x, y, turn, out):
    block = np.empty((3, 3))
    for a in range(x.shape[0]):
        for b in range(y.shape[0]):
            d0, d1, d2 = x[a, 0] - y[b, 0], x[a, 1] - y[b, 1], x[a, 2] - y[b, 2]
            i1 = 1.0 / np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
            i3 = i1 * i1 * i1
            block[0, 0], block[1, 1], block[2, 2] = (
                i1 + i3 * d0 * d0,
                i1 + i3 * d1 * d1,
                i1 + i3 * d2 * d2,
            )
            block[0, 1], block[0, 2], block[1, 2] = i3 * d0 * d1, i3 * d0 * d2, i3 * d1 * d2
            block[1, 0], block[2, 0], block[2, 1] = block[0, 1], block[0, 2], block[1, 2]
            for i in range(3):
                for j in range(3):
                    out[3 * a + i, 3 * b + j] = (
                        block[i, 0] * turn[0, j]
                        + block[i, 1] * turn[1, j]
                        + block[i, 2] * turn[2, j]
                    )
