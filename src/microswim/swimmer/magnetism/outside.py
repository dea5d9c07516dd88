"""Field and gradient outside a magnet or a winding, from what gives B alone (magpylib).

    dB_i/dx_j = sum_k w_k (B_i(x + k h e_j) - B_i(x - k h e_j))      k = 1 to 4, order 8

with h a small part of the distance to the source, so that the error is 1e-10 of B over that
distance; then the part that no field without currents has, trace and curl, is taken away.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.errors import MachineError
from microswim.numerics.array import Array

SHARE = 0.02  #: of the distance to the source: a step
_WEIGHTS = np.array([4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0])


def magpylib() -> Any:
    """Return the package.

    Raises
    ------
    MachineError
        If it is not installed.
    """
    try:
        import magpylib
    except ImportError:
        raise MachineError(
            'a magnet or a winding of finite size needs magpylib: pip install "microswim[magnetic]"'
        ) from None
    return magpylib


def gradient(field: Callable[[Array], Array], places: Array, distance: Array) -> Array:
    """Return ``dB_i/dx_j`` (n, 3, 3) at places (n, 3); NaN where the distance (n,) is not positive.

    Parameters
    ----------
    field
        B (m, 3) at places (m, 3).
    places, distance
        Where, and how far the source is.
    """
    h = SHARE * np.where(distance > 0.0, distance, np.nan)
    shifts = np.concatenate([k * np.eye(3) for k in (1, -1, 2, -2, 3, -3, 4, -4)])
    points = places[:, None] + h[:, None, None] * shifts
    B = field(np.where(np.isnan(points), 1.0, points).reshape(-1, 3)).reshape(-1, 4, 2, 3, 3)
    J = np.einsum("k,nkji->nij", _WEIGHTS, B[:, :, 0] - B[:, :, 1]) / h[:, None, None]
    J = (J + np.swapaxes(J, 1, 2)) / 2.0
    return J - np.trace(J, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
