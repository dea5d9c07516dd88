"""Balance of a rod in the plane s-q, by virtual work: no tension, no shear force to solve for.

Velocities ``w = (V, dq/dphi)``, V the free velocities of the body, move a point X of the rod at
``v = sum_j J_j w_j + v_d``, v_d by the drive. With drag ``f = (c_t t t' + c_n n n') v`` along the
rod and R_b of the body every velocity w_i does no work,

    sum_j M_ij w_j + M_id + K_i (q_i - q_i^0) = int J_i . p ds,    M_ij = int J_i . f(J_j) ds + R_b,

which is Onsager's principle of least dissipation. Lengths are in L, forces in ``B / L^2``, time in
phase; drag is then in units of ``Sp^4 = L^4 w c_n / B``. Everything is analytic in its arguments.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim.models.elastic.rod import Rod


@dataclass(frozen=True, eq=False)
class Drag:
    """Resistances of rod and body, in units of ``B / L^2`` per ``w L``.

    Parameters
    ----------
    tangential, normal
        Per unit length, ``Sp^4 c_t / c_n`` and ``Sp^4``.
    tip
        Of the free end, in all directions.
    body
        Of the body about its centre, for its velocities along s and q and about r, (3, 3).
    offset
        Of the joint from the body's centre.
    free
        Which of these three velocities are free.
    """

    tangential: float
    normal: float
    tip: float
    body: np.ndarray
    offset: float
    free: tuple[int, ...]

    def weights(self, rod: Rod) -> tuple[np.ndarray, np.ndarray]:
        """Return the tangential and normal resistance of each node."""
        t, n = self.tangential * rod.weight, self.normal * rod.weight
        return t + self.tip * rod.end, n + self.tip * rod.end


@dataclass(frozen=True, eq=False)
class Base:
    """Where the drive holds the base, each (T,): place across s, angle, and their rates."""

    place: np.ndarray
    angle: np.ndarray
    place_rate: np.ndarray
    angle_rate: np.ndarray


@dataclass(frozen=True, eq=False)
class Loads:
    """What else pulls at the rod, in units of ``B / L^2`` (and velocities in ``w L``).

    Parameters
    ----------
    weight
        Force per length along s and q, (2,).
    end
        Force at the free end along s and q, (2,).
    flow
        Velocity of the fluid along s and q, (2,).
    tip, along
        Follower forces, against the tangent: at the free end, and per length.
    """

    weight: tuple[float, float] = (0.0, 0.0)
    end: tuple[float, float] = (0.0, 0.0)
    flow: tuple[float, float] = (0.0, 0.0)
    tip: float = 0.0
    along: float = 0.0


@dataclass(frozen=True, eq=False)
class Balance:
    """Work of each velocity, ``residual`` (T, f + n), and its derivatives.

    By the velocities ``resistance`` (T, f + n, f + n), at fixed velocities by the coordinates
    ``stiffness`` (T, f + n, n).
    """

    residual: np.ndarray
    resistance: np.ndarray
    stiffness: np.ndarray


def balance(
    rod: Rod, drag: Drag, base: Base, q: np.ndarray, w: np.ndarray, loads: Loads, rest: np.ndarray
) -> Balance:
    """Return the balance of work at T times at once.

    Parameters
    ----------
    q, w
        Coordinates (T, n) and velocities (T, f + n), in phase.
    rest
        Coordinates without stress, ``q^0`` (T, n) or (n,).
    """
    S, Phi, f = rod.along, rod.shapes, len(drag.free)
    given = (drag.normal, drag.tangential, drag.tip, drag.body, drag.offset, base.place, base.angle)
    q = q.astype(np.result_type(q, w, rest, rod.stiffness, *given))
    theta = base.angle[:, None] + rod.tilt + q @ Phi.T
    turning = base.angle_rate[:, None] + w[:, f:] @ Phi.T
    c, s = np.cos(theta), np.sin(theta)
    X, Y = c @ S.T, base.place[:, None] + s @ S.T

    jx, jy = S @ (-s[..., None] * Phi), S @ (c[..., None] * Phi)  # J_k = int_0^s n Phi_k
    one, nought = np.ones_like(X), np.zeros_like(X)
    rigid_x = np.stack([one, nought, -Y], axis=-1)[..., list(drag.free)]
    rigid_y = np.stack([nought, one, X + drag.offset], axis=-1)[..., list(drag.free)]
    Jx, Jy = np.concatenate([rigid_x, jx], -1), np.concatenate([rigid_y, jy], -1)
    Jt, Jn = _turned(Jx, Jy, c, s)

    driven_x = -(s * base.angle_rate[:, None]) @ S.T
    driven_y = (c * base.angle_rate[:, None]) @ S.T + base.place_rate[:, None]
    vx = (Jx @ w[..., None])[..., 0] + driven_x - loads.flow[0]
    vy = (Jy @ w[..., None])[..., 0] + driven_y - loads.flow[1]
    vt, vn = c * vx + s * vy, c * vy - s * vx

    ct, cn = drag.weights(rod)
    end = rod.end
    ft, fn = ct * vt + loads.tip * end + loads.along * rod.weight, cn * vn
    fx = c * ft - s * fn - loads.weight[0] * rod.weight - loads.end[0] * end
    fy = s * ft + c * fn - loads.weight[1] * rod.weight - loads.end[1] * end

    residual = (_swap(Jx) @ fx[..., None] + _swap(Jy) @ fy[..., None])[..., 0]
    residual[:, f:] += rod.stiffness * (q - rest)
    M = _swap(Jt) @ (ct[:, None] * Jt) + _swap(Jn) @ (cn[:, None] * Jn)
    own = drag.body[np.ix_(drag.free, drag.free)]
    M[:, :f, :f] += own
    residual[:, :f] += w[:, :f] @ own.T

    # d/dq_k at fixed w: the tangent turns by Phi_k, the velocity changes by dv_k
    spin = w[:, drag.free.index(2)] if 2 in drag.free else np.zeros_like(base.angle)
    dvx = -spin[:, None, None] * jy - S @ ((c * turning)[..., None] * Phi)
    dvy = spin[:, None, None] * jx - S @ ((s * turning)[..., None] * Phi)
    dvt, dvn = _turned(dvx, dvy, c, s)
    dft = ct[:, None] * (dvt + vn[..., None] * Phi) - fn[..., None] * Phi
    dfn = cn[:, None] * (dvn - vt[..., None] * Phi) + ft[..., None] * Phi
    G = _swap(Jt) @ dft + _swap(Jn) @ dfn
    pull = c * (fx @ S) + s * (fy @ S)  # minus the tension of the drag beyond s
    G[:, f:] -= _swap(Phi) @ (pull[..., None] * Phi)
    if 2 in drag.free:
        G[:, drag.free.index(2)] += (fy[:, None] @ jx - fx[:, None] @ jy)[:, 0]
    G[:, f:] += np.diag(rod.stiffness)
    return Balance(residual, M, G)


def _swap(a: np.ndarray) -> np.ndarray:
    return np.swapaxes(a, -1, -2)


def _turned(x: np.ndarray, y: np.ndarray, c: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, ...]:
    """Components along tangent and normal of columns of vectors."""
    return c[..., None] * x + s[..., None] * y, c[..., None] * y - s[..., None] * x
