"""Tables on the terminal, and a line that says what is going on."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import click

from microswim.cli._options import leveled
from microswim.cli._progress import bar

if TYPE_CHECKING:
    from microswim.output.report.html import Table


def print_table(table: Table) -> None:
    """Print a table on stdout; never cut off a number."""
    from rich import box
    from rich.console import Console
    from rich.table import Table as RichTable

    console = Console(highlight=False)
    if console.width < _needed(table):
        _print_lines(table)
        return
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


NOTES = 24  # columns that a note needs to be read


def _needed(table: Table) -> int:
    """Columns of a terminal in which no number of the table is cut."""
    rows = [row for row in (table.header, *table.rows) if row]
    wide = [max(len(row[i]) for row in rows) for i in range(len(table.header))]
    if not table.header[-1]:
        wide[-1] = min(wide[-1], NOTES)
    return sum(wide) + 3 * len(wide)


def _print_lines(table: Table) -> None:
    """Print a table for a narrow terminal: a line for each number, its note below."""
    click.echo(table.title)
    for row in table.rows:
        for name, cell in zip(("", *table.header[1:]), row):
            if cell:
                click.echo(f"    {name + ': ' if name else ''}{cell}" if cell != row[0] else cell)
    if table.note:
        click.echo(table.note)


def timed_gait(
    swimmer: Any,
    model: str,
    level: str | None = None,
    estimate: bool = False,
    accuracy: float | None = None,
) -> tuple[Any, float]:
    """Return gait by a model, and the wall seconds it took; with a progress bar for the references.

    estimate : solve the next coarser level of the boundary elements too, for an error estimate.
    accuracy : for the model "auto", which may then come to boundary elements.
    """
    options: dict[str, Any] = leveled(model, level)
    if estimate and model == "bem":
        options["estimate_error"] = True
    if accuracy is not None:
        options["accuracy"] = accuracy
    if model in ("rft", "atlas", "elastic") or (model == "auto" and accuracy is None):
        start = time.perf_counter()
        return swimmer.gait(model), time.perf_counter() - start
    with bar(model if model == "auto" else f"{model}, {level or 'standard'}") as progress:
        start = time.perf_counter()
        gait = swimmer.gait(model, progress=progress, **options)
        return gait, time.perf_counter() - start
