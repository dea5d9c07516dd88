"""Least squares that leaves alone what the data do not determine."""

from __future__ import annotations

from typing import Any

import numpy as np

#: Singular values below this share of the largest are rounding.
NOISE = 1e-9


def gauss_newton(residuals: Any, jacobian: Any, z: np.ndarray, steps: int = 100) -> np.ndarray:
    """Return the least squares by Gauss-Newton with halved steps.

    A step is the shortest (relative to the values) that the data ask for, ``V S^+ U' r`` without
    the singular values that are rounding: what the data do not determine stays at its start.
    """
    r = residuals(z)
    for _ in range(steps):
        scale = np.maximum(np.abs(z), 0.1)
        U, S, Vt = np.linalg.svd(jacobian(z) * scale, full_matrices=False)
        real = NOISE * max(S[0], 1e-300) < S
        step = -scale * (Vt[real].T @ ((U[:, real].T @ r) / S[real]))
        share = 1.0
        while share > 1e-6:
            trial = residuals(z + share * step)
            if np.all(np.isfinite(trial)) and trial @ trial <= r @ r:
                break
            share /= 2.0
        else:
            return z
        z, before, r = z + share * step, r @ r, trial
        if np.abs(share * step / scale).max() < 1e-14 or before - r @ r <= 1e-30 * before:
            return z
    return z
