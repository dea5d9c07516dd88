"""A unit ball beside a plane wall in a Stokes fluid of viscosity one, written for these tests.

What a singularity at the ball's centre makes on a wall at rest is undone by singularities at the
centre's image (Blake & Chwang 1974, J. Eng. Math. 8, 23), so that Lamb's general solution about
both (Happel & Brenner, Low Reynolds Number Hydrodynamics, sec. 3-2) is fitted to the ball's
velocity and to a wall at rest by least squares.
"""

import numpy as np

from oracles.two_spheres import _modes


def resistance(height, terms=24, places=60):
    """Resistance (6, 6) about the centre at z = height over the wall z = 0."""
    turn = np.array([0.3, 1.7, 3.3, 4.9])
    t, phi = _grid(np.polynomial.legendre.leggauss(places)[0], turn)
    across = np.sqrt(1 - t * t)
    sphere = np.array([across * np.cos(phi), across * np.sin(phi), t])
    far, phi = _grid(_along_the_wall(height, places), turn)
    wall = np.array([far * np.cos(phi), far * np.sin(phi), np.full_like(far, -height)])
    image = np.array([0.0, 0.0, -2.0 * height])[:, None]
    points = np.concatenate([sphere, wall], axis=1)
    A = np.concatenate([_modes(points, terms), _modes(points - image, terms)], axis=-1)
    b = np.zeros((points.shape[1], 3, 6))
    for i in range(3):
        b[: sphere.shape[1], :, i] = np.eye(3)[i]
        b[: sphere.shape[1], :, 3 + i] = np.cross(np.eye(3)[i], sphere.T)
    A, b = A.reshape(-1, A.shape[-1]), b.reshape(-1, 6)
    size = np.linalg.norm(A, axis=0)
    c = np.linalg.lstsq(A / size, b, rcond=1e-14)[0] / size[:, None]
    c = c.reshape(2, 3, terms, 3, 6)  # centre, kind, degree, order
    R = np.zeros((6, 6))
    for axis, order in ((2, 0), (0, 1), (1, 2)):
        R[axis] = 4 * np.pi * c[0, 0, 0, order]
        R[3 + axis] = 8 * np.pi * c[0, 2, 0, order]
    return R


def _grid(first, second):
    return (a.ravel() for a in np.meshgrid(first, second, indexing="ij"))


def _along_the_wall(height, places):
    """Distances from the ball's foot: close to it where the gap is small, out to a thousand."""
    gap = max(height - 1.0, 0.02)
    return np.concatenate([np.linspace(0.0, 3.0, places), np.geomspace(0.05 * gap, 1000.0, places)])
