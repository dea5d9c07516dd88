"""``microswim mobility``: the 6x6 resistance of a surface file, or of a swimmer held rigid."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files
from microswim.cli._options import example, force_option, json_option, out_option, print_json, read
from microswim.errors import SpecError

if TYPE_CHECKING:
    from microswim.models.bem.mobility import Mobility

BLOCKS = (("force by velocity", 0, 0, "N s/m"), ("torque by velocity", 3, 0, "N s"),
          ("torque by angular velocity", 3, 3, "N s m"))  # fmt: skip


@click.command(
    epilog=example(
        'microswim mobility head.stl --scale "1 mm"',
        'microswim mobility robot.stl --scale "1 um" --viscosity "5 mPa s" --json',
        "microswim mobility robot.toml --out results",
    )
)
@click.argument("file", metavar="FILE_OR_SPEC", type=click.Path(path_type=Path))
@click.option("--scale", metavar="LENGTH", help='Length of one unit of a surface file: "1 mm".')
@click.option("--viscosity", metavar="VALUE", help="Of the fluid; else the spec's, or water's.")
@click.option(
    "--level",
    type=click.Choice(["coarse", "standard", "fine"]),
    default="standard",
    show_default=True,
    help="Resolution; the command says how far off the answer may be at it.",
)
@click.option("--set", "changes", metavar="FIELD=VALUE", multiple=True,
              help="Override a field of the spec (repeatable).")  # fmt: skip
@json_option
@out_option
@force_option
def command(
    file: Path,
    scale: str | None,
    viscosity: str | None,
    level: str,
    changes: tuple[str, ...],
    as_json: bool,
    out: Path | None,
    force: bool,
) -> None:
    """Print how a rigid body of any shape resists and moves: its 6x6, by boundary elements.

    FILE_OR_SPEC is an STL, PLY or OBJ file of a closed surface, or a spec whose tail stands still.
    """
    from microswim.cli import _folder
    from microswim.models.bem.mobility import mobility

    if out is not None:
        _folder.check(out, force)
    what: Any = file
    if file.suffix.lower() == ".toml":
        if scale is not None:
            raise SpecError("--scale", scale, "left out with a spec", "body.scale says it there")
        what = read(file, None, changes).swimmer
    elif changes:
        raise SpecError("--set", changes[0], "left out with a surface file", "it has no fields")
    units = getattr(what, "units", "SI" if _has_unit(scale) else "dimensionless")
    found = mobility(
        what,
        scale=_value("body.scale", scale, units, "--scale"),
        viscosity=_value("fluid.viscosity", viscosity, units, "--viscosity"),
        level=level,  # type: ignore[arg-type]
    )
    numbers = {"file": str(file), **found.as_dict()}
    show = partial(print_json, numbers) if as_json else partial(_print, found, str(file))
    if out is not None:
        with _files.or_else(show):
            _write(found, numbers, out, force)
    show()


def _has_unit(scale: str | None) -> bool:
    from microswim.spec.units import has_unit

    return scale is not None and has_unit(scale)


def _value(name: str, text: str | None, units: str, said: str) -> Any:
    """The number of an option; a scale with its unit stays a text, which says that it has one."""
    from microswim.spec.values import from_text

    if text is None:
        return None
    value = from_text(name, text, units, said)
    return f"{value!r} m" if name == "body.scale" and units == "SI" else value


def _print(found: Mobility, name: str) -> None:
    from microswim.gait.readable import EXPLAINED, percent

    si = found.units == "SI"
    unit = {"length": " m", "viscosity": " Pa s"} if si else {"length": "", "viscosity": ""}
    click.echo(f"{name}, rigid, in a fluid of viscosity {found.viscosity:.4g}{unit['viscosity']}")
    click.echo(f"  about {_row(found.about)}{unit['length']}, by axes of the file or the frame sqr")
    for title, i, j, measure in BLOCKS:
        click.echo(f"  {title}{f' ({measure})' if si else ''}")
        for row in found.resistance[i : i + 3, j : j + 3]:
            click.echo(f"    {_row(row)}")
    click.echo(f"  centre of mobility {_row(found.centre_of_mobility)}{unit['length']}")
    click.echo(f"  chirality {found.chirality:.3g}")
    power = ("^2", "^3") if si else ("", "")
    click.echo(f"  surface {found.surface_area:.6g}{unit['length']}{power[0] if si else ''}, "
               f"volume {found.volume:.6g}{unit['length']}{power[1] if si else ''}")  # fmt: skip
    click.echo(f"  expected error {percent(found.expected_error)} of sqrt(R_ii R_jj): "
               f"{found.how}; {EXPLAINED}")  # fmt: skip
    for remark in found.remarks:
        click.echo(f"  note: {remark}")
    click.echo(f"  {found.unknowns:,} unknowns, solved in {found.seconds:.3g} s")


def _row(values: Any) -> str:
    return "  ".join(f"{value: .5e}" for value in values)


def _write(found: Mobility, numbers: dict[str, Any], out: Path, force: bool) -> None:
    """Numbers, surface and picture, all or none."""
    from microswim.cli import _folder
    from microswim.numerics.files import write
    from microswim.numerics.plain import plain
    from microswim.output.plots.mobility import mobility as picture
    from microswim.output.report.html import png

    with _folder.filled(out, force) as folder:
        write(folder / "mobility.json", json.dumps(plain(numbers), indent=1) + "\n")
        found.to_vtk(folder / "surface.vtp")
        write(folder / "surface.png", png(picture(found)))
    click.echo(f"written to {out}/: mobility.json, surface.vtp (ParaView), surface.png", err=True)
