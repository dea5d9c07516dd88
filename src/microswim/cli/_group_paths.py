"""Paths of a group: followed, told and written."""

from __future__ import annotations

import json
import time as clock
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files, _kept
from microswim.cli._options import print_json
from microswim.errors import SpecError

if TYPE_CHECKING:
    import xarray as xr

    from microswim.swimmer.group import Group

#: Swimmers that stand side by side in a table, and those of a larger group that are printed.
BESIDE, SHOWN = 6, 12
PATH_FILES = ("paths.png", "paths.nc", "paths.csv", "paths.json")


def follow(
    group: Group,
    scene: str,
    time: str,
    samples: int,
    asked: dict[str, Any],
    as_json: bool,
    out: Path | None,
) -> None:
    """Follow the swimmers from their poses; print where they end, write their paths."""
    import numpy as np

    from microswim.cli._progress import bar
    from microswim.path.of_group import group_path
    from microswim.spec.values import in_unit

    end, begun = in_unit("--time", time, "s", group.units), clock.perf_counter()
    if not end > 0:
        raise SpecError("--time", time, "above zero")
    keep = None if out is None else out / _kept.CHECKPOINT
    with _kept.resumable(out), bar(f"paths of {len(group.members)} swimmers") as progress:
        times = np.linspace(0.0, end, samples)
        found = group_path(group, times, keep=keep, progress=progress, **asked)
    report = _report(scene, found, asked["level"], clock.perf_counter() - begun)
    show = partial(print_json, report) if as_json else partial(_print_paths, report)
    if out is not None:
        with _files.or_else(show):
            _write_paths(out, found, report)
    show()
    if out is not None:
        names = ", ".join(PATH_FILES)
        click.echo(f"written to {out}/: {names}", err=True)


def _report(scene: str, found: xr.Dataset, level: str, seconds: float) -> dict[str, Any]:
    from scipy.spatial import KDTree

    x, time = found.position.values, float(found.time[-1])
    apart = [KDTree(here).query(here, 2)[0][:, 1].min() for here in x] if x.shape[1] > 1 else []
    by_points = found.attrs["model"] != "bem"
    worst = float(found.expected_error.max()) if by_points else None
    how = "velocity: the largest along the paths, a share of the velocities; position: not known"
    if not by_points:
        how = "as of the velocities at one pose: the same command without --time"
    return {
        "scene": scene,
        "model": found.attrs["model"],
        "level": level,
        "units": found.attrs["units"],
        "time": time,
        "position": x[-1],
        "quaternion": found.quaternion.values[-1],
        "phase": found.phase.values[-1],
        "drift": (x[-1] - x[0]) / time,
        "nearest": float(min(apart)) if apart else None,
        "expected_error": {"velocity": worst, "how": how},
        "wall_seconds": seconds,
    }


def _print_paths(report: dict[str, Any]) -> None:
    from microswim.cli._print import print_table
    from microswim.gait.readable import percent, quantity, significant
    from microswim.gait.units import unit
    from microswim.output.report.html import Table

    units = report["units"]

    def q(values: Any, kind: str) -> str:
        return ", ".join(quantity(float(v), unit(units, kind)) for v in values)

    count = len(report["position"])
    columns = [
        ("", *(f"swimmer {n}" for n in range(min(count, SHOWN)))),
        ("at the end, x, y, z", *(q(x, "length") for x in report["position"][:SHOWN])),
        ("drift, x, y, z", *(q(x, "speed") for x in report["drift"][:SHOWN])),
    ]
    header, *rows = columns if count <= BESIDE else zip(*columns, strict=True)
    error = report["expected_error"]
    share = error["velocity"]
    known = error["how"] if share is None else f"velocities within {percent(share)}"
    near = report["nearest"]
    apart = f"bodies' centres at least {q([near], 'length')} apart; " if near is not None else ""
    more = f"; {count - SHOWN} more in --json and --out" if count > SHOWN else ""
    note = f"{apart}{known}; {significant(report['wall_seconds'], 2)} s{more}"
    title = f"{report['scene']}: paths over {q([report['time']], 'time')}, {report['model']}"
    print_table(Table(title, header, rows, note))


def _write_paths(out: Path, found: xr.Dataset, report: dict[str, Any]) -> None:
    import csv
    import io

    from microswim.numerics.files import write
    from microswim.numerics.plain import plain
    from microswim.output.io.run import netcdf
    from microswim.output.plots.path import group_path as picture
    from microswim.output.report.html import png

    length, time = found.position.attrs["units"], found.time.attrs["units"]
    table = io.StringIO()
    rows = csv.writer(table, lineterminator="\n")
    said = [f" ({u})" if u not in ("length", "time") else "" for u in (length, time)]
    rows.writerow([f"t{said[1]}", "track", *(f"{axis}{said[0]}" for axis in "xyz")])
    for t, places in zip(found.time.values, found.position.values, strict=True):
        rows.writerows([repr(float(t)), n, *map(repr, x.tolist())] for n, x in enumerate(places))
    write(out / "paths.csv", table.getvalue())
    write(out / "paths.nc", netcdf(found))
    write(out / "paths.png", png(picture(found)))
    write(out / "paths.json", json.dumps(plain(report), indent=1) + "\n")
