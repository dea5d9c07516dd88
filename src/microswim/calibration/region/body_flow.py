"""Resistive force theory in the flow that the moving body drives: base of the region calibration.

A sphere of radius a moving with ``V = [U; W]`` drives the flow ``u = M U + (a/r)^3 W x x``,

    M = (3q/4 + q^3/4) I + (3q/4 - 3q^3/4) e e',     q = a/r, e = x/r,

so the filament at x meets the fluid at ``H V``, ``H = [I - M, -(1 - q^3) x^]``, and with the local
resistance C of Eq. (5) and the tail's own velocity u_hat

    R = B_b + int H' C H dl,     F_p = int H' C u_hat dl,     C = c_n I + (c_t - c_n) t t'.

H' carries a force on the filament to the force it leaves on the whole swimmer (reciprocal theorem),
so R stays symmetric and positive definite. The tip is half a sphere, with half its drag,
``3 pi mu r_t`` in all directions at s = L: a wave of a whole number of turns cancels along its
length, and what its end feels is then the larger part of the lateral wrench. Bodies that are not
spheres shade like the sphere of radius r_s.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.models.rft.plane_wave import fill_nodes
from microswim.models.rft.segment import (
    C_N,
    C_R,
    C_T,
    MOST_NODES,
    OFFSET,
    RAMP,
    SPIN,
    TIP,
    WAVENUMBER,
    add_sums,
    in_plane,
    nothing,
    out_of_plane,
    plus,
    resistances,
)
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.quadrature import PANEL, gauss
from microswim.swimmer.drag.coefficients import GrayHancock
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.swimmer import Swimmer

_LAW = GrayHancock(tip=True)

ON_RAMP = 8  #: nodes on the ramp
FEWEST, PER_WAVE = 6, 4.5  #: nodes on the rest: of a straight tail, and more for each wave


@compiled(fastmath=FAST, error_model="numpy", inline="always")
def shaded_segment(X: Any, T: Any, U: Any, n: Any, d: Any, w: Any, spin: Any, radius: Any) -> Any:
    """Return what one segment adds beside a sphere: the 28 sums of `segment.segment`.

    With ``A = a I - b X X'`` and tau the factors of ``H = [A, -tau X^]``, ``e = A T`` and
    ``m = tau X x T``,

        H' C H = [n A^2 + d e e', -n a tau X^ + d e m'; .., n tau^2 (|X|^2 I - X X') + d m m'],
        H' C U = [n A U + d (T . U) e; n tau X x U + d (T . U) m],

    and the spin adds ``w T T'`` as ever. Far from the sphere a and tau are one, b is zero.
    """
    x, y, z = X
    t0, t1, t2 = T
    u0, u1, u2 = U
    r2 = x * x + y * y + z * z
    q2 = radius * radius / r2
    q = np.sqrt(q2)
    a, b, tau = 1.0 - 0.25 * q * (3.0 + q2), 0.75 * q * (1.0 - q2) / r2, 1.0 - q2 * q
    along = b * (x * t0 + y * t1 + z * t2)
    e0, e1, e2 = a * t0 - along * x, a * t1 - along * y, a * t2 - along * z
    m0, m1, m2 = tau * (y * t2 - z * t1), tau * (z * t0 - x * t2), tau * (x * t1 - y * t0)
    na, nb, nt, nc = n * a * a, n * b * (2.0 * a - b * r2), n * a * tau, n * tau * tau
    d0, d1, d2, D0, D1, D2 = d * e0, d * e1, d * e2, d * m0, d * m1, d * m2
    w0, w1, w2 = w * t0, w * t1, w * t2
    slip = t0 * u0 + t1 * u1 + t2 * u2
    away, turn, pull = n * b * (x * u0 + y * u1 + z * u2), n * tau, n * a
    return (
        d0 * e0 + na - nb * x * x,
        *(d1 * e0 - nb * x * y, d1 * e1 + na - nb * y * y),
        *(d2 * e0 - nb * x * z, d2 * e1 - nb * y * z, d2 * e2 + na - nb * z * z),
        *(D0 * e0, D0 * e1 - nt * z, D0 * e2 + nt * y),
        D0 * m0 + nc * (y * y + z * z) + w0 * t0,
        *(D1 * e0 + nt * z, D1 * e1, D1 * e2 - nt * x, D1 * m0 - nc * x * y + w1 * t0),
        D1 * m1 + nc * (x * x + z * z) + w1 * t1,
        *(D2 * e0 - nt * y, D2 * e1 + nt * x, D2 * e2, D2 * m0 - nc * x * z + w2 * t0),
        *(D2 * m1 - nc * y * z + w2 * t1, D2 * m2 + nc * (x * x + y * y) + w2 * t2),
        d0 * slip + pull * u0 - away * x,
        d1 * slip + pull * u1 - away * y,
        d2 * slip + pull * u2 - away * z,
        D0 * slip + turn * (y * u2 - z * u1) + w0 * spin,
        D1 * slip + turn * (z * u0 - x * u2) + w1 * spin,
        D2 * slip + turn * (x * u1 - y * u0) + w2 * spin,
        n * (u0 * u0 + u1 * u1 + u2 * u2) + d * slip * slip + w * spin * spin,
    )


@compiled(fastmath=FAST, error_model="numpy")
def add_tail(R: Any, F: Any, p: Any, nodes: Any, phase: float, g: float) -> Any:
    """Add tail and tip to the lower triangle of R and to ``F_p``; returns G.

    `nodes` as of `rft.plane_wave.fill_nodes`, the tip the last of them; g the sign of the
    helix's hand, zero for a plane wave.
    """
    k, radius, spin = p[WAVENUMBER], p[OFFSET], p[SPIN]
    local = p[C_N], p[C_T] - p[C_N], p[C_R]
    C, S = np.cos(phase), np.sin(phase)
    sums = nothing(p.dtype.type(0))
    for i in range(nodes.shape[1]):
        c, d = nodes[4, i] * C + nodes[5, i] * S, nodes[5, i] * C - nodes[4, i] * S
        q, q_s, u = in_plane(nodes[2, i], nodes[3, i], k, c, d)
        r, r_s, v = out_of_plane(g, nodes[3, i], k, q, u, d)
        n, D, w = resistances(nodes[1, i], 1.0 + q_s * q_s + r_s * r_s, True, local)
        n += nodes[6, i] * p[TIP]
        X, T, U = (nodes[0, i], q, r), (1.0, q_s, r_s), (0.0, u, v)
        sums = plus(sums, shaded_segment(X, T, U, n, D, w, spin, radius))
    add_sums(R, F, sums[:21], sums[21:27])
    return sums[27]


@compiled()
def behind_ramp(size: int, xi: Any, weight: Any) -> Any:
    """Return nodes and weights of about `size` nodes behind the ramp; the last is the tip.

    One of the rules of `rules`, or equal panels where it would take more than the largest.
    """
    if size < len(xi):
        return xi[size, : size + 1], weight[size, : size + 1]
    count = (size + PANEL - 1) // PANEL
    nodes, weights = np.ones(count * PANEL + 1), np.zeros(count * PANEL + 1)
    for i in range(count * PANEL):
        nodes[i] = (i // PANEL + xi[PANEL, i % PANEL]) / count
        weights[i] = weight[PANEL, i % PANEL] / count
    return nodes, weights


@compiled()
def table(p: Any, size: int, ramp_rule: Any, xi: Any, weight: Any) -> Any:
    """Return nodes (7, m): the rows of `microswim.models.rft.plane_wave.fill_nodes`, and a one at
    the tip.

    The rules are those of `rules`, `size` nodes on the rest.
    """
    rule = behind_ramp(size, xi, weight)
    if p[RAMP] == 0.0:  # no ramp, no nodes on it
        ramp_rule = ramp_rule[0][:0], ramp_rule[1][:0]
    nodes = np.zeros((7, ramp_rule[0].size + rule[0].size), dtype=p.dtype)
    fill_nodes(nodes, p, ramp_rule, rule)
    nodes[6, -1] = 1.0
    return nodes


@compiled()
def fill_base(R: Any, F: Any, p: Any, D: Any, nodes: Any, phase: float, g: float) -> Any:
    """Fill R with the drags D (6,) of the body and the tail's R, and ``F_p``; returns G."""
    R[:], F[:] = 0.0, 0.0
    for i in range(6):
        R[i, i] = D[i]
    G = add_tail(R, F, p, nodes, phase, g)
    for i in range(6):
        for j in range(i):
            R[j, i] = R[i, j]
    return G


