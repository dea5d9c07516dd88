"""Closed curves on the sphere where an odd function is zero, found and traced.

Seeds are changes of sign between the points of a grid. From one on, steps go on along the way that
the last one went, and Newton's method along the gradient takes each back to the curve; so a point
where two curves cross, at which the gradient is zero, is passed straight on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.numerics.array import Array

Condition = Callable[[Array], tuple[Array, Array]]
Curve = Callable[[Any], Array]

STEP = 2.0 * np.pi / 720.0  #: of a trace (rad)
RINGS, ROUND = 37, 73  #: of the grid of seeds: odd, and none on an axis
MOST = 8000  #: steps of a trace
SETTLED = 1e-13


def curves_of(condition: Condition) -> tuple[Curve, ...]:
    """Return the curves, each a function of an angle from 0 to 2 pi; of a pair b, -b, one.

    Parameters
    ----------
    condition
        Function of directions (..., 3) to values (...) and gradients (..., 3), odd.
    """
    traces: list[Array] = []
    for seed in _seeds(condition):
        known = (abs(np.abs(t @ seed) - 1.0).min() < (2.0 * STEP) ** 2 for t in traces)
        if not any(known):
            traces.append(_traced(condition, seed))
    return tuple(_curve(condition, t) for t in traces if len(t) > 3)


def _seeds(condition: Condition) -> Array:
    """Points of the curves: where the sign changes along a ring, on one half of the sphere."""
    z = (np.arange(RINGS) + 0.41) / RINGS
    angle = 2.0 * np.pi * (np.arange(ROUND) + 0.37) / ROUND
    flat = np.sqrt(1.0 - z**2)[:, None]
    grid = np.stack(np.broadcast_arrays(flat * np.cos(angle), flat * np.sin(angle), z[:, None]), -1)
    value = condition(grid)[0]
    changes = np.argwhere(value * np.roll(value, -1, axis=1) < 0)
    seeds = [grid[i, j] + grid[i, (j + 1) % ROUND] for i, j in changes]
    return _settled(condition, np.array(seeds).reshape(-1, 3))


def _settled(condition: Condition, b: Array) -> Array:
    """Return unit vectors (..., 3) on the curve, near to the given ones."""
    b = b / np.linalg.norm(b, axis=-1, keepdims=True)
    for _ in range(12):
        value, slope = condition(b)
        slope = slope - np.sum(slope * b, axis=-1, keepdims=True) * b
        square = np.maximum(np.sum(slope**2, axis=-1), 1e-30)
        step = np.clip(value / np.sqrt(square), -STEP / 2.0, STEP / 2.0) / np.sqrt(square)
        b = b - step[..., None] * slope
        b = b / np.linalg.norm(b, axis=-1, keepdims=True)
        if np.abs(value).max(initial=0.0) < SETTLED:
            break
    return b


def _traced(condition: Condition, seed: Array) -> Array:
    """Return points (n, 3) of the curve through a seed, a step apart, once round."""
    slope = condition(seed)[1]
    way = np.cross(seed, slope)
    way /= np.linalg.norm(way)
    points = [seed]
    while len(points) < MOST:
        here = _settled(condition, points[-1] + STEP * way)
        way = here - points[-1]
        way = way - (way @ here) * here
        way /= np.linalg.norm(way)
        if len(points) > 4 and np.linalg.norm(here - seed) < 0.75 * STEP:
            break
        points.append(here)
    return np.array(points)


def _curve(condition: Condition, points: Array) -> Curve:
    """Return a closed curve through points as a function of an angle."""
    closed = np.concatenate([points, points[:1]])

    def at(angle: Any) -> Array:
        u = np.mod(np.asarray(angle) / (2.0 * np.pi), 1.0) * len(points)
        i = np.minimum(u.astype(int), len(points) - 1)
        part = (u - i)[..., None]
        return _settled(condition, (1.0 - part) * closed[i] + part * closed[i + 1])

    return at
