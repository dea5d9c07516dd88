"""``microswim reproduce``: the paper's tables, figures and numbers beside ours."""

from __future__ import annotations

from pathlib import Path

import click

from microswim.cli._options import example, json_option, print_json

EXAMPLES = example(
    "microswim reproduce --out paper          everything, some ten minutes",
    "microswim reproduce --quick --out paper  coarser, under two minutes",
    "microswim reproduce --only fig4 --only table4 --out paper",
)


@click.command(epilog=EXAMPLES)
@click.option(
    "--only", multiple=True, metavar="ITEM", help="table1 to table4, fig2 to fig7; repeatable."
)
@click.option("--quick", is_flag=True, help="Coarse reference solutions, and fewer of them.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("paper"),
    show_default=True,
    help="Folder for report, figures and finished reference solutions; a killed run resumes there.",
)
@json_option
def command(only: tuple[str, ...], quick: bool, out: Path, as_json: bool) -> None:
    """Reproduce the paper: one page with every table, figure and number beside ours.

    The circles are our own boundary-element solutions in place of the paper's CFD. Each statement
    gets a verdict: agrees, agrees under a reading, differs because, cannot be checked because.
    """
    import sys
    import warnings

    from microswim.errors import MicroswimError
    from microswim.studies.paper.report import reproduce
    from microswim.swimmer.drag.coefficients import ValidityWarning

    terminal = sys.stderr.isatty() and not as_json

    def progress(line: str) -> None:
        if terminal:
            click.echo(f"  {line}", err=True)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # the maps mark what is out of range
        result = reproduce(out, only=only, quick=quick, progress=progress)
    if as_json:
        print_json(result)
    else:
        for kind, number in result["verdicts"].items():
            click.echo(f"{number:4d}  {kind}")
        click.echo(f"report: {result['report']}")
    if result["broken"]:
        raise MicroswimError(f"verdicts that no longer hold: {', '.join(result['broken'])}")
