"""``microswim identify``: what the tracks of filmed cells hold, and the swimmers that made them."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import click

from microswim.cli import _cell_tables, _files, _wandering, _waveform
from microswim.cli._options import (
    Given,
    example,
    force_option,
    json_option,
    out_option,
    print_json,
    swimmer_options,
    workers_option,
)
from microswim.errors import MicroswimError, SpecError
from microswim.gait.units import unit
from microswim.numerics.files import fresh

EXAMPLES = example(
    "microswim identify spots.csv --fps 25 --pixel 0.11um --out cells",
    "microswim identify track.csv sperm.toml",
    "microswim identify beat.csv --out beat",
    "microswim identify track.csv --preset tabak/helix --unknown tail.amplitude",
    "microswim identify track.csv sperm.toml --sigma 50nm --json",
    "microswim identify spots.csv --fps 25 --pixel 0.11um --noise",
)
Draw = Callable[[Path, dict[str, str]], None]  #: into a folder, under the names of the pictures
TABLE, DISPLACEMENT = "cells.csv", "displacement.csv"


@click.command(epilog=EXAMPLES)
@click.argument("tracks", type=click.Path(path_type=Path))
@partial(swimmer_options, needed=False)
@click.option("--pixel", metavar="0.11um", help="Size of a pixel, where the file has pixels.")
@click.option("--fps", metavar="25", help="Frames per second, where the file counts frames.")
@click.option(
    "--track", "--particle", "only", multiple=True, metavar="NAME",
    help="The tracks that are wanted (repeatable); all by default.",
)  # fmt: skip
@click.option(
    "--unknown", "unknowns", multiple=True, metavar="NAME",
    help="What to find: a number of the spec, or translation.s and the like (repeatable). "
    "Default: tail.amplitude, tail.waves, tail.frequency.",
)  # fmt: skip
@click.option(
    "--noise", is_flag=True,
    help="Without a SPEC: how the cells wander as well, each and all of them together: "
    "persistence, diffusion, and what two coordinates tell of the third.",
)  # fmt: skip
@click.option("--sigma", metavar="50nm", help="Noise of each coordinate; default: from the fit.")
@click.option(
    "--sigma-attitude", metavar="1deg", help="Noise of the attitude (bare: rad); default 0.02."
)
@click.option(
    "--model-error/--no-model-error", default=True,
    help="Whether intervals hold the error to expect of the model too; they do.",
)  # fmt: skip
@click.option("--starts", type=int, default=8, show_default=True, help="First guesses to follow.")
@workers_option
@out_option
@force_option
@json_option
def command(
    tracks: Path,
    given: Given | None,
    pixel: str | None,
    fps: str | None,
    only: tuple[str, ...],
    noise: bool,
    out: Path | None,
    force: bool,
    as_json: bool,
    **fit: Any,
) -> None:
    """Tell what the TRACKS of filmed cells hold; with a SPEC, find the swimmer that made each.

    TRACKS is a table with x, y and, if known, z of the body's centre, with time or frame and, for
    several cells, the track's name: the CSV of TrackMate (or its XML) or of trackpy, or any such
    table; comma, semicolon or tab, decimal comma, units in the header, x (um). Two coordinates are
    the projection onto the image. The attitude, if known, is qw, qx, qy, qz (body to lab).

    Without a SPEC: speed, curvilinear and straight-line velocity, turning, wobble and mean squared
    displacement of every cell, with 95 % intervals. With a SPEC or --preset, which says what is
    known of the swimmer: wave shape and rate, with uncertainty.

    A beat that was traced frame by frame, a table with time or frame, s, x, y (or the tangent
    angle) in the frame of the head, is fitted by smooth modes; tail.kind = "waveform" takes it.
    """
    from microswim.spec.readers.beat import is_beat
    from microswim.studies.identification.films.tracks import read_tracks

    units = "SI" if given is None else given.swimmer.units
    if tracks.is_file() and is_beat(tracks):
        if given is not None:
            raise SpecError(
                f"{tracks}: a beat; it needs no SPEC here, the SPEC names it: tail.file"
            )
        return _waveform.identify(tracks, pixel, fps, out, force, as_json)
    read = read_tracks(tracks, units=units, pixel=pixel, fps=fps, track=list(only) or None)
    if noise and given is not None:
        raise SpecError("--noise: asks what the tracks themselves hold; leave out the SPEC")
    names = _pictures(list(read))
    if out is not None:
        _files.check_files("--out", out, [TABLE, DISPLACEMENT, *names.values()], force)
    said = [*read.remarks, *_left_out(read)]
    if given is None:
        rows, draw = _describe(read, tracks.name, fit["workers"])
        result: dict[str, Any] = {"units": units}
        if noise:
            result["wandering"] = _wandering.found(read, rows, tracks.name)
    else:
        rows, draw = _fit(given, read, tracks.name, fit)
        result = {"swimmer": given.name, "units": units}

    def show() -> None:
        if as_json:
            alone = given is not None and len(rows) == 1
            first = {k: v for k, v in rows[0].items() if k != "notes"} if alone else {}
            return print_json(result | first | {"cells": rows, "notes": said})
        for sentence in said:
            click.echo(f"note: {sentence}", err=True)
        _print(rows, units, given is not None)
        return _wandering.show(rows, result["wandering"], units) if noise else None

    if out is not None:
        with _files.or_else(show):
            draw(out, names)
    return show()


def _left_out(read: Any) -> list[str]:
    """What of the file was not used, a sentence each."""
    found = []
    if read.ignored:
        found.append(f"columns not used: {', '.join(read.ignored)}")
    reasons: dict[str, list[str]] = {}
    for name, why in read.left_out.items():
        kind = "too short" if "positions" in why and "at least" in why else why
        reasons.setdefault(kind, []).append(name)
    for why, names in reasons.items():
        few = ", ".join(names[:5]) + (", ..." if len(names) > 5 else "")
        found.append(f"{len(names)} track(s) left out ({few}): {why}")
    return found


def _pictures(names: list[str]) -> dict[str, str]:
    """File of each cell's picture: its name, made harmless, or its number."""
    if len(names) == 1:
        return {names[0]: "track.png"}
    plain = {name: re.sub(r"[^\w-]", "_", name)[:40] for name in names}
    unique = len(set(plain.values())) == len(plain)
    return {n: f"track-{plain[n] if unique else i}.png" for i, n in enumerate(names)}


