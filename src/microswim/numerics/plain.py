"""Values as files and the page can hold them: mappings, lists, numbers, texts, truths."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


def plain(value: Any, *, nan: bool = False, none: bool = True) -> Any:
    """Return a value in the words of JSON: mappings, lists, numbers, texts, truths, null.

    Parameters
    ----------
    value
        Anything; arrays become lists, NumPy's numbers Python's, what JSON has no word for its
        text.
    nan
        Whether NaN and infinities stay numbers, as our own files may hold them; else None.
    none
        Whether mappings keep the names of what is None; TOML has no word for it.

    Examples
    --------
    >>> import numpy as np
    >>> plain({"speed": np.float64(0.5), "series": np.eye(2), "ratio": float("nan")})
    {'speed': 0.5, 'series': [[1.0, 0.0], [0.0, 1.0]], 'ratio': None}
    >>> plain({"waves": 3, "wavelength": None, "ratio": np.nan}, nan=True, none=False)
    {'waves': 3, 'ratio': nan}
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        kept = {str(k): v for k, v in value.items() if none or v is not None}
        return {k: plain(v, nan=nan, none=none) for k, v in kept.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v, nan=nan, none=none) for v in value]
    if isinstance(value, float):
        return value if nan or math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)
