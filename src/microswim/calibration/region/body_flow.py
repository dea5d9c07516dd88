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

from microswim.models.rft.plane_wave import fill_nodes
from microswim.models.rft.segment import add_sums
from microswim.numerics.compiled import FAST, compiled
from microswim.numerics.quadrature import gauss
from microswim.swimmer.drag.coefficients import GrayHancock
from microswim.swimmer.geometry.tails import as_wave
from microswim.swimmer.swimmer import Swimmer

_LAW = GrayHancock(tip=True)

ON_RAMP = 8  #: nodes on the ramp


@compiled(fastmath=FAST, error_model="numpy")
def add_tail(R: Any, F: Any, p: Any, nodes: Any, phase: float, g: float) -> Any:
    """Add tail and tip to the lower triangle of R and to ``F_p``; returns G.

    `nodes` as of `rft.plane_wave.fill_nodes`, the tip the last of them; g the sign of the
    helix's hand, zero for a plane wave. With ``A = a I - b x x'`` and T the factors of H = [A, -T
    x^] and y the tangent over the step in s, ``A y = w`` and ``m = T x × y``,

        H' C H = [n A^2 + D w w', ..; n a T x^ + D m w', n T^2 (|x|^2 I - x x') + D m m' + S y y'].

    Each sum is a scalar of its own: without stores in the loop the compiler takes several nodes at
    once.
    """
    k, c_n, d_c, c_r, radius, spin = p[2], p[6], p[5] - p[6], p[7], p[8], p[9]
    C, S = np.cos(phase), np.sin(phase)
    zero = p.dtype.type(0)  # a number: where the sums are arrays, each becomes one of its own
    r00, r10, r11, r20, r21, r22 = zero, zero, zero, zero, zero, zero
    r30, r31, r32, r33, r40, r41, r42 = zero, zero, zero, zero, zero, zero, zero
    r43, r44, r50, r51, r52, r53, r54, r55 = zero, zero, zero, zero, zero, zero, zero, zero
    f0, f1, f2, f3, f4, f5, G = zero, zero, zero, zero, zero, zero, zero
    last = nodes.shape[1] - 1
    for i in range(last + 1):
        x, amplitude, slope = nodes[0, i], nodes[2, i], nodes[3, i]
        c, d = nodes[4, i] * C + nodes[5, i] * S, nodes[5, i] * C - nodes[4, i] * S
        y, u = amplitude * c, amplitude * d
        z, v = -g * u, g * y
        t, w = slope * c - k * u, -g * (slope * d + k * y)
        v2 = 1.0 + t * t + w * w
        dl = nodes[1, i] * np.sqrt(v2)
        n, D, c_s = c_n * dl + nodes[6, i] * p[10], d_c * dl / v2, c_r * dl / v2
        r2 = x * x + y * y + z * z
        q2 = radius * radius / r2
        q = np.sqrt(q2)
        a, b, T = 1.0 - 0.25 * q * (3.0 + q2), 0.75 * q * (1.0 - q2) / r2, 1.0 - q2 * q
        bx = b * (x + y * t + z * w)
        w0, w1, w2 = a - bx * x, a * t - bx * y, a * w - bx * z
        m0, m1, m2 = T * (y * w - z * t), T * (z - x * w), T * (x * t - y)
        na, nb, nt, nc = n * a * a, n * b * (2.0 * a - b * r2), n * a * T, n * T * T
        D0, D1, D2, E0, E1, E2 = D * w0, D * w1, D * w2, D * m0, D * m1, D * m2
        r00 += D0 * w0 + na - nb * x * x
        r10 += D1 * w0 - nb * x * y
        r11 += D1 * w1 + na - nb * y * y
        r20 += D2 * w0 - nb * x * z
        r21 += D2 * w1 - nb * y * z
        r22 += D2 * w2 + na - nb * z * z
        r30 += E0 * w0
        r31 += E0 * w1 - nt * z
        r32 += E0 * w2 + nt * y
        r33 += E0 * m0 + nc * (y * y + z * z) + c_s
        r40 += E1 * w0 + nt * z
        r41 += E1 * w1
        r42 += E1 * w2 - nt * x
        r43 += E1 * m0 - nc * x * y + c_s * t
        r44 += E1 * m1 + nc * (x * x + z * z) + c_s * t * t
        r50 += E2 * w0 - nt * y
        r51 += E2 * w1 + nt * x
        r52 += E2 * w2
        r53 += E2 * m0 - nc * x * z + c_s * w
        r54 += E2 * m1 - nc * y * z + c_s * t * w
        r55 += E2 * m2 + nc * (x * x + y * y) + c_s * w * w
        slip, bu, turn = t * u + w * v, n * b * (y * u + z * v), n * T
        f0 += D0 * slip - bu * x
        f1 += D1 * slip + n * a * u - bu * y
        f2 += D2 * slip + n * a * v - bu * z
        f3 += E0 * slip + turn * (y * v - z * u) + c_s * spin
        f4 += E1 * slip - turn * x * v + c_s * t * spin
        f5 += E2 * slip + turn * x * u + c_s * w * spin
        G += n * (u * u + v * v) + D * slip * slip + c_s * spin * spin
    sums = (
        *(r00, r10, r11, r20, r21, r22, r30, r31, r32, r33),
        *(r40, r41, r42, r43, r44, r50, r51, r52, r53, r54, r55),
    )
    add_sums(R, F, sums, (f0, f1, f2, f3, f4, f5))
    return G


