"""Brownian paths, compiled: overdamped Langevin steps of fixed length, many paths at once.

    V dt = (M (W - F_p rate) + k_B T div M) dt + sqrt(2 k_B T) M^(1/2) dB,    M = R^-1

in the body frame, Ito's sense; each step follows the exponential of a twist that is held, so that
turning and moving are coupled as on the group of rigid motions (Makino & Doi 2004). M^(1/2) comes
from the Cholesky factor of R. ``div M`` is zero in free fluid, where M in the body frame does not
depend on the pose; beside a boundary it is found by a random difference (Delong, Usabiaga &
Donev 2015). The deterministic part is of order 4. A step that would reach through a boundary is
not taken, as in a Metropolis rule.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.poses.table import FREE, resist
from microswim.numerics.compiling.compiled import compiled, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.rigid_motion import turn
from microswim.numerics.solve6 import solve
from microswim.path.march import in_chart, unit
from microswim.path.velocity import WORK as VELOCITY_WORK
from microswim.path.velocity import velocity

#: Scratch of a path.
WORK = 110 + VELOCITY_WORK
NORMALS = 12  #: random numbers of a step: the kick, and the direction of the random difference
SMALL = 1e-4  #: of a length and a radian, of that difference


@compiled()
def kicked(R: Any, free: Any, size: Any, normals: Any, kick: Any) -> None:
    """Write the twist ``size L'^-1 n`` with ``R = L L'``: of covariance ``size^2 R^-1``.

    The lower triangle of R is overwritten by L.
    """
    for i in range(6):
        if not free[i]:
            for j in range(6):
                R[i, j] = 0.0
                R[j, i] = 0.0
            R[i, i] = 1.0
    for j in range(6):
        for i in range(j, 6):
            s = R[i, j]
            for k in range(j):
                s -= R[i, k] * R[j, k]
            R[i, j] = np.sqrt(s) if i == j else s / R[j, j]
    for i in range(5, -1, -1):
        s = size * normals[i] if free[i] else 0.0
        for k in range(i + 1, 6):
            s -= R[k, i] * kick[k]
        kick[i] = s / R[i, i]


@compiled()
def add_divergence(
    table: Any, loads: Any, x: Any, q: Any, phase: Any, energy: Any, length: Any, n: Any,
    kick: Any, work: Any,
) -> None:  # fmt: skip
    """Add an unbiased ``k_B T div M``: M at two poses a random way n apart, times that way."""
    R, F, V, touch = work[:36].reshape((6, 6)), work[36:42], work[42:48], work[96:110]
    place, turned, way = work[55:58], work[58:62], work[62:65]
    for sense in (-1.0, 1.0):
        for i in range(3):
            way[i] = sense * SMALL * n[3 + i]
            place[i] = x[i]
        turn(q, way, turned)
        unit(turned)
        # the way's linear part in the lab, to first order
        w, a, b, c = q[0], q[1], q[2], q[3]
        u, v, s = n[0], n[1], n[2]
        d, e, f = 2.0 * (b * s - c * v), 2.0 * (c * u - a * s), 2.0 * (a * v - b * u)
        place[0] += sense * SMALL * length * (u + w * d + b * f - c * e)
        place[1] += sense * SMALL * length * (v + w * e + c * d - a * f)
        place[2] += sense * SMALL * length * (s + w * f + a * e - b * d)
        resist(table, place, turned, phase, R, F, touch, work[110:])
        if touch[0] <= 0.0:
            return
        for i in range(6):
            V[i] = n[i] / length if i < 3 else n[i]
        solve(R, V, loads.free)
        for i in range(6):
            kick[i] += sense * energy / (2.0 * SMALL) * V[i]


@compiled()
def noisy_step(
    table: Any, loads: Any, energy: Any, length: Any, t: Any, h: Any, x: Any, q: Any, phase: Any,
    normals: Any, work: Any,
) -> Any:  # fmt: skip
    """Step by a length h; x and q are overwritten. Returns the gap before it.

    If the step would reach through a boundary, x and q stay.
    """
    kick, out, u, s = work[65:71], work[71:79], work[79:82], work[82:85]
    place, turned, rest = work[85:88], work[88:92], work[110:]
    R, F, touch = work[:36].reshape((6, 6)), work[36:42], work[96:110]
    resist(table, x, q, phase + loads.rate * h / 2.0, R, F, touch, rest)
    before = touch[0]
    kicked(R, loads.free, np.sqrt(2.0 * energy / h), normals, kick)
    if table.kind != FREE:
        add_divergence(table, loads, x, q, phase, energy, length, normals[6:], kick, work)
    x0, x1, x2, r0, r1, r2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        u[i] = 0.0
        place[i] = x[i]
    for i in range(4):
        ahead = 0.0 if i == 0 else (h if i == 3 else h / 2.0)
        turn(q, u, turned)
        unit(turned)
        gap = velocity(
            table, loads, t + ahead, place, turned, phase + loads.rate * ahead, kick, out, rest
        )
        if gap <= 0.0:
            return before
        in_chart(u, out[3:6], s)
        weight = h / 6.0 if i == 0 or i == 3 else h / 3.0
        x0, x1, x2 = x0 + weight * out[0], x1 + weight * out[1], x2 + weight * out[2]
        r0, r1, r2 = r0 + weight * s[0], r1 + weight * s[1], r2 + weight * s[2]
        reach = h if i == 2 else h / 2.0
        for k in range(3):
            u[k] = reach * s[k]
            place[k] = x[k] + reach * out[k]
    u[0], u[1], u[2] = r0, r1, r2
    turn(q, u, turned)
    unit(turned)
    place[0], place[1], place[2] = x[0] + x0, x[1] + x1, x[2] + x2
    if table.kind != FREE:
        resist(table, place, turned, phase + loads.rate * h, R, F, touch, rest)
        if touch[0] <= 0.0:
            return before
    for i in range(3):
        x[i] = place[i]
    for i in range(4):
        q[i] = turned[i]
    return before


@loop(error_model="numpy")
def scatter(
    table: Any, loads: Any, energy: Any, length: Any, t: Any, h: Any, X: Any, Q: Any, phase: Any,
    normals: Any, least: Any,
) -> None:  # fmt: skip
    """Carry all paths, X (n, 3) and Q (n, 4), on by the steps of `normals` (steps, n, 12).

    `least` (n,) is lowered to the smallest gap of each.
    """
    n = X.shape[0]
    blocks = min(n, 8)
    for b in prange(blocks):
        work = np.empty(WORK)
        for i in range(b * n // blocks, (b + 1) * n // blocks):
            for k in range(normals.shape[0]):
                done = k * h
                at = phase + loads.rate * done
                gap = noisy_step(
                    table, loads, energy, length, t + done, h, X[i], Q[i], at, normals[k, i], work
                )
                least[i] = min(least[i], gap)
