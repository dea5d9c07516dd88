"""The one name for an array of floats in annotations; arrays and tables that nobody writes into."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Class = TypeVar("Class", bound=type)
Table = TypeVar("Table")
Object = TypeVar("Object")


def kept(values: Any, kind: Any = None) -> np.ndarray:
    """Return an array of its own that nobody can write into, for a frozen object to hold."""
    own = np.array(values, dtype=kind)
    own.setflags(write=False)
    return own


def lent(values: Any, kind: Any = None) -> np.ndarray:
    """Return a contiguous array that the borrower cannot write into: to compiled code, which is
    compiled anew for arrays that it may write into, all of one kind.
    """
    view = np.ascontiguousarray(values, dtype=kind).view()
    view.setflags(write=False)
    return view


def read_only(cls: Class) -> Class:
    """Make the arrays that a frozen dataclass holds its own, so that nobody writes to them.

    Also those in its tuples and dictionaries, and those of `still_read_only`. Stands below the
    ``@dataclass`` that it serves: it is the last step of ``__post_init__``.
    """
    checked = getattr(cls, "__post_init__", None)

    def freeze(self: Any) -> None:
        if checked is not None:
            checked(self)
        own = self.__dict__
        for name, value in own.items():
            holder = FROZEN.get(type(value))
            if holder is not None:
                own[name] = holder(value)

    cls.__post_init__ = freeze  # type: ignore[attr-defined]
    return still_read_only(cls)


def still_read_only(cls: Class) -> Class:
    """Decorate a frozen dataclass: arrays are read-only also after a trip through a pool."""

    def restore(self: Any, state: dict[str, Any]) -> None:
        for name, value in state.items():  # what is computed on first use may be scratch: _name
            self.__dict__[name] = value if name.startswith("_") else _frozen(value)

    cls.__setstate__ = restore  # type: ignore[attr-defined]
    return cls


def _frozen(value: Any) -> Any:
    holder = FROZEN.get(type(value))
    return value if holder is None else holder(value)


def _tuple(value: tuple) -> tuple:
    return value if FROZEN.keys().isdisjoint(map(type, value)) else tuple(map(_frozen, value))


def _dict(value: dict) -> dict:
    return {k: _frozen(v) for k, v in value.items()}


#: How each type that is or may hold an array is frozen.
FROZEN: dict[type, Callable[[Any], Any]] = {np.ndarray: kept, tuple: _tuple, dict: _dict}


def owned(cls: type[Object], **values: Any) -> Object:
    """Return a frozen object of arrays that were just made for it: closed, not copied or checked.

    For what the package makes by the thousand; every field is given.
    """
    made = object.__new__(cls)
    made.__dict__.update(values)
    for value in values.values():
        if type(value) is np.ndarray:
            value.setflags(write=False)
    return made


def sealed(table: Table) -> Table:
    """Return an ``xarray.Dataset`` whose arrays cannot be written in place."""
    for variable in table.variables.values():  # type: ignore[attr-defined]
        if isinstance(variable.data, np.ndarray):
            variable.data.flags.writeable = False
    return table
