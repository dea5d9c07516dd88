"""Kernels that are compiled when it pays: their first calls run as the Python they are written in.

To load what was compiled before takes numba most of a second, and to compile for the first time
many; one gait in Python takes milliseconds. So a command that needs a single gait never imports
numba, and whoever needs many compiles after a few calls. Both ways run the same lines and agree to
rounding. Written so that each number may be an array, a kernel also takes many cases side by side
(`Kernel.written`).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property, update_wrapper
from typing import Any

import numpy as np

#: Sums may be reordered and fused; NaN and infinity keep their meaning.
FAST = {"reassoc", "contract", "arcp", "nsz"}

#: First calls of a kernel that run as Python.
FEW = 8

_in_python: ContextVar[bool] = ContextVar("in_python", default=False)
_settled: ContextVar[bool | None] = ContextVar("settled", default=None)


@contextmanager
def settled(pays: bool) -> Iterator[None]:
    """Within, kernels are compiled (`pays`) or not, however often they have been called before.

    So what is computed does not depend on the past, to the last bit.
    """
    token = _settled.set(pays)
    try:
        yield
    finally:
        _settled.reset(token)


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit`` whose cache processes may fill at once.

    numba calls what it stores 1, 2, ... and keeps a list of which is for which types. Of two
    processes that compile for different types one could overwrite what the other has listed, and
    the list would lead to code for other types. Here each name is made of the types.
    """
    import numba

    def decorate(function: Callable[..., Any]) -> Any:
        made = numba.njit(**options)(function)
        stored = getattr(made._cache, "_cache_file", None)  # none if it is not cached
        if stored is not None:
            _name_by_types(stored)
        return made

    return decorate


def _name_by_types(stored: Any) -> None:
    save = stored.save

    def save_by_types(key: Any, data: Any) -> None:
        types = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        name = f"{stored._index_name.removesuffix('.nbi')}.{types}.nbc"
        stored._data_name = lambda number: name
        save(key, data)

    stored.save = save_by_types


class Kernel:
    """A function that numba compiles on its call number `first` + 1; kernels may call kernels."""

    def __init__(self, function: Callable[..., Any], first: int, options: dict[str, Any]) -> None:
        update_wrapper(self, function)
        self.function, self.left, self.options = function, first, options

    @cached_property
    def dispatcher(self) -> Any:
        """The function as numba has it."""
        return njit(cache=True, **self.options)(self.function)

    @property
    def _numba_type_(self) -> Any:
        """By this numba knows the kernel where compiled code calls it."""
        return self.dispatcher._numba_type_

    def written(self, *args: Any) -> Any:
        """Run as Python, and so all kernels that it calls; the numbers may be arrays."""
        token = _in_python.set(True)
        try:
            with np.errstate(all="ignore"):  # as compiled code does
                return self.function(*args)
        finally:
            _in_python.reset(token)

    def due(self, calls: int = 1) -> bool:
        """Count a call, or work worth several; whether it is time to compile."""
        if (pays := _settled.get()) is not None:
            return pays
        self.left -= calls
        return self.left < 0

    def __call__(self, *args: Any) -> Any:
        if _in_python.get():
            return self.function(*args)
        return self.dispatcher(*args) if self.due() else self.written(*args)


def compiled(*, first: int = FEW, **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """Make a function a `Kernel`; `options` as of ``numba.njit``, results are always cached.

    first : calls that run as Python; 0 for loops that are long in any case.
    """
    return lambda function: Kernel(function, first, options)
