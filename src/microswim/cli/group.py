"""``microswim group``: several swimmers in one fluid."""

from __future__ import annotations

import json
import time as clock
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files, _kept
from microswim.cli._options import (
    change,
    example,
    force_option,
    json_option,
    out_option,
    print_json,
)
from microswim.errors import SpecError

if TYPE_CHECKING:
    import xarray as xr

    from microswim.models.group.far_field import FarField
    from microswim.models.group.mean import GroupMotion
    from microswim.output.report.html import Table
    from microswim.swimmer.group import Group

#: Swimmers that stand side by side in a table, and those of a larger group that are printed.
BESIDE, SHOWN = 6, 12
PATH_FILES = ("paths.png", "paths.nc", "paths.csv", "paths.json")


@click.command(
    epilog=example(
        "microswim group pair.toml",
        "microswim group pair.toml --set swimmer[1].phase=1.57 --json",
        'microswim group pair.toml --set tail.frequency="20 Hz" --out results',
        "microswim group pair.toml --time 10s --out path     the paths from there",
        "microswim group drop.toml --time 60s --model far     thousands of swimmers",
    )
    + '\n\n\b\nA scene, pair.toml:\n  [[swimmer]]\n  spec = "robot.toml"\n\n\b\n  [[swimmer]]\n'
    '  spec = "robot.toml"\n  position = ["0 um", "20 um", "0 um"]\n  direction = [1, 0, 0]\n'
    '  phase = "90 deg"'
)
@click.argument("scene", type=click.Path(path_type=Path))
@click.option(
    "--set",
    "changes",
    metavar="FIELD=VALUE",
    multiple=True,
    help="Override a field: swimmer[0].phase=1, or tail.amplitude=0.12 of all specs (repeatable).",
)
@click.option(
    "--trust",
    metavar="FILE.py",
    type=click.Path(path_type=Path),
    help="Python file whose functions the specs may name; it is run.",
)
@click.option(
    "--level",
    type=click.Choice(["coarse", "standard", "fine"]),
    default="standard",
    show_default=True,
    help="Resolution; the expected error is the difference from the next coarser one.",
)
@click.option("--time", metavar="T", help="Follow them for so long, such as 10s.")
@click.option(
    "--model",
    type=click.Choice(["estimate", "bem", "far"]),
    default="estimate",
    show_default=True,
    help="With --time: point forces, a millisecond a step and pair; the solve at each step; or "
    "thousands of swimmers from afar, averaged over their periods.",
)
@click.option(
    "--samples",
    type=click.IntRange(2, 1_000_000),
    default=101,
    show_default=True,
    help="With --time: times at which the paths are kept.",
)
@json_option
@out_option
@click.option("--resume", is_flag=True, help="Go on with the paths in --out, if there are any.")
@force_option
def command(
    scene: Path,
    changes: tuple[str, ...],
    trust: Path | None,
    level: str,
    time: str | None,
    model: str,
    samples: int,
    as_json: bool,
    out: Path | None,
    resume: bool,
    force: bool,
) -> None:
    """Print how several swimmers swim together, by boundary elements; with --time where to.

    SCENE is a TOML file of [[swimmer]] tables: spec (a file beside it) or preset, position of the
    body's centre, direction of the axis from the body along the tail, roll, phase, frequency, free
    ("none" holds it), force, torque, places (a CSV with a row x, y, z, and dx, dy, dz and phase if
    they differ, for each of many), and "set" for fields of the spec; and of one [wall], if any:
    position of a point of it, normal into the fluid.
    """
    from microswim.cli import _folder
    from microswim.cli._progress import bar
    from microswim.spec.readers.scene import read_scene

    if resume and (out is None or time is None):
        raise SpecError("--resume needs --out DIR and --time T")
    if out is not None and time is None:
        _folder.check(out, force)
    elif out is not None and not resume:
        _kept.check(out, "path", PATH_FILES, "vtk", force)
    group = read_scene(scene, dict(change(text) for text in changes), trust)
    if time is not None:
        asked = {"model": model, "level": level}
        _follow(group, str(scene), time, samples, asked, as_json, out)
        return
    with bar(f"{len(group.members)} swimmers, {level}") as progress:
        found = group.swim(level=level, progress=progress)  # type: ignore[arg-type]
    numbers = {"scene": str(scene), **found.as_dict()}
    show = partial(print_json, numbers) if as_json else partial(_print, found, scene.stem)
    if out is not None:
        with _files.or_else(show):
            _write(found, numbers, out, force)
    show()


