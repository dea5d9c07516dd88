"""``microswim world``: the models beside published numbers."""

from __future__ import annotations

from pathlib import Path

import click

from microswim.cli import _files
from microswim.cli._options import example, force_option, json_option, print_json
from microswim.cli._progress import bar
from microswim.numerics.files import fresh, write


@click.command(epilog=example("microswim world --no-bem", "microswim world --out docs/world.md"))
@click.option("--bem/--no-bem", default=True, help="Solve by boundary elements too.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Markdown file to write; its picture goes to img/cells.png beside it.",
)
@force_option
@json_option
def command(bem: bool, out: Path | None, force: bool, as_json: bool) -> None:
    """Compare with Vibrio, Rodenborn's helix, cells of BOSO-Micro and Table 3 of the paper."""
    from microswim.studies.world import cells
    from microswim.studies.world import page as world

    if as_json:
        print_json(
            {
                "vibrio": world.vibrio(),
                "rodenborn": world.rodenborn(bem),
                "boso": world.boso(bem),
                "table_3": world.table_3(),
            }
        )
        return
    if out is None:
        click.echo(world.page(bem))
        return
    picture = out.parent / "img" / "cells.png"
    for path in (out, picture):
        _files.check_file("--out", path, force)
    with bar("world"):
        found = world.boso(bem)
        text = world.page(bem, "img/cells.png", found)
    with fresh(picture) as scratch:
        cells.picture(found).savefig(scratch, dpi=150)
    write(out, text)
    click.echo(f"{out}, {picture}")
