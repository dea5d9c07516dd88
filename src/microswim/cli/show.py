"""``microswim show``: what a spec works out to."""

from __future__ import annotations

import click

from microswim.cli._options import Given, example, json_option, print_json, swimmer_options


@click.command(epilog=example("microswim show robot.toml", "microswim show --preset goto/C --json"))
@swimmer_options
@json_option
def command(given: Given, as_json: bool) -> None:
    """Print the swimmer of a spec with its derived numbers: alpha, k, arc length, c_t, c_n, Re."""
    from microswim.output.report.html import derived, spec_table

    if as_json:
        print_json({"swimmer": given.name, "spec": given.tables, **derived(given.swimmer)})
        return
    from microswim.cli._print import print_table

    print_table(spec_table(given.swimmer))
