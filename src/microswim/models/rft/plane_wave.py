"""The travelling plane wave, fast: one table of sines for all phases, and only what is not zero.

With ``c = cos(k s - phase)``, ``d = sin(k s - phase)`` and x measured from the body's centre,

    X = (x, y, 0),   T = (1, t, 0),   U = (0, u, 0),   y = a c,  t = a' c - a k d,  u = a d

so that 12 of the 21 sums of `segment.segment` are left: with ``m = x t - y``

    forces     ss: n + d          qs: d t              qq: n + d t^2        rr: n
    turning    sr: n y            qr: -n x             rs: d m - n y        rq: d m t + n x
    torques    ss: n y^2 + w      qs: w t - n x y      qq: n x^2 + w t^2
               rr: d m^2 + n (x^2 + y^2)

and three of the six forces, as nothing drives it out of the plane. They stand here on their own
because a compiler that keeps what ``0 x inf`` is cannot leave out the others by itself, and this
loop is most of the time that a plane wave takes. A test holds them to the plain quadrature of
segment.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.models.rft.segment import (
    AMPLITUDE,
    C_N,
    C_R,
    C_T,
    LENGTH,
    OFFSET,
    PLANE_WAVE,
    RAMP,
    WAVENUMBER,
    add_tip,
    cosine_sine,
    in_plane,
    resistances,
)
from microswim.numerics.compiling.compiled import FAST, compiled, pays

#: Segments of all phases and designs that are added at once as Python.
SIDE_BY_SIDE = 4096
#: Seconds of a segment as Python.
SEGMENT = 3e-7


@compiled(fastmath=FAST)
def fill_nodes(nodes: Any, p: Any, ramp_rule: Any, rule: Any) -> None:
    """Fill in the rows of `nodes`: x, weight, a, a', cos ks, sin ks; p as in `segment`."""
    m = len(ramp_rule[0])
    fill_ramp(nodes[:, :m], p, ramp_rule)
    fill_rest(nodes[:, m:], p, rule)
    for i in range(nodes.shape[1]):
        nodes[4, i], nodes[5, i] = cosine_sine(p[WAVENUMBER] * (nodes[0, i] - p[OFFSET]))


@compiled(fastmath=FAST)
def fill_ramp(nodes: Any, p: Any, rule: Any) -> None:
    """Fill the first rows where the amplitude grows, ``a = b s/(ramp L)``."""
    L, b, ramp, offset = p[LENGTH], p[AMPLITUDE], p[RAMP], p[OFFSET]
    for i in range(len(rule[0])):
        s = ramp * rule[0][i] * L
        nodes[0, i] = s + offset
        nodes[1, i] = L * ramp * rule[1][i]
        nodes[2, i] = b * rule[0][i]
        nodes[3, i] = b / (ramp * L)


@compiled(fastmath=FAST)
def fill_rest(nodes: Any, p: Any, rule: Any) -> None:
    """Fill the first rows behind the ramp."""
    L, b, ramp, offset = p[LENGTH], p[AMPLITUDE], p[RAMP], p[OFFSET]
    for i in range(len(rule[0])):
        s = (ramp + (1.0 - ramp) * rule[0][i]) * L
        nodes[0, i] = s + offset
        nodes[1, i] = L * (1.0 - ramp) * rule[1][i]
        nodes[2, i] = b
        nodes[3, i] = 0 * b


@compiled(fastmath=FAST, error_model="numpy")
def add_in_plane(R: Any, F: Any, p: Any, nodes: Any, turn: Any, arc: bool) -> Any:
    """Add what moves and resists in the plane to ``B_t`` (lower triangle) and ``F_p``; returns
    G.

    `turn` is the phase with its cosine and sine.
    """
    k, local, C, S = p[WAVENUMBER], (p[C_N], p[C_T] - p[C_N], p[C_R]), turn[1], turn[2]
    z = p.dtype.type(0)  # a number: where the sums are arrays, each becomes one of its own
    r00, r10, r11, r50, r51, r55, f0, f1, f5, G = z, z, z, z, z, z, z, z, z, z
    for i in range(nodes.shape[1]):
        x, a = nodes[0, i], nodes[2, i]
        c, d = nodes[4, i] * C + nodes[5, i] * S, nodes[5, i] * C - nodes[4, i] * S
        y, t, u = in_plane(a, nodes[3, i], k, c, d)
        n, D, _ = resistances(nodes[1, i], 1.0 + t * t, arc, local)
        m = x * t - y
        Dt, Dm, nx, ny = D * t, D * m, n * x, n * y
        along, across = Dt * u, n * u + Dt * t * u
        r00 += D + n
        r10 += Dt
        r11 += Dt * t + n
        r50 += Dm - ny
        r51 += Dm * t + nx
        r55 += Dm * m + nx * x + ny * y
        f0 += along
        f1 += across
        f5 += x * across - y * along
        G += across * u
    R[0, 0] += r00
    R[1, 0] += r10
    R[1, 1] += r11
    R[5, 0] += r50
    R[5, 1] += r51
    R[5, 5] += r55
    F[0] += f0
    F[1] += f1
    F[5] += f5
    return G


