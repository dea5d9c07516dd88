"""A sign of life for what takes long: a bar with rate and time left, or a line now and then."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import click

SOON = 2.0  # seconds before anything is shown on a terminal
QUIET = 10.0  # seconds between two lines where there is no terminal


@contextlib.contextmanager
def bar(what: str) -> Iterator[Callable[[int, int], None]]:
    """Show progress on stderr: give a function of the number done and of all.

    Work that cannot count its steps need not call it; that it goes on is shown all the same.
    """
    from rich.console import Console

    console = Console(stderr=True)
    shown = _Bar(what, console) if console.is_terminal else _Lines(what)
    stop = threading.Event()
    pulse = threading.Thread(target=_pulse, args=(shown, stop), daemon=True)
    pulse.start()
    try:
        yield shown.update
    finally:
        stop.set()
        pulse.join()
        shown.close()


def _pulse(shown: Any, stop: threading.Event) -> None:
    """Tell a display that time passes, from its first moment on until it is stopped."""
    wait = shown.first
    while not stop.wait(wait):
        shown.beat()
        wait = shown.next


class _Rate:
    """Designs per second since the first call: what was resumed does not count."""

    def __init__(self) -> None:
        self.start: tuple[float, int] | None = None

    def value(self, done: int) -> float:
        now = time.perf_counter()
        if self.start is None:
            self.start = (now, done)
        elapsed = now - self.start[0]
        return (done - self.start[1]) / elapsed if elapsed > 0 else 0.0

    def text(self, done: int) -> str:
        rate = self.value(done)
        return f"{rate:,.0f}/s" if rate >= 10 else f"{rate:.2g}/s" if rate > 0 else ""


class _Bar:
    """A bar on a terminal, once the work has taken longer than a moment."""

    first, next = SOON, 0.5

    def __init__(self, what: str, console: Any) -> None:
        self.what, self.console = what, console
        self.rate, self.state = _Rate(), (0, None, "")
        self.shown: Any = None
        self.task: Any = None

    def update(self, done: int, total: int) -> None:
        self.state = (done, total, self.rate.text(done))

    def beat(self) -> None:
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        if self.shown is None:
            columns = (
                *(TextColumn(self.what), BarColumn(), MofNCompleteColumn()),
                *(TextColumn("{task.fields[rate]}"), TimeElapsedColumn()),
                *(TextColumn("left"), TimeRemainingColumn()),
            )
            self.shown = Progress(*columns, console=self.console, transient=True)
            self.task = self.shown.add_task(self.what, total=None, rate="")
            self.shown.start()
        done, total, rate = self.state
        self.shown.update(self.task, completed=done, total=total, rate=rate)

    def close(self) -> None:
        if self.shown is not None:
            self.shown.stop()


class _Lines:
    """A line every few seconds where there is no terminal."""

    first = next = QUIET

    def __init__(self, what: str) -> None:
        self.what, self.rate, self.state = what, _Rate(), (0, 0)
        self.begun = time.perf_counter()

    def update(self, done: int, total: int) -> None:
        self.rate.value(done)
        self.state = (done, total)

    def beat(self) -> None:
        (done, total), speed = self.state, self.rate.value(self.state[0])
        text = f"{self.what}: {time.perf_counter() - self.begun:.0f} s"
        if total:
            text = f"{self.what}: {done} of {total}"
        if total and speed > 0:
            text += f", {self.rate.text(done)}, {(total - done) / speed:.0f} s left"
        click.echo(text, err=True)

    def close(self) -> None:
        """Leave nothing open."""
