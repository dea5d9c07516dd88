"""Many poses of a group: solved, told and written."""

from __future__ import annotations

import csv
import io
import json
import time as clock
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files, _kept
from microswim.cli._options import print_json

if TYPE_CHECKING:
    from microswim.swimmer.group import Group

POSES_FILES = ("poses.csv", "poses.nc", "poses.json")
_VELOCITY = ("u_s", "u_q", "u_r", "Omega_s", "Omega_q", "Omega_r")


def solve_poses(
    group: Group,
    scene: str,
    poses: Path,
    asked: dict[str, Any],
    as_json: bool,
    out: Path | None,
) -> None:
    """Solve for a group at the poses of a table; print what came out, write it."""
    from microswim.cli._progress import bar
    from microswim.spec.readers.pose_table import read_group_poses

    given, begun = read_group_poses(poses, group), clock.perf_counter()
    keep = None if out is None else out / _kept.CHECKPOINT
    with _kept.resumable(out), bar(f"poses of {len(group.members)} swimmers") as progress:
        found = group.at_poses(**given, **asked, keep=keep, progress=progress)
    report = {
        "scene": scene,
        "poses": str(poses),
        "level": asked["level"],
        "units": group.units,
        **{name: getattr(found, name) for name in ("velocity", "resistance", "propulsion", "gap")},
        "refused": found.refused,
        "wall_seconds": clock.perf_counter() - begun,
    }
    show = partial(print_json, report) if as_json else partial(_print, report)
    if out is not None:
        with _files.or_else(show):
            _write(out, report, given)
    show()
    if out is not None:
        click.echo(f"written to {out}/: {', '.join(POSES_FILES)}", err=True)


def _print(report: dict[str, Any]) -> None:
    import numpy as np

    from microswim.cli._print import print_table
    from microswim.gait.readable import quantity, significant
    from microswim.gait.units import unit
    from microswim.output.report.html import Table

    kinds = ["speed"] * 3 + ["rate"] * 3
    solved = np.isfinite(report["gap"])
    V = report["velocity"][solved]
    if len(V):
        rows = []
        for k, (label, kind) in enumerate(zip(_VELOCITY, kinds, strict=True)):
            u = unit(report["units"], kind)
            ends = ((V[:, i, k].min(), V[:, i, k].max()) for i in range(V.shape[1]))
            rows.append((label, *(f"{quantity(a, u)} to {quantity(b, u)}" for a, b in ends)))
        near = [
            quantity(float(g), unit(report["units"], "length"))
            for g in (report["gap"][solved].min(), report["gap"][solved].max())
        ]
        note = f"{len(V)} poses, gaps {near[0]} to {near[1]}; each swimmer in its own axes."
        header = ("", *(f"swimmer {i}" for i in range(V.shape[1])))
        print_table(Table(f"{report['scene']} at {report['poses']}", header, rows, note))
    wrong = [(k, why) for k, why in enumerate(report["refused"]) if why]
    if wrong:
        k, why = wrong[0]
        click.echo(f"  {len(wrong)} of {len(solved)} poses refused, the first pose {k}: {why}")
    click.echo(f"  level {report['level']}; {significant(report['wall_seconds'], 2)} s")


def _write(out: Path, report: dict[str, Any], given: dict[str, Any]) -> None:
    from microswim.gait.units import unit
    from microswim.numerics.files import write
    from microswim.numerics.plain import plain
    from microswim.output.io.run import netcdf

    units = [unit(report["units"], kind) for kind in ["speed"] * 3 + ["rate"] * 3]
    said = [f" ({u})" if report["units"] == "SI" else "" for u in units]
    gap = f"gap ({unit('SI', 'length')})" if report["units"] == "SI" else "gap"
    table = io.StringIO()
    rows = csv.writer(table, lineterminator="\n")
    heads = [f"{v}{u}" for v, u in zip(_VELOCITY, said, strict=True)]
    rows.writerow(["pose", "swimmer", *heads, gap, "refused"])
    answers = zip(report["velocity"], report["gap"], report["refused"], strict=True)
    for k, (V, g, why) in enumerate(answers):
        rows.writerows([k, i, *map(repr, v.tolist()), repr(float(g)), why] for i, v in enumerate(V))
    write(out / "poses.csv", table.getvalue())
    write(out / "poses.nc", netcdf(_dataset(report, given)))
    write(out / "poses.json", json.dumps(plain(report, nan=True), indent=1) + "\n")


def _dataset(report: dict[str, Any], given: dict[str, Any]) -> Any:
    import xarray as xr

    from microswim.gait.units import unit

    length = unit(report["units"], "length")
    shapes = {
        "positions": ("pose", "swimmer", "axis"),
        "directions": ("pose", "swimmer", "axis"),
        "rolls": ("pose", "swimmer"),
        "phases": ("pose", "swimmer"),
    }
    of = {"positions": length, "directions": "1", "rolls": "rad", "phases": "rad"}
    data = {name: (shapes[name], values, {"units": of[name]}) for name, values in given.items()}
    data |= {
        "velocity": (("pose", "swimmer", "component"), report["velocity"]),
        "resistance": (("pose", "wrench", "motion"), report["resistance"]),
        "propulsion": (("pose", "wrench", "motor"), report["propulsion"]),
        "gap": ("pose", report["gap"], {"units": length}),
        "refused": ("pose", list(report["refused"])),
    }
    coords = {"axis": list("xyz"), "component": list(_VELOCITY)}
    return xr.Dataset(data, coords, {name: report[name] for name in ("level", "units", "scene")})