def _describe(read: Any, what: str, workers: int | None) -> tuple[list[Any], Draw]:
    """What each track holds without a model; and what draws it and writes the tables."""
    from microswim.cli._progress import bar
    from microswim.studies.identification.many_cells import describe_tracks

    with bar(f"identify {what}") as progress:
        every = describe_tracks(dict(read.items()), workers=workers, progress=progress)
    found = list(every.values())
    rows = [one.as_dict() for one in found]

    def draw(out: Path, names: dict[str, str]) -> None:
        for row, one, (name, track) in zip(rows, found, read.items()):
            _draw_cell(track, one, read.units, out / names[name])
            row["picture"] = str(out / names[name])
        _cell_tables.write(out / TABLE, _cell_tables.flat(rows))
        _cell_tables.write(out / DISPLACEMENT, _cell_tables.lags(rows))

    return rows, draw


def _fit(given: Given, read: Any, what: str, fit: dict[str, Any]) -> tuple[list[Any], Draw]:
    """The swimmer of each track, or why there is none and what it does hold; and what draws it."""
    from microswim.cli._progress import bar
    from microswim.spec.values import from_text
    from microswim.studies.identification.fitting.fit import SHAPE
    from microswim.studies.identification.fitting.many import identify_swimmers
    from microswim.studies.identification.without_model import describe_track

    swimmer, rows, paths = given.swimmer, [], {}
    options: dict[str, Any] = fit | {"unknowns": fit["unknowns"] or SHAPE}
    for name, like in (("sigma", "tail.radius"), ("sigma_attitude", "wall.tilt")):
        if fit[name] is not None:
            said = f"--{name.replace('_', '-')}"
            options[name] = from_text(like, fit[name], swimmer.units, said)
    with bar(f"identify {what}") as progress:
        every = identify_swimmers(swimmer, dict(read.items()), progress=progress, **options)
    for name, found in every.items():
        if isinstance(found, MicroswimError):
            seen = describe_track(read[name], name).as_dict()
            rows.append(seen | {"values": {}, "warnings": [str(found)]})
        else:
            rows.append({"track": name} | found.as_dict())
            paths[name] = found.path

    def draw(out: Path, names: dict[str, str]) -> None:
        for row in rows:
            name = row["track"]
            if name in paths:
                _draw_fit(read[name], paths[name], swimmer.units, out / names[name])
                row["picture"] = str(out / names[name])
        _cell_tables.write(out / TABLE, [_cell_tables.values(row) for row in rows])

    return rows, draw


def _print(rows: list[Any], units: str, fitted: bool) -> None:
    if not fitted:
        return _print_cells(rows, units)
    without = [row for row in rows if not row["values"]]
    for row in rows:
        if len(rows) > 1:
            click.echo(f"track {row['track']}")
        _print_fit(row, units)
    return _print_cells(without, units) if without else None


