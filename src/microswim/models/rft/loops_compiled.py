"""Many designs at once, compiled for all cores: helices in closed form, waves from their table.

The sums are those of rigidhelix and planarwave; here are the loops over designs. They always run
compiled. Array expressions are spelled out as loops on purpose: each would be a parallel region of
its own, and take seconds to compile.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from microswim.models.rft.half_beats import half_beats as half_beats
from microswim.models.rft.helix import MOST_ON_RAMP, behind_ramp, pair_on_ramp
from microswim.models.rft.plane_wave import add_in_plane, fill_nodes
from microswim.models.rft.segment import (
    HELIX,
    LENGTH,
    PARAMETERS,
    PLANE_WAVE,
    RAMP,
    SUMS,
    TIP,
    WAVENUMBER,
    add_tip,
    cosine_sine,
    keep_sums,
    numbers,
    plus,
    sums_at,
    tip,
)
from microswim.numerics.array import lent
from microswim.numerics.compiling.compiled import FAST, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.quadrature import gauss
from microswim.numerics.solve6 import solve_lanes

LANES = 16  #: designs whose 6x6 systems are solved side by side
BLOCK = 8  #: designs that share scratch arrays
IN_PLANE = np.array([True, True, False, False, False, True])  #: motions of a plane wave


@cache
def _ramp_rules() -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [0, 1/2]; row n holds half of the rule of 2 n nodes.

    Behind its end a row has no weight, so that lanes of few nodes stand beside lanes of many.
    """
    xi, weight = np.zeros((2, MOST_ON_RAMP // 2 + 1, MOST_ON_RAMP // 2))
    for n in range(MOST_ON_RAMP // 2 + 1):
        for row, whole in zip((xi, weight), gauss(2 * n)):
            row[n, :n] = whole[:n]
    return xi, weight


def solve_helices(
    arc: bool, p: np.ndarray, drag: np.ndarray, free: np.ndarray, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return twists at phase 0 and tail powers ``F_p . V + G`` per unit rate of many helices, in
    parallel.

    `p` (n, 11), `drag` (n, 6) of the body, `counts` (n,) the nodes on each ramp; where it is
    negative the result is NaN. Returns (n, 6) and (n,).
    """
    order = np.argsort(counts.astype(np.int8), kind="stable")
    return _helices.over(len(p))(arc, lent(p), lent(drag), free, counts, order, _ramp_rules())


@loop(error_model="numpy", fastmath=FAST)
def _helices(arc: bool, p: Any, drag: Any, free: Any, counts: Any, order: Any, rules: Any) -> Any:
    """Blocks of designs side by side, each lane one of them, in the order of their nodes."""
    n, (xi, weight) = p.shape[0], rules
    V = np.empty((6, n))
    power = np.empty(n)
    for block in prange((n + LANES - 1) // LANES):
        at, P = np.empty(LANES, np.int64), np.empty((PARAMETERS, LANES))
        S, node, middle = np.empty((SUMS, LANES)), np.empty((2, LANES)), np.empty((2, LANES))
        A, U, work = np.empty((6, 6, LANES)), np.empty((6, LANES)), np.empty((2, LANES))
        most = 0
        for l in range(LANES):
            at[l] = order[min(block * LANES + l, n - 1)]  # the last block repeats its last design
            most = max(most, counts[at[l]])
            for i in range(PARAMETERS):
                P[i, l] = p[at[l], i]
        for l in range(LANES):
            own = numbers(P, l)
            turn, end = own[WAVENUMBER] * own[RAMP] * own[LENGTH], own[WAVENUMBER] * own[LENGTH]
            at_end = cosine_sine(end)
            sums = behind_ramp(own, cosine_sine(turn), at_end, arc)
            keep_sums(S, l, plus(sums, tip(HELIX, own, at_end)))
            middle[0, l], middle[1, l] = cosine_sine(0.5 * turn)
        for i in range(most // 2):
            for l in range(LANES):
                m = max(counts[at[l]] // 2, 0)
                node[0, l], node[1, l] = xi[m, i], weight[m, i]
            for l in range(LANES):
                own, half = numbers(P, l), (middle[0, l], middle[1, l])
                sums = pair_on_ramp(own, half, node[0, l], node[1, l], arc)
                keep_sums(S, l, plus(sums_at(S, l), sums))
        for l in range(LANES):
            for i in range(6):
                U[i, l] = -S[21 + i, l]
                for j in range(i):
                    A[i, j, l] = S[i * (i + 1) // 2 + j, l]
                A[i, i, l] = S[i * (i + 3) // 2, l] + drag[at[l], i]
        solve_lanes(A, U, free, work)
        for l in range(min(LANES, n - block * LANES)):
            good = counts[at[l]] >= 0
            total = S[27, l]
            for i in range(6):
                V[i, at[l]] = U[i, l] if good else np.nan
                total += S[21 + i, l] * U[i, l]
            power[at[l]] = total if good else np.nan
    return V.T, power


def solve_waves(
    arc: bool, p: Any, drag: Any, phases: Any, free: Any, ramp_rule: Any, rule: Any
) -> Any:
    """Return twists and tail powers ``F_p . V + G`` per unit rate of many plane waves, in parallel.

    `p` (n, 11), `drag` (n, 6) of the body. Returns V (n, m, 6) and powers (n, m) over the m phases.
    """
    turns = np.stack([phases, np.cos(phases), np.sin(phases)], axis=-1)
    in_plane = free & IN_PLANE
    return _waves.over(len(p) * phases.size)(arc, p, drag, turns, in_plane, ramp_rule, rule)


@loop(error_model="numpy")
def _waves(arc: bool, p: Any, drag: Any, turns: Any, free: Any, ramp_rule: Any, rule: Any) -> Any:
    n, m = p.shape[0], len(turns)
    V = np.empty((n, m, 6))
    power = np.empty((n, m))
    for block in prange((n + BLOCK - 1) // BLOCK):
        F, A, U, work = np.empty((6, m)), np.empty((6, 6, m)), np.empty((6, m)), np.empty((2, m))
        nodes = np.empty((6, ramp_rule[0].size + rule[0].size))
        for d in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            fill_nodes(nodes, p[d], ramp_rule, rule)
            F[:], A[:] = 0.0, 0.0
            for i in range(6):
                A[i, i] = drag[d, i]
            for j in range(m):
                R, force = A[:, :, j], F[:, j]
                power[d, j] = add_in_plane(R, force, p[d], nodes, turns[j], arc)
                if p[d, TIP] != 0:
                    power[d, j] += add_tip(PLANE_WAVE, R, force, p[d], turns[j, 0])
            U[:] = -F
            solve_lanes(A, U, free, work)
            for j in range(m):
                for i in range(6):
                    V[d, j, i] = U[i, j]
                    power[d, j] += F[i, j] * U[i, j]
    return V, power
