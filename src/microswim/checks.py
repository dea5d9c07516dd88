"""Checks shared by everything that is validated on construction."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import MISSING, fields
from typing import Any, TypeVar

from microswim.errors import SpecError, renamed

#: No number that is given is larger, and no size that must be positive smaller: with what is
#: computed from them, up to the sixth power, they stay far from the edges of the floating point.
LARGEST, SMALLEST = 1e30, 1e-30

Called = TypeVar("Called", bound=Callable[..., Any])
Class = TypeVar("Class", bound=type)


def number(
    field: str,
    value: Any,
    allowed: str,
    *,
    above: float | None = None,
    least: float | None = None,
    most: float | None = None,
) -> None:
    """Refuse what is not a finite real number within the bounds (`above` is exclusive).

    Nothing is larger than `LARGEST`, nothing that must be above zero smaller than `SMALLEST`.
    """
    if isinstance(value, (str, bytes, bytearray)):
        mend = "numbers only: units are read in spec files and by with_" if str(value) else None
        raise SpecError(field, value, allowed, mend)
    if isinstance(value, complex):  # NumPy's own turns it into a real number with a warning alone
        raise SpecError(field, value, allowed)
    try:
        x = float(value)
    except (TypeError, ValueError, OverflowError):
        raise SpecError(field, value, allowed) from None
    if (
        isinstance(value, bool)
        or getattr(value, "ndim", 0)
        or not math.isfinite(x)
        or (above is not None and not x > above)
        or (least is not None and not x >= least)
        or (most is not None and not x <= most)
    ):
        raise SpecError(field, value, allowed)
    if abs(x) > LARGEST or (above == 0.0 and x < SMALLEST):
        sizes = f"{SMALLEST:g} to {LARGEST:g} in size"
        raise SpecError(field, value, f"{allowed}, {sizes}", "choose units in which it is near one")


def positive(field: str, value: Any, what: str = "number") -> None:
    """Refuse what is not a finite number above zero."""
    number(field, value, f"a positive {what}", above=0.0)


def numbers(field: str, values: Any, length: int, allowed: str, **bounds: float) -> None:
    """Refuse what is not a sequence of `length` finite numbers within the bounds."""
    unordered = isinstance(values, (str, bytes, bytearray, Set, Mapping))
    if unordered or not isinstance(values, Iterable):
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


def count(field: str, value: Any, least: int = 1) -> None:
    """Refuse what is not a whole number of at least `least`; None passes."""
    whole = hasattr(value, "__index__") and not isinstance(value, bool)
    if value is not None and not (whole and value >= least):
        raise SpecError(field, value, f"a whole number of at least {least}")


def by_name(cls: Class) -> Class:
    """Decorate a dataclass so that a wrong call says which fields it has, in one sentence.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Fluid(0.001)
    Traceback (most recent call last):
        ...
    microswim.errors.SpecError: Fluid: its fields are given by name, such as Fluid(viscosity=...)
    """
    made = cls.__init__
    known = [f.name for f in fields(cls) if f.init]
    needed = [
        f.name
        for f in fields(cls)
        if f.init and f.default is MISSING and f.default_factory is MISSING
    ]

    @functools.wraps(made)
    def init(self: Any, *args: Any, **given: Any) -> None:
        name = cls.__name__
        if args:
            example = ", ".join(f"{field}=..." for field in needed or known[:1])
            raise SpecError(f"{name}: its fields are given by name, such as {name}({example})")
        for field in given:
            if field not in known:
                raise SpecError(f"{name}: it has no field {field}; it has {', '.join(known)}")
        missing = [field for field in needed if field not in given]
        if missing:
            raise SpecError(f"{name}: {', '.join(missing)} must be given")
        made(self, **given)

    cls.__init__ = init  # type: ignore[misc]
    return cls


def keyword_was(old: str, new: str) -> Callable[[Called], Called]:
    """Return a decorator: the keyword `old` of earlier versions is taken for `new`, and warns."""

    def decorate(function: Called) -> Called:
        @functools.wraps(function)
        def called(*args: Any, **options: Any) -> Any:
            if old in options:
                renamed(f"{function.__name__}({old}=...)", f"{new}=")
                options[new] = options.pop(old)
            return function(*args, **options)

        return called  # type: ignore[return-value]

    return decorate
