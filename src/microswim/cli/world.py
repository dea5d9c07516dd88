"""``microswim world``: the models beside published numbers."""

from __future__ import annotations

from pathlib import Path

import click

from ._options import example, json_option, print_json


@click.command(epilog=example("microswim world --no-bem", "microswim world --out docs/world.md"))
@click.option("--bem/--no-bem", default=True, help="Solve the helix by boundary elements too.")
@click.option("--out", type=click.Path(path_type=Path), help="Markdown file to write.")
@json_option
def command(bem: bool, out: Path | None, as_json: bool) -> None:
    """Compare with Vibrio, Rodenborn's helix and Table 3 of the paper."""
    from .. import world

    if as_json:
        print_json(
            {
                "vibrio": world.vibrio(),
                "rodenborn": world.rodenborn(bem),
                "table_3": world.table_3(),
            }
        )
        return
    text = world.page(bem)
    if out is None:
        click.echo(text)
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text, encoding="utf-8")
    click.echo(f"{out}")
