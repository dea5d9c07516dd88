"""The folder of a run: all files at once or none."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from microswim.errors import SpecError
from microswim.numerics.files import scratch
from microswim.numerics.files import write as write_file

if TYPE_CHECKING:
    import xarray as xr

    from microswim.output.report.html import Table
    from microswim.swimmer.swimmer import Swimmer

FILES = {
    "report.html": "numbers, pictures, spec and provenance on one page",
    "trajectory.png": "the swimmer and its path, to scale",
    "velocity.png": "velocities and power over one period",
    "run.nc": "everything, netCDF with units",
    "trajectory.csv": "position and quaternion in time",
    "swimmer.pvd": "the swimmer in time, for ParaView (frames in vtk/)",
    "path.vtp": "its path, for ParaView",
    "spec.toml": "the spec it came from",
}


def check(folder: Path, force: bool) -> None:
    """Refuse a folder that cannot be used, before any work is done.

    Raises
    ------
    SpecError
        If it is a file, or holds files and `force` is not given.
    """
    if folder.exists() and not folder.is_dir():
        raise SpecError("--out", str(folder), "a folder", "this is a file")
    if folder.is_dir() and any(folder.iterdir()) and not force:
        raise SpecError(
            "--out", str(folder), "a new or empty folder", "--force replaces the files in it"
        )


@contextmanager
def filled(folder: Path, force: bool) -> Iterator[Path]:
    """Give a temporary folder that takes the name `folder` once everything is written.

    With `force`, entries of an existing folder are replaced one by one; others stay.
    """
    check(folder, force)
    with scratch(folder) as new:
        yield new
        if not folder.exists():
            new.rename(folder)
            return
        for entry in new.iterdir():
            if (folder / entry.name).is_dir():
                shutil.rmtree(folder / entry.name)
            entry.replace(folder / entry.name)


def write(
    folder: Path,
    run: xr.Dataset,
    swimmer: Swimmer,
    name: str,
    tables: Sequence[Table],
    lead: str = "",
) -> None:
    """Write all files of a run into an existing folder."""
    from microswim.output.io import run as io
    from microswim.output.io import vtk
    from microswim.output.plots import run as plots
    from microswim.output.report import html as report

    write_file(folder / "spec.toml", run.attrs["spec"])
    io.save(run, folder / "run.nc")
    figures = [("velocity", plots.velocity(run), _VELOCITY_CAPTION)]
    if "position" in run:
        io.save(run, folder / "trajectory.csv")
        vtk.write_swimmer(folder, swimmer, run)
        path = ("trajectory", plots.trajectory(run, swimmer), _path_caption(run))
        figures.insert(0, path)
    pictures = []
    for stem, figure, caption in figures:
        pictures.append((caption, report.png(figure)))
        write_file(folder / f"{stem}.png", pictures[-1][1])
    page = report.page(run, name, tables, pictures, lead)
    write_file(folder / "report.html", page)


def _path_caption(run: xr.Dataset) -> str:
    return (
        f"The path over {run.attrs['periods']:g} periods of the motor. a: the swimmer to scale at "
        "the start (pale) and at the end, and the path of its body's centre. b: that path seen "
        "from behind. c: the first periods in time."
    )


_VELOCITY_CAPTION = (
    "One period of the tail, in the frame of the body: a velocity of the body's centre, b angular "
    "velocity, c power of the motor. Dotted: means."
)


def say_where(folder: Path) -> None:
    """Tell on stderr what has been written and where."""
    import click

    click.echo(f"written to {folder}/", err=True)
    width = max(map(len, FILES))
    for name, meaning in FILES.items():
        if (folder / name).exists():
            click.echo(f"  {name:<{width}}  {meaning}", err=True)
    if not (folder / "trajectory.csv").exists():
        click.echo("  no path was drawn: beside what turns with it the gait has none", err=True)
