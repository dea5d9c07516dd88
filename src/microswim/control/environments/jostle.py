"""Thermal noise and tumbles inside compiled environments: after each step a random displacement.

As `microswim.control.thermal`, with the streams of `random_streams`: covariance ``2 k_B T M dt`` in
the body frame, carried out by the exponential of rigid motions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.control.environments.random_streams import normals, uniform
from microswim.control.motion import ratios, turned
from microswim.gait.stepping import row
from microswim.numerics.compiling.compiled import njit
from microswim.numerics.rigid_motion import to_lab


@njit(cache=True)
def rooted(M: Any, n: Any, z: Any, L: Any) -> None:
    """Write ``L n`` with ``M = L L'``, M packed row by row; motions that are held stay zero."""
    for i in range(6):
        z[i] = 0.0
        for j in range(i + 1):
            rest = M[i * (i + 1) // 2 + j]
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            if i == j:
                L[i, i] = np.sqrt(rest) if rest > 0.0 else 0.0
            else:
                L[i, j] = rest / L[j, j] if L[j, j] > 0.0 else 0.0
            z[i] += L[i, j] * n[j]


@njit(cache=True)
def tumble(y: Any, expected: float, angle: float, keys: Any, i: int) -> None:
    """Turn a state by an angle about random axes across s, a number of times that is Poisson's with
    a mean; the stream of key i moves on.
    """
    left = expected + np.log(uniform(keys, i))
    while left > 0.0:
        about = 2.0 * np.pi * uniform(keys, i)
        axis = (0.0, angle * np.cos(about), angle * np.sin(about))
        y[3], y[4], y[5], y[6] = turned((y[3], y[4], y[5], y[6]), axis)
        left += np.log(uniform(keys, i))


@njit(cache=True)
def jostle(twist: Any, y: Any, size: float, keys: Any, i: int) -> None:
    """Move a state by a twist of covariance ``size^2 M``; the stream of key i moves on."""
    work, n, z, L = np.empty(27), np.empty(6), np.empty(6), np.zeros((6, 6))
    for k in range(3):
        n[2 * k], n[2 * k + 1] = normals(keys, i)
    row(twist, y[7], work)
    rooted(work, n, z, L)
    for k in range(6):
        z[k] *= size
    displace(y, z)


@njit(cache=True)
def displace(y: Any, z: Any) -> None:
    """Move a state by a twist (6,), body frame, by the exponential of rigid motions."""
    a, b, c, u, v, w = z[3], z[4], z[5], z[0], z[1], z[2]
    square = a * a + b * b + c * c
    sine, versine = ratios(square)
    third = (1.0 - sine) / square if square > 1e-6 else 1.0 / 6.0 - square / 120.0
    d, e, f = b * w - c * v, c * u - a * w, a * v - b * u
    g, h, j = b * f - c * e, c * d - a * f, a * e - b * d
    q = (y[3], y[4], y[5], y[6])
    p0, p1, p2 = to_lab(
        q,
        u + versine * d + third * g,
        v + versine * e + third * h,
        w + versine * f + third * j,
        1.0,
    )
    y[0], y[1], y[2] = y[0] + p0, y[1] + p1, y[2] + p2
    q0, q1, q2, q3 = turned(q, (a, b, c))
    one = np.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    y[3], y[4], y[5], y[6] = q0 / one, q1 / one, q2 / one, q3 / one
