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
from microswim.models.rft.helix import MOST_ON_RAMP, add_constant_part, add_ramp
from microswim.models.rft.plane_wave import add_in_plane, fill_nodes
from microswim.models.rft.segment import HELIX, PLANE_WAVE, TIP, add_tip
from microswim.numerics.compiling.compiled import prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.quadrature import gauss
from microswim.numerics.solve6 import solve_lanes

LANES = 16  #: designs whose 6x6 systems are solved side by side
BLOCK = 8  #: designs that share scratch arrays
IN_PLANE = np.array([True, True, False, False, False, True])  #: motions of a plane wave


@cache
def _ramp_rules() -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [0, 1]; row n holds the rule of n nodes."""
    xi, weight = np.zeros((2, MOST_ON_RAMP + 1, MOST_ON_RAMP))
    for n in range(MOST_ON_RAMP + 1):
        xi[n, :n], weight[n, :n] = gauss(n)
    return xi, weight


def solve_helices(
    arc: bool, p: np.ndarray, body: np.ndarray, free: np.ndarray, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return twists at phase 0 and tail powers ``F_p . V + G`` per unit rate of many helices, in
    parallel.

    `p` (n, 11), `body` (n, 6, 6), `counts` (n,) the nodes on each ramp; where the count is negative
    the result is NaN. Returns (n, 6) and (n,).
    """
    return _helices.over(len(p))(arc, p, body, free, counts, *_ramp_rules())


@loop(error_model="numpy")
def _helices(arc: bool, p: Any, body: Any, free: Any, counts: Any, xi: Any, weight: Any) -> Any:
    n = p.shape[0]
    V = np.empty((n, 6))
    power = np.empty(n)
    for block in prange((n + LANES - 1) // LANES):
        R, F, trig = np.empty((6, 6)), np.empty((LANES, 6)), np.empty((2, MOST_ON_RAMP))
        A, U, work = np.empty((6, 6, LANES)), np.empty((6, LANES)), np.empty((2, LANES))
        for l in range(LANES):
            d = min(block * LANES + l, n - 1)  # the last block repeats its last design
            m = max(counts[d], 0)
            for i in range(6):
                F[l, i] = 0.0
                for j in range(i + 1):
                    R[i, j] = body[d, i, j]
            G = add_ramp(R, F[l], p[d], 0.0, arc, (xi[m, :m], weight[m, :m]), trig)
            G += add_constant_part(R, F[l], p[d], 0.0, arc)
            power[d] = G + (add_tip(HELIX, R, F[l], p[d], 0.0) if p[d, TIP] != 0 else 0.0)
            for i in range(6):
                U[i, l] = -F[l, i]
                for j in range(i + 1):
                    A[i, j, l] = R[i, j]
        solve_lanes(A, U, free, work)
        for l in range(min(LANES, n - block * LANES)):
            d = block * LANES + l
            for i in range(6):
                V[d, i] = U[i, l] if counts[d] >= 0 else np.nan
                power[d] += F[l, i] * V[d, i]
    return V, power


def solve_waves(
    arc: bool, p: Any, body: Any, phases: Any, free: Any, ramp_rule: Any, rule: Any
) -> Any:
    """Return twists and tail powers ``F_p . V + G`` per unit rate of many plane waves, in parallel.

    `p` (n, 11), `body` (n, 6, 6) without coupling of the plane to what is out of it, where nothing
    drives. Returns V (n, m, 6) and the powers (n, m) over the m phases.
    """
    turns = np.stack([phases, np.cos(phases), np.sin(phases)], axis=-1)
    in_plane = free & IN_PLANE
    return _waves.over(len(p) * phases.size)(arc, p, body, turns, in_plane, ramp_rule, rule)


@loop(error_model="numpy")
def _waves(arc: bool, p: Any, body: Any, turns: Any, free: Any, ramp_rule: Any, rule: Any) -> Any:
    n, m = p.shape[0], len(turns)
    V = np.empty((n, m, 6))
    power = np.empty((n, m))
    for block in prange((n + BLOCK - 1) // BLOCK):
        F, A, U, work = np.empty((6, m)), np.empty((6, 6, m)), np.empty((6, m)), np.empty((2, m))
        nodes = np.empty((6, ramp_rule[0].size + rule[0].size))
        for d in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            fill_nodes(nodes, p[d], ramp_rule, rule)
            F[:] = 0.0
            for i in range(6):
                for l in range(i + 1):
                    A[i, l] = body[d, i, l]
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
