"""A progress bar with rate and time left on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Any

import click

QUIET = 10.0  # seconds between two lines where there is no terminal


@contextlib.contextmanager
def bar(what: str) -> Iterator[Callable[[int, int], None]]:
    """Progress on stderr: a function of the number done and of all."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    if not console.is_terminal:
        yield _lines(what)
        return
    columns = (
        TextColumn(what),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task(what, total=None, rate="")
        rate = _Rate()

        def update(done: int, total: int) -> None:
            shown.update(task, completed=done, total=total, rate=rate.text(done))

        yield update


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


def _lines(what: str) -> Callable[[int, int], Any]:
    rate, said = _Rate(), [time.perf_counter()]

    def update(done: int, total: int) -> None:
        now, speed = time.perf_counter(), rate.value(done)
        if now - said[0] >= QUIET and speed > 0:
            said[0] = now
            left = (total - done) / speed
            click.echo(f"{what}: {done} of {total}, {rate.text(done)}, {left:.0f} s left", err=True)

    return update
