"""Calls held to their names: decorators whose wrong calls end in one sentence."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import Any, TypeVar

from microswim.errors import SpecError, nearest, renamed

Called = TypeVar("Called", bound=Callable[..., Any])
Class = TypeVar("Class", bound=type)


def required(cls: type) -> list[str]:
    """Return the fields of a dataclass that must be given."""
    own = [f for f in fields(cls) if f.init]
    return [f.name for f in own if f.default is MISSING and f.default_factory is MISSING]


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
    checks is held to its names alone, at no cost where they are right.

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
        if not checked:
            return _named(function, takes)

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


def _named(function: Called, takes: inspect.Signature) -> Called:
    """Return a function whose wrong calls end in one sentence; right ones are as quick as ever."""

    @functools.wraps(function)
    def called(*args: Any, **named: Any) -> Any:
        try:
            return function(*args, **named)
        except TypeError:
            try:
                takes.bind(*args, **named)
            except TypeError:
                raise _wrong_arguments(function.__qualname__, takes, args, named) from None
            raise

    return called  # type: ignore[return-value]


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
