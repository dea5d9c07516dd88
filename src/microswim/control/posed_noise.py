"""Thermal displacement beside a boundary, on top of a step: as `thermal`, M of the pose.

    z = sqrt(2 k_B T M dt) n + k_B T div M dt,    (x, q) -> (x, q) exp(z)

with the divergence by an unbiased random difference (Delong, Usabiaga & Donev 2015), as in
`microswim.path.brownian`. What would reach through the boundary is not taken.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.control.thermal import moved
from microswim.gait.stepping import length_of
from microswim.numerics.array import Array

SMALL = 1e-4  #: of a length and a radian, of the random difference


def displaced(
    poses: Any, free: Any, values: Array, energy: float, dt: float, random: np.random.Generator
) -> Array:
    """Return states (n, 8) after the thermal displacements of a time dt.

    Parameters
    ----------
    poses
        The gait at every pose.
    free
        Degrees of freedom that are free (6,).
    values
        States (n, 8).
    energy
        k_B T.
    dt, random
        Time, and where the random numbers come from.
    """
    unit = np.repeat([length_of(poses.gait), 1.0], 3)
    z = np.zeros((len(values), 6))
    for i, y in enumerate(values):
        kick, way = random.standard_normal((2, 6))
        own = np.linalg.cholesky(_mobility(poses, free, y)) @ kick[free]
        z[i, free] = np.sqrt(2.0 * energy * dt) * own
        z[i, free] += energy * dt * _divergence(poses, free, y, way * free, unit)
    after = moved(values, z)
    reaches = np.array([poses.gap(y[:3], y[3:7], y[7]) for y in after]) <= 0.0
    return np.where(reaches[:, None], values, after)


def _mobility(poses: Any, free: Any, y: Array) -> Array:
    """Return M over what is free."""
    R = poses.at(y[:3], y[3:7], y[7])[0]
    return np.linalg.inv(R[np.ix_(free, free)])


def _divergence(poses: Any, free: Any, y: Array, way: Array, unit: Array) -> Array:
    """Return a sample of ``div M``: M at two poses a random way apart, times that way."""
    found = 0.0
    for sense in (-1.0, 1.0):
        there = moved(y[None], (sense * SMALL * unit * way)[None])[0]
        if not poses.gap(there[:3], there[3:7], there[7]) > 0.0:
            return np.zeros(int(free.sum()))
        M = _mobility(poses, free, there)
        found = found + sense / (2.0 * SMALL) * M @ (way / unit)[free]
    return np.asarray(found, float)
