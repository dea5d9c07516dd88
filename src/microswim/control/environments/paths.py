"""Paths in space for an environment: polylines of equal steps, and where one is along them."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.control.environments.random_streams import direction, uniform
from microswim.errors import SpecError
from microswim.numerics.compiling.compiled import njit

POINTS = 41
SHORTEST, LONGEST = 1e-3, 1e6  # mm, of a path that is given


@njit(cache=True)
def wander(path: Any, length: float, bend: float, ways: int, keys: Any, i: int) -> None:
    """Write a smooth path from the origin: its direction turns at a rate of at most `bend`.

    `ways`: in space, in the plane z = 0 (2), or along the x axis (1).
    """
    n = path.shape[0]
    t0, t1, t2 = direction(keys, i)
    a0, a1, a2 = direction(keys, i)
    b0, b1, b2 = direction(keys, i)
    first, second = 6.3 * uniform(keys, i), 6.3 * uniform(keys, i)
    waves, h = 0.5 + uniform(keys, i), length / (n - 1)
    if ways < 3:
        a0, a1, b0, b1, t2 = 0.0, 0.0, 0.0, 0.0, 0.0
    if ways < 2:
        a2, b2, t0, t1 = 0.0, 0.0, np.sign(t0), 0.0
    size = np.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
    t0, t1, t2 = t0 / size, t1 / size, t2 / size
    path[0, 0], path[0, 1], path[0, 2] = 0.0, 0.0, 0.0
    for k in range(1, n):
        x = 2.0 * np.pi * waves * k / n
        p, q = 0.5 * bend * h * np.sin(x + first), 0.5 * bend * h * np.cos(1.3 * x + second)
        w0, w1, w2 = p * a0 + q * b0, p * a1 + q * b1, p * a2 + q * b2
        t0, t1, t2 = t0 + w1 * t2 - w2 * t1, t1 + w2 * t0 - w0 * t2, t2 + w0 * t1 - w1 * t0
        size = np.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
        t0, t1, t2 = t0 / size, t1 / size, t2 / size
        path[k, 0], path[k, 1] = path[k - 1, 0] + h * t0, path[k - 1, 1] + h * t1
        path[k, 2] = path[k - 1, 2] + h * t2


@njit(cache=True)
def locate(path: Any, segment: int, x0: float, x1: float, x2: float) -> tuple[int, float]:
    """Return the segment, and fraction of it, nearest to a point, going forward from a segment."""
    last = path.shape[0] - 2
    while True:
        a, b = path[segment], path[segment + 1]
        d0, d1, d2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        along = (x0 - a[0]) * d0 + (x1 - a[1]) * d1 + (x2 - a[2]) * d2
        fraction = along / (d0 * d0 + d1 * d1 + d2 * d2)
        if fraction <= 1.0 or segment == last:
            return segment, min(max(fraction, 0.0), 1.0)
        segment += 1


@njit(cache=True)
def point(path: Any, where: float) -> tuple[float, float, float]:
    """Return the point at ``where`` segments from the start; at most the end."""
    where = min(max(where, 0.0), path.shape[0] - 1.0)
    k = min(int(where), path.shape[0] - 2)
    f = where - k
    a, b = path[k], path[k + 1]
    return a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2])


def resampled(path: Any, points: int = POINTS) -> np.ndarray:
    """Return a polyline given by its corners (k, 3) as one of equal steps.

    Raises
    ------
    SpecError
        If it is no polyline of finite points with a length.
    """
    try:
        corners = np.array(path, dtype=float)
    except (TypeError, ValueError):
        corners = np.empty(0)
    if corners.ndim != 2 or corners.shape[1:] != (3,) or len(corners) < 2:
        raise SpecError("path", path, "points (k, 3), two or more")
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    if not np.isfinite(arc[-1]) or (np.diff(arc) <= 0).any():
        raise SpecError("path", path, "finite points, each apart from the one before")
    if not SHORTEST <= arc[-1] <= LONGEST:
        raise SpecError(
            "path", f"{arc[-1]:.3g} mm long", f"from {SHORTEST:g} to {LONGEST:g} mm long"
        )
    at = np.linspace(0.0, arc[-1], points)
    made = np.stack([np.interp(at, arc, x) for x in corners.T], axis=-1)
    if (np.linalg.norm(np.diff(made, axis=0), axis=1) < 1e-6 * at[1]).any():
        raise SpecError("path", path, "a path that does not turn back upon itself")
    return made
