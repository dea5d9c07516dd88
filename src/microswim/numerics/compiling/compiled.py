"""Kernels: functions that run as the Python they are written in, or compiled by Numba.

Loading compiled code takes Numba most of a second, and compiling it for the first time many; one
gait in Python takes a millisecond. Which way a call runs depends on the work in it, known before
it starts, never on earlier calls (`pays`); `warm_up` of the surrogate chooses compiled code for
the whole process. Both ways run the same lines and agree to rounding. Written so that each number
may be an array, a kernel as Python also takes many cases side by side (`Kernel.written`).
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property, update_wrapper
from importlib import import_module
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.numerics.compiling.code_cache import digest, keep
from microswim.numerics.compiling.first_time import listen

#: Sums may be reordered and fused; NaN and infinity keep their meaning.
FAST = {"reassoc", "contract", "arcp", "nsz"}

#: Seconds of work as Python from which on compiled code is loaded.
PATIENCE = 0.1

_in_python: ContextVar[bool] = ContextVar("in_python", default=False)
_settled: ContextVar[bool | None] = ContextVar("settled", default=None)
_building = threading.RLock()


_warm = False  # whether the process chose compiled code wherever nothing else is settled


def much(seconds: float) -> bool:
    """Return whether work that takes so long as Python is worth loading compiled code."""
    return seconds > PATIENCE


def pays(seconds: float) -> bool:
    """Return whether work that takes so long as Python is to run compiled, here and now."""
    settled_ = _settled.get()
    return _warm or much(seconds) if settled_ is None else settled_


@contextmanager
def settled(compile_it: bool) -> Iterator[None]:
    """Run kernels within compiled or as Python, as said, whatever the process has chosen."""
    token = _settled.set(compile_it)
    try:
        yield
    finally:
        _settled.reset(token)


def choose_compiled() -> None:
    """Run kernels compiled from now on, in the whole process, wherever nothing else is settled."""
    global _warm
    _warm = True


def numba() -> Any:
    """Return Numba, imported.

    Raises
    ------
    MicroswimError
        If the environment asks it for a number of threads that is none.
    """
    threads = os.environ.get("NUMBA_NUM_THREADS", "1")
    try:
        enough = int(threads) >= 1
    except ValueError:
        enough = False
    if not enough:
        raise MicroswimError(
            f"NUMBA_NUM_THREADS = {threads}: must be a whole number from 1 on, or not be set"
        )
    module = import_module("numba")
    listen()
    return module


def __getattr__(name: str) -> Any:
    if name == "prange":
        return numba().prange
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function by Numba; the code is kept under names that no other source shares."""

    def decorate(function: Callable[..., Any]) -> Any:
        with _building:
            return keep(lambda: numba().njit(**options)(function), digest(function, options))

    return decorate


class Kernel:
    """A function that runs as Python or compiled; kernels may call kernels."""

    def __init__(self, function: Callable[..., Any], always: bool, options: dict[str, Any]) -> None:
        update_wrapper(self, function)
        self.py_func, self.always, self.options = function, always, options

    @cached_property
    def dispatcher(self) -> Any:
        """The function as Numba has it."""
        with _building:
            return njit(cache=True, **self.options)(self.py_func)

    @property
    def _numba_type_(self) -> Any:
        """Type by which Numba knows the kernel where compiled code calls it."""
        return self.dispatcher._numba_type_

    @property
    def targetoptions(self) -> dict[str, Any]:
        """Options as Numba looks for them: ``inline="always"`` puts a formula into each loop."""
        return self.options

    def written(self, *args: Any) -> Any:
        """Run as Python, and so all kernels that it calls; the numbers may be arrays."""
        token = _in_python.set(True)
        try:
            with np.errstate(all="ignore"):  # as compiled code does
                return self.py_func(*args)
        finally:
            _in_python.reset(token)

    def __call__(self, *args: Any) -> Any:
        if _in_python.get():
            return self.py_func(*args)
        return self.dispatcher(*args) if self.always or pays(0.0) else self.written(*args)


def compiled(*, always: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """Make a function a `Kernel`; `options` as of ``numba.njit``, compiled code is always kept.

    always : compiled whatever was chosen, for loops that are long in any case.
    """
    return lambda function: Kernel(function, always, options)
