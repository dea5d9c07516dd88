"""Checks shared by everything that is validated on construction."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Mapping, Set
from os import PathLike
from typing import Any

from microswim.checks.calls import by_name as by_name
from microswim.checks.calls import given as given
from microswim.checks.calls import keyword_was as keyword_was
from microswim.checks.calls import required as required
from microswim.errors import SpecError

#: No number that is given is larger, and no size that must be positive smaller: with what is
#: computed from them, up to the sixth power, they stay far from the edges of the floating point.
LARGEST, SMALLEST = 1e30, 1e-30
EMPTY = 1000  #: frames of a film for each that is there, at which a time is wrong


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
    if type(value).__name__ == "ndarray":  # also one of no dimension
        raise SpecError(field, value, allowed, None if value.ndim else "float(...) makes one of it")
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
    if not isinstance(value, str) or value not in options:
        raise SpecError(field, value, "one of " + ", ".join(f'"{o}"' for o in options))


def truth(field: str, value: Any) -> None:
    """Refuse what is neither True nor False."""
    if type(value).__name__ not in ("bool", "bool_"):  # NumPy's own as well
        raise SpecError(field, value, "true or false")


def count(field: str, value: Any, least: int = 1) -> None:
    """Refuse what is not a whole number of at least `least`; None passes."""
    whole = hasattr(value, "__index__") and not isinstance(value, bool)
    if value is not None and not (whole and not hasattr(value, "__len__") and value >= least):
        raise SpecError(field, value, f"a whole number of at least {least}")


def text(field: str, value: Any) -> None:
    """Refuse what is not text."""
    if not isinstance(value, str):
        raise SpecError(field, value, "text")


def words(field: str, value: Any) -> None:
    """Refuse what is neither a name nor a series of names."""
    if isinstance(value, str):
        return
    if isinstance(value, (bytes, bytearray, Mapping)) or not isinstance(value, Iterable):
        raise SpecError(field, value, "a name, or a list of names")
    if isinstance(value, (Set, list, tuple)) and not all(isinstance(w, str) for w in value):
        raise SpecError(field, value, "a name, or a list of names")


def mapping(field: str, value: Any, allowed: str = "dotted names to values, {...}") -> None:
    """Refuse what does not map names to values."""
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        raise SpecError(field, value, allowed)


def place(field: str, value: Any) -> None:
    """Refuse what is not the path of a file or folder."""
    if not isinstance(value, (str, PathLike)):
        raise SpecError(field, value, "a path")


def function(field: str, value: Any) -> None:
    """Refuse what cannot be called."""
    if not callable(value):
        raise SpecError(field, value, "a function")


def reals(field: str, value: Any, allowed: str = "made of numbers") -> Any:
    """Return a real number, or an array or list of such, as an array; NaN passes."""
    import numpy as np

    try:
        if isinstance(value, (str, bytes, bytearray, Set, Mapping)) or np.iscomplexobj(value):
            raise TypeError
        if value is None or np.asarray(value).dtype.kind not in "iufO":
            raise TypeError
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise SpecError(field, value, allowed) from None


def series(field: str, value: Any, allowed: str = "made of finite numbers") -> None:
    """Refuse what is not a finite real number, or an array or list of such."""
    import numpy as np

    if not np.isfinite(reals(field, value, allowed)).all():
        raise SpecError(field, value, allowed)


def numeric(field: str, value: Any) -> None:
    """Refuse what is not a number, real or complex, or an array of such."""
    if getattr(getattr(value, "dtype", None), "kind", "") != "c" and not isinstance(value, complex):
        reals(field, value)


def finite(field: str, value: Any) -> None:
    """Refuse what is not a finite number, real or complex, or an array of such."""
    if type(value) is float and math.isfinite(value):
        return
    import numpy as np

    numeric(field, value)
    if not np.isfinite(value).all():
        raise SpecError(field, value, "made of finite numbers")


def six(field: str, value: Any) -> None:
    """Refuse what is not six finite numbers, or rows of six."""
    import numpy as np

    finite(field, value)
    if np.shape(value)[-1:] != (6,):
        raise SpecError(field, value, "six numbers, force and torque, or rows of six")


def shaped(field: str, value: Any, shape: tuple[int | str, ...]) -> None:
    """Refuse what is not finite numbers in an array of a shape, ``"n"`` for any length."""
    import numpy as np

    finite(field, value)
    found = np.shape(value)
    if len(found) != len(shape) or any(n not in (m, "n") for m, n in zip(found, shape)):
        wanted = f"({', '.join(map(str, shape))}{',' if len(shape) == 1 else ''})"
        raise SpecError(field, f"an array of shape {found}", f"one of shape {wanted}")


def sign(field: str, value: Any) -> None:
    """Refuse what is neither 1 nor -1."""
    number(field, value, "1 or -1")
    if abs(value) != 1:
        raise SpecError(field, value, "1 or -1")


def load(field: str, value: Any) -> None:
    """Refuse what is neither finite numbers nor a function of time."""
    if not callable(value):
        series(field, value, "made of finite numbers, or a function of times")


def instance(field: str, value: Any, kind: str) -> None:
    """Refuse what is not of a class, told by its name (its module may not be imported yet)."""
    if not any(kind == owner.__name__ for owner in type(value).__mro__):
        article = "an" if kind[0] in "AEIO" else "a"
        raise SpecError(field, value, f"{article} {kind}")


def whole(field: str, value: Any, least: int = 1) -> None:
    """Refuse what is not a whole number of at least `least`."""
    if value is None:
        raise SpecError(field, value, f"a whole number of at least {least}")
    count(field, value, least)


def swimmer(field: str, value: Any) -> None:
    """Refuse what is not a `Swimmer`."""
    instance(field, value, "Swimmer")


def gait(field: str, value: Any) -> None:
    """Refuse what is not a `Gait`."""
    instance(field, value, "Gait")


def dataset(field: str, value: Any) -> None:
    """Refuse what is not an ``xarray.Dataset``."""
    instance(field, value, "Dataset")


def at_least(least: int) -> Callable[[str, Any], None]:
    """Return the check of a whole number of at least `least`."""
    return functools.partial(whole, least=least)


def one_of(*options: str) -> Callable[[str, Any], None]:
    """Return the check of a choice."""
    return functools.partial(choice, options=options)


def above_zero(what: str) -> Callable[[str, Any], None]:
    """Return the check of a positive number."""
    return functools.partial(positive, what=what)


def share(field: str, value: Any) -> None:
    """Refuse what is not a number from 0 to 1."""
    number(field, value, "a share from 0 to 1", least=0.0, most=1.0)


def nearly_empty(time: Any) -> float:
    """Return over how many frames increasing times of a film lie, where nearly all of these are
    empty, as by a wrong number; else zero.
    """
    import numpy as np

    frames = float((time[-1] - time[0]) / np.median(np.diff(time)))
    return 0.0 if frames < EMPTY * len(time) else frames
