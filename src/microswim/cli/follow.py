"""``microswim follow``: a magnetic robot led along a path by its field or its coils."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files
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

if TYPE_CHECKING:
    from microswim.control.follower import PathFollower
    from microswim.control.led import Led
    from microswim.output.report.html import Table

FILES = ("follow.csv", "follow.json", "follow.png")


@click.command(
    epilog=example(
        "microswim follow robot.toml --path way.csv",
        "microswim follow robot.toml --path way.csv --strength 5mT --frequency 8Hz --out led",
        "microswim follow coils.toml --path way.csv --strength 5mT --json     by its coils",
    )
)
@swimmer_options
@click.option(
    "--path", "file", required=True, metavar="FILE.csv", type=click.Path(path_type=Path),
    help="Its corners: x, y, z with units in the header, such as x (mm).",
)  # fmt: skip
@click.option("--strength", metavar="B", help="Of the field; by default that of a rotating field.")
@click.option("--frequency", metavar="F", help="Of the field; by default 3/4 of step-out.")
@click.option("--step", metavar="T", help="Between commands; by default a 32nd of a turn.")
@click.option("--time", metavar="T", help="To give up after; by default 4 times the way's.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of [noise].")
@auto_option
@level_option
@json_option
@out_option
@force_option
def command(
    given: Given,
    file: Path,
    strength: str | None,
    frequency: str | None,
    step: str | None,
    time: str | None,
    seed: int,
    model: str,
    level: str | None,
    as_json: bool,
    out: Path | None,
    force: bool,
) -> None:
    """Lead a magnetic robot along a path by a field that turns, or by the currents of its coils.

    The spec has [magnet], and [field] of kind "rotating" or "coils"; [gravity], a linear [flow] and
    [noise] act. With --out: commands and places in time, the numbers as JSON, and a picture.
    """
    from microswim.cli import _print
    from microswim.cli._progress import bar
    from microswim.control.follower import PathFollower
    from microswim.control.led import check, led
    from microswim.spec.readers.corners import read_corners
    from microswim.spec.values import in_unit

    if out is not None:
        _files.check_files("--out", out, FILES, force)
    units = given.swimmer.units
    corners = read_corners(str(file), units)
    asked = {
        name: None if text is None else in_unit(f"--{name}", text, unit, units)
        for name, text, unit in (
            ("strength", strength, "T"), ("frequency", frequency, "Hz"),
            ("step", step, "s"), ("time", time, "s"),
        )
    }  # fmt: skip
    check(given.swimmer)
    gait = _print.timed_gait(given.swimmer, model, level)[0]
    follower = PathFollower(
        swimmer=given.swimmer, path=corners, strength=asked["strength"],
        frequency=asked["frequency"], gait=gait,
    )  # fmt: skip
    with bar(f"follow {given.name}") as progress:
        found = led(follower, dt=asked["step"], time=asked["time"], seed=seed, progress=progress)
    report = _report(given, follower, found)

    def show() -> None:
        if as_json:
            return print_json(report)
        return _print.print_table(_table(given.name, report))

    if out is not None:
        with _files.or_else(show):
            _write(out, follower, found, report)
    show()
    if out is not None and not as_json:
        click.echo(f"{out}: {', '.join(FILES)}")


def _report(given: Given, follower: PathFollower, found: Led) -> dict[str, Any]:
    import numpy as np

    from microswim.calibration.atlas.expected import expected_error

    gait: Any = follower.gait
    report = {
        "swimmer": given.name,
        "model": gait.model,
        "units": given.swimmer.units,
        "arrived": found.arrived,
        "time": float(found.time[-1]),
        "position": found.position[-1],
        "off_path_rms": float(np.sqrt(np.mean(found.off**2))),
        "off_path_most": float(found.off.max()),
        "strength": float(follower.strength or 0.0),
        "frequency": float(follower.frequency or 0.0),
        "step_out": follower.step_out,
        "largest_current": None,
        "expected_error": {
            "velocity": expected_error(given.swimmer, gait),
            "how": "of the model; the follower corrects a wrong speed, the time does not",
        },
    }
    if found.currents is not None:
        report["largest_current"] = float(np.abs(found.currents).max())
    return report


def _table(who: str, report: dict[str, Any]) -> Table:
    from microswim.gait.readable import percent, quantity
    from microswim.gait.units import unit
    from microswim.output.report.html import Table

    def q(name: str, kind: str) -> str:
        return quantity(report[name], unit(report["units"], kind))

    ends = ", ".join(quantity(x, unit(report["units"], "length")) for x in report["position"])
    rows = [
        ("arrived", f"after {q('time', 'time')}" if report["arrived"] else "no"),
        ("at the end, x, y, z", ends),
        ("off the path, root mean square", q("off_path_rms", "length")),
        ("off the path, at most", q("off_path_most", "length")),
        ("field", f"{q('strength', 'field')}, {q('frequency', 'frequency')}"),
        ("step-out", q("step_out", "frequency")),
    ]
    if report["largest_current"] is not None:
        rows.append(("largest current", q("largest_current", "current")))
    off = report["expected_error"]["velocity"]["us"]
    note = f"by {report['model']}"
    note += f", u_s within {percent(off)}: the time may be as wrong" if off else ""
    return Table(f"{who}: led along a path of its own", ("", ""), rows, note)


def _write(out: Path, follower: PathFollower, found: Led, report: dict[str, Any]) -> None:
    import json

    import numpy as np

    from microswim.gait.units import unit
    from microswim.numerics.files import fresh, write
    from microswim.numerics.plain import plain
    from microswim.output.plots.led import led as picture

    table, text, image = (out / file for file in FILES)
    units, coils = report["units"], getattr(follower.swimmer.field, "coils", ())
    length, field = unit(units, "length"), unit(units, "field")
    names = [f"t ({unit(units, 'time')})", *(f"{x} ({length})" for x in "xyz")]
    names += [f"q{x}" for x in "wxyz"] + [f"B{x} ({field})" for x in "xyz"]
    names += [f"off ({length})", *(f"current {coil.name} (A)" for coil in coils)]
    columns = [found.time[:, None], found.position, found.quaternion, found.field]
    columns += [found.off[:, None], *([] if found.currents is None else [found.currents])]
    with fresh(table) as scratch:
        rows = np.concatenate(columns, axis=1)
        np.savetxt(scratch, rows, "%.12g", ",", header=",".join(names), comments="")
    write(text, json.dumps(plain(report), allow_nan=False, ensure_ascii=False, indent=1) + "\n")
    with fresh(image) as scratch:
        picture(found, follower.path, units).savefig(scratch, format="png", dpi=200)
