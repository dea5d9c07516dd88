"""What a round tube adds to R and F_p of a tail that all but touches it, compiled.

Each piece of the tail is dragged by the tube's side as a cylinder by a plane: per length, beyond
what it is at a gap H, as a force on the piece that moves towards the side, along its own direction
on it and across,

    f(h) = 4 pi mu (1/(A - B), 1/(2 A), 1/A),   A = acosh(h/r),  B = sqrt(1 - r^2/h^2)

[Jeffrey & Onishi 1981], h the distance of its axis. Of a piece that leans by alpha
the lower side counts, ``r cos(alpha)`` below its axis. The tip is half a ball, and as much more of
one as it noses towards the side: with the share chi of the ball's pressure that lies on it,

    6 pi mu r chi (r/g, 8/15 log(1 + r/g)),   chi = (1 + X/sqrt(X^2 + 2 r g))/2,  X = r sin(alpha).

Not the whole answer, but what changes fast from pose to pose: what is left is smooth in the pose.
Gaps below the smallest gap solved count as that.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.poses.beside_wall import LEAST, SIGN, SIZE, TAIL_RADIUS, VISCOSITY
from microswim.numerics.compiling.compiled import FAST, compiled


@compiled(fastmath=FAST, error_model="numpy")
def near_tail(
    line: Any, tail: Any, numbers: Any, radius: Any, share: Any, R: Any, F: Any, work: Any
) -> None:
    """Add a share of it to R (6, 6), lower triangle and upper, and F_p (6,), frame of the tail."""
    last, thick = tail.shape[0] - 1, numbers[TAIL_RADIUS]
    t, n, N = work[:3], work[3:6], work[6:12]
    beyond = 1.0 + numbers[SIZE] / thick
    far_n, far_c = _beside(beyond)
    for i in range(tail.shape[0] if share != 0.0 else 0):
        low, high = max(i - 1, 0), min(i + 1, last)
        per = 1.0 / (high - low)
        length, rise, dist = _piece(line, tail, radius, (low, i, high), t, n)
        length *= per
        lean = np.sqrt(max(1.0 - rise * rise, 1e-12))
        h = 1.0 + max(dist - thick * lean, numbers[LEAST]) / thick
        along = 0.5 if i == 0 or i == last else 1.0
        weight = share * numbers[VISCOSITY] * along * length * lean
        if h < beyond:
            of_n, of_c = _beside(h)
            of_n, of_c = weight * (of_n - far_n), weight * (of_c - far_c)
            _drag(tail[i], t, n, (of_n, 0.5 * of_c, of_c), numbers, N, R, F)
        if i == last:
            gap = max(dist - thick, numbers[LEAST])
            nose = -thick * rise
            ball = 0.5 * (1.0 + nose / np.sqrt(nose * nose + 2.0 * thick * gap))
            ball *= 6.0 * np.pi * thick * numbers[VISCOSITY] * share
            side = ball * 8.0 / 15.0 * np.log(1.0 + thick / gap)
            _drag(tail[i], t, n, (ball * thick / gap, side, side), numbers, N, R, F)


@compiled(error_model="numpy")
def _beside(h: Any) -> Any:
    """Return drag per length towards a plane and across, of a cylinder of radius 1 at h."""
    A, B = np.arccosh(h), np.sqrt(1.0 - 1.0 / (h * h))
    return 4.0 * np.pi / (A - B), 4.0 * np.pi / A


@compiled(fastmath=FAST, error_model="numpy")
def _piece(line: Any, tail: Any, radius: Any, at: Any, t: Any, n: Any) -> Any:
    """Write a piece's direction along the tube's side, and the side's normal, (3,) each.

    Returns length between its neighbours, slope off the side and distance of its axis from it.
    """
    low, i, high = at
    along = 0.0
    for k in range(3):
        along += (line[3 + k] + tail[i, k]) * line[k]
    far = 0.0
    for k in range(3):
        n[k] = along * line[k] - line[3 + k] - tail[i, k]
        far += n[k] * n[k]
    far = np.sqrt(far) + 1e-300
    length = 0.0
    for k in range(3):
        n[k] /= far
        t[k] = tail[high, k] - tail[low, k]
        length += t[k] * t[k]
    length = np.sqrt(length)
    rise = 0.0
    for k in range(3):
        rise += t[k] * n[k] / length
    flat = 0.0
    for k in range(3):
        t[k] = t[k] / length - rise * n[k]
        flat += t[k] * t[k]
    flat = np.sqrt(flat) + 1e-12
    for k in range(3):
        t[k] /= flat
    return length, rise, radius - far


@compiled(fastmath=FAST, error_model="numpy")
def _drag(P: Any, t: Any, n: Any, f: Any, numbers: Any, N: Any, R: Any, F: Any) -> None:
    """Add drags towards the side, along t and across, where a piece's surface is nearest to it."""
    thick = numbers[TAIL_RADIUS]
    p0, p1, p2 = P[0] - thick * n[0], P[1] - thick * n[1], P[2] - thick * n[2]
    for axis in range(3):
        if axis == 0:
            N[0], N[1], N[2] = n[0], n[1], n[2]
        elif axis == 1:
            N[0], N[1], N[2] = t[0], t[1], t[2]
        else:
            N[0] = t[1] * n[2] - t[2] * n[1]
            N[1] = t[2] * n[0] - t[0] * n[2]
            N[2] = t[0] * n[1] - t[1] * n[0]
        N[3], N[4], N[5] = p1 * N[2] - p2 * N[1], p2 * N[0] - p0 * N[2], p0 * N[1] - p1 * N[0]
        comes = numbers[SIGN] * N[3]
        for j in range(6):
            pull = f[axis] * N[j]
            F[j] += pull * comes
            for k in range(6):
                R[j, k] += pull * N[k]
