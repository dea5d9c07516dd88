"""``microswim export``: the model for another program, as C or as an FMU."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files
from microswim.cli._options import (
    Given,
    example,
    force_option,
    json_option,
    level_option,
    leveled,
    model_option,
    print_json,
    swimmer_options,
)
from microswim.errors import SpecError

if TYPE_CHECKING:
    from microswim.control.stepper import Stepper


@click.command(
    epilog=example(
        "microswim export robot.toml --format c",
        "microswim export --preset goto/C --format fmu --out units",
        'microswim export robot.toml --format fmu --fmi 2.0 --moment "[0, 2e-5, 0]" --name robot',
    )
)
@swimmer_options
@click.option(
    "--format",
    "kind",
    type=click.Choice(["c", "fmu"]),
    required=True,
    help="c: one header and one source. fmu: a co-simulation unit.",
)
@click.option(
    "--fmi",
    type=click.Choice(["3.0", "2.0"]),
    default="3.0",
    show_default=True,
    help="Version of the standard; 2.0 for older tools.",
)
@click.option("--name", metavar="NAME", help="Prefix of symbols and files; by default the spec's.")
@click.option(
    "--moment",
    metavar="LIST",
    default="[0, 0, 0]",
    show_default=True,
    help="Magnetic moment in the body frame s, q, r (A m^2, or the spec's own units).",
)
@click.option("--locked", is_flag=True, help="The motor is locked: a rigid magnetised robot.")
@click.option(
    "--resolution",
    type=float,
    default=64.0,
    show_default=True,
    help="Internal steps per turn of tail, field or body.",
)
@model_option
@level_option
@click.option(
    "--out",
    metavar="DIR",
    type=click.Path(path_type=Path, file_okay=True),
    default=Path(),
    help="Folder for the files; by default the current one.",
)
@force_option
@json_option
def command(
    given: Given,
    kind: str,
    fmi: str,
    name: str | None,
    moment: str,
    locked: bool,
    resolution: float,
    model: str,
    level: str | None,
    out: Path,
    force: bool,
    as_json: bool,
) -> None:
    """Write the swimmer as C or as an FMU, for a controller or a simulator.

    The files need no Python; their heads say conventions, units and where the numbers come from.
    """
    from microswim.cli._progress import bar
    from microswim.control.export import compiler
    from microswim.control.export.cmodel import c_model
    from microswim.control.stepper import Stepper

    name = name or _identifier(given.name)
    files = [f"{name}.h", f"{name}.c"] if kind == "c" else [f"{name}.fmu"]
    _files.check_files("--out", out, files, force)
    options = leveled(model, level)
    with bar(f"{model}, {given.name}"):
        gait = given.swimmer.gait(model, **options)
    options = {"moment": _moment(moment), "locked": locked, "resolution": resolution}
    stepper = Stepper(gait, given.swimmer, **options)
    code = c_model(stepper, name, given.text)
    found: dict[str, Any] = {"format": kind, "name": name, "units": gait.units, "model": gait.model}
    found |= compiler.measured(code)
    found |= _written(stepper, code, given.text, out, files, fmi)
    if as_json:
        print_json(found)
    else:
        _say(found)


def _written(
    stepper: Stepper, code: Any, spec: str, out: Path, files: list[str], fmi: str
) -> dict[str, Any]:
    """Write into a scratch folder, then move: all files or none."""
    from microswim.control.export import compiler
    from microswim.control.export.fmu import export_fmu

    out.mkdir(parents=True, exist_ok=True)
    about: dict[str, Any] = {}
    with tempfile.TemporaryDirectory(prefix=".export-", dir=out) as scratch:
        here = Path(scratch)
        if files[0].endswith(".fmu"):
            about = export_fmu(stepper, here / files[0], name=code.name, fmi=fmi, spec=spec)
        else:
            compiler.write(code, here)
        for file in files:
            (here / file).replace(out / file)
    paths = [out / file for file in files]
    return {
        **{k: v for k, v in about.items() if k in ("fmi", "platform", "variables")},
        "files": [str(p) for p in paths],
        "bytes": sum(p.stat().st_size for p in paths),
    }


def _identifier(name: str) -> str:
    made = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")[:41]
    return made if made[:1].isalpha() else "swimmer"


def _moment(text: str) -> tuple[float, ...]:
    try:
        values = tuple(float(v) for v in text.strip("[]() ").split(","))
    except ValueError:
        values = ()
    if len(values) != 3:
        raise SpecError("--moment", text, 'three numbers, such as "[0, 2e-5, 0]"')
    return values


def _say(found: dict[str, Any]) -> None:
    for path in found["files"]:
        click.echo(f"  {path}")
    click.echo(f"  {found['bytes'] / 1000:.1f} kB written")
    if found["object_bytes"] is None:
        click.echo("  no C compiler on the path: neither compiled nor timed here")
        return
    click.echo(f"  {found['object_bytes'] / 1000:.1f} kB compiled, with its tables")
    click.echo(
        f"  {1e6 * found['seconds_per_step']:.2f} µs per internal step of order 4 (one core)"
    )
