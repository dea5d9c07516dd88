"""``microswim export``: the model for another program, as C or as an FMU."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from microswim import checks
from microswim.cli import _files
from microswim.cli._options import (
    Given,
    auto_option,
    example,
    force_option,
    json_option,
    level_option,
    leveled,
    print_json,
    swimmer_options,
)
from microswim.errors import SpecError
from microswim.gait.readable import origin
from microswim.numerics.files import scratch

if TYPE_CHECKING:
    from microswim.control.stepper import Stepper
    from microswim.gait.gait import Gait
    from microswim.swimmer.swimmer import Swimmer


@click.command(
    epilog=example(
        "microswim export robot.toml --format c",
        "microswim export --preset goto/C --format fmu --out units/cell.fmu",
        'microswim export robot.toml --format fmu --fmi 2.0 --moment "0, 0.02 mA m^2, 0"',
        "microswim export robot.toml --format c --precision float --steps 4",
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
    help="In place of the spec's [magnet]: moment in the body frame s, q, r, with a unit, or in "
    "A m^2; a spec without units takes numbers.",
)
@click.option("--locked", is_flag=True, help="The motor is locked: a rigid magnetised robot.")
@click.option(
    "--resolution",
    type=float,
    default=64.0,
    show_default=True,
    help="Internal steps per turn of tail, field or body.",
)
@click.option(
    "--steps",
    type=click.IntRange(1, 10_000_000),
    metavar="N",
    help="Internal steps of every step, for a fixed time; by default as many as it takes.",
)
@click.option(
    "--most-steps",
    type=click.IntRange(1, 10_000_000),
    default=100_000,
    show_default=True,
    metavar="N",
    help="Internal steps that a step may take; more is an error of the step.",
)
@click.option(
    "--precision",
    type=click.Choice(["double", "float"]),
    default="double",
    show_default=True,
    help="Numbers of the C; float for a processor without double.",
)
@auto_option
@level_option
@click.option(
    "--out",
    metavar="PATH",
    type=click.Path(path_type=Path, file_okay=True),
    default=Path(),
    help="Folder for the files, by default the current one; or the file: robot.fmu.",
)
@force_option
@json_option
def command(
    given: Given,
    kind: str,
    fmi: Literal["3.0", "2.0"],
    name: str | None,
    moment: str | None,
    locked: bool,
    resolution: float,
    steps: int | None,
    most_steps: int,
    precision: Literal["double", "float"],
    model: str,
    level: str | None,
    out: Path,
    force: bool,
    as_json: bool,
) -> None:
    """Write the swimmer as C or as an FMU, for a controller or a simulator.

    The files need no Python; their heads say conventions, units and where the numbers come from.
    With [wall] or an off-axis [channel] poses are solved first, and the tables go into the files.
    """
    from microswim.control.export import compiler
    from microswim.control.export.cmodel import c_model, check_name

    name = name or _identifier(given.name)
    if precision == "float" and kind == "fmu":
        raise SpecError("--precision", precision, "double for an FMU, whose standard has it so")
    files = [f"{name}.h", f"{name}.c"] if kind == "c" else [f"{name}.fmu"]
    if kind == "fmu" and out.suffix == ".fmu":
        out, files = out.parent, [out.name]
    elif out.suffix in (".c", ".h", ".fmu"):
        raise SpecError("--out", str(out), "a folder", "header and source are written into it")
    _files.check_files("--out", out, files, force)
    check_name(name)
    checks.number("--resolution", resolution, "4 or more steps per turn", least=4)
    own = None if moment is None else _moment(moment, given.swimmer.units)
    options: dict[str, Any] = {"moment": own, "locked": locked}
    options |= {"resolution": resolution, "steps": steps, "most_steps": most_steps}
    stepper = _stepper(given, model, level, options)
    gait = stepper.gait
    code = c_model(stepper, name, given.text, precision)
    found: dict[str, Any] = {"format": kind, "name": name, "units": gait.units, "model": gait.model}
    found |= compiler.measured(code)
    found |= _written(stepper, code, given.text, out, files, fmi)
    if as_json:
        error = gait.info.get("expected_error")
        around = getattr(stepper, "poses", None)
        found |= {} if around is None else {"poses_error": around.expected_error}
        print_json(found | {"expected_error": error, "remarks": gait.info.get("remarks", [])})
    else:
        _say(found)
        for line in origin(gait):
            click.echo(f"  note: {line}")


def _stepper(given: Given, model: str, level: str | None, options: dict[str, Any]) -> Stepper:
    """Return the stepper of a gait, beside a boundary of one at every pose."""
    from microswim.cli._progress import bar
    from microswim.control.export.boundary import check
    from microswim.control.posed_stepper import beside
    from microswim.control.stepper import Stepper
    from microswim.swimmer.physical_sense import turning

    boundary = turning(given.swimmer)
    if boundary:
        check(given.swimmer)
        with bar(f"poses of {given.name} by the {boundary}") as progress:
            return beside(given.swimmer, level=level, progress=progress, **options)
    solver = leveled(model, level)
    with bar(f"{model}, {given.name}"):
        gait = _with_error(given.swimmer, given.swimmer.gait(model, **solver))
    return Stepper(gait, given.swimmer, **options)


def _with_error(swimmer: Swimmer, gait: Gait) -> Gait:
    """Return the gait with what is known of its error, for the heads of the files."""
    from microswim.calibration.atlas.expected import expected_error

    if "expected_error" in gait.info:
        return gait
    off = expected_error(swimmer, gait)
    known = {} if off["us"] is None else {"expected_error": off}
    return replace(gait, info=gait.info | known)


def _written(
    stepper: Stepper, code: Any, spec: str, out: Path, files: list[str], fmi: Literal["3.0", "2.0"]
) -> dict[str, Any]:
    """Write into a scratch folder, then move: all files or none."""
    from microswim.control.export import compiler
    from microswim.control.export.fmu import export_fmu

    about: dict[str, Any] = {}
    with scratch(out / "export", said=out) as here:
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
    from microswim.control.export.cmodel import reserved

    made = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")[:32]
    if reserved(made):
        return f"{made}_swimmer"
    return made if made[:1].isalpha() else "swimmer"


def _moment(text: str, units: str) -> tuple[float, ...]:
    """Three components, with or without units: ``[0, 2e-5, 0]``, ``0 0.02 mA m^2 0``."""
    inside = text.strip("[]() ")
    parts = inside.split(",") if "," in inside else _three(inside)
    if len(parts) != 3:
        raise SpecError(
            "--moment", text, 'three numbers, such as "[0, 2e-5, 0]" or "0, 0.02 mA m^2, 0"'
        )
    return tuple(_component(part.strip(" '\""), text, units) for part in parts)


def _three(text: str) -> list[str]:
    """Parts that begin with a number, where there are no commas."""
    return re.findall(r"(?:^|(?<=\s))[+-]?(?:\d|\.\d|nan|inf)\S*(?:\s+[^\d\s+.-]\S*)*", text)


def _component(part: str, text: str, units: str) -> float:
    from microswim.spec.units import to_si

    try:
        return float(part)
    except ValueError:
        pass
    if units != "SI":
        raise SpecError("--moment", text, "three numbers, as the spec is without units")
    try:
        return to_si(part, "A m^2")
    except ValueError as error:
        raise SpecError(f"--moment = {part!r}: {error}") from None


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
