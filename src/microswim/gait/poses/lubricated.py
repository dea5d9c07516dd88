"""Lubrication where body or tail all but touch a boundary, compiled; by a wall and in a tube.

N is the wrench of a unit force across the gap at the nearest point, ``N' R^-1 N`` what the point
yields to it. Below the smallest gap solved, g_0, R goes on as lubrication has it, for body and tail
each, and with it all that the boundary does to a swimmer along N:

    R + c N N',   F_p + c a N,   G + c a^2,   c = (g_0/g - 1) / (N' R^-1 N),

a the velocity per unit phase rate with which the nearest point comes off the boundary: the
dissipation of body and motor together stays one positive form.
"""

from __future__ import annotations

from typing import Any

from microswim.gait.poses.beside_wall import LEAST, LENGTH, SIGN
from microswim.numerics.compiling.compiled import compiled
from microswim.numerics.solve6 import solve

NEAR = 0.5  #: gap from which on a wall keeps a flow off, in half axes of the body


@compiled()
def ease(touch: Any, R: Any, N: Any, work: Any) -> Any:
    """Write N (6,), the wrench of a unit force at what touches, and ``R^-1 N`` to work[:6].

    Returns ``N' R^-1 N``.
    """
    V, A = work[:6], work[6:42].reshape((6, 6))
    for i in range(3):
        N[i], N[3 + i] = touch[4 + i], touch[1 + i]
    for i in range(6):
        V[i] = N[i]
        for j in range(6):
            A[i, j] = R[i, j]
    solve(A, V, (True, True, True, True, True, True))
    found = 0.0
    for i in range(6):
        found += N[i] * V[i]
    return found


@compiled(error_model="numpy")
def continued(numbers: Any, touch: Any, R: Any, F: Any, work: Any) -> Any:
    """Add what grows like 1/gap below the smallest gap solved, for body and then for tail.

    `touch` (14,): body, then tail. Returns what is added to G.
    """
    rises = numbers[SIGN] * touch[8]
    first = grown(numbers, touch[:7], 0.0, R, F, work)
    return first + grown(numbers, touch[7:], rises, R, F, work)


@compiled(error_model="numpy")
def grown(numbers: Any, touch: Any, comes: Any, R: Any, F: Any, work: Any) -> Any:
    """Add what grows like 1/gap at one nearest point, which comes off by `comes` per phase rate."""
    gap = touch[0]
    if not gap < numbers[LEAST]:
        return 0.0
    N = work[:6]
    yields = ease(touch, R, N, work[6:])
    c = (numbers[LEAST] / max(gap, 1e-12 * numbers[LENGTH]) - 1.0) / yields
    for i in range(6):
        F[i] += c * comes * N[i]
        for j in range(6):
            R[i, j] += c * N[i] * N[j]
    return c * comes * comes


@compiled(error_model="numpy")
def kept_off(numbers: Any, touch: Any, R: Any, U: Any, D: Any, work: Any) -> None:
    """Hold what a flow does to a swimmer in a tube bounded below the smallest gap solved.

    R (U + D), the wrench of the flow on the swimmer held, does not grow as R does in `continued`:
    of N . (U + D) it leaves g/g_0. U (6,): flow and rotation at the centre.
    """
    least = numbers[LEAST]
    first = max(touch[0], 0.0) / least if touch[0] < least else 1.0
    second = max(touch[7], 0.0) / least if touch[7] < least else 1.0
    _held(touch, R, U, D, first, second, work)


@compiled(error_model="numpy")
def kept_off_wall(numbers: Any, touch: Any, R: Any, free: Any, U: Any, D: Any, work: Any) -> None:
    """Hold what a flow does to a swimmer close to a wall to what it does in free fluid.

    R U would press it onto the wall with ``(N . U) / (N' R^-1 N)``, which grows as R does, though
    the flow is at rest there: across the gap it presses as in free fluid, R_0 (`free`), so that of
    N . (U + D) ``(N' R^-1 N) / (N' R_0^-1 N)`` is left. It sets in at `NEAR` half axes of the body.
    """
    left, reach = work[:2], NEAR * numbers[LENGTH]
    for k in range(2):
        left[k] = 1.0
        part = touch[7 * k : 7 * k + 7]
        if part[0] < reach:
            there = ease(part, free, work[2:8], work[8:])
            held = 1.0 - min(ease(part, R, work[2:8], work[8:]) / there, 1.0)
            left[k] -= held * (1.0 - max(part[0], 0.0) / reach) ** 2
    _held(touch, R, U, D, left[0], left[1], work[2:])


@compiled(error_model="numpy")
def _held(touch: Any, R: Any, U: Any, D: Any, first: Any, second: Any, work: Any) -> None:
    """Leave shares of N . (U + D) of the two parts: ``D - R^-1 (a N_1 + b N_2)``, both at once.

    Where both are as good as one, the first alone.
    """
    N, V, M, W = work[:6], work[6:12], work[12:18], work[18:24]
    here, there, a, b, c = 1.0, 1.0, 0.0, 0.0, 0.0
    toward, other = 0.0, 0.0
    if first < 1.0:
        here = ease(touch[:7], R, N, work[24:])
        for i in range(6):
            V[i] = work[24 + i]
            toward += (1.0 - first) * N[i] * (U[i] + D[i])
    if second < 1.0:
        there = ease(touch[7:], R, M, work[24:])
        for i in range(6):
            W[i] = work[24 + i]
            other += (1.0 - second) * M[i] * (U[i] + D[i])
    if first < 1.0 and second < 1.0:
        for i in range(6):
            c += N[i] * W[i]
    whole = here * there - c * c
    if whole > 1e-9 * here * there:
        a, b = (toward * there - other * c) / whole, (other * here - toward * c) / whole
    else:
        a = toward / here
    for i in range(6):
        if first < 1.0:
            D[i] -= a * V[i]
        if second < 1.0:
            D[i] -= b * W[i]
