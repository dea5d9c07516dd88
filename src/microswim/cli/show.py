"""``microswim show``: what a spec works out to."""

from __future__ import annotations

import click

from microswim.cli._options import Given, example, json_option, print_json, swimmer_options


@click.command(epilog=example("microswim show robot.toml", "microswim show --preset goto/C --json"))
@swimmer_options
@json_option
def command(given: Given, as_json: bool) -> None:
    """Print the swimmer of a spec with its derived numbers: alpha, k, arc length, c_t, c_n, Re.

    And which model the other commands take for it, and how far off that may be.
    """
    from microswim.output.report.html import derived, percent, spec_table

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
