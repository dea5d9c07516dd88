"""From R and F_p at a grid of poses to the coefficients that `beside_wall.interpolate` sums."""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array


def factors(R: Array, F: Array, normal: Array, length: float, viscosity: float) -> Array:
    """Return log D (6,), M below its diagonal (15,) and z (6,) of ``R = M D M'``, ``F_p = M D z``.

    Parameters
    ----------
    R, F
        (6, 6) and (6,), body frame.
    normal
        Of the wall into the fluid, body frame (3,).
    length, viscosity
        Units of what is returned.

    Raises
    ------
    numpy.linalg.LinAlgError
        If R is not positive definite.
    """
    c, across = normal[0], np.hypot(normal[1], normal[2])
    cosine, sine = (normal[1] / across, normal[2] / across) if across > 1e-12 else (1.0, 0.0)
    n = np.array([c, across * cosine, across * sine])
    t = np.array([across, -c * cosine, -c * sine])
    r = np.array([0.0, -sine, cosine])
    rows = np.zeros((6, 6))
    for k, (axis, half) in enumerate(((n, 0), (r, 3), (t, 0), (r, 0), (n, 3), (t, 3))):
        rows[k, half : half + 3] = axis / (length if half else 1.0)
    A = rows @ R @ rows.T / (viscosity * length)
    L = np.linalg.cholesky(0.5 * (A + A.T))
    D = np.diag(L)
    M = L / D
    z = np.linalg.solve(L, rows @ F / (viscosity * length**2)) / D
    return np.concatenate([2.0 * np.log(D), M[np.tril_indices(6, -1)], z])


def coefficients(values: Array) -> Array:
    """Return coefficients (2, n + 2, m + 2, k + 3, 28) through values (2, n, m, k, 28).

    Side, xi from the smallest gap to infinity, |sigma| from 0 to 1, the tail's phase over a full
    turn, of which the last is the first.
    """
    series = np.concatenate([values, values[:, :, :, :1]], axis=3)
    for axis in (1, 2, 3):
        series = np.moveaxis(_spline(np.moveaxis(series, axis, 0)), 0, axis)
    return np.ascontiguousarray(series)


def _spline(values: Array) -> Array:
    """Coefficients (n + 2, ...) of uniform cubic B-splines through n values, not-a-knot ends.

    ``(c_i + 4 c_i+1 + c_i+2)/6 = f_i``; the third derivative is the same on the first two
    intervals, and on the last two: the fourth difference of c vanishes.
    """
    n = len(values)
    A = np.zeros((n + 2, n + 2))
    for i in range(n):
        A[i + 1, i : i + 3] = 1 / 6, 4 / 6, 1 / 6
    A[0, :5] = A[-1, -5:] = 1.0, -4.0, 6.0, -4.0, 1.0
    right = np.zeros((n + 2, *values.shape[1:]))
    right[1:-1] = values
    return np.asarray(np.linalg.solve(A, right.reshape(n + 2, -1)), float).reshape(right.shape)
