"""How many cores a compiled loop over swimmers wakes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from numba import get_num_threads, set_num_threads

#: Swimmers from which on a second core is worth waking.
MANY = 256


@contextmanager
def awake(n: int) -> Iterator[None]:
    """One core for a few swimmers, all that numba may use for many."""
    usual = get_num_threads()
    set_num_threads(usual if n >= MANY else 1)
    try:
        yield
    finally:
        set_num_threads(usual)