@compiled(fastmath=FAST, error_model="numpy")
def add_out_of_plane(R: Any, p: Any, nodes: Any, turn: Any, arc: bool) -> None:
    """Add what resists motion out of the plane to ``B_t`` (lower triangle); nothing drives it."""
    k, local, C, S = p[WAVENUMBER], (p[C_N], p[C_T] - p[C_N], p[C_R]), turn[1], turn[2]
    z = p.dtype.type(0)
    r22, r32, r33, r42, r43, r44 = z, z, z, z, z, z
    for i in range(nodes.shape[1]):
        x = nodes[0, i]
        c, d = nodes[4, i] * C + nodes[5, i] * S, nodes[5, i] * C - nodes[4, i] * S
        y, t, _ = in_plane(nodes[2, i], nodes[3, i], k, c, d)
        n, _, w = resistances(nodes[1, i], 1.0 + t * t, arc, local)
        r22 += n
        r32 += n * y
        r33 += n * y * y + w
        r42 -= n * x
        r43 += w * t - n * x * y
        r44 += w * t * t + n * x * x
    R[2, 2] += r22
    R[3, 2] += r32
    R[3, 3] += r33
    R[4, 2] += r42
    R[4, 3] += r43
    R[4, 4] += r44


@compiled()
def in_a_row(arc: bool, p: Any, phases: Any, ramp_rule: Any, rule: Any) -> Any:
    """Return `wave_phases`, one phase after the other."""
    m = phases.size
    R = np.zeros((m, 6, 6), dtype=p.dtype)
    F = np.zeros((m, 6), dtype=p.dtype)
    G = np.empty(m, dtype=p.dtype)
    nodes = np.empty((6, ramp_rule[0].size + rule[0].size), dtype=p.dtype)
    fill_nodes(nodes, p, ramp_rule, rule)
    for j in range(m):
        turn = phases[j], np.cos(phases[j]), np.sin(phases[j])
        G[j] = add_in_plane(R[j], F[j], p, nodes, turn, arc)
        add_out_of_plane(R[j], p, nodes, turn, arc)
        G[j] += add_tip(PLANE_WAVE, R[j], F[j], p, phases[j])
        for i in range(6):
            for n in range(i):
                R[j, n, i] = R[j, i, n]
    return R, F, G


def fill_rows(nodes: Any, p: Any, ramp_rule: Any, rule: Any) -> None:
    """Fill nodes as `fill_nodes`, all at once, of designs p (11, ...); rules are (nodes, ...)."""
    n = len(ramp_rule[0])
    fill_ramp.written(nodes[:, None, :n], p, [x[None] for x in ramp_rule])
    fill_rest.written(nodes[:, None, n:], p, [x[None] for x in rule])
    nodes[4], nodes[5] = cosine_sine.written(p[WAVENUMBER] * (nodes[0] - p[OFFSET]))


def side_by_side(arc: bool, p: Any, phases: Any, ramp_rule: Any, rule: Any) -> Any:
    """Return `wave_phases` as Python, all phases at once, and all designs of p (11, n): (m, 6, 6,
    n)...
    """
    each, m = p.shape[1:], phases.size
    nodes = np.empty((6, ramp_rule[0].size + rule[0].size, *each), dtype=p.dtype)
    fill_rows(nodes, p, *([x.reshape(-1, *[1] * len(each)) for x in r] for r in (ramp_rule, rule)))
    R, F, G = (np.zeros((*s, m, *each), dtype=p.dtype) for s in ((6, 6), (6,), ()))
    at = phases.reshape(-1, *[1] * len(each))
    width = max(1, SIDE_BY_SIDE // max(1, G.size))
    for part in np.split(nodes, range(width, nodes.shape[1], width), axis=1):
        own = (m, part.shape[1], *each)
        R_part, F_part = (np.zeros((*s, *own), dtype=p.dtype) for s in ((6, 6), (6,)))
        turn = at[:, None], np.cos(at[:, None]), np.sin(at[:, None])
        here = p, part[:, None, None], turn, arc
        G_part = add_in_plane.written(R_part, F_part, *here)
        add_out_of_plane.written(R_part, *here)
        R, F, G = R + R_part.sum(axis=3), F + F_part.sum(axis=2), G + G_part.sum(axis=1)
    G = G + add_tip.written(PLANE_WAVE, R, F, p, at)
    upper = np.triu_indices(6, 1)
    R[upper] = R.swapaxes(0, 1)[upper]
    return np.moveaxis(R, 2, 0), np.moveaxis(F, 1, 0), G


def wave_phases(arc: bool, p: Any, phases: Any, ramp_rule: Any, rule: Any) -> Any:
    """Return ``(B_t, F_p, G)`` of a plane wave at m phases: shapes (m, 6, 6), (m, 6), (m,)."""
    segments = phases.size * (ramp_rule[0].size + rule[0].size)
    run = in_a_row.dispatcher if pays(segments * SEGMENT) else side_by_side
    return run(arc, p, phases, ramp_rule, rule)
