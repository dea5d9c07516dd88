"""Dotted names of the numbers that a frozen dataclass holds: ``.amplitude``, ``.rotation[1]``."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


def numbers_of(owner: Any, prefix: str = ".") -> list[tuple[str, float]]:
    """Name and value of every number, entries of nested tuples included."""
    found: list[tuple[str, float]] = []
    for f in fields(owner):
        found += _entries(f"{prefix}{f.name}", getattr(owner, f.name))
    return found


def _entries(path: str, value: Any) -> list[tuple[str, float]]:
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return []
    if isinstance(value, tuple):
        return [e for i, v in enumerate(value) for e in _entries(f"{path}[{i}]", v)]
    return [] if callable(value) else [(path, value)]


def set_item(values: tuple, index: list[int], value: Any) -> tuple:
    """Copy of nested tuples with one entry replaced."""
    head, *rest = index
    new = set_item(values[head], rest, value) if rest else value
    return (*values[:head], new, *values[head + 1 :])


def replaced(owner: Any, name: str, value: Any) -> Any:
    """Copy of a frozen dataclass with one field replaced, without its checks."""
    copy = object.__new__(type(owner))
    for f in fields(owner):
        object.__setattr__(copy, f.name, getattr(owner, f.name))
    object.__setattr__(copy, name, value)
    return copy


def nearest(path: str, known: Any) -> str:
    """What an error can offer in place of an unknown name."""
    from difflib import get_close_matches

    match = get_close_matches(path, list(known), n=1)
    return f'did you mean "{match[0]}"?' if match else "fields: " + ", ".join(known)
