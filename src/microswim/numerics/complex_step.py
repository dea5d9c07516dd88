"""The complex step: exact derivatives ``f'(x) = Im f(x + i h) / h``.

No difference is taken, so h may be so small that its square is nothing beside rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np

STEP = 1e-30


def derivative_from(value: Any) -> Any:
    """Return the derivative from the value of a function at ``x + i STEP``."""
    return np.imag(value) / STEP
