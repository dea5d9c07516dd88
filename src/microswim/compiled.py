"""Kernels that are compiled when it pays: their first calls run as the Python they are written in.

To load what was compiled before takes numba most of a second, and to compile for the first time
many; one gait in Python takes milliseconds. So a command that needs a single gait never imports
numba, and whoever needs many compiles after a few calls. Both ways run the same lines and agree to
rounding. Written so that each number may be an array, a kernel also takes many cases side by side
(`Kernel.written`). Depends on nothing of the package; on numba when a kernel is compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from functools import cached_property, update_wrapper
from typing import Any

import numpy as np

#: First calls of a kernel that run as Python.
FEW = 8

_in_python: ContextVar[bool] = ContextVar("in_python", default=False)


class Kernel:
    """A function that numba compiles on its call number `first` + 1; kernels may call kernels."""

    def __init__(self, function: Callable[..., Any], first: int, options: dict[str, Any]) -> None:
        update_wrapper(self, function)
        self.function, self.left, self.options = function, first, options

    @cached_property
    def dispatcher(self) -> Any:
        """The function as numba has it."""
        from numba import njit

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
