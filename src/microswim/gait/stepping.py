"""One step of a gait, compiled: phase, pose and loads in, pose out.

The state is position x (lab), quaternion q (``wxyz``, body to lab) and phase. Order 4: see
trajectory. Everything is analytic, so that complex-step derivatives run through it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.rigid_motion import to_lab, turn
from microswim.numerics.solve6 import solve

LOWER = [(i, j) for i in range(6) for j in range(i + 1)]


def length_of(gait: Gait) -> float:
    """Return a length of the swimmer, from its resistances to turning and to moving."""
    R = np.real(gait.resistance(0.0))
    return float(np.sqrt(np.trace(R[3:, 3:]) / np.trace(R[:3, :3])))


def pack(gait: Gait) -> np.ndarray:
    """Return series of the lower triangle of R (21 columns) and F_p (6 columns), shape (1 + 2 H,
    27).
    """
    R, F = gait.resistance_series, gait.propulsion_series
    packed = np.zeros((max(len(R), len(F)), 27), dtype=np.result_type(R, F))
    packed[: len(R), :21] = np.stack([R[:, i, j] for i, j in LOWER], axis=-1)
    packed[: len(F), 21:] = F
    return packed


WORK = 6 * 6 + 6 + 27 + 4 + 3


@compiled(fastmath=FAST, error_model="numpy")
def row(table: Any, phase: Any, out: Any) -> None:
    """Write the value of a table of series at a phase; multiples of it by angle addition."""
    n, m = table.shape
    for j in range(m):
        out[j] = table[0, j]
    if n == 1:
        return
    c1, s1 = np.cos(phase), np.sin(phase)
    c, s = c1, s1
    for h in range(1, n, 2):
        for j in range(m):
            out[j] += c * table[h, j] + s * table[h + 1, j]
        c, s = c * c1 - s * s1, s * c1 + c * s1


@compiled()
def twist(packed: Any, free: Any, q: Any, phase: Any, rate: Any, load: Any, work: Any) -> None:
    """Write the velocity ``V = R^-1 (W - F_p rate)``, body frame [Tabak Eq. 15], to work[36:42].

    `load` (5, 3): force, torque, field and flow in the lab frame, magnetic moment in the body
    frame; the torque of the field is ``m x B``.
    """
    R, V, values = work[:36].reshape((6, 6, *work.shape[1:])), work[36:42], work[42:69]
    row(packed, phase, values)
    m = 0
    for i in range(6):
        for j in range(i + 1):
            R[i, j] = values[m]
            m += 1
        V[i] = values[21 + i]
    f0, f1, f2 = to_lab(q, load[0, 0], load[0, 1], load[0, 2], -1.0)
    t0, t1, t2 = to_lab(q, load[1, 0], load[1, 1], load[1, 2], -1.0)
    b0, b1, b2 = to_lab(q, load[2, 0], load[2, 1], load[2, 2], -1.0)
    m0, m1, m2 = load[4, 0], load[4, 1], load[4, 2]
    V[0] = f0 - V[0] * rate
    V[1] = f1 - V[1] * rate
    V[2] = f2 - V[2] * rate
    V[3] = t0 + m1 * b2 - m2 * b1 - V[3] * rate
    V[4] = t1 + m2 * b0 - m0 * b2 - V[4] * rate
    V[5] = t2 + m0 * b1 - m1 * b0 - V[5] * rate
    solve(R, V, free)


@compiled()
def step(
    packed: Any, free: Any, x: Any, q: Any, phase: Any, h: Any, rates: Any, loads: Any, work: Any
) -> Any:
    """Return one Runge-Kutta-Munthe-Kaas step of order 4; x and q are overwritten, the phase
    returned.

    `rates` (3,) and `loads` (3, 5, 3) at the start, the middle and the end of the step; with one
    row each they are constant. `work` is scratch of `WORK` numbers.
    """
    V, turned, u = work[36:42], work[69:73], work[73:76]
    d, e = rates.shape[0] // 2, loads.shape[0] // 2
    half = phase + h * (5.0 * rates[0] + 8.0 * rates[d] - rates[2 * d]) / 24.0
    end = phase + h * (rates[0] + 4.0 * rates[d] + rates[2 * d]) / 6.0
    x0, x1, x2 = 0 * phase, 0 * phase, 0 * phase  # moved
    r0, r1, r2 = 0 * phase, 0 * phase, 0 * phase  # turned
    u[0], u[1], u[2] = 0 * phase, 0 * phase, 0 * phase
    for i in range(4):
        at = (i + 1) // 2
        here = phase if i == 0 else (end if i == 3 else half)
        weight = h / 6.0 if i == 0 or i == 3 else h / 3.0
        turn(q, u, turned)
        twist(packed, free, turned, here, rates[at * d], loads[at * e], work)
        flow = loads[at * e, 3]
        v0, v1, v2 = to_lab(turned, V[0], V[1], V[2], 1.0)
        x0 += weight * (v0 + flow[0])
        x1 += weight * (v1 + flow[1])
        x2 += weight * (v2 + flow[2])
        # u' = w + u x w / 2 + u x (u x w) / 12
        c0, c1, c2 = u[1] * V[5] - u[2] * V[4], u[2] * V[3] - u[0] * V[5], u[0] * V[4] - u[1] * V[3]
        s0 = V[3] + c0 / 2.0 + (u[1] * c2 - u[2] * c1) / 12.0
        s1 = V[4] + c1 / 2.0 + (u[2] * c0 - u[0] * c2) / 12.0
        s2 = V[5] + c2 / 2.0 + (u[0] * c1 - u[1] * c0) / 12.0
        r0 += weight * s0
        r1 += weight * s1
        r2 += weight * s2
        ahead = h if i == 2 else h / 2.0
        u[0], u[1], u[2] = ahead * s0, ahead * s1, ahead * s2
    x[0] += x0
    x[1] += x1
    x[2] += x2
    u[0], u[1], u[2] = r0, r1, r2
    turn(q, u, turned)
    square = turned[0] ** 2 + turned[1] ** 2 + turned[2] ** 2 + turned[3] ** 2
    for i in range(4):  # one Newton step towards norm 1 keeps rounding from adding up
        q[i] = turned[i] * (1.5 - 0.5 * square)
    return end


@compiled(always=True)
def integrate(
    packed: Any,
    free: Any,
    x: Any,
    q: Any,
    phase: Any,
    times: Any,
    counts: Any,
    rates: Any,
    loads: Any,
) -> Any:
    """Return states at `times`; between times[i-1] and times[i] there are counts[i] equal steps.

    `rates` (n,) and `loads` (n, 5, 3) at starts, middles and ends of all steps in a row
    (n = 2 steps + 1), or at one time for constant ones (n = 1).
    """
    n = times.size
    X = np.empty((n, 3), dtype=packed.dtype)
    Q = np.empty((n, 4), dtype=packed.dtype)
    phases = np.empty(n, dtype=packed.dtype)
    work = np.empty(WORK, dtype=packed.dtype)
    x, q = x.copy(), q.copy()
    a = 2 if rates.shape[0] > 1 else 0
    b = 2 if loads.shape[0] > 1 else 0
    here = 0
    for i in range(n):
        for _ in range(counts[i]):
            h = (times[i] - times[i - 1]) / counts[i]
            r, w = rates[a * here : a * here + a + 1], loads[b * here : b * here + b + 1]
            phase = step(packed, free, x, q, phase, h, r, w, work)
            here += 1
        X[i], Q[i], phases[i] = x, q, phase
    return X, Q, phases
