"""What a flow that strains or bends does to a swimmer, at the level of resistive force theory.

A swimmer held in the flow ``u(X) = E X`` (E symmetric, X from the body's centre) feels the wrench
``S(phi) e``, e = the six entries `ENTRIES` of E. With the local resistance C of Eqs. (5), (6)

    tail:  S = int [ C u; X x C u ] dl       for the unit flows u = E_k X, as F_p with u for û
    body:  T_i = K_i (r_j^2 - r_k^2) / (r_j^2 + r_k^2) E_jk      [Jeffery 1922], ijk cyclic

K_i the body's own resistance to rotation. The body of revolution and the ellipsoid are exact when
alone; that body and tail shade one another in a strain is left out, as in the surrogate itself.
``g(phi) = int û . C u dl`` is the part of the motor's torque.

In a curved flow ``u(X) = sum_k c_k u_k(X)``, u_k the 18 unit flows ``e_i X_j X_l``, it feels C c:
the tail as above, the body Faxen's force ``K_i (a_j^2 d_j^2 u_i) / 6`` [Kim & Karrila 1991, ch. 3],
which is exact for an ellipsoid alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from microswim.models.rft.gait import body_resistance
from microswim.models.rft.segment import centreline_tail
from microswim.numerics.quadrature import gauss
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.swimmer import Swimmer

#: Entries of the strain in the order of the columns of S; an off-diagonal one stands for both.
ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def unit_gradients() -> np.ndarray:
    """Return the velocity gradients of the six unit strains, shape (6, 3, 3)."""
    E = np.zeros((len(ENTRIES), 3, 3))
    for k, (i, j) in enumerate(ENTRIES):
        E[k, i, j] = E[k, j, i] = 1.0
    return E


def coupling(swimmer: Swimmer, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return ``S`` (n, 6, 6) and ``g`` (n, 6) at the phases."""
    S, g = tail_coupling(swimmer, phases, unit_gradients())
    return S + body_coupling(swimmer), g


def body_coupling(swimmer: Swimmer) -> np.ndarray:
    """Return Jeffery's torque on the body alone per unit strain, (6, 6)."""
    S, K = np.zeros((6, 6)), np.diag(body_resistance(swimmer))[3:]
    square = np.array(swimmer.body.semi_axes3, dtype=float) ** 2
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        if square[j] + square[k] > 0:
            column = ENTRIES.index((min(j, k), max(j, k)))
            S[3 + i, column] = K[i] * (square[j] - square[k]) / (square[j] + square[k])
    return S


def curved_coupling(swimmer: Swimmer, phases: np.ndarray) -> np.ndarray:
    """Return ``C`` (n, 6, 18) at the phases: wrench on it, held, in the flows ``e_i X_j X_k``."""

    def bent(X: np.ndarray) -> np.ndarray:
        squares = np.stack([X[:, j] * X[:, k] for j, k in ENTRIES])
        return np.einsum("kn,il->ikln", squares, np.eye(3)).reshape(18, 3, -1).swapaxes(1, 2)

    C, _ = _tail_in(swimmer, phases, bent)
    K = np.diag(body_resistance(swimmer))[:3]
    square = np.array(swimmer.body.semi_axes3, dtype=float) ** 2
    for i in range(3):
        C[:, i, 6 * i : 6 * i + 3] += K[i] * square / 3.0
    return C


def tail_coupling(
    swimmer: Swimmer, phases: np.ndarray, gradients: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the wrench (n, 6, m) and motor's part (n, m) of the tail held in m linear flows about
    the centre.

    The flows have the gradients (m, 3, 3); they turn no section about itself (no spin).
    """
    return _tail_in(swimmer, phases, lambda X: X @ gradients.swapaxes(1, 2))


def _tail_in(
    swimmer: Swimmer, phases: np.ndarray, flows: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """The same in flows that give velocities (m, k, 3) at points (k, 3) about the centre."""
    S, g = zip(*(_one_in(swimmer, tail, phases, flows) for tail in swimmer.tail.each))
    return np.sum(S, axis=0), np.sum(g, axis=0)


def _one_in(
    swimmer: Swimmer, tail: Tail, phases: np.ndarray, flows: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """The same of one tail alone."""
    local = swimmer.coefficients.local(tail, swimmer.fluid.viscosity)
    c = tuple(float(f * x) for f, x in zip(swimmer.interaction.tail, local))
    x, w = _nodes(tail)
    arc = swimmer.motion.line_element == "arc"
    length = tail.apparent_length
    P, P_s, U = tail.centreline(length * x[None, :], np.asarray(phases)[:, None])
    X = P + np.array([swimmer.body.semi_axes3[0], 0.0, 0.0])
    S, g = [], []
    for n in range(len(phases)):
        at = [np.ascontiguousarray(v[n], dtype=float) for v in (X, P_s, U)]

        def held(flow: np.ndarray, at: list[np.ndarray] = at) -> tuple[np.ndarray, float]:
            _, F, G = centreline_tail.dispatcher(at[0], at[1], flow, length * w, arc, c, 0.0)
            return F, G

        beating = held(at[2])[1]
        for u in np.ascontiguousarray(flows(at[0])):
            wrench, alone = held(u)
            S.append(wrench)
            like = np.sqrt(beating / alone) if alone > 0 and beating > 0 else 1.0
            up, down = held(at[2] + like * u)[1], held(at[2] - like * u)[1]
            g.append((up - down) / (4.0 * like))  # C is symmetric
    n = len(phases)
    return np.array(S).reshape(n, -1, 6).swapaxes(1, 2).copy(), np.array(g).reshape(n, -1)


def _nodes(tail: Tail) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre panels along the tail, on [0, 1], with a break where the ramp ends."""
    edges = tail.edges
    panels = []
    for a, b in zip(edges, edges[1:]):
        if b > a:
            x, w = gauss(int(24 + 24 * float(tail.number_of_waves) * (b - a)))
            panels.append((a + (b - a) * x, (b - a) * w))
    x, w = (np.concatenate(part) for part in zip(*panels))
    return x, w
