"""``microswim group``: several swimmers in one fluid."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files
from microswim.cli._options import (
    change,
    example,
    force_option,
    json_option,
    out_option,
    print_json,
)

if TYPE_CHECKING:
    from microswim.models.group.far_field import FarField
    from microswim.models.group.mean import GroupMotion
    from microswim.output.report.html import Table


@click.command(
    epilog=example(
        "microswim group pair.toml",
        "microswim group pair.toml --set swimmer[1].phase=1.57 --json",
        'microswim group pair.toml --set tail.frequency="20 Hz" --out results',
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
@json_option
@out_option
@force_option
def command(
    scene: Path,
    changes: tuple[str, ...],
    trust: Path | None,
    level: str,
    as_json: bool,
    out: Path | None,
    force: bool,
) -> None:
    """Print how several swimmers swim together, by boundary elements.

    SCENE is a TOML file of [[swimmer]] tables: spec (a file beside it) or preset, position of the
    body's centre, direction of the axis from the body along the tail, roll, phase, frequency, free
    ("none" holds it), force, torque, and "set" for fields of the spec; and of one [wall], if any:
    position of a point of it, normal into the fluid.
    """
    from microswim.cli import _folder
    from microswim.cli._progress import bar
    from microswim.spec.readers.scene import read_scene

    if out is not None:
        _folder.check(out, force)
    group = read_scene(scene, dict(change(text) for text in changes), trust)
    with bar(f"{len(group.members)} swimmers, {level}") as progress:
        found = group.swim(level=level, progress=progress)  # type: ignore[arg-type]
    numbers = {"scene": str(scene), **found.as_dict()}
    show = partial(print_json, numbers) if as_json else partial(_print, found, scene.stem)
    if out is not None:
        with _files.or_else(show):
            _write(found, numbers, out, force)
    show()


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
