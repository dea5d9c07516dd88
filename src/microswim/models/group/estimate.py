"""What swimmers do to each other from afar: each a cloud of point forces, coupled once.

    R_ij = - H_i' G_ij H_j,   G_ij = (I/r + r r/r^3)/(8 pi mu),   i /= j

H_i (3 b, 7) are the forces of the patches of swimmer i alone, in its six rigid motions and its
tail's: by reciprocity what the flow of j does to i is what the forces of i say of it. Swimmers'
own blocks stay as they are alone. What is left out is the flow that comes back, of the order

    e^2,   e the norm of L_i^-1 R_ij L_j^-T,  R_ii = L_i L_i'

which is the error that is stated; where it is not small the pair is solved by few nodes of each
(`near_pairs`), and a share of it is left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim.errors import SpecError
from microswim.models.bem.levels import get_level
from microswim.models.group.alone import Alone, rotation_of_block
from microswim.models.group.blocks import Blocks, prepare
from microswim.models.group.motion import Motion
from microswim.models.group.near_pairs import corrected
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import njit
from microswim.swimmer.group import Group
from microswim.swimmer.in_units import in_its_units
from microswim.swimmer.member import Member


@dataclass(frozen=True, eq=False, kw_only=True)
class GroupEstimate(Motion):
    """How a group moves at its pose and phases, by point forces of each swimmer alone.

    Parameters
    ----------
    resistance : (6n, 6n)
        Symmetric; swimmers' axes.
    propulsion : (6n, n)
    rates : (n,)
    expected_error : float
        Of the velocities, a share of each swimmer's speed: what is left out of what comes back,
        and by how much the level misses reciprocity.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> beside = ms.Member(swimmer=helix, position=(0, 8, 0))
    >>> pair = ms.Group((ms.Member(swimmer=helix), beside))
    >>> blocks = pair.prepared("coarse")
    >>> quick, true = pair.estimate(blocks=blocks), pair.solve(blocks=blocks)
    >>> off = abs(quick.velocity - true.velocity).max() / abs(true.velocity).max()
    >>> bool(off < quick.expected_error < 0.02)
    True
    """

    group: Group
    resistance: Array
    propulsion: Array
    rates: Array
    expected_error: float


@in_its_units
def estimate(group: Group, level: str = "standard", blocks: Blocks | None = None) -> GroupEstimate:
    """Return how a group moves at its pose and phases, by point forces of each swimmer alone.

    Raises
    ------
    SpecError
        Beside a wall.
    """
    get_level(level)
    if group.wall is not None:
        raise SpecError("wall: an estimate knows free fluid alone; use solve, or remove the wall")
    blocks = prepare(group, level) if blocks is None else blocks
    alone = [blocks.of(m) for m in group.members]
    points = [_points(m, own) for m, own in zip(group.members, alone, strict=True)]
    n = len(alone)
    R, F = np.zeros((n, 6, n, 6)), np.zeros((n, 6, n))
    for i, (member, own) in enumerate(zip(group.members, alone, strict=True)):
        Q = _six(member.rotation.T @ rotation_of_block(member))
        R[i, :, i], F[i, :, i] = Q @ own.resistance @ Q.T, Q @ own.propulsion
    for i in range(n):
        for j in range(i):
            K = np.zeros((7, 7))
            coupled(*points[i], *points[j], K)
            K /= 8.0 * np.pi * group.viscosity
            Qi, Qj = _six(group.members[i].rotation.T), _six(group.members[j].rotation.T)
            R[i, :, j] = -Qi @ K[:6, :6] @ Qj.T
            R[j, :, i] = R[i, :, j].T
            F[i, :, j], F[j, :, i] = -Qi @ K[:6, 6], -Qj @ K[6, :6]
    R, F, left = corrected(group, alone, R, F, _returned(R))
    return GroupEstimate(
        group=group,
        resistance=R.reshape(6 * n, 6 * n),
        propulsion=F.reshape(6 * n, n),
        rates=np.array([own.rate for own in alone]),
        expected_error=float(left.sum()) + max(own.misfit for own in alone),
    )


def _returned(R: Array) -> Array:
    """Return twice the squares (n, n) of the couplings of R (n, 6, n, 6) above the diagonal, which
    bound what comes back.
    """
    n = len(R)
    inverse = [np.linalg.inv(np.linalg.cholesky(R[i, :, i])) for i in range(n)]
    found = np.zeros((n, n))
    for i in range(n):
        for j in range(i):
            found[j, i] = 2.0 * np.linalg.norm(inverse[i] @ R[i, :, j] @ inverse[j].T, 2) ** 2
    return found


def _six(Q: Array) -> Array:
    six = np.zeros((6, 6))
    six[:3, :3] = six[3:, 3:] = Q
    return six


def _points(member: Member, own: Alone) -> tuple[Array, Array]:
    """Return places (b, 3) and forces (b, 3, 7) of the patches, all in the scene's axes."""
    (X, H), Q = own.points, rotation_of_block(member)
    turned = np.einsum("ab,ebk->eak", Q, H)
    turned[..., :6] = turned[..., :6] @ _six(Q).T
    return X @ Q.T + np.array(member.position), np.ascontiguousarray(turned)


@njit(cache=True, fastmath=True)
def coupled(X, H, Y, J, out):
    """Add H' G J (7, 7) over all pairs of points X (n, 3) and Y (m, 3); G without 1/(8 pi mu)."""
    u = np.empty((3, 7))
    for a in range(X.shape[0]):
        u[:] = 0.0
        for b in range(Y.shape[0]):
            x, y, z = X[a, 0] - Y[b, 0], X[a, 1] - Y[b, 1], X[a, 2] - Y[b, 2]
            i1 = 1.0 / np.sqrt(x * x + y * y + z * z)
            i3 = i1 * i1 * i1
            for k in range(7):
                along = i3 * (x * J[b, 0, k] + y * J[b, 1, k] + z * J[b, 2, k])
                u[0, k] += i1 * J[b, 0, k] + along * x
                u[1, k] += i1 * J[b, 1, k] + along * y
                u[2, k] += i1 * J[b, 2, k] + along * z
        for l in range(7):
            for k in range(7):
                out[l, k] += H[a, 0, l] * u[0, k] + H[a, 1, l] * u[1, k] + H[a, 2, l] * u[2, k]
