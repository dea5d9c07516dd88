"""Values as JSON can hold them."""

from __future__ import annotations

import math
from typing import Any


def plain(value: Any) -> Any:
    """Return a value in the words of JSON: mappings, lists, numbers, texts, truths, null.

    Parameters
    ----------
    value
        Anything; arrays become lists, NumPy's numbers Python's, NaN and infinities None, what
        JSON has no word for its text.

    Examples
    --------
    >>> import numpy as np
    >>> plain({"speed": np.float64(0.5), "series": np.eye(2), "ratio": float("nan")})
    {'speed': 0.5, 'series': [[1.0, 0.0], [0.0, 1.0]], 'ratio': None}
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)