@compiled(always=True)
def base(p: Any, D: Any, nodes: Any, phases: Any, g: float) -> Any:
    """Return ``(R, F_p, G)`` of body and tail at several phases: shapes (m, 6, 6), (m, 6), (m,)."""
    m = len(phases)
    R, F = np.empty((m, 6, 6), dtype=p.dtype), np.empty((m, 6), dtype=p.dtype)
    G = np.empty(m, dtype=p.dtype)
    for j in range(m):
        G[j] = fill_base(R[j], F[j], p, D, nodes, phases[j], g)
    return R, F, G


def unit(swimmer: Swimmer) -> Any:
    """Return the length in which a plane wave's corrections count: r_s, or without a body L."""
    return swimmer.tail.apparent_length if swimmer.body.is_absent else swimmer.body.semi_axes3[0]


def parameters(swimmer: Swimmer) -> np.ndarray:
    """Return the kernel parameters (..., 11) of the left-handed tail, Gray and Hancock's law with
    spin.
    """
    tail = as_wave(swimmer.tail)
    local = _LAW.local(tail, swimmer.fluid.viscosity)
    values = (
        *(tail.apparent_length, tail.amplitude, tail.wavenumber, tail.ramp, 1.0),
        *(*local, swimmer.body.semi_axes3[0], tail.spin * tail.sign),
        _LAW.end(tail, swimmer.fluid.viscosity),
    )
    return side_by_side(values)


