"""What one request may cost: a time, after which it ends, and an end when nobody waits for it.

Work that comes in pieces asks `check` between them. The pieces themselves are bounded: in number
by the sides of a map, in size by the waves of a tail.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextvars import ContextVar
from typing import Any

from microswim.errors import MicroswimError

SECONDS = 20.0  #: that a request may take

_current: ContextVar[Budget | None] = ContextVar("budget", default=None)


class Budget:
    """Time of one request."""

    def __init__(self, seconds: float = SECONDS) -> None:
        self.seconds, self.ends = seconds, time.monotonic() + seconds
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
    if time.monotonic() > budget.ends:
        raise MicroswimError(
            f"this takes more than {budget.seconds:g} s; ask for a smaller map or fewer waves"
        )
