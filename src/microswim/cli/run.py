"""``microswim run``: how a swimmer swims."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli import _files
from microswim.cli._options import (
    Given,
    accuracy_option,
    auto_option,
    example,
    force_option,
    json_option,
    level_option,
    out_option,
    print_json,
    share,
    swimmer_options,
)
from microswim.errors import SpecError

if TYPE_CHECKING:
    from microswim.output.report.html import Table
    from microswim.swimmer.swimmer import Swimmer


@click.command(
    epilog=example(
        "microswim run robot.toml",
        "microswim run --preset tabak/helix --set tail.amplitude=0.12 --json",
        "microswim run --preset goto/C --model bem --out results",
        "microswim run robot.toml --accuracy 0.5%",
    )
)
@swimmer_options
@auto_option
@accuracy_option
@level_option
@json_option
@out_option
@click.option(
    "--periods",
    type=click.FloatRange(min=0, min_open=True, max=1e5),
    help="Length of the path in periods; by default one and a half lengths of the swimmer.",
)
@force_option
def command(
    given: Given,
    model: str,
    accuracy: str | None,
    level: str | None,
    as_json: bool,
    out: Path | None,
    periods: float | None,
    force: bool,
) -> None:
    """Print how a swimmer swims; with --out also write files, pictures and a report.

    SPEC is a TOML file; "microswim new" writes one to start from. Velocities come with the error
    to expect; "What each number's error means" in the documentation (docs/errors.md) says how it
    is known.
    """
    from microswim.cli import _folder, _print

    if out is not None:
        _folder.check(out, force)
    from microswim.calibration.atlas.expected import expected_error
    from microswim.output.io import run as io
    from microswim.output.report import html as report

    asked = share(accuracy)
    if asked is not None and model != "auto":
        raise SpecError("--accuracy", accuracy, 'given without --model, or with "auto"')
    gait, seconds = _print.timed_gait(given.swimmer, model, level, estimate=True, accuracy=asked)
    numbers: dict[str, Any] = {
        "swimmer": given.name,
        **io.numbers(given.swimmer, gait),
        "expected_error": expected_error(given.swimmer, gait),
        "calibration": _record(given.swimmer),
        "wall_seconds": seconds,
        "info": gait.info,
    }
    tables = [report.numbers_table(numbers, given.name), report.spec_table(given.swimmer)]
    show = partial(_show, numbers, tables[0], as_json)
    if out is not None:
        run = io.dataset(given.swimmer, gait, periods=periods, spec=given.text, known=numbers)
        run.attrs["wall_seconds"] = seconds
        with _files.or_else(show), _folder.filled(out, force) as folder:
            _folder.write(folder, run, given.swimmer.settled, given.name, tables)
    show()
    if not as_json:
        _point_to_paths(given.swimmer, gait.model)
    if out is not None:
        _folder.say_where(out)


def _show(numbers: dict[str, Any], table: Table, as_json: bool) -> None:
    from microswim.cli import _print

    if as_json:
        print_json(numbers)
        return
    info = numbers["info"]
    _print.print_table(table)
    for remark in (*info.get("calibration", ()), *info.get("remarks", ())):
        click.echo(f"  note: {remark}")
    error = info.get("error")
    if error:
        _say_difference(error)
    click.echo(f"  solved in {numbers['wall_seconds']:.3g} s")


def _point_to_paths(swimmer: Swimmer, model: str) -> None:
    """Say which tables of the spec act along a path alone."""
    tail: Any = swimmer.tail
    settled = tail.settles and tail.drive != "none" and not any(swimmer.motion.mask)
    felt = settled and model == "elastic"
    if settled and not felt and swimmer.flow is not None:
        click.echo(
            f"  note: the tail bends as in its [flow]; {model} has its wrench in still fluid"
        )
    acting = ("noise",) if felt else ("gravity", "flow", "noise")
    there = [name for name in acting if name in swimmer.parts]
    if there:
        tables = ", ".join(f"[{name}]" for name in there)
        acts = "acts" if len(there) == 1 else "act"
        click.echo(
            f"  note: without {tables}, which {acts} along a path: microswim path follows it"
        )


def _say_difference(error: dict[str, Any]) -> None:
    """Say how far the next coarser level lies, in u_s and in the velocity that differs most."""
    from microswim.gait.gait import DEGREES_OF_FREEDOM
    from microswim.gait.readable import percent

    forward, against = error["relative_forward"], error["against"]
    if forward != forward:  # nothing moves by itself
        click.echo(f"  R differs by {percent(error['resistance'])} from level {against}")
        return
    each = [float(x) for x in error["velocities"]]
    worst = DEGREES_OF_FREEDOM[each.index(max(each))]
    most = f"at most {percent(max(each))} in all six velocities ({worst})"
    click.echo(f"  u_s differs by {percent(forward)} from level {against}, {most}")


def _record(swimmer: Swimmer) -> dict[str, Any] | None:
    """Return where the coefficients come from, and which numbers are others by now."""
    made = swimmer.calibration
    if made is None:
        return None
    return made.as_tables() | {"away": made.away(swimmer), "changed": made.changed(swimmer)}
