"""A path step by step, compiled: adaptive, with values at any time in between.

Dormand and Prince's pair of orders 5 and 4 (1980), in position and in the rotation vector u since
the start of the step (Munthe-Kaas 1999),

    u' = w + u x w / 2 + (1 - (a/2) cot(a/2)) / a^2  u x (u x w),    a = |u|,

so that the quaternion keeps its norm; values within a step by their continuous extension of order
4 (Hairer, Norsett & Wanner 1993, II.6). A step that would reach through a boundary is not taken.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.poses.table import WORK as POSE_WORK
from microswim.gait.poses.table import near
from microswim.numerics.compiling.compiled import compiled
from microswim.numerics.rigid_motion import turn
from microswim.path.velocity import WORK, velocity

STAGES, WIDTH = 7, 8
_A = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0],
    ]
)
_C = _A.sum(axis=1)
#: Order 5 less order 4.
_E = np.array(
    [71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]
)  # fmt: skip
#: Weights of the stages within a step: powers 1 to 4 of the share of it.
_D = np.array(
    [
        [1, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0, 0, 0, 0],
        [0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0, 127303824393 / 49829197408, -318862633887 / 49829197408,
         701980252875 / 199316789632],
        [0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ]
)  # fmt: skip
DONE, STUCK, TOO_LONG = 0, 1, 2  #: how a march ends


@compiled()
def in_chart(u: Any, w: Any, out: Any) -> None:
    """Write the change of the rotation vector u while the body turns with w."""
    square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
    if square < 0.01:
        b = 1.0 / 12.0 + square * (1.0 / 720.0 + square / 30240.0)
    else:
        half = np.sqrt(square) / 2.0
        b = (1.0 - half * np.cos(half) / np.sin(half)) / square
    c0, c1, c2 = u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]
    out[0] = w[0] + c0 / 2.0 + b * (u[1] * c2 - u[2] * c1)
    out[1] = w[1] + c1 / 2.0 + b * (u[2] * c0 - u[0] * c2)
    out[2] = w[2] + c2 / 2.0 + b * (u[0] * c1 - u[1] * c0)


@compiled()
def unit(q: Any) -> None:
    """Take a Newton step towards norm 1; it keeps rounding from adding up."""
    square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]
    for i in range(4):
        q[i] *= 1.5 - 0.5 * square


@compiled()
def attempt(
    table: Any, loads: Any, t: Any, x: Any, q: Any, phase: Any, h: Any, K: Any, Y: Any, work: Any
) -> Any:
    """Write the stages 2 to 7 of a step into K (7, 8) and its change into Y (8,).

    Returns the smallest gap of all stages; where it is not positive the step is none. Leaves the
    velocity at its end in work[6:14].
    """
    kick, raw, turned = work[:6], work[6:14], work[14:18]
    place, rest = work[18:21], work[21:]
    least = np.inf
    for s in range(1, STAGES):
        for i in range(WIDTH):
            Y[i] = 0.0
            for r in range(s):
                Y[i] += h * _A[s, r] * K[r, i]
        turn(q, Y[3:6], turned)
        unit(turned)
        for i in range(3):
            place[i] = x[i] + Y[i]
        at = _C[s] * h
        gap = velocity(
            table, loads, t + at, place, turned, phase + loads.rate * at, kick, raw, rest
        )
        least = min(least, gap)
        if gap <= 0.0:
            return gap
        for i in range(WIDTH):
            K[s, i] = raw[i]
        in_chart(Y[3:6], raw[3:6], K[s, 3:6])
    return least


@compiled()
def error_of(K: Any, h: Any, tolerance: Any, length: Any) -> Any:
    """Return the error of a step in tolerances: of the place in lengths, of the turn in radians."""
    worst = 0.0
    for i in range(6):
        e = 0.0
        for s in range(STAGES):
            e += _E[s] * K[s, i]
        worst = max(worst, abs(h * e) / (tolerance * (length if i < 3 else 1.0)))
    return worst


@compiled()
def between(x: Any, q: Any, K: Any, h: Any, share: Any, X: Any, P: Any, Y: Any) -> None:
    """Write place and attitude at a share of a step; Y (8,) is the change since its start."""
    for i in range(WIDTH):
        Y[i] = 0.0
        for s in range(STAGES):
            d = _D[s]
            Y[i] += h * share * (d[0] + share * (d[1] + share * (d[2] + share * d[3]))) * K[s, i]
    for i in range(3):
        X[i] = x[i] + Y[i]
    turn(q, Y[3:6], P)
    unit(P)


@compiled(always=True)
def march(
    table: Any,
    loads: Any,
    times: Any,
    x: Any,
    q: Any,
    phase: Any,
    control: Any,
    X: Any,
    Q: Any,
    spent: Any,
) -> Any:
    """Follow a path from times[0] on; write places, attitudes and the two works at the times.

    `control` (6,): first step, longest step, tolerance, a length, most steps, and written: the
    smallest gap. x (3,), q (4,) and control[0] are overwritten by what the next march starts from.
    Returns how it ended and the number of steps.
    """
    work = np.zeros(21 + WORK)
    K, Y, turned = np.zeros((STAGES, WIDTH)), np.zeros(WIDTH), np.zeros(4)
    done, total = np.zeros(2), np.zeros(2)
    t, end, h = times[0], times[-1], control[0]
    X[0], Q[0], spent[0] = x, q, 0.0
    here, steps = 1, 0
    gap = velocity(table, loads, t, x, q, phase, work[:6], K[0], work[21:])
    if gap <= 0.0:
        return STUCK, steps
    control[5] = min(control[5], gap)
    while here < times.size:
        if steps >= control[4]:
            return TOO_LONG, steps
        h = min(h, control[1])
        last = t + h >= end - 1e-9 * h
        step = end - t if last else h
        steps += 1
        gap = attempt(table, loads, t, x, q, phase, step, K, Y, work)
        off = error_of(K, step, control[2], control[3]) if gap > 0.0 else np.inf
        if not off <= 1.0:
            h = step * (max(0.2, 0.9 * off**-0.2) if np.isfinite(off) else 0.2)
            if h < 1e-13 * max(abs(t), control[1], end - times[0]):
                return STUCK, steps
            continue
        control[5] = min(control[5], gap)
        for i in range(2):
            done[i] = Y[6 + i]
        while here < times.size and (times[here] <= t + step or last):
            between(x, q, K, step, (times[here] - t) / step, X[here], Q[here], Y)
            for i in range(2):
                spent[here, i] = total[i] + Y[6 + i]
            here += 1
        change(x, q, K, step, turned)
        for i in range(2):
            total[i] += done[i]
        t = end if last else t + step
        phase += loads.rate * step
        for i in range(WIDTH):  # the last stage is where the next step starts
            K[0, i] = work[6 + i]
        grown = step * min(5.0, max(0.2, 0.9 * max(off, 1e-10) ** -0.2))
        h = h if last and grown < h else grown
    control[0] = h
    return DONE, steps


@compiled()
def change(x: Any, q: Any, K: Any, h: Any, turned: Any) -> None:
    """Carry place and attitude over a step that was accepted."""
    u0, u1, u2 = 0.0, 0.0, 0.0
    for s in range(STAGES - 1):
        b = h * _A[6, s]
        x[0] += b * K[s, 0]
        x[1] += b * K[s, 1]
        x[2] += b * K[s, 2]
        u0, u1, u2 = u0 + b * K[s, 3], u1 + b * K[s, 4], u2 + b * K[s, 5]
    turn(q, (u0, u1, u2), turned)
    unit(turned)
    for i in range(4):
        q[i] = turned[i]


@compiled(always=True)
def gaps_along(table: Any, X: Any, Q: Any, phases: Any, out: Any) -> None:
    """Write the gap to the boundary at places (n, 3), attitudes (n, 4) and phases (n,)."""
    touch, work = np.empty(14), np.empty(POSE_WORK)
    for i in range(phases.size):
        out[i] = near(table, X[i], Q[i], phases[i], touch, work)
