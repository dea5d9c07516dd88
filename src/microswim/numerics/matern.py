"""Matern 5/2: the kernel of what is interpolated between scattered solves."""

from __future__ import annotations

from math import factorial
from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import FAST, compiled

#: Of the series of exp.
C2, C3, C4, C5, C6, C7 = (1.0 / factorial(n) for n in range(2, 8))


@compiled(fastmath=FAST, error_model="numpy")
def matern(r2: Any) -> Any:
    """Return Matern 5/2 of the squared scaled distance, ``(1 + q + q^2/3) exp(-q)``, ``q^2 = 5
    r2``.

    ``exp(-q) = exp(-q/128)^128`` by its series, beyond q = 40 as there, to 2e-14 of 1: plain
    arithmetic without divisions or branches (a choice of two numbers is none), which compilers do
    for several designs at once.
    """
    q = np.sqrt(5.0 * r2)
    q = q if q.real < 40.0 else 0.0 * q + 40.0
    x = q * (-1.0 / 128.0)
    e = C4 + x * (C5 + x * (C6 + x * C7))
    e = 1.0 + x * (1.0 + x * (C2 + x * (C3 + x * e)))
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    return (1.0 + q + q * q * (1.0 / 3.0)) * e


def matern_of_arrays(r2: np.ndarray) -> np.ndarray:
    """Return the same of whole arrays, where NumPy's own exponential takes a third of the time."""
    q = np.sqrt(5.0 * r2)
    return (1.0 + q + q * q / 3.0) * np.exp(-q)
