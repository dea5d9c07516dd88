"""Checks shared by everything that is validated on construction."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import MISSING, fields
from os import PathLike
from typing import Any, TypeVar

from microswim.errors import SpecError, nearest, renamed

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
    if not isinstance(value, str) or value not in options:
        raise SpecError(field, value, "one of " + ", ".join(f'"{o}"' for o in options))


def truth(field: str, value: Any) -> None:
    """Refuse what is neither True nor False."""
    if type(value).__name__ not in ("bool", "bool_"):  # NumPy's own as well
        raise SpecError(field, value, "true or false")


def count(field: str, value: Any, least: int = 1) -> None:
    """Refuse what is not a whole number of at least `least`; None passes."""
    whole = hasattr(value, "__index__") and not isinstance(value, bool)
    if value is not None and not (whole and not getattr(value, "ndim", 0) and value >= least):
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


def load(field: str, value: Any) -> None:
    """Refuse what is neither finite numbers nor a function of time."""
    if not callable(value):
        series(field, value, "made of finite numbers, or a function of times")


def instance(field: str, value: Any, kind: str) -> None:
    """Refuse what is not of a class, told by its name (its module may not be imported yet)."""
    if not any(kind == owner.__name__ for owner in type(value).__mro__):
        article = "an" if kind[0] in "AEIO" else "a"
        raise SpecError(field, value, f"{article} {kind}")


def required(cls: type) -> list[str]:
    """Return the fields of a dataclass that must be given."""
    own = [f for f in fields(cls) if f.init]
    return [f.name for f in own if f.default is MISSING and f.default_factory is MISSING]


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
    takes = {f.name: f for f in fields(cls) if f.init and not f.name.startswith("_")}
    needed = required(cls)
    by_place = [n for n, f in takes.items() if not f.kw_only]

    @functools.wraps(made)
    def init(self: Any, *args: Any, **named: Any) -> None:
        try:
            made(self, *args, **named)
        except TypeError:
            wrong = _wrong_fields(cls.__name__, list(takes), needed, by_place, args, named)
            if wrong is None:
                raise
            raise wrong from None

    cls.__init__ = init  # type: ignore[misc]
    return cls


def _wrong_fields(
    name: str, known: list[str], needed: list[str], by_place: list[str], args: tuple, named: dict
) -> SpecError | None:
    """Return what is wrong with a call of a dataclass, if anything is."""
    for field in named:
        if field not in known:
            it_has = f"it has {', '.join(known)}" if known else "it has none"
            return SpecError(f"{name}: it has no field {field}; {it_has}")
        if field in by_place[: len(args)]:
            return SpecError(f"{name}: {field} is given twice")
    if len(args) > len(by_place):
        example = ", ".join(f"{field}=..." for field in needed or known[:1])
        return SpecError(f"{name}: its fields are given by name, such as {name}({example})")
    missing = [n for n in needed if n not in named and n not in by_place[: len(args)]]
    return SpecError(f"{name}: {', '.join(missing)} must be given") if missing else None


def given(**checked: Callable[[str, Any], None]) -> Callable[[Called], Called]:
    """Return a decorator: arguments are checked before any work, their names, then each value.

    Each check takes name and value and refuses in a sentence; a default passes. A function without
    checks is held to its names alone.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.screw(5)
    Traceback (most recent call last):
        ...
    microswim.errors.SpecError: gait = 5: must be a Gait
    """

    def decorate(function: Called) -> Called:
        takes = inspect.signature(function)
        each = takes.parameters.values()
        defaults = {p.name: p.default for p in each}
        by_place = [p.name for p in each if p.kind is p.POSITIONAL_OR_KEYWORD]
        needed = {p.name for p in each if p.default is p.empty and p.kind is not p.VAR_KEYWORD}
        free = any(p.kind is p.VAR_KEYWORD for p in each)

        @functools.wraps(function)
        def called(*args: Any, **named: Any) -> Any:
            values = dict(zip(by_place, args)) | named
            once = len(values) == len(args) + len(named)
            if not (
                once and needed <= values.keys() and (free or values.keys() <= defaults.keys())
            ):
                raise _wrong_arguments(function.__qualname__, takes, args, named)
            for name, check in checked.items():
                if name in values and values[name] is not defaults[name]:
                    check(name, values[name])
            return function(*args, **named)

        return called  # type: ignore[return-value]

    return decorate


def _wrong_arguments(name: str, takes: inspect.Signature, args: tuple, named: dict) -> SpecError:
    """Return what is wrong with a call of a function."""
    own = [p for p in takes.parameters.values() if p.name not in ("self", "cls")]
    known = [p.name for p in own if p.kind is not p.VAR_KEYWORD]
    args = args if len(own) == len(takes.parameters) else args[1:]
    by_place = [p.name for p in own if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    for argument in named:
        if argument in by_place[: len(args)]:
            return SpecError(f"{name}: {argument} is given twice")
        if argument not in known and len(known) == len(own):
            mend = nearest(argument, known) if known else "it takes none"
            return SpecError(f"{name}: it takes no {argument}; {mend}")
    if len(args) > len(by_place):
        first = ", ".join(by_place) or "none"
        return SpecError(f"{name}: it takes by position {first}; give the others by name")
    filled = {*by_place[: len(args)], *named}
    needed = (p for p in own if p.default is p.empty and p.kind is not p.VAR_KEYWORD)
    missing = [p.name for p in needed if p.name not in filled]
    return SpecError(f"{name}: {', '.join(missing)} must be given")


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
