"""Poses that lie scattered: which of many are solved, and the weights of what lies between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.calibration.region import kriging
from microswim.numerics.array import Array

#: Poses from which the lengths of the covariance are found.
ENOUGH = 240
#: Fewest poses with which it may be enough: an error of 16 others says too little of fewer.
FEWEST = 100
#: Unknowns of a pose, several seconds of a core, beyond which so many times the error is enough.
DEAR, TIMES = 7500, 4.0
OF_L = 21  #: of a pose's targets are those of L


@dataclass(frozen=True)
class Scatter:
    """Numbers of poses.

    Parameters
    ----------
    poses
        That are solved, as far from one another as they can lie.
    smallest
        Smallest gap, in the body's smaller half axes.
    left_out
        Further ones, that measure the error.
    within
        Error of those left out (95 %, each velocity in its scale) at which a quarter or a half of
        the poses is enough, `TIMES` it where a pose takes seconds; 0 to solve all. Of 375 poses
        that meet 16 within 1 % a tenth of others at random are missed by more, 1.4 % at worst.
    """

    poses: int = 600
    smallest: float = 0.02
    left_out: int = 16
    within: float = 0.005

    @property
    def parts(self) -> list[int]:
        """Numbers of poses, one after the other, at which the error is asked."""
        some = [self.poses // 4, self.poses // 2] if self.left_out and self.within > 0.0 else []
        return [n for n in some if n >= FEWEST] + [self.poses]

    def enough(self, error: dict[str, Any], unknowns: list[int]) -> bool:
        """Return whether the poses left out are met well enough, for solves of this size."""
        off = [value for value in error.values() if not isinstance(value, str)]
        dear = bool(unknowns) and sum(unknowns) > DEAR * len(unknowns)
        return bool(off) and max(off) <= self.within * (TIMES if dear else 1.0)


def spread(Z: Array, count: int, others: Array | None = None) -> NDArray[np.int64]:
    """Return the indices (count,) of features (n, f) that lie far from one another.

    Each is the one farthest from all before it, in units of the features' spread: the first ones
    of many are those of few.

    Parameters
    ----------
    Z
        To choose from.
    count
        How many, all of them at most.
    others
        Features that are chosen already, whose spread then counts.
    """
    size = (Z if others is None else others).std(axis=0)
    size = np.where(size > 0, size, 1.0)
    Z = Z / size
    if others is None:
        chosen = [int(np.argmin(np.linalg.norm(Z - Z.mean(axis=0), axis=1)))]
        away = np.linalg.norm(Z - Z[chosen[0]], axis=1)
    else:
        chosen = []
        away = np.min([np.linalg.norm(Z - z, axis=1) for z in others / size], axis=0)
    while len(chosen) < min(count, len(Z)):
        chosen.append(int(np.argmax(away)))
        away = np.minimum(away, np.linalg.norm(Z - Z[chosen[-1]], axis=1))
    return np.array(chosen, np.int64)


def known_of_both(Z: Array, Y: Array) -> tuple[Array, Array]:
    """Return `PoseTable.known` (2, 1 + f, n) and weights (m, 1 + n): of L, and of all else.

    Velocities change over other lengths than resistances do.
    """
    found, weights = known_of_each(Z, Y[:, :OF_L], Y[:, OF_L:])
    return found, np.concatenate(weights)


def known_of_each(Z: Array, *targets: Array) -> tuple[Array, list[Array]]:
    """Return `PoseTable.known` (k, 1 + f, n), and weights (m, 1 + n) of each group of targets."""
    found = [known(Z, Y) for Y in targets]
    return np.stack([poses for poses, _ in found]), [weights for _, weights in found]


def known(Z: Array, Y: Array) -> tuple[Array, Array]:
    """Return poses in lengths (1 + f, n) and weights (m, 1 + n) of targets Y (n, m) at features Z.

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
