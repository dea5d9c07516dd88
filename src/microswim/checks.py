"""Checks shared by everything that is validated on construction."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from microswim.errors import SpecError


def number(
    field: str,
    value: Any,
    allowed: str,
    *,
    above: float | None = None,
    least: float | None = None,
    most: float | None = None,
) -> None:
    """Refuse what is not a finite real number within the bounds (`above` is exclusive)."""
    if isinstance(value, (str, bytes)):
        mend = "numbers only: units are read in spec files and by with_" if str(value) else None
        raise SpecError(field, value, allowed, mend)
    try:
        x = float(value)
    except (TypeError, ValueError, OverflowError):
        raise SpecError(field, value, allowed) from None
    if (
        isinstance(value, bool)
        or not math.isfinite(x)
        or (above is not None and not x > above)
        or (least is not None and not x >= least)
        or (most is not None and not x <= most)
    ):
        raise SpecError(field, value, allowed)


def positive(field: str, value: Any, what: str = "number") -> None:
    """Refuse what is not a finite number above zero."""
    number(field, value, f"a positive {what}", above=0.0)


def numbers(field: str, values: Any, length: int, allowed: str, **bounds: float) -> None:
    """Refuse what is not a sequence of `length` finite numbers within the bounds."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise SpecError(field, values, allowed)
    entries = list(values)
    if len(entries) != length:
        raise SpecError(field, values, allowed)
    for i, entry in enumerate(entries):
        number(f"{field}[{i}]", entry, allowed, **bounds)


def choice(field: str, value: Any, options: Iterable[str]) -> None:
    """Refuse what is not one of the options."""
    options = tuple(options)
    if value not in options:
        raise SpecError(field, value, "one of " + ", ".join(f'"{o}"' for o in options))


def truth(field: str, value: Any) -> None:
    """Refuse what is neither True nor False."""
    if type(value).__name__ not in ("bool", "bool_"):  # NumPy's own as well
        raise SpecError(field, value, "true or false")
