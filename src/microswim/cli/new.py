"""``microswim new``: a commented spec to start from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from microswim.cli._options import example
from microswim.errors import SpecError

if TYPE_CHECKING:
    from microswim.spec.fields import Field


@click.command(
    epilog=example(
        "microswim new robot.toml",
        "microswim new cell.toml --units um",
        "microswim new --kind plane_wave > sperm.toml",
    )
)
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option(
    "--kind",
    type=click.Choice(["helix", "plane_wave", "elastic"]),
    default="helix",
    show_default=True,
)
@click.option(
    "--units",
    type=click.Choice(["none", "um", "mm"]),
    default="none",
    show_default=True,
    help="Units of length; none: a dimensionless swimmer.",
)
def command(file: Path | None, kind: str, units: str) -> None:
    """Write a commented spec to start from: into FILE, or to the terminal."""
    text = spec_text(kind, units)
    if file is None:
        click.echo(text, nl=False)
        return
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise SpecError(f"{file}: exists already; choose another name or remove it") from None
    click.echo(f"written: {file}\nnow try: microswim run {file}", err=True)


#: Values of a new spec that no unit of length gives, by dimension.
TYPICAL = {
    "frequency": {"um": '"100 Hz"', "mm": '"10 Hz"'},
    "viscosity": {"um": '"1 mPa s"', "mm": '"1 Pa s"'},
    "bending stiffness": {"um": '"4e-25 N m^2"', "mm": '"4e-11 N m^2"'},
    "density": {"um": '"1000 kg/m^3"', "mm": '"1000 kg/m^3"'},
}


#: Tables that stand as comments: a spec without them is corrected by what comes along.
COMMENTED = ("coefficients", "interaction")


def spec_text(kind: str, units: str) -> str:
    """Return a commented spec of a kind of tail, in ``"none"``, ``"um"`` or ``"mm"``.

    Which fields it holds, their values and comments are those of `microswim.spec.tables`.
    """
    from microswim.spec.tables import FIELDS, TABLES, TAGS, word

    bare = "give units to all quantities or to none; none: a dimensionless swimmer"
    lines = [
        f"# A swimmer for microswim: a sphere; its tail: {kind.replace('_', ' ')}.",
        f"# Quantities: {bare}.",
    ]
    chosen = {"body": "sphere", "tail": kind}
    for name, kinds in TABLES.items():
        tag = TAGS.get(name)
        given = chosen.get(name)
        table = next(t for t in kinds if given is None or word(t, name) == given)
        paths = (f"{name}.{f}" for f in table.model_fields)
        fields = [FIELDS[path] for path in paths if path in FIELDS]
        shown = [(f, _start(f, units)) for f in fields if f.about.start is not None]
        if tag and name in chosen:
            shown.insert(0, (FIELDS[f"{name}.{tag}"], f'"{chosen[name]}"'))
        mark = "# " if name in COMMENTED else ""
        if shown:
            lines += ["", f"{mark}[{name}]"]
            lines += [
                f"{mark + f.path.partition('.')[2] + ' = ' + value:<32} # {f.about.help}"
                for f, value in shown
            ]
    return "\n".join(lines) + "\n"


def _start(field: Field, units: str) -> str:
    """Value of a field in a new spec, as TOML."""
    value = field.about.start
    if field.dimension is None or units == "none":
        return json.dumps(value)
    if field.measures == "length":
        return f'"{value:g} {units}"'
    return TYPICAL.get(str(field.measures), {}).get(units) or f'"{field.dimension.example}"'
