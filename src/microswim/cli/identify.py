"""``microswim identify``: wave shape and rate of a swimmer from its track."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from microswim.cli import _files
from microswim.cli._options import (
    Given,
    example,
    force_option,
    json_option,
    out_option,
    print_json,
    swimmer_options,
)
from microswim.gait.units import unit
from microswim.numerics.files import fresh

PICTURE = "track.png"
EXAMPLES = example(
    "microswim identify track.csv sperm.toml",
    "microswim identify track.csv --preset tabak/helix --unknown tail.amplitude",
    "microswim identify track.csv sperm.toml --sigma 0.002 --json",
)


@click.command(epilog=EXAMPLES)
@click.argument("track", type=click.Path(path_type=Path))
@swimmer_options
@click.option(
    "--unknown", "unknowns", multiple=True, metavar="NAME",
    help="What to find: a number of the spec, or translation.s and the like (repeatable). "
    "Default: tail.amplitude, tail.waves, tail.frequency.",
)  # fmt: skip
@click.option("--sigma", type=float, help="Noise of each coordinate; default: from the fit.")
@click.option("--sigma-attitude", type=float, help="Noise of the attitude (rad); default 0.02.")
@click.option("--starts", type=int, default=8, show_default=True, help="First guesses to follow.")
@out_option
@force_option
@json_option
def command(
    track: Path,
    given: Given,
    unknowns: tuple[str, ...],
    sigma: float | None,
    sigma_attitude: float | None,
    starts: int,
    out: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Identify a swimmer from its TRACK: wave shape and rate, with uncertainty.

    TRACK is a CSV with the columns time, x, y and, if known, z and the attitude qw, qx, qy, qz
    (body to lab) of the body's centre. Two coordinates are the projection onto the image. SPEC or
    --preset says what is known of the swimmer; what is not unknown stays as it is.
    """
    from microswim.cli._progress import bar
    from microswim.studies.identification.fit import SHAPE, identify_swimmer
    from microswim.studies.identification.track import Track

    swimmer = given.swimmer
    if out is not None:
        _files.check_files("--out", out, [PICTURE], force)
    read = Track.from_csv(track, si=swimmer.units == "SI")
    with bar(f"identify {track.name}"):
        found = identify_swimmer(
            swimmer,
            read,
            unknowns or SHAPE,
            sigma=sigma,
            sigma_attitude=sigma_attitude,
            starts=starts,
        )
    result = {"swimmer": given.name, "units": swimmer.units, **found.as_dict()}
    if out is not None:
        _draw(read, found.path, unit(swimmer.units, "length"), out / PICTURE)
        result["picture"] = str(out / PICTURE)
    if as_json:
        print_json(result)
    else:
        _print(found)


def _print(found: Any) -> None:
    """Values with their 95 % intervals, then what cannot be determined."""
    for name, value, (low, high) in zip(found.names, found.values, found.interval()):
        click.echo(f"{name:22s} {value:12.6g}   95 %: {low:.6g} to {high:.6g}")
    click.echo(f"{'residual':22s} {found.residual:12.3g}   (root mean square, per coordinate)")
    for other in found.alternatives:
        values = ", ".join(f"{n} = {v:.4g}" for n, v in zip(found.names, other))
        click.echo(f"fits as well: {values}")
    for sentence in found.warnings:
        click.echo(f"note: {sentence}")


def _draw(track: Any, path: Any, unit: str, file: Path) -> None:
    """Track and fitted path in the image plane."""
    from microswim.output.plots.run import track_and_fit

    figure = track_and_fit(track.position, path, unit)
    with fresh(file) as scratch:
        figure.savefig(scratch, dpi=200)
