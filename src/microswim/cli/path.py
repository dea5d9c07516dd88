"""``microswim path``: the path of a swimmer under all that its spec says acts on it."""

from __future__ import annotations

import time as clock
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files, _kept
from microswim.cli._options import (
    Given,
    auto_option,
    example,
    force_option,
    json_option,
    level_option,
    out_option,
    print_json,
    swimmer_options,
)
from microswim.cli._over import map_starts
from microswim.cli._path_told import report as report_of
from microswim.cli._path_told import table
from microswim.errors import SpecError
from microswim.numerics.files import write

if TYPE_CHECKING:
    import xarray as xr


FILES = {
    "path.png": "the path from above, from the side and in time",
    "path.gif": "a film of it, from above and close by (--film)",
    "path.nc": "everything, netCDF with units",
    "path.csv": "position and quaternion in time",
    "swimmer.pvd": "the swimmer in time, for ParaView (frames in vtk/)",
    "path.vtp": "its path, for ParaView",
    "spec.toml": "the spec it came from",
    _kept.CHECKPOINT: "what --resume goes on from",
    "starts.nc": "a map of starts (--over)",
    "starts.png": "its picture",
    "starts.json": "what --resume goes on from",
}
FRAMES = 120  #: of the swimmer for ParaView


@click.command(
    epilog=example(
        "microswim path robot.toml --time 10s",
        "microswim path robot.toml --time 60s --from 0um,0um,20um --tilt 10deg --out path",
        "microswim path robot.toml --time 60s --out path --film",
        "microswim path robot.toml --time 60s --out path --resume     after it was killed",
        "microswim path soft.toml --time 2s --from-rest     an elastic tail from rest on",
        "microswim path cell.toml --time 30s --paths 200 --seed 1 --json     with [noise]",
        "microswim path cell.toml --time 60s --over z=1um:5um:9,tilt=0:60deg:7 --out map",
    )
)
@swimmer_options
@click.option("--time", required=True, metavar="T", help="How long, such as 60s.")
@click.option(
    "--from",
    "start",
    metavar="X,Y,Z",
    help="Start of the body's centre in the lab; by default 0,0,0.",
)
@click.option(
    "--tilt", metavar="A", help="Angle by which it noses down at the start, such as 10deg."
)
@auto_option
@level_option
@click.option(
    "--poses",
    type=click.IntRange(40, 10_000),
    help="Poses in a tube to solve; by default 187 to 750, until others are met within 0.5 %.",
)
@click.option(
    "--samples",
    type=click.IntRange(2, 1_000_000),
    help="Times at which the path is kept; by default 16 a period, at most 4000.",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(1e-12, 1e-2),
    default=1e-6,
    show_default=True,
    help="Error of a time step, in lengths of the swimmer and radians.",
)
@click.option(
    "--paths",
    type=click.IntRange(1, 1_000_000),
    default=1,
    show_default=True,
    help="Number of paths with [noise].",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the noise.")
@click.option(
    "--from-rest",
    is_flag=True,
    help="Follow an elastic tail from its shape at rest on; always so if nothing drives its base.",
)
@click.option(
    "--over",
    multiple=True,
    metavar="NAME=A:B:N",
    help="A map of starts: x, y, z, tilt, phase of the start, or fields; how each path ends.",
)
@json_option
@out_option
@click.option("--film", is_flag=True, help="A film in --out too, from above and close by.")
@click.option("--resume", is_flag=True, help="Go on with the path in --out, if there is one.")
@force_option
def command(
    given: Given,
    time: str,
    start: str | None,
    tilt: str | None,
    model: str,
    level: str | None,
    poses: int | None,
    from_rest: bool,
    over: tuple[str, ...],
    as_json: bool,
    out: Path | None,
    film: bool,
    resume: bool,
    force: bool,
    **asked: Any,
) -> None:
    """Follow a swimmer in time: [motor], [magnet] and [field], [gravity], [flow], [noise].

    With --out the path is kept in parts while it grows: killed at any moment, --resume goes on from
    there to the same numbers. The swimmer heads for -x at the start. With [wall], the plane z = 0,
    or [channel], a tube about the x axis, it is first solved at some hundred poses there, which are
    kept for the next time. With [motor] its torque turns each tail.
    """
    from microswim.cli._progress import bar
    from microswim.path.following import path

    asked |= _start(given, time, start, tilt)
    _check(out, resume, force)
    if film and (out is None or asked["paths"] > 1 or over):
        raise SpecError("--film: with --out DIR, and of one path")
    if poses is not None and (given.swimmer.channel is None or over):
        raise SpecError("--poses", poses, "left out but for one path in a [channel]")
    if over:
        if given.swimmer.motor is not None:
            raise SpecError("--over", over[0], "left out with [motor]", "sweep one path at a time")
        map_starts(given, over, asked["time"], model, out, as_json)
        return
    about = _gait(given, model, level, poses, from_rest, asked)
    begun = clock.perf_counter()
    if out is not None:
        asked["keep"] = _kept.begin(out, given.text)
    with _kept.resumable(out), bar(f"path {given.name}") as progress:
        found = path(given.swimmer, progress=progress, **about, **asked)
    report = report_of(given, about, found, clock.perf_counter() - begun)
    show = partial(print_json, report) if as_json else partial(_show, given.name, report)
    if out is not None:
        with _files.or_else(show):
            _write(out, given, found)
            if film:
                _film(out / "path.gif", given, found)
    show()
    if out is not None:
        click.echo(f"written to {out}/", err=True)
        for name, meaning in FILES.items():
            if (out / name).exists():
                click.echo(f"  {name:<14}  {meaning}", err=True)


def _show(name: str, report: dict[str, Any]) -> None:
    from microswim.cli import _print

    _print.print_table(table(name, report))
    for remark in report["remarks"]:
        click.echo(f"  note: {remark}")


def _gait(
    given: Given,
    model: str,
    level: str | None,
    poses: int | None,
    from_rest: bool,
    asked: dict[str, Any],
) -> dict[str, Any]:
    """Return the gait, by a boundary at every pose; none where the tail's shape is followed."""
    from microswim.cli import _print
    from microswim.path.remembering import remembers

    if from_rest and not given.swimmer.tail.settles:
        raise SpecError("--from-rest", given.swimmer.tail.kind, "for a tail of kind elastic")
    if from_rest or remembers(given.swimmer):
        return {"memory": True}
    if given.swimmer.motor is not None:
        if level is not None and model != "bem":
            raise SpecError("--level", level, "left out with [motor]", "or take --model bem")
        if model == "bem" and given.swimmer.hook is None:
            _tell_cost(given, level)
        return {"model": model, "level": level}
    boundary = "beside the wall" if given.swimmer.wall is not None else "in the tube"
    if given.swimmer.wall is not None or given.swimmer.channel is not None:
        from microswim.calibration.poses.around import around
        from microswim.cli._progress import bar
        from microswim.path.start import check_early

        begins = {n: asked[n] for n in ("position", "tilt", "paths") if n in asked}
        check_early(given.swimmer, **begins)
        with _kept.solves(), bar(f"poses of {given.name} {boundary}") as progress:
            return {"poses": around(given.swimmer, level=level, progress=progress, **_many(poses))}
    return {"gait": _print.timed_gait(given.swimmer, model, level)[0]}


def _many(poses: int | None) -> dict[str, Any]:
    """Return how many poses in a tube are solved, if that was asked."""
    from microswim.calibration.poses.scattered import Scatter

    return {} if poses is None else {"scatter": Scatter(poses=poses, within=0.0)}


def _tell_cost(given: Given, level: str | None) -> None:
    """Say before what boundary elements take for motors of given torque."""
    from microswim.jobs.motor_phases import foreseen

    solves, unknowns = foreseen(given.swimmer, level or "standard")
    click.echo(
        f"note: {solves} solves of {unknowns:,} unknowns at least, more if that many do not meet "
        "other phases; each is kept as it comes: stopped, the same command goes on",
        err=True,
    )


def _start(given: Given, time: str, start: str | None, tilt: str | None) -> dict[str, Any]:
    """Return time and pose at the start as numbers."""
    from microswim.spec.values import in_unit

    units = given.swimmer.units
    asked: dict[str, Any] = {"time": in_unit("--time", time, "s", units)}
    if not asked["time"] > 0:
        raise SpecError("--time", time, "above zero")
    if start is not None:
        parts = start.split(",")
        if len(parts) != 3:
            raise SpecError("--from", start, "three lengths x,y,z", "such as 0um,0um,20um")
        asked["position"] = tuple(in_unit("--from", part, "m", units) for part in parts)
    if tilt is not None:
        bare = tilt.strip().lstrip("+-").replace(".", "", 1).isdecimal()
        asked["tilt"] = float(tilt) if bare else in_unit("--tilt", tilt, "rad", "SI")
    return asked


def _check(out: Path | None, resume: bool, force: bool) -> None:
    """Refuse before any work what cannot end well; with --force, clear the way."""
    if resume and out is None:
        raise SpecError("--resume needs --out DIR")
    if out is not None and not resume:
        _kept.check(out, "path", FILES, "vtk", force)


def _film(file: Path, given: Given, found: xr.Dataset) -> None:
    from microswim.cli._progress import bar
    from microswim.output.plots.film import film

    with bar(f"film of {given.name}") as progress:
        film(given.swimmer, found, file, progress=progress)


def _write(out: Path, given: Given, found: xr.Dataset) -> None:
    import shutil

    from microswim.numerics.files import scratch
    from microswim.output.io import run as io
    from microswim.output.io import vtk
    from microswim.output.plots.path import path as picture
    from microswim.output.report.html import png

    run = io.with_birthplace(found.rename(phase="motor_phase"), given.text, "Path of a swimmer")
    io.save(run, out / "path.nc")
    io.save(run, out / "path.csv")
    write(out / "path.png", png(picture(found)))
    if "path" in found.dims:  # many of them
        return
    drawn = given.swimmer if "filament" in found else given.swimmer.settled
    with scratch(out / "frames", out) as new:
        vtk.write_swimmer(new, drawn, run, FRAMES)
        shutil.rmtree(out / "vtk", ignore_errors=True)
        for entry in new.iterdir():
            entry.replace(out / entry.name)
