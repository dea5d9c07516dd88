"""Slender-body theory of Lighthill, written for these tests alone, and closed forms for a slender
torus.

Lighthill (1976) SIAM Review 18, 161: on the centreline of a filament of radius a,

    u(s) = f_n(s) / (4 pi mu) + int_{|R| > delta} (f / R + (R . f) R / R^3) ds' / (8 pi mu),

with f the force per length on the fluid, f_n its part normal to the tangent, delta = a sqrt(e) / 2.
"""

import numpy as np


def lighthill_resistance(position, tangent, length, radius, viscosity=1.0, order=4):
    """Resistance matrix (6, 6) about the origin of a rigid filament.

    position(x), tangent(x): arrays (n, 3) of the centreline at arc lengths x in [0, length].
    The force is constant on segments of length 2 delta, so that the excluded stretch is the own
    segment.
    """
    n = round(length / (radius * np.sqrt(np.e)))
    h = length / n
    middle = (np.arange(n) + 0.5) * h
    x, w = np.polynomial.legendre.leggauss(order)
    points = position((middle[:, None] + 0.5 * h * x).ravel()).reshape(n, order, 3)
    P, t = position(middle), tangent(middle)
    A = np.zeros((n, 3, n, 3))
    for m in range(order):
        R = P[:, None] - points[None, :, m]
        d = np.linalg.norm(R, axis=-1)
        np.fill_diagonal(d, np.inf)
        kernel = np.eye(3) / d[..., None, None]
        kernel += R[..., :, None] * R[..., None, :] / d[..., None, None] ** 3
        A += (0.5 * h * w[m] * kernel).transpose(0, 2, 1, 3)
    own = np.arange(n)
    A[own, :, own, :] += 2.0 * (np.eye(3) - t[:, :, None] * t[:, None, :])
    modes = np.zeros((n, 3, 6))
    for i in range(3):
        modes[:, i, i] = 1.0
        modes[:, :, 3 + i] = np.cross(np.eye(3)[i], P)
    f = np.linalg.solve(A.reshape(3 * n, 3 * n), 8 * np.pi * viscosity * modes.reshape(3 * n, 6))
    return h * modes.reshape(3 * n, 6).T @ f


def helix(axial_length, amplitude, wavelength):
    """Position and tangent by arc length, and the arc length, of a left-handed helix about s."""
    k = 2 * np.pi / wavelength
    stretch = np.sqrt(1 + (amplitude * k) ** 2)

    def position(x):
        a = k * x / stretch
        return np.stack([x / stretch, amplitude * np.cos(a), -amplitude * np.sin(a)], axis=-1)

    def tangent(x):
        a = k * x / stretch
        rows = [np.ones_like(x), -amplitude * k * np.sin(a), -amplitude * k * np.cos(a)]
        return np.stack(rows, axis=-1) / stretch

    return position, tangent, axial_length * stretch


def slender_torus(ratio):
    """Axial drag, lateral drag, axial torque of a torus with ring radius and viscosity one.

    ratio = tube over ring radius; errors of order ratio^2 log(ratio). Johnson & Wu (1979) J. Fluid
    Mech. 95, 263 (the leading terms in E = log(8 / ratio)).
    """
    E = np.log(8 / ratio)
    axial = 8 * np.pi**2 / (E + 0.5)
    lateral = 2 * np.pi**2 * (3 * E - 8.5) / ((E - 0.5) * (E - 2) - 2)
    return axial, lateral, 4 * np.pi**2 / (E - 2)
