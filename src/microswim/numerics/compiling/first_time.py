"""Who is told when machine code is made that is not kept yet: nothing else shows meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

_tell: Callable[[], None] | None = None


def tell_once(tell: Callable[[], None]) -> None:
    """Tell by a function when code is first compiled in this process, not where it is loaded."""
    global _tell
    _tell = tell


def listen() -> None:
    """Begin to listen to Numba, which is imported; nothing happens where nobody is to be told."""
    global _tell
    if _tell is None:
        return
    tell, _tell = _tell, None
    event = import_module("numba.core.event")
    told = []

    class First(event.Listener):
        """Told of each function that is compiled."""

        def on_start(self, _: object) -> None:
            """Tell of the first."""
            if not told:
                told.append(True)
                tell()

        def on_end(self, _: object) -> None:
            """Leave it at that."""

    event.register("numba:compile", First())
