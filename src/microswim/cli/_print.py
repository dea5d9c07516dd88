"""Tables on the terminal, and a line that says what is going on."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from microswim.cli._progress import bar

if TYPE_CHECKING:
    from microswim.output.report.html import Table


def print_table(table: Table) -> None:
    """Print a table on stdout; never cut off a number."""
    from rich import box
    from rich.console import Console
    from rich.table import Table as RichTable

    console = Console(highlight=False)
    shown = RichTable(
        title=table.title,
        caption=table.note or None,
        box=box.SIMPLE_HEAD,
        title_style="bold",
        title_justify="left",
        caption_justify="left",
        show_header=any(table.header),
    )
    for i, name in enumerate(table.header):
        last = i == len(table.header) - 1 and not name
        shown.add_column(
            name,
            justify="left" if i == 0 or last else "right",
            style="dim" if last else "",
            no_wrap=not last,
        )
    for row in table.rows:
        shown.add_row(*row)
    console.print(shown)


def timed_gait(
    swimmer: Any, model: str, level: str | None = None, estimate: bool = False
) -> tuple[Any, float]:
    """Gait by a model, and the wall seconds it took; with a progress bar for the references.

    estimate : solve the next coarser level of the boundary elements too, for an error estimate.
    """
    options: dict[str, Any] = {"estimate_error": True} if estimate and model == "bem" else {}
    if model == "rft":
        start = time.perf_counter()
        return swimmer.gait(model), time.perf_counter() - start
    if level is not None:
        options["level"] = level
    with bar(f"{model}, {level or 'standard'}") as progress:
        start = time.perf_counter()
        gait = swimmer.gait(model, progress=progress, **options)
        return gait, time.perf_counter() - start
