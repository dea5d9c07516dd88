"""Balance of a rod in space that turns as a whole about s, by virtual work.

The directors ``d_1, d_2, t`` of a section follow the curvatures and the twist, ``d_i' = u x d_i``,
``u = k_1 d_1 + k_2 d_2 + k_3 t``, each strain a Legendre series. A coordinate k turns the sections
at ``phi_k(s) = int_0^s d_k p_k`` and moves them at ``X_k(s) = int_0^s phi_k x t``. Drag is that of
the plane, and a section that spins about its tangent feels the torque ``c_r t (t . w)`` per
length. Of every velocity the work vanishes,

    sum_i X_i . f + phi_i . m + R_b + K_i q_i = 0,

and with the force ``N`` and moment ``M`` of the drag beyond s its derivative by a coordinate needs
no other integrals: ``phi_k . (d_i x M) p_i + phi_i . ((phi_k x t) x N) + X_i . df + phi_i . dm``.
Leading axes of the arrays are poses side by side. Units are those of `plane`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim.models.elastic.filament import Filament
from microswim.numerics.rigid_motion import skew

AXIS = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class DragInSpace:
    """Resistances of rod and body, in units of ``B / L^2`` per ``w L``.

    Parameters
    ----------
    tangential, normal, spin
        Per unit length: along, across, and torque of spin (over ``L^2``).
    tip
        Of the free end, in all directions.
    body
        Of the body about its centre, (6, 6).
    offset
        Of the joint from the body's centre.
    free
        Which of the body's velocities are free.
    """

    tangential: float
    normal: float
    spin: float
    tip: float
    body: np.ndarray
    offset: float
    free: tuple[int, ...]

    def along(self, rod: Filament) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the tangential, normal and spinning resistance of each node."""
        W_t, W_n = (c * rod.weight + self.tip * rod.end for c in (self.tangential, self.normal))
        return W_t, W_n, self.spin * rod.weight


@dataclass(frozen=True, eq=False)
class Pose:
    """A rod in space: directors (..., m, 3, 3) as rows ``d_1, d_2, t``, places from the joint (...,
    m, 3).
    """

    directors: np.ndarray
    place: np.ndarray


@dataclass(frozen=True, eq=False)
class BalanceInSpace:
    """Work of each velocity (f + 3 n,), and its derivatives by velocities and coordinates."""

    residual: np.ndarray
    resistance: np.ndarray
    stiffness: np.ndarray


def pose(rod: Filament, q: np.ndarray, base: np.ndarray | None = None) -> Pose:
    """Return directors and places for the coordinates (..., 3, n); base directors (..., 3, 3) as at
    rest, or so.
    """
    m, strain = len(rod.s), rod.curvatures @ swap(q)  # (..., m, 3)
    K = np.zeros((*strain.shape, 3), dtype=strain.dtype)  # rows of directors: D' = K D
    K[..., 0, 1], K[..., 0, 2] = strain[..., 2], -strain[..., 1]
    K[..., 1, 2] = strain[..., 0]
    K = np.swapaxes(K - swap(K), -3, -2)[..., None, :, :, :]  # (..., 1, 3, m, 3)
    size = 3 * m
    system = np.eye(size) - (rod.turns[:, None, :, None] * K).reshape(*q.shape[:-2], size, size)
    given = np.broadcast_to(
        np.tile(rod.base if base is None else base, (m, 1)), (*q.shape[:-2], size, 3)
    )
    directors = np.linalg.solve(system, given).reshape(*q.shape[:-2], m, 3, 3)
    return Pose(directors, rod.along @ heading(rod, directors))


def heading(rod: Filament, directors: np.ndarray) -> np.ndarray:
    """Return where the filament goes on from each node, (..., m, 3): along its tangent, but an
    arm.
    """
    return dots(rod.heading, directors)


def balance_in_space(
    rod: Filament, drag: DragInSpace, at: Pose, q: np.ndarray, V: np.ndarray, rate: float
) -> BalanceInSpace:
    """Return the balance of a rod at rest in axes that turn about s.

    Parameters
    ----------
    q
        Coordinates (3, n): two curvatures and the twist.
    V
        All velocities of the body (6,), in these axes.
    rate
        Of the turning relative to the body, in units of the phase rate.
    """
    given = (drag.normal, drag.tangential, drag.spin, drag.tip, drag.body, drag.offset)
    q = q.astype(np.result_type(q, V, at.place, rod.stiffness, rod.rest, *given))
    at = Pose(at.directors.astype(q.dtype), at.place.astype(q.dtype))
    t = at.directors[:, 2]
    X = at.place + drag.offset * AXIS
    phi, moved = shapes_of(rod, at)  # (m, 3, 3 n) each
    rigid_phi, rigid = rigid_motions(X, drag.free)
    turn, shift = np.concatenate([rigid_phi, phi], 2), np.concatenate([rigid, moved], 2)

    whole = V[3:] + rate * AXIS
    v = V[:3] + cross(V[3:], X) + rate * cross(AXIS, at.place)
    W_t, W_n, W_r = drag.along(rod)
    extra = W_t - W_n
    along, spin = (t * v).sum(axis=1), t @ whole
    f = W_n[:, None] * v + (extra * along)[:, None] * t
    m = (W_r * spin)[:, None] * t
    residual = flat(shift).T @ f.ravel() + flat(turn).T @ m.ravel()
    free, count = list(drag.free), len(drag.free)
    own = drag.body[free]
    K = rod.stiffness.ravel()
    residual[:count] += own @ V
    residual[count:] += K * (q - rod.rest).ravel()

    tangent, spun = (dots(t, c) for c in (shift, turn))  # (m, f + 3 n)
    R = flat(shift).T @ flat(W_n[:, None, None] * shift)
    R += tangent.T @ (extra[:, None] * tangent) + spun.T @ (W_r[:, None] * spun)
    R[:count, :count] += own[:, free]

    dt = cross_columns(phi, t[..., None])
    dv = crossed(whole, moved)
    d_along = dots(v, dt) + dots(t, dv)
    df = W_n[:, None, None] * dv + (
        (extra[:, None] * d_along)[:, None] * t[..., None] + (extra * along)[:, None, None] * dt
    )
    d_spin = dots(whole, dt)
    dm = (W_r[:, None] * d_spin)[:, None] * t[..., None] + (W_r * spin)[:, None, None] * dt
    G = flat(shift).T @ flat(df) + flat(turn).T @ flat(dm)
    G += as_it_bends(rod, at, (phi, moved), (f, m), drag.free)
    G[count:] += np.diag(K)
    return BalanceInSpace(residual, R, G)


