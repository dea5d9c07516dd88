"""Drag of a ball on the axis of a tube, to rounding: multipoles and their images in the tube.

The flow of a ball of radius 1 is ``sum_m c_m d^m/dz^m (Stokeslet) / m!`` (m even) and
``d^m/dz^m (grad 1/r) / m!`` (m odd): the problem of Haberman & Sayre (1958) and Bohlin. A tube
is the same all along, so the image of a derivative is the derivative of the image: of wave number
k it is that of ``K0(k rho)`` in ``I0(k rho)``, two conditions on the wall. The c_m are fitted to
``u = e_z`` on the ball.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import eval_legendre, factorial, ive, kve


def drag(ratio: float, terms: int = 20, waves: int = 400, points: int = 200) -> float:
    """Return the drag over 6 pi mu a U of a ball `ratio` times as wide as the tube."""
    b = 1.0 / ratio
    t, weight = np.polynomial.legendre.leggauss(waves)
    t, most = 0.5 * (t + 1.0), (60.0 + 4.0 * terms) / b
    k, dk = most * t**3, most * 1.5 * t**2 * weight * 2.0 / np.pi
    theta = (np.arange(points) + 0.5) / points * 0.5 * np.pi
    images = _images(k, b, np.cos(theta), np.sin(theta))
    columns = []
    for m in range(0, 2 * terms, 2):
        own = _of_stokeslet(m, theta) + (_gradient(m - 1, theta) if m else 0.0)
        sign = (-1.0) ** (m // 2)
        columns.append(own + images[0] @ (sign * k**m / factorial(m) * dk))
        own = -_gradient(m + 1, theta)
        columns.append(own + images[1] @ (sign * k**m / factorial(m + 1) * dk))
    A = np.array([c.ravel() for c in columns]).T
    size = np.linalg.norm(A, axis=0)
    asked = np.repeat([1.0, 0.0], points)
    found = np.linalg.lstsq(A / size, asked, rcond=None)[0] / size
    return float(4.0 / 3.0 * found[0])


def _potential(m: int, theta: Any) -> Any:
    """``P_m / r^(m+1)`` on the ball, and its gradient along z and rho (2, n)."""
    c = np.cos(theta)
    P = eval_legendre(m, c)
    along = -(m + 1) * eval_legendre(m + 1, c)
    return P, np.stack([along, (-(m + 1) * P - c * along) / np.sin(theta)])


def _gradient(m: int, theta: Any) -> Any:
    return _potential(m, theta)[1]


def _of_stokeslet(m: int, theta: Any) -> Any:
    """``phi e_z - z grad phi`` of that potential, (2, n)."""
    P, slope = _potential(m, theta)
    return np.stack([P, 0.0 * P]) - np.cos(theta) * slope


def _images(k: Any, b: float, z: Any, rho: Any) -> list[Any]:
    """Images (2, n, waves) of a Stokeslet and of ``d/dz grad 1/r``, scaled Bessel functions."""
    X, R = k * b, np.outer(rho, k)
    I0, I1, I2 = (ive(n, X) for n in range(3))
    K0, K1 = kve(0, X), kve(1, X)
    falls = np.exp(R - 2.0 * X)
    turns = np.cos(np.outer(z, k)) * falls, np.sin(np.outer(z, k)) * falls
    i0, i1, i2 = (ive(n, R) for n in range(3))
    found = []
    for along, out in ((2 * K0 - X * K1, X * K0), (-(k**2) * K0, k**2 * K1)):
        det = X * (I0 * I2 - I1 * I1)
        p, q = X * (out * I1 - along * I2) / det, (along * I1 - out * I0) / det
        found.append(np.stack([(p * i0 + q * R * i1) * turns[0], (p * i1 + q * R * i2) * turns[1]]))
    return found
