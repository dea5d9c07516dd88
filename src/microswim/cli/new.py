"""``microswim new``: a commented spec to start from."""

from __future__ import annotations

from pathlib import Path

import click

from microswim.cli._options import example
from microswim.errors import SpecError


@click.command(
    epilog=example(
        "microswim new robot.toml",
        "microswim new cell.toml --units um",
        "microswim new --kind plane_wave > sperm.toml",
    )
)
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option(
    "--kind", type=click.Choice(["helix", "plane_wave"]), default="helix", show_default=True
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


def spec_text(kind: str, units: str) -> str:
    """A commented spec of a kind of tail, in ``"none"``, ``"um"`` or ``"mm"``."""
    si = units != "none"

    def length(value: float) -> str:
        return f'"{value:g} {units}"' if si else repr(value)

    own = {
        "helix": ['handedness = "left"', "right for the mirror image"],
        "plane_wave": ['sections = "sheared"', "bem, fem: circles in s = const planes"],
    }[kind]
    fast = {"none": "1.0", "um": '"100 Hz"', "mm": '"10 Hz"'}[units]
    thick = {"none": "100.0", "um": '"1 mPa s"', "mm": '"1 Pa s"'}[units]
    heavy = {"none": "1.0", "um": '"1000 kg/m^3"', "mm": '"1000 kg/m^3"'}[units]
    bare = "give units to all quantities or to none; none: a dimensionless swimmer"
    lines: list[str | tuple[str, str]] = [
        f"# A swimmer for microswim: a sphere with a {kind.replace('_', ' ')} for a tail.",
        f"# Quantities: {bare}.",
        "",
        "[fluid]",
        (f"viscosity = {thick}", "dynamic"),
        (f"density = {heavy}", "for the Reynolds number, and finite elements with inertia"),
        "",
        "[body]",
        ('shape = "sphere"', "sphere: radius | spheroid, ellipsoid: semi_axes | none"),
        (f"radius = {length(0.5)}", "the body touches the tail's joint with its rear"),
        "",
        "[tail]",
        (f'kind = "{kind}"', "helix | plane_wave | custom"),
        (f"length = {length(2.0)}", "from the body to the tip"),
        ('length_measure = "apparent"', "apparent: along the axis s | arc: along the filament"),
        (f"amplitude = {length(0.1)}", "of the wave; the radius of a helix"),
        ("waves = 3", "or wavelength, one of the two"),
        (f"radius = {length(0.05)}", "of the filament"),
        (f"frequency = {fast}", "of the motor: the tail relative to the body"),
        (own[0], own[1]),
        ("ramp = 0.1", "fraction of the length over which the amplitude grows"),
        "",
        "# [coefficients]",
        ('# law = "lighthill"', "without a law: corrected by what comes along (model auto)"),
        ("# spin = true", "laws: lighthill, gray_hancock, cox, constant (normal, tangential)"),
        ("# tip = false", "true: the free end has a drag of its own, 3 pi mu r_t"),
        "",
        "# [interaction]",
        ("# translation = [1.0, 1.0, 1.0]", "factors on the body's drag along s, q, r"),
        ("# rotation = [1.0, 1.0, 1.0]", "and about s, q, r; microswim calibrate finds them"),
        "",
        "[motion]",
        ('free = "all"', 'or a list such as ["us", "uq", "ur", "os"]'),
    ]
    return "".join(
        f"{line}\n" if isinstance(line, str) else f"{line[0]:<30} # {line[1]}\n" for line in lines
    )