def as_it_bends(
    rod: Filament, at: Pose, by: tuple[np.ndarray, np.ndarray],
    of: tuple[np.ndarray, np.ndarray], free: tuple[int, ...],
) -> np.ndarray:  # fmt: skip
    """Return how the work of forces that stay changes by the coordinates, (..., f + 3 n, 3 n).

    Parameters
    ----------
    by
        ``phi_k`` and ``X_k``, (..., m, 3, 3 n) each.
    of
        Force and torque on each node, (..., m, 3) each.
    """
    (phi, moved), (f, m), n, count = by, of, rod.count, len(free)
    ahead = heading(rod, at.directors)
    kind = np.result_type(phi, f, m)
    G = np.zeros((*phi.shape[:-3], count + 3 * n, 3 * n), dtype=kind)
    N = rod.along.T @ f
    M = rod.turns.T @ (cross(ahead, N) + m)
    d_ahead = cross_columns(phi, ahead[..., None])
    G[..., count:, :] += swap(flat(phi)) @ flat(cross_columns(d_ahead, N[..., None]))
    for i in range(3):  # phi_k . (d_i x M) p_i
        bent = dots(cross(at.directors[..., i, :], M), phi)
        G[..., count + i * n : count + (i + 1) * n, :] += rod.curvatures.T @ bent
    arms = cross_columns(moved, f[..., None]).sum(axis=-3)  # torque as the points move
    turning = [i for i, name in enumerate(free) if name >= 3]
    G[..., turning, :] += arms[..., [free[i] - 3 for i in turning], :]
    return G


def shapes_of(rod: Filament, at: Pose) -> tuple[np.ndarray, np.ndarray]:
    """Return ``phi_k`` and ``X_k`` of each coordinate at the nodes, (..., m, 3, 3 n)."""
    m, n = rod.curvatures.shape
    directors = swap(at.directors)[..., None]  # (..., m, 3, director, 1)
    whole = (*directors.shape[:-4], m, 3, 3 * n)
    phi = summed(rod.turns, (directors * rod.curvatures[:, None, None]).reshape(whole))
    speed = cross_columns(phi, heading(rod, at.directors)[..., None])
    return phi, summed(rod.along, speed)


def rigid_motions(X: np.ndarray, free: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return the same of the body's free velocities, (..., m, 3, f)."""
    turn, shift = np.zeros((2, *X.shape, 6), dtype=X.dtype)
    turn[..., 3:] = np.eye(3)
    shift[..., :3] = np.eye(3)
    shift[..., 3:] = swap(skew(X))
    return turn[..., list(free)], shift[..., list(free)]


def worked(moves: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return the work (..., k) of forces (..., m, 3) by each column of moves (..., m, 3, k)."""
    return (swap(flat(moves)) @ flat(force[..., None]))[..., 0]


def flat(a: np.ndarray) -> np.ndarray:
    """Return nodes and components in one row, (..., 3 m, k)."""
    return a.reshape(*a.shape[:-3], -1, a.shape[-1])


def swap(a: np.ndarray) -> np.ndarray:
    """Return the transpose of the last two axes."""
    return np.swapaxes(a, -1, -2)


def summed(along: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Return integrals (k, m) over the nodes of columns of vectors (..., m, 3, n)."""
    m, three, n = a.shape[-3:]
    return (along @ a.reshape(*a.shape[:-3], m, three * n)).reshape(*a.shape[:-3], -1, three, n)


def dots(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the scalar products of vectors (..., 3) and columns of vectors (..., 3, k)."""
    x, y, z = (a[..., i, None] * b[..., i, :] for i in range(3))
    return x + y + z


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the vector product over the last axis."""
    x, y, z, u, v, w = (c[..., i] for c in (a, b) for i in range(3))
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def cross_columns(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the vector product over the axis of components, the last but one."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape), np.result_type(a, b))
    x, y, z, u, v, w = (c[..., i, :] for c in (a, b) for i in range(3))
    out[..., 0, :], out[..., 1, :] = y * w - z * v, z * u - x * w
    out[..., 2, :] = x * v - y * u
    return out


def crossed(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the vector products of vectors (..., 3) and columns of vectors (..., 3, k)."""
    return cross_columns(a[..., None], b)