def side_by_side(values: tuple[Any, ...]) -> np.ndarray:
    """Return numbers, or numbers of many designs, as one array (..., values)."""
    if not any(isinstance(v, np.ndarray) for v in values):
        return np.array(values) + 0.0
    kind = np.result_type(np.float64, *values)
    return np.stack(np.broadcast_arrays(*values), axis=-1).astype(kind, copy=False)


@cache
def rules(most: int) -> tuple[Any, Any, Any]:
    """Return quadrature on the ramp; nodes and weights of up to `most` nodes on the rest in rows.

    The rest ends with the tip, a node without length. Two panels' nodes are the most of a row:
    `behind_ramp` makes panels of what takes more.
    """
    most = min(most, 2 * PANEL)
    xi, weight = np.ones((most + 1, most + 1)), np.zeros((most + 1, most + 1))
    for n in range(1, most + 1):
        xi[n, :n], weight[n, :n] = gauss(n)
    return gauss(ON_RAMP), xi, weight


def sizes(waves: Any) -> Any:
    """Return nodes on the rest for so many waves: a helix to rounding, a plane wave to ``(b k)^2 /
    100``.

    The corrections are fitted to the same base with the same nodes, and take that up.

    Raises
    ------
    SpecError
        If a tail has so many turns that it would take more than `MOST_NODES`.
    """
    most = (MOST_NODES - FEWEST) / PER_WAVE
    if not np.all(np.real(waves) <= most):
        raise SpecError("tail.waves", float(np.max(np.real(waves))), f"{most:.5g} at most")
    return FEWEST + np.ceil(PER_WAVE * np.real(waves)).astype(int)


def hand(swimmer: Swimmer) -> float:
    """Return one for the left-handed helix that `parameters` describe, zero for a plane wave."""
    return 1.0 if swimmer.tail.is_rigid else 0.0


def base_of(swimmer: Swimmer, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return `base` of one swimmer."""
    p = parameters(swimmer)
    D = np.array(swimmer.body.diagonal(swimmer.fluid.viscosity), dtype=float)
    most = int(sizes(swimmer.tail.number_of_waves))
    return base(p, D, table(p, most, *rules(most)), phases, hand(swimmer))
