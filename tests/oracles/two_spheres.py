"""Two rigid unit spheres in a Stokes fluid of viscosity one, written for these tests alone.

Along the line of centres the series in bispherical coordinates: Stimson & Jeffery (1926) Proc. R.
Soc. A 111, 110, both spheres moving alike; Maude (1961) Br. J. Appl. Phys. 12, 293 and Brenner
(1961) Chem. Eng. Sci. 16, 242, towards each other. For every motion Lamb's general solution about
both centres (Happel & Brenner, Low Reynolds Number Hydrodynamics, sec. 3-2), fitted to the boundary
values by least squares.
"""

import numpy as np


def along(gap, opposed=False):
    """Force on a sphere over 6 pi for unit speed along the line of centres."""
    alpha = np.arccosh(1.0 + gap / 2.0)
    n = np.arange(1.0, min(300.0 / alpha, 4000.0))
    sinh, cosh = np.sinh, np.cosh
    if opposed:
        above = 4 * cosh((n + 0.5) * alpha) ** 2 + (2 * n + 1) ** 2 * sinh(alpha) ** 2
        below = 2 * sinh((2 * n + 1) * alpha) - (2 * n + 1) * sinh(2 * alpha)
        term = above / below - 1.0
    else:
        above = 4 * sinh((n + 0.5) * alpha) ** 2 - (2 * n + 1) ** 2 * sinh(alpha) ** 2
        below = 2 * sinh((2 * n + 1) * alpha) + (2 * n + 1) * sinh(2 * alpha)
        term = 1.0 - above / below
    weight = n * (n + 1) / ((2 * n - 1) * (2 * n + 3))
    return 4.0 / 3.0 * sinh(alpha) * np.sum(weight * term)


def _decaying(X, terms):
    """Decaying solid harmonics (n, 3, points) of degree -(n + 1), orders 0, cos, sin about z."""
    x, y, z = X
    r2 = x * x + y * y + z * z
    zonal, first = [np.ones_like(z), z], [np.zeros_like(z), np.ones_like(z)]
    for n in range(1, terms):
        zonal.append(((2 * n + 1) * z * zonal[n] - n * r2 * zonal[n - 1]) / (n + 1))
        first.append(((2 * n + 1) * z * first[n] - (n + 1) * r2 * first[n - 1]) / n)
    both = [[zonal[n], x * first[n] / n, y * first[n] / n] for n in range(1, terms + 1)]
    power = np.array([r2 ** -(n + 0.5) for n in range(1, terms + 1)])
    return np.array(both) * power[:, None]


def _modes(X, terms):
    """Velocities (points, 3, modes) of Lamb's solution, pressure, potential and swirl in turn."""
    value = _decaying(X, terms)
    step = 1e-30
    slope = np.stack([
        _decaying(X + 1j * step * np.eye(3)[k][:, None], terms).imag / step for k in range(3)
    ], axis=-1)  # fmt: skip
    n = np.arange(1, terms + 1)[:, None, None, None]
    r2, R = np.sum(X * X, axis=0)[:, None], X.T
    pressure = (n + 1) / (n * (2 * n - 1)) * R * value[..., None]
    pressure = pressure - (n - 2) / (2 * n * (2 * n - 1)) * r2 * slope
    swirl = np.cross(slope, np.broadcast_to(R, slope.shape))
    all_ = np.stack([pressure, slope, swirl])
    return np.moveaxis(all_.reshape(-1, *all_.shape[-2:]), 0, -1)


def resistance(gap, terms=40, places=90):
    """Resistance (12, 12) about the centres, the second sphere at z = 2 + gap from the first."""
    cosine = np.polynomial.legendre.leggauss(places)[0]
    turn = np.array([0.3, 1.7, 3.3, 4.9])
    t, phi = (a.ravel() for a in np.meshgrid(cosine, turn, indexing="ij"))
    across = np.sqrt(1 - t * t)
    sphere = np.array([across * np.cos(phi), across * np.sin(phi), t])
    apart = np.array([0.0, 0.0, 2.0 + gap])[:, None]
    rows, values = [], []
    for k in range(2):  # the surface of sphere k, seen from both centres
        seen = [sphere + (k - j) * apart for j in range(2)]
        rows.append(np.concatenate([_modes(s, terms) for s in seen], axis=-1))
        u = np.zeros((sphere.shape[1], 3, 12))
        for i in range(3):
            u[..., 6 * k + i] = np.eye(3)[i]
            u[..., 6 * k + 3 + i] = np.cross(np.eye(3)[i], sphere.T)
        values.append(u)
    A = np.concatenate(rows).reshape(-1, rows[0].shape[-1])
    b = np.concatenate(values).reshape(-1, 12)
    size = np.linalg.norm(A, axis=0)
    c = np.linalg.lstsq(A / size, b, rcond=1e-14)[0] / size[:, None]
    c = c.reshape(2, 3, terms, 3, 12)  # sphere, kind, degree, order
    R = np.zeros((12, 12))
    for k in range(2):  # F = 4 pi grad(r^3 p_-2), T = 8 pi grad(r^3 chi_-2) on the fluid
        for axis, order in ((2, 0), (0, 1), (1, 2)):
            R[6 * k + axis] = 4 * np.pi * c[k, 0, 0, order]
            R[6 * k + 3 + axis] = 8 * np.pi * c[k, 2, 0, order]
    return R
