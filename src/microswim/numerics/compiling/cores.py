"""Cores: loops over many cases, compiled for one core and for all of them.

Numba's threads take one loop at a time (its plainest layer aborts on the second) and do not live on
in a forked process. So a short loop wakes no threads at all, loops on all cores take turns, and a
process that was forked from one with threads runs every loop on its one core. What is computed is
the same to the last bit.
"""

from __future__ import annotations

import os
import threading
import types
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any

from microswim.numerics.compiling.compiled import njit

#: Cases, each as dear as a helix in a batch, from which on a second core is worth waking.
MANY = 256

_turn = threading.RLock()
_woken = False  # whether this process has threads
_orphaned = False  # whether it was forked from a process with threads


class Loop:
    """A function with a ``prange`` over cases; `over` gives it compiled for so many of them."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        named: Any = self
        update_wrapper(named, function)
        self.function, self.options = function, options

    @cached_property
    def alone(self) -> Any:
        """The loop on one core, under a name of its own in Numba's cache."""
        f = self.function
        twin = types.FunctionType(f.__code__, f.__globals__, f.__name__, f.__defaults__)
        twin.__module__, twin.__qualname__ = f.__module__, f.__qualname__ + "_alone"
        return njit(**self.options)(twin)

    @cached_property
    def parallel(self) -> Any:
        """The loop on all cores."""
        return njit(parallel=True, **self.options)(self.function)

    def over(self, cases: int) -> Callable[..., Any]:
        """Return the loop on one core for few cases, on all cores for many."""
        return self.alone if cases < MANY or _orphaned else self._in_turn

    def _in_turn(self, *args: Any) -> Any:
        global _woken
        with _turn:
            _woken = True
            return self.parallel(*args)


def loop(**options: Any) -> Callable[[Callable[..., Any]], Loop]:
    """Make a function a `Loop`; `options` as of ``numba.njit``, results are always cached."""
    return lambda function: Loop(function, {"cache": True, **options})


def _forked() -> None:
    global _woken, _orphaned
    _orphaned, _woken = _orphaned or _woken, False
    _turn.release()


if hasattr(os, "register_at_fork"):  # a fork waits until the loop that runs is done
    os.register_at_fork(before=_turn.acquire, after_in_parent=_turn.release, after_in_child=_forked)
