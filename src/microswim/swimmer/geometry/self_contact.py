"""How near a helix comes to itself from turn to turn."""

from __future__ import annotations

from typing import Any

import numpy as np

#: (bk)^2 above which a helix comes back towards itself within a turn: min theta/|sin theta|.
SHALLOW = 4.60333885


def nearest_turn(B2: np.ndarray, waves: Any) -> Any:
    """Return distance, times k, from a point to the next turn; infinite where there is none near.

    Points an angle theta apart are ``sqrt(theta^2 + 2 B2 (1 - cos theta)) / k`` from each other,
    ``B2 = (bk)^2``; beyond half a turn a shallow helix only moves away from itself.
    """
    deep = B2 > SHALLOW
    if not deep.any():
        return np.inf
    out = np.full(B2.shape, np.inf, dtype=B2.dtype)  # complex where a derivative is asked for
    waves, B2 = np.broadcast_to(waves, B2.shape)[deep], B2[deep]
    theta = np.full_like(B2, 2.0 * np.pi)
    for _ in range(8):  # theta + B2 sin theta = 0, from the side where Newton cannot miss
        theta = theta - (theta + B2 * np.sin(theta)) / (1.0 + B2 * np.cos(theta))
    theta = np.minimum(theta, 2.0 * np.pi * np.maximum(waves, 0.5))
    apart2 = theta**2 + 2.0 * B2 * (1.0 - np.cos(theta))
    out[deep] = np.where(apart2 < np.pi**2 + 4.0 * B2, np.sqrt(apart2), np.inf)
    return out
