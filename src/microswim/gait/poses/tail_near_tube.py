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
    """Add a share of it to R (6, 6) and F_p (6,), frame of the tail; `work` (51,) is lost."""
    last, thick = tail.shape[0] - 1, numbers[TAIL_RADIUS]
    T, K = work[:36].reshape((6, 6)), work[36:45].reshape((3, 3))
    t, n = work[45:48], work[48:51]
    T[:] = 0.0
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
            _drag(tail[i], t, n, (of_n, 0.5 * of_c, of_c), thick, K, T)
        if i == last:
            gap = max(dist - thick, numbers[LEAST])
            nose = -thick * rise
            ball = 0.5 * (1.0 + nose / np.sqrt(nose * nose + 2.0 * thick * gap))
            ball *= 6.0 * np.pi * thick * numbers[VISCOSITY] * share
            side = ball * 8.0 / 15.0 * np.log(1.0 + thick / gap)
            _drag(tail[i], t, n, (ball * thick / gap, side, side), thick, K, T)
    for i in range(6):
        F[i] += numbers[SIGN] * (T[3, i] if i < 3 else T[i, 3])  # the tail turns about s
        for j in range(6):
            R[i, j] += T[j, i] if i < 3 <= j else T[i, j]


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
def _drag(P: Any, t: Any, n: Any, f: Any, thick: Any, K: Any, T: Any) -> None:
    """Add a piece's drags f towards the side, along t and across, where it is nearest to it.

    ``K = f_n n n' + f_t t t' + f_c (1 - n n' - t t')`` at p: to T (6, 6), but its upper right.
    """
    p = (P[0] - thick * n[0], P[1] - thick * n[1], P[2] - thick * n[2])
    for i in range(3):
        for j in range(3):
            K[i, j] = (f[0] - f[2]) * n[i] * n[j] + (f[1] - f[2]) * t[i] * t[j]
        K[i, i] += f[2]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        a = p[j] * K[k, 0] - p[k] * K[j, 0]
        b = p[j] * K[k, 1] - p[k] * K[j, 1]
        c = p[j] * K[k, 2] - p[k] * K[j, 2]
        T[i, 0] += K[i, 0]
        T[i, 1] += K[i, 1]
        T[i, 2] += K[i, 2]
        T[3 + i, 0] += a
        T[3 + i, 1] += b
        T[3 + i, 2] += c
        T[3 + i, 3] += p[1] * c - p[2] * b
        T[3 + i, 4] += p[2] * a - p[0] * c
        T[3 + i, 5] += p[0] * b - p[1] * a
