"""``microswim group``: several swimmers in one fluid."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files, _kept
from microswim.cli._group_paths import PATH_FILES, follow
from microswim.cli._group_poses import POSES_FILES, solve_poses
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
    from microswim.models.group.far_field import FarField
    from microswim.models.group.mean import GroupMotion
    from microswim.output.report.html import Table
    from microswim.swimmer.group import Group


@click.command(
    epilog=example(
        "microswim group pair.toml",
        "microswim group pair.toml --set swimmer[1].phase=1.57 --json",
        'microswim group pair.toml --set tail.frequency="20 Hz" --out results',
        "microswim group pair.toml --time 10s --out path     the paths from there",
        "microswim group drop.toml --time 60s --model far     thousands of swimmers",
        "microswim group pair.toml --poses poses.csv --out answers     many poses",
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
@click.option(
    "--poses",
    metavar="FILE.csv",
    type=click.Path(path_type=Path),
    help="Solve at many poses, columns pose, swimmer, x (um), y, z and if they change dx, dy, dz "
    "(direction), roll, phase; what has no column stays.",
)
@click.option(
    "--workers",
    metavar="N",
    type=click.IntRange(1, 1024),
    help="With --poses: poses at a time (default: one a core).",
)
@json_option
@out_option
@click.option("--resume", is_flag=True, help="Go on with the paths or poses in --out, if any.")
@force_option
def command(
    scene: Path,
    changes: tuple[str, ...],
    trust: Path | None,
    level: str,
    time: str | None,
    model: str,
    samples: int,
    poses: Path | None,
    workers: int | None,
    as_json: bool,
    out: Path | None,
    resume: bool,
    force: bool,
) -> None:
    """Print how several swimmers swim together, by boundary elements; with --time where to,
    with --poses at many poses.

    SCENE is a TOML file of [[swimmer]] tables: spec (a file beside it) or preset, position of the
    body's centre, direction of the axis from the body along the tail, roll, phase, frequency, free
    ("none" holds it), force, torque, places (a CSV with a row x, y, z, and dx, dy, dz and phase if
    they differ, for each of many), and "set" for fields of the spec; and of one [wall], if any:
    position of a point of it, normal into the fluid; and one magnetic [field], if any, as in a
    spec: it acts on their magnets, with --time.
    """
    from microswim.cli import _folder
    from microswim.cli._progress import bar
    from microswim.spec.readers.scene import read_scene

    if time is not None and poses is not None:
        raise SpecError("--time and --poses: give one of them")
    if resume and (out is None or (time is None and poses is None)):
        raise SpecError("--resume needs --out DIR, and --time T or --poses FILE.csv")
    if workers is not None and poses is None:
        raise SpecError("--workers needs --poses FILE.csv")
    if out is not None and time is None and poses is None:
        _folder.check(out, force)
    elif out is not None and not resume:
        what, files = ("path", PATH_FILES) if poses is None else ("run", POSES_FILES)
        _kept.check(out, what, files, "vtk", force)
    group = read_scene(scene, dict(change(text) for text in changes), trust)
    _say_of_motors(group)
    if time is not None:
        asked = {"model": model, "level": level}
        follow(group, str(scene), time, samples, asked, as_json, out)
        return
    if poses is not None:
        how = {"level": level, "workers": workers}
        solve_poses(group, str(scene), poses, how, as_json, out)
        return
    with bar(f"{len(group.members)} swimmers, {level}") as progress:
        found = group.swim(level=level, progress=progress)  # type: ignore[arg-type]
    numbers = {"scene": str(scene), **found.as_dict()}
    show = partial(print_json, numbers) if as_json else partial(_print, found, scene.stem)
    if out is not None:
        with _files.or_else(show):
            _write(found, numbers, out, force)
    show()


def _say_of_motors(group: Group) -> None:
    """Say that motors turn at a frequency here, and that hooks do not bend."""
    from microswim.swimmer.physical_sense import of_motors

    first = {id(m.swimmer): n for n, m in reversed([*enumerate(group.members)])}
    for n in sorted(first.values()):
        for said in of_motors(group.members[n].swimmer):
            click.echo(f"note: swimmer[{n}]: {said}", err=True)


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
    held = _held(found, header)
    return [Table(name, header, rows, note), *held]


def _held(found: GroupMotion, header: tuple[str, ...]) -> list[Table]:
    """Return the wrenches by the fluid, where a swimmer is held."""
    from microswim.gait.readable import but_rounding, quantity
    from microswim.gait.units import unit
    from microswim.output.report.html import Table

    if found.group.free.all():
        return []
    kinds = [unit(found.units, "force")] * 3 + [unit(found.units, "torque")] * 3
    wrenches = [[*but_rounding(w[:3]), *but_rounding(w[3:])] for w in found.mean_wrench]
    rows = [
        (f"{'FT'[k > 2]}_{'sqr'[k % 3]}", *(quantity(w[k], u) for w in wrenches))
        for k, u in enumerate(kinds)
    ]
    return [Table("by the fluid", header, rows, "What a holder feels, each in its own axes.")]


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
