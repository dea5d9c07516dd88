"""Progress of a long run: a bar with the time left, or the caller's own function."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def watched(
    progress: bool | Callable[[int, int], None] | None, total: int, what: str = "swimming"
) -> Iterator[Callable[[int, int], None]]:
    """Give the function to call as ``tell(done, of)`` after each step."""
    if progress is True:
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn(what), BarColumn(), TextColumn("{task.completed}/{task.total}"))
        with Progress(*columns, TimeRemainingColumn()) as bar:
            task = bar.add_task(what, total=total)
            yield lambda done, of: bar.update(task, completed=done, total=of)
    else:
        yield progress or (lambda done, of: None)