@compiled()
def table(p: Any, size: int, ramp_rule: Any, xi: Any, weight: Any) -> Any:
    """Nodes (7, m): the rows of `microswim.models.rft.plane_wave.fill_nodes`, and a one at the tip.

    The rules are those of `rules`, `size` nodes on the rest.
    """
    rule = xi[size, : size + 1], weight[size, : size + 1]
    if p[3] == 0.0:  # no ramp, no nodes on it
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
    """``(R, F_p, G)`` of body and tail at several phases: shapes (m, 6, 6), (m, 6), (m,)."""
    m = len(phases)
    R, F = np.empty((m, 6, 6), dtype=p.dtype), np.empty((m, 6), dtype=p.dtype)
    G = np.empty(m, dtype=p.dtype)
    for j in range(m):
        G[j] = fill_base(R[j], F[j], p, D, nodes, phases[j], g)
    return R, F, G


def parameters(swimmer: Swimmer) -> np.ndarray:
    """Kernel parameters (..., 11) of the left-handed tail, Gray and Hancock's law with spin."""
    tail = as_wave(swimmer.tail)
    local = _LAW.local(tail, swimmer.fluid.viscosity)
    values = (
        *(tail.apparent_length, tail.amplitude, tail.wavenumber, tail.ramp, 1.0),
        *(*local, swimmer.body.semi_axes3[0], tail.spin * tail.sign),
        _LAW.end(tail, swimmer.fluid.viscosity),
    )
    if not any(isinstance(v, np.ndarray) for v in values):
        return np.array(values) + 0.0
    kind = np.result_type(np.float64, *values)
    return np.stack(np.broadcast_arrays(*values), axis=-1).astype(kind, copy=False)


@cache
def rules(most: int) -> tuple[Any, Any, Any]:
    """Quadrature on the ramp; nodes and weights of up to `most` nodes on the rest in rows.

    The rest ends with the tip, a node without length.
    """
    xi, weight = np.ones((most + 1, most + 1)), np.zeros((most + 1, most + 1))
    for n in range(1, most + 1):
        xi[n, :n], weight[n, :n] = gauss(n)
    return gauss(ON_RAMP), xi, weight


def sizes(waves: Any) -> Any:
    """Nodes on the rest for so many waves: about 1e-5, enough below a correction of 1e-3."""
    return 6 + np.ceil(4.5 * np.real(waves)).astype(int)


def hand(swimmer: Swimmer) -> float:
    """One for the left-handed helix that `parameters` describe, zero for a plane wave."""
    return 1.0 if swimmer.tail.is_rigid else 0.0


def base_of(swimmer: Swimmer, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`base` of one swimmer."""
    p = parameters(swimmer)
    D = np.array(swimmer.body.diagonal(swimmer.fluid.viscosity), dtype=float)
    most = int(sizes(swimmer.tail.number_of_waves))
    return base(p, D, table(p, most, *rules(most)), phases, hand(swimmer))
