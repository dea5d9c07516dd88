"""``microswim presets``: the swimmers that come along."""

from __future__ import annotations

import click

from microswim.cli._options import example, json_option, print_json


@click.command(epilog=example("microswim presets", "microswim presets --show goto/C > mine.toml"))
@click.option("--show", metavar="NAME", help="Print the spec file of one.")
@json_option
def command(show: str | None, as_json: bool) -> None:
    """List the swimmers that come along, or print the spec file of one."""
    from microswim.output.report.html import Table
    from microswim.spec import presets

    if show is not None:
        text = presets.read(show)
        if as_json:
            print_json({"name": show, "spec": text})
        else:
            click.echo(text, nl=False)
        return
    about = {name: _about(presets.read(name)) for name in presets.names()}
    if as_json:
        print_json({"presets": [{"name": n, "about": text} for n, text in about.items()]})
        return
    from microswim.cli._print import print_table

    print_table(Table("Presets: microswim run --preset NAME", ("name", ""), list(about.items())))


def _about(text: str) -> str:
    """The comment at the head of a spec file, its first sentence."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("# ").strip())
    head, stop, _ = " ".join(lines).replace("et al. ", "et al.\0").partition(". ")
    return (head + stop.strip()).replace("\0", " ").partition(", as Table")[0]
