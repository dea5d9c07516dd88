"""``microswim show``: what a spec works out to."""

from __future__ import annotations

from pathlib import Path

import click

from microswim.cli import _files
from microswim.cli._options import (
    Given,
    example,
    force_option,
    json_option,
    print_json,
    swimmer_options,
)


@click.command(
    epilog=example(
        "microswim show robot.toml",
        "microswim show --preset goto/C --json",
        "microswim show robot.toml --stl robot.stl",
    )
)
@swimmer_options
@json_option
@click.option(
    "--stl",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Write one closed surface for printing, in mm where the spec has units.",
)
@force_option
def command(given: Given, as_json: bool, stl: Path | None, force: bool) -> None:
    """Print the swimmer of a spec with its derived numbers: alpha, k, arc length, c_t, c_n, Re.

    And which model the other commands take for it, and how far off that may be.
    """
    if stl is not None:
        _write(given, stl, force)
    from microswim.gait.readable import percent
    from microswim.output.report.html import derived, spec_table

    gait = given.swimmer.gait("auto")
    found = {"model": gait.model, "expected_error": gait.info["expected_error"]}
    found |= {"calibration": list(gait.info.get("calibration", ()))}
    if as_json:
        print_json({"swimmer": given.name, "spec": given.tables, **derived(given.swimmer), **found})
        return
    from microswim.cli._print import print_table

    print_table(spec_table(given.swimmer))
    error = found["expected_error"]
    click.echo(
        f"  model auto is {gait.model}; error of u_s: {percent(error['us'])} ({error['how']})"
    )
    for remark in (*gait.info.get("calibration", ()), *gait.info["remarks"]):
        click.echo(f"  note: {remark}")


def _write(given: Given, stl: Path, force: bool) -> None:
    """Write the swimmer's surface, the place checked first."""
    from microswim.output.io.stl import unit_of, write_stl

    _files.check_file("--stl", stl, force)
    write_stl(stl, given.swimmer)
    back = f'microswim mobility {stl} --scale "{unit_of(given.swimmer)}"'
    click.echo(f"written to {stl}, one unit is {unit_of(given.swimmer)}: {back}", err=True)
