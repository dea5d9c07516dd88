"""Poses that lie scattered: which of many are solved, and the weights of what lies between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from microswim.calibration.region import kriging
from microswim.numerics.array import Array

#: Poses from which the lengths of the covariance are found.
ENOUGH = 240


def spread(Z: Array, count: int) -> NDArray[np.int64]:
    """Return the indices (count,) of features (n, f) that lie far from one another.

    Each is the one farthest from all before it, in units of the features' spread: the first ones
    of many are those of few.
    """
    size = Z.std(axis=0)
    Z = Z / np.where(size > 0, size, 1.0)
    chosen = [int(np.argmin(np.linalg.norm(Z - Z.mean(axis=0), axis=1)))]
    away = np.linalg.norm(Z - Z[chosen[0]], axis=1)
    while len(chosen) < min(count, len(Z)):
        chosen.append(int(np.argmax(away)))
        away = np.minimum(away, np.linalg.norm(Z - Z[chosen[-1]], axis=1))
    return np.array(chosen, np.int64)


def known(Z: Array, Y: Array) -> tuple[Array, Array]:
    """Return `PoseTable.known` (1 + f, n) and weights (m, 1 + n) of targets Y (n, m) at features Z.

    One covariance for all targets, its lengths by the likelihood of the first poses.
    """
    size = Z.std(axis=0)
    size = np.where(size > 0, size, 1.0)
    waves, some = np.zeros(len(Z)), slice(0, ENOUGH)
    found = kriging.fit(Z[some] / size, waves[some], Y[some], 0)
    whole = kriging.conditioned(
        Z / size, waves, Y, found.lengths, found.phasors, found.noise
    )  # fmt: skip
    per = 1.0 / (size * whole.lengths)
    head = np.zeros((1, len(Z)))
    head[0, : Z.shape[1]] = per
    weights = np.concatenate([whole.mean[:, None], whole.alpha.T], axis=1)
    return np.concatenate([head, (Z * per).T]), np.ascontiguousarray(weights)