def _print_fit(row: dict[str, Any], units: str) -> None:
    """Values with their 95 % intervals, then what cannot be determined."""
    for name, value in row.get("values", {}).items():
        low, high = row["interval_95"][name]
        text, ends = _with_ends(name, value, (low, high), units, 6)
        known = f"95 %: {ends}" if ends else "not determined"
        click.echo(f"{name:22s} {text:>14s}   {known}")
    if "residual" in row:
        text, _ = _with_ends("tail.length", row["residual"], (None, None), units, 3)
        click.echo(f"{'residual':22s} {text:>14s}   (root mean square, per coordinate)")
    designs = row.get("branches", ())
    for i, design in enumerate(designs if len(designs) > 1 else ()):
        click.echo(f"design {i + 1} of {len(designs)}: " + ", ".join(_known(design, units)))
    for sentence in row.get("warnings", ()):
        click.echo(f"note: {sentence}")


def _known(design: dict[str, Any], units: str) -> list[str]:
    """Each value of a design that fits, with its 95 % interval."""
    found = []
    for name, value in design["values"].items():
        text, ends = _with_ends(name, value, design["interval_95"][name], units, 4)
        found.append(f"{name} = {text} ({ends or 'not determined'})")
    return found


def _with_ends(name: str, value: float, interval: Any, units: str, digits: int) -> tuple[str, str]:
    """A number of the spec with its unit, and the ends of its interval in the same one."""
    from microswim.gait.readable import prefixed
    from microswim.spec.describe import unit_of

    measured_in = unit_of(name, units)
    factor, short = prefixed(value, measured_in) if measured_in else (1.0, "")
    after = f" {short}" if short else ""
    low, high = (None if x is None else f"{x * factor:.{digits}g}" for x in interval)
    ends = "" if low is None else f"{low} to {high}{after}"
    return f"{value * factor:.{digits}g}{after}", ends


SHOWN = {
    "speed": "speed", "curvilinear_velocity": "curvilinear", "straight_line_velocity": "straight",
    "linearity": "linearity", "turning_rate": "turning", "loop_radius": "loops of radius",
    "drift": "drift", "wobble_frequency": "wobble", "wobble_amplitude": "its amplitude",
}  # fmt: skip
RARE = ("loop_radius", "drift")  #: shown where a cell has them


def _estimated(value: float, interval: list[float], measured_in: str) -> str:
    """A number with the half of its interval; one that noise hides, by its bound."""
    from microswim.gait.readable import quantity, with_error

    low, high = interval
    if value == 0.0 and high > low:
        return f"below {quantity(max(-low, high), measured_in, 2)}"
    half = (high - low) / 2.0
    return with_error(value, half / abs(value) if value else None, measured_in)


def _print_cells(rows: list[Any], units: str) -> None:
    """A row for each cell, then what the tracks cannot hold."""
    from microswim.cli._print import print_table
    from microswim.gait.readable import quantity
    from microswim.output.report.html import Table
    from microswim.studies.identification.without_model import NUMBERS

    names = [n for n in SHOWN if n not in RARE or any(row[n] is not None for row in rows)]
    lines = []
    for row in rows:
        line = [row["track"]]
        for name in names:
            value, interval = row[name], row["interval_95"][name]
            of = unit(units, NUMBERS[name])
            if value is None:
                line.append("-")
                continue
            line.append(_estimated(value, interval, of))
        lines.append(tuple(line))
    fastest = min(row["frame_rate"] for row in rows) / 2.0
    limit = quantity(fastest, unit(units, "frequency"))
    note = f"± is the 95 % interval. A beat faster than {limit} does not show at this frame rate."
    print_table(Table("Cells", ("track", *(SHOWN[n] for n in names)), lines, note))
    notes: dict[str, list[str]] = {}
    for row in rows:
        for sentence in row["notes"]:
            notes.setdefault(sentence, []).append(row["track"])
    for sentence, of in notes.items():
        few = ", ".join(of[:5]) + (", ..." if len(of) > 5 else "")
        click.echo(f"track {few}: {sentence}" if len(rows) > 1 else f"note: {sentence}")


def _draw_cell(track: Any, found: Any, units: str, file: Path) -> None:
    from microswim.output.plots.cells import cell

    _save(cell(track.position, found, unit(units, "length"), unit(units, "time")), file)


def _draw_fit(track: Any, path: Any, units: str, file: Path) -> None:
    """Track and fitted path in the image plane."""
    from microswim.output.plots.run import track_and_fit

    _save(track_and_fit(track.position, path, unit(units, "length")), file)


def _save(figure: Any, file: Path) -> None:
    with fresh(file) as scratch:
        figure.savefig(scratch, dpi=150)
