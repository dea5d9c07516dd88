"""What the magnets of several swimmers feel: a field from outside, and one another as dipoles.

    m = m_0 + S B,   torque m x (B + B'),   force (grad B + grad B')' m

with B from outside and B' of the other magnets, each at its body's centre. A soft magnet (S) is
magnetised by the field from outside alone. The dipoles need SI, since mu_0 is in them: swimmers
without units feel the field alone. Scene's axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.magnetism.field_in_space import dipole, dipole_gradient
from microswim.swimmer.magnetism.magnet import magnetic_of

if TYPE_CHECKING:
    from microswim.swimmer.magnetism.applied_field import AppliedField
    from microswim.swimmer.member import Member


def are_magnetic(members: Sequence[Member]) -> bool:
    """Return whether a magnet is among the swimmers."""
    return any(m.swimmer.magnet is not None for m in members)


def wrenches(members: Sequence[Member], field: AppliedField | None, time: float) -> Array:
    """Return force and torque (n, 6) on each body, about its centre.

    Parameters
    ----------
    members
        Swimmers at their poses.
    field
        From outside, if any.
    time
        At which it is asked.
    """
    p, B, J = _felt(members, field, time)
    return np.concatenate([np.einsum("nij,ni->nj", J, p), np.cross(p, B)], axis=1)


def largest_torques(members: Sequence[Member], field: AppliedField | None, time: float) -> Array:
    """Return the torque (n,) on each body, were its moment across the field that it feels."""
    p, B, _ = _felt(members, field, time)
    return np.linalg.norm(p, axis=1) * np.linalg.norm(B, axis=1)


def _felt(
    members: Sequence[Member], field: AppliedField | None, time: float
) -> tuple[Array, Array, Array]:
    """Return moments (n, 3), what they feel of B (n, 3) and its gradient (n, 3, 3)."""
    x = np.array([m.position for m in members])
    B, J = _from_outside(field, time, x)
    p = _moments(members, B)
    if members[0].swimmer.units == "SI":
        b, j = _of_the_others(p, x)
        return p, B + b, J + j
    return p, B, J


def _from_outside(field: AppliedField | None, time: float, places: Array) -> tuple[Array, Array]:
    """Return B (n, 3) and ``dB_i/dx_j`` (n, 3, 3) of a field at places (n, 3)."""
    n = len(places)
    if field is None:
        return np.zeros((n, 3)), np.zeros((n, 3, 3))
    each: Any = (field.at(time, places), field.gradient(time, places))
    return np.broadcast_to(each[0], (n, 3)), np.broadcast_to(each[1], (n, 3, 3))


def _moments(members: Sequence[Member], B: Array) -> Array:
    """Return the moments (n, 3) of the swimmers' magnets in fields (n, 3), zero without one."""
    Q = np.array([m.rotation for m in members])
    magnets = np.array([magnetic_of(m.swimmer.magnet) for m in members])
    inner = np.einsum("nji,nj->ni", Q, B)
    own = magnets[:, :3] + np.einsum("nij,nj->ni", magnets[:, 3:].reshape(-1, 3, 3), inner)
    return np.einsum("nij,nj->ni", Q, own)


def _of_the_others(p: Array, x: Array) -> tuple[Array, Array]:
    """Return B (n, 3) and its gradient (n, 3, 3) at each dipole by all others."""
    n = len(p)
    B, J = np.zeros((n, 3)), np.zeros((n, 3, 3))
    strong = np.flatnonzero(p.any(axis=1))
    for i in strong:
        others = strong[strong != i]
        away = x[i] - x[others]
        B[i] = dipole(p[others], away).sum(axis=0)
        J[i] = dipole_gradient(p[others], away).sum(axis=0)
    return B, J
