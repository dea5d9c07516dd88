"""The one name for an array of floats in annotations; arrays and tables that nobody writes into."""

from __future__ import annotations

import functools
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Class = TypeVar("Class", bound=type)
Table = TypeVar("Table")


def kept(values: Any, kind: Any = None) -> np.ndarray:
    """Return an array of its own that nobody can write into, for a frozen object to hold."""
    own = np.array(values, dtype=kind)
    own.flags.writeable = False
    return own


def read_only(cls: Class) -> Class:
    """Decorate a frozen dataclass: the arrays that it holds are its own, and nobody writes to them.

    Also those in its tuples and dictionaries, and those of `still_read_only`.
    """
    made = cls.__init__
    plain = ("float", "int", "str", "bool", "tuple[bool, ...]", "tuple[str, ...]")
    names = [f.name for f in fields(cls) if f.type not in plain]

    @functools.wraps(made)
    def init(self: Any, *args: Any, **named: Any) -> None:
        made(self, *args, **named)
        for name in names:
            value = getattr(self, name)
            if type(value) in HOLDERS:
                object.__setattr__(self, name, _frozen(value))

    cls.__init__ = init  # type: ignore[misc]
    return still_read_only(cls)


def still_read_only(cls: Class) -> Class:
    """Decorate a frozen dataclass: arrays are read-only also after a trip through a pool."""

    def restore(self: Any, state: dict[str, Any]) -> None:
        for name, value in state.items():  # what is computed on first use may be scratch: _name
            self.__dict__[name] = value if name.startswith("_") else _frozen(value)

    cls.__setstate__ = restore  # type: ignore[attr-defined]
    return cls


HOLDERS = (np.ndarray, tuple, dict)


def _frozen(value: Any) -> Any:
    if type(value) is np.ndarray:
        return kept(value)
    if type(value) is tuple:
        return tuple(_frozen(v) for v in value)
    return {k: _frozen(v) for k, v in value.items()} if type(value) is dict else value


def sealed(table: Table) -> Table:
    """Return an ``xarray.Dataset`` whose arrays cannot be written in place."""
    for variable in table.variables.values():  # type: ignore[attr-defined]
        if isinstance(variable.data, np.ndarray):
            variable.data.flags.writeable = False
    return table
