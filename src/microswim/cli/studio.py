"""``microswim studio``: the page where a swimmer swims."""

from __future__ import annotations

import os
from pathlib import Path

import click

from microswim.cli import _files
from microswim.cli._options import example, force_option, read
from microswim.errors import MicroswimError
from microswim.numerics.files import write


@click.command(
    epilog=example(
        "microswim studio robot.toml",
        "microswim studio --preset goto/A --port 9000",
        "microswim studio robot.toml --snapshot robot.html    one file that plays without a server",
    )
)
@click.argument("spec", required=False, type=click.Path(path_type=Path))
@click.option("--preset", metavar="NAME", help="A swimmer that comes along: microswim presets.")
@click.option("--set", "changes", metavar="FIELD=VALUE", multiple=True, help="Override a field.")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option("--port", type=click.IntRange(0, 65535), help="Port; 8642 or a free one by default.")
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@click.option(
    "--snapshot",
    metavar="FILE",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write the page with this swimmer inside to one HTML file, and stop.",
)
@force_option
def command(
    spec: Path | None,
    preset: str | None,
    changes: tuple[str, ...],
    host: str,
    port: int | None,
    no_browser: bool,
    snapshot: Path | None,
    force: bool,
) -> None:
    """Open a page in the browser: see it swim, drag its numbers, ask the judge.

    Without SPEC the base case of the package swims. The page is served to this machine alone
    unless --host says otherwise; stop it with Ctrl-C.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads only cost here
    if spec is None and preset is None:
        preset = "tabak/helix"
    given = read(spec, preset, changes)
    if snapshot is not None:
        from microswim.studio import snapshot as page

        _files.check_file("--snapshot", snapshot, force)
        write(snapshot, page(given.tables, given.name))
        click.echo(f"wrote {snapshot}")
        return
    try:
        from microswim.studio.server import serve
    except ModuleNotFoundError as error:
        raise MicroswimError(
            f"the studio needs {error.name}: pip install 'microswim[studio]'"
        ) from None
    if host not in ("127.0.0.1", "::1", "localhost"):
        click.echo(
            f"--host {host}: anyone on the network of this machine can now compute on it",
            err=True,
        )
    serve(
        *(given.tables, given.name),
        host=host,
        port=port,
        browser=not no_browser,
        ready=lambda where: click.echo(f"{given.name} swims at {where}    (Ctrl-C stops it)"),
    )
