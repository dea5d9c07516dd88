"""Random numbers inside compiled environments: one stream per environment.

SplitMix64 (Steele, Lea & Flood 2014): a counter and a mixing function, so a stream depends on its
key alone, not on how many environments there are nor on which core they run.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import njit

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
FIRST, SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
S30, S27, S31, S11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)


@njit(cache=True)
def uniform(keys: Any, i: int) -> float:
    """Return a random number in (0, 1); the key moves on."""
    keys[i] += GOLDEN
    z = keys[i]
    z = (z ^ (z >> S30)) * FIRST
    z = (z ^ (z >> S27)) * SECOND
    z = z ^ (z >> S31)
    return (np.float64(z >> S11) + 0.5) / 9007199254740992.0


@njit(cache=True)
def normals(keys: Any, i: int) -> tuple[float, float]:
    """Return two independent standard normal numbers (Box & Muller 1958)."""
    radius = np.sqrt(-2.0 * np.log(uniform(keys, i)))
    angle = 2.0 * np.pi * uniform(keys, i)
    return radius * np.cos(angle), radius * np.sin(angle)


@njit(cache=True)
def direction(keys: Any, i: int) -> tuple[float, float, float]:
    """Return the unit vector, uniform on the sphere."""
    z = 2.0 * uniform(keys, i) - 1.0
    angle = 2.0 * np.pi * uniform(keys, i)
    r = np.sqrt(1.0 - z * z)
    return r * np.cos(angle), r * np.sin(angle), z


@njit(cache=True)
def direction_within(ways: int, keys: Any, i: int) -> tuple[float, float, float]:
    """Return `direction`, or of two or of one way its part in the plane z = 0 or along x."""
    a, b, c = direction(keys, i)
    return a, b if ways > 1 else 0.0, c if ways > 2 else 0.0
