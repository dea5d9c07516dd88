"""What one request may cost: a time, after which it ends, and an end when nobody waits for it.

Work that comes in pieces asks `check` between them. The pieces themselves are bounded: in number
by the sides of a map, in size by the waves of a tail. Time in which all requests wait for code to
be compiled, on the first start, costs none of them anything: `uncounted`.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from typing import Any

from microswim.errors import MicroswimError

SECONDS = 20.0  #: that a request may take

_current: ContextVar[Budget | None] = ContextVar("budget", default=None)


class _Clock:
    """Seconds that count: they stand still while `uncounted` work is done."""

    def __init__(self) -> None:
        self.lock, self.inside, self.began, self.lost = threading.Lock(), 0, 0.0, 0.0

    def now(self) -> float:
        with self.lock:
            return (self.began if self.inside else time.monotonic()) - self.lost

    def stop(self) -> None:
        with self.lock:
            if not self.inside:
                self.began = time.monotonic()
            self.inside += 1

    def go(self) -> None:
        with self.lock:
            self.inside -= 1
            if not self.inside:
                self.lost += time.monotonic() - self.began


_clock = _Clock()


@contextlib.contextmanager
def uncounted() -> Iterator[None]:
    """Run work for which every request waits, and of which none is to blame."""
    _clock.stop()
    try:
        yield
    finally:
        _clock.go()


class Budget:
    """Time of one request."""

    def __init__(self, seconds: float = SECONDS) -> None:
        self.seconds, self.ends = seconds, _clock.now() + seconds
        self.stopped = threading.Event()

    def stop(self) -> None:
        """End the work: nobody waits for it any more."""
        self.stopped.set()

    def within(self, answer: Callable[[Any], Any], ask: Any) -> Any:
        """Return ``answer(ask)``, in which `check` knows this budget."""
        token = _current.set(self)
        try:
            return answer(ask)
        finally:
            _current.reset(token)


def check() -> None:
    """End the work of a request that is over its time or that nobody waits for.

    Raises
    ------
    MicroswimError
        Then.
    """
    budget = _current.get()
    if budget is None:
        return
    if budget.stopped.is_set():
        raise MicroswimError("nobody waits for this any more")
    if _clock.now() > budget.ends:
        raise MicroswimError(
            f"this takes more than {budget.seconds:g} s; ask for a smaller map or fewer waves"
        )