def _follow(
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
    from microswim.gait.readable import quantity, significant
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
    known = error["how"] if share is None else f"velocities within {100.0 * share:.2g} %"
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


def _print(found: GroupMotion, name: str) -> None:
    from microswim.cli._print import print_table

    for table in _tables(found, name):
        print_table(table)
    for n, far in enumerate(found.far_field):
        if far.force_dipole == 0.0:
            continue
        click.echo(f"  swimmer {n} alone: {_far(far)}")
    for remark in found.solution.remarks:
        click.echo(f"  note: {remark}")
    click.echo(f"  {found.solution.unknowns:,} unknowns, solved in {found.seconds:.3g} s")


def _tables(found: GroupMotion, name: str) -> list[Table]:
    """Return the mean velocities, each with its error, and what they are relative to."""
    import numpy as np

    from microswim.gait.readable import quantity
    from microswim.gait.units import unit
    from microswim.output.report.html import Table

    n = len(found.mean_velocity)
    speed, rate = (unit(found.units, kind) for kind in ("speed", "rate"))
    rows = []
    for k, label in enumerate(("u_s", "u_q", "u_r", "Omega_s", "Omega_q", "Omega_r")):
        cells = zip(found.mean_velocity[:, k], found.error_of_velocity[:, k], strict=True)
        rows.append((label, *(_cell(*cell, speed if k < 3 else rate) for cell in cells)))
    gap = found.solution.gap
    near = quantity(gap, unit(found.units, "length")) if n > 1 else "none"
    how = "the difference from the next coarser level at one phase, and of half the phases"
    if np.isnan(found.error_of_velocity).any():
        how = found.expected_error["how"]
    note = (
        f"{_means(found.phases)} at this pose, each swimmer in its own axes. Errors: {how}. "
        f"Smallest gap: {near}."
    )
    header = ("", *(f"swimmer {i}" for i in range(n)))
    return [Table(name, header, rows, note)]


def _means(phases: int) -> str:
    return "Velocities" if phases == 1 else f"Means over {phases} phases"


def _cell(value: float, error: float, unit: str) -> str:
    """Return a velocity with its error; what is held is zero."""
    from microswim.gait.readable import with_error

    share = abs(error / value) if value and error == error else None
    return with_error(value, share, unit)


def _far(far: FarField) -> str:
    """Return the flow far from a swimmer in words and numbers."""
    from microswim.gait.readable import with_error

    told = far.as_dict()
    parts = []
    for name, words in (("force_dipole", "force dipole"), ("rotlet_dipole", "rotlet dipole")):
        value, error = told[name], told["error"][name]
        if abs(value) > error:
            parts.append(f"{words} {with_error(value, abs(error / value), told['units'][name])}")
    return ", ".join([far.kind, *parts])


def _write(found: GroupMotion, numbers: dict[str, Any], out: Path, force: bool) -> None:
    """Numbers, surfaces and the flow, all or none."""
    from microswim.cli import _folder
    from microswim.numerics.files import write
    from microswim.numerics.plain import plain
    from microswim.output.plots.group import group as picture
    from microswim.output.report.html import png

    with _folder.filled(out, force) as folder:
        write(folder / "group.json", json.dumps(plain(numbers), indent=1) + "\n")
        found.solution.to_vtk(folder / "swimmers.vtp")
        write(folder / "flow.png", png(picture(found.solution)))
    click.echo(f"written to {out}/: group.json, swimmers.vtp (ParaView), flow.png", err=True)
