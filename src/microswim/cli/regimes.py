"""``microswim regimes``: what a magnetic robot does at each frequency of its field."""

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
from microswim.errors import SpecError
from microswim.numerics.files import fresh, write

if TYPE_CHECKING:
    from microswim.output.report.html import Table
    from microswim.path.regimes import Regimes

FILES = ("regimes.csv", "regimes.json", "regimes.png")
#: What a sweep may vary without another gait.
DRIVE = ("magnet.", "field.")
#: Share of the step-out below which a frequency is the rounding of none.
ROUNDING = 1e-9


@click.command(
    epilog=example(
        "microswim regimes robot.toml",
        "microswim regimes robot.toml --frequency 0.5Hz:30Hz:60 --out regimes",
        "microswim regimes robot.toml --frequency 1Hz,5Hz --strength 3mT --json",
        "microswim regimes robot.toml --over magnet.direction=30deg:90deg:13 --out map",
    )
)
@swimmer_options
@click.option(
    "--frequency",
    metavar="A:B:N",
    help="Of the field: FIRST:LAST:COUNT or a list; by default up to beyond step-out.",
)
@click.option("--strength", metavar="B", help="Of the field, in place of the spec's.")
@click.option(
    "--over", metavar="NAME=A:B:N", help="One more number that varies: field.strength, tail.waves."
)
@auto_option
@level_option
@json_option
@out_option
@force_option
def command(
    given: Given,
    frequency: str | None,
    strength: str | None,
    over: str | None,
    model: str,
    level: str | None,
    as_json: bool,
    out: Path | None,
    force: bool,
) -> None:
    """Print regimes, precession angle and velocity over the frequency of a rotating field.

    The spec has [magnet] and [field] of kind "rotating". The robot is rigid: a motor stands still.
    With an elastic tail it bends, and --model bem takes velocity and torque of that shape.
    With --out: a table, everything as JSON, and a picture.
    """
    from microswim.cli import _over, _print
    from microswim.cli._progress import bar

    if out is not None:
        _files.check_files("--out", out, FILES, force)
    swimmer = given.swimmer
    if strength is not None:
        swimmer = swimmer.with_({"field.strength": _number("field.strength", strength, swimmer)})
    name, values = _varied(over, swimmer)
    asked = None
    if frequency is not None:
        asked = _over.values_of("field.frequency", frequency, swimmer.units, "--frequency")
    with bar(f"regimes {given.name}") as progress:
        found = _solved(swimmer, asked, name, values, model, level, progress)
    report = _report(given.name, found, name, values)

    def show() -> None:
        if as_json:
            return print_json(report)
        _print.print_table(_table(given.name, found, name, values))
        for remark in max(found, key=lambda one: one.reynolds.max()).remarks:
            click.echo(f"  note: {remark}")
        return None

    if out is not None:
        with _files.or_else(show):
            _write(out, found, report, name, values)
    show()
    if out is not None and not as_json:
        click.echo(f"{out}: {', '.join(FILES)}")


def _number(name: str, text: str, swimmer: Any) -> float:
    from microswim.spec.values import from_text

    return from_text(name, text, swimmer.units, "--strength")


def _varied(over: str | None, swimmer: Any) -> tuple[str, list[Any]]:
    from microswim.cli import _over

    if over is None:
        return "", []
    axes = _over.axes((over,), swimmer.units)
    if len(axes) != 1:
        raise SpecError("--over", over, "one name; the frequency is the other axis")
    ((name, values),) = axes.items()
    return name, [v.item() if hasattr(v, "item") else v for v in values]


def _solved(
    swimmer: Any,
    asked: Any,
    name: str,
    values: list[Any],
    model: str,
    level: str | None,
    progress: Any,
) -> list[Regimes]:
    """Regimes for each value; where magnet or field alone vary there is one gait."""
    import numpy as np

    from microswim.cli._options import leveled
    from microswim.path.regimes import regimes, steady_turning
    from microswim.swimmer.variants import check_names, vary

    options = leveled(model, level)
    if name:
        check_names(swimmer, [name])
    robots = [vary(swimmer, {name: value}) for value in values] or [swimmer]
    if swimmer.tail.settles:
        return _bending(robots, asked, (model, level), progress)
    one = swimmer.gait(model, **options) if not name or name.startswith(DRIVE) else None
    if asked is None:
        gait = one if one is not None else robots[-1].gait(model, **options)
        most = max(steady_turning(r, gait).step_out for r in robots)
        if not most:
            raise SpecError("--frequency: missing; the field never holds this robot, so give it")
        asked = np.linspace(0.02, 1.5, 60) * most / (2.0 * np.pi)
    found = []
    for i, robot in enumerate(robots):
        gait = one if one is not None else robot.gait(model, **options)
        found.append(regimes(robot, asked, gait=gait))
        progress(i + 1, len(robots))
    return found


def _bending(
    robots: list[Any], asked: Any, by: tuple[str, str | None], progress: Any
) -> list[Regimes]:
    """Regimes of robots with an elastic tail, which has no gait in a field."""
    from microswim.path.regimes import regimes

    if asked is None:
        raise SpecError("--frequency: missing; of a robot that bends give it")
    found = []
    for i, robot in enumerate(robots):
        found.append(regimes(robot, asked, model=by[0], level=by[1]))  # type: ignore[arg-type]
        progress(i + 1, len(robots))
    return found


def _report(who: str, found: list[Regimes], name: str, values: list[Any]) -> dict[str, Any]:
    if not name:
        return {"swimmer": who, **found[0].as_dict()}
    rows = [{name: value, **one.as_dict()} for value, one in zip(values, found)]
    return {"swimmer": who, "over": name, "results": rows}


def _table(who: str, found: list[Regimes], name: str, values: list[Any]) -> Table:
    import numpy as np

    from microswim.gait.readable import quantity, significant
    from microswim.gait.units import unit
    from microswim.output.report.html import Table
    from microswim.spec.describe import unit_of

    first = found[0]

    def q(value: float, kind: str) -> str:
        return "-" if np.isnan(value) else quantity(value, unit(first.units, kind))

    if name:
        header = (name, "wobbling from", "step-out", "velocity there")
        rows = [
            (
                _shown(value, unit_of(name, first.units)),
                q(one.wobbling_onset, "frequency"),
                q(one.step_out, "frequency"),
                q(one.velocity_at_step_out, "speed"),
            )
            for value, one in zip(values, found)
        ]
        return Table(f"{who}: regimes in a rotating field, by {first.model}", header, rows)
    header = ("frequency", "regime", "precession", "velocity", "Re", "")
    rows = []
    for i, f in enumerate(first.frequency):
        angle = np.degrees(first.precession_angle[i])
        also = (f"also {np.degrees(a):.3g} deg, {q(v, 'speed')}" for a, v in first.others[i])
        rows.append(
            (
                q(f, "frequency"),
                first.regime[i],
                "-" if np.isnan(angle) else f"{angle:.3g} deg",
                q(first.velocity[i], "speed"),
                significant(first.reynolds[i], 2) if first.reynolds[i] else "-",
                ", ".join(also),
            )
        )
    return Table(
        f"{who}: regimes in a rotating field, by {first.model}", header, rows, _note(first)
    )


def _shown(value: Any, measured_in: str) -> str:
    from microswim.gait.readable import spec_value

    return value if isinstance(value, str) else spec_value(value, measured_in)


def _note(one: Regimes) -> str:
    import numpy as np

    from microswim.gait.readable import EXPLAINED, percent, quantity, with_error
    from microswim.gait.units import unit

    def f(value: float) -> str:
        return quantity(value, unit(one.units, "frequency"))

    off, speed = one.expected_error, unit(one.units, "speed")
    if not one.step_out:
        return f"no step-out: the field never holds it (errors: {off['how']})"
    if np.isnan(one.step_out):
        said = ["step-out outside of the frequencies asked for"]
    else:
        at = with_error(one.step_out, off["step_out"], unit(one.units, "frequency"))
        said = [
            f"step-out {at}, there {with_error(one.velocity_at_step_out, off['velocity'], speed)}"
        ]
    said[0] += f" (errors: {off['how']}; {EXPLAINED})"
    if not np.isnan(one.wobbling_onset):
        said.append(f"wobbling from {f(one.wobbling_onset)}")
    if one.reversals:
        said.append("velocity changes its sign at " + ", ".join(map(f, one.reversals)))
    exact = one.closed_form
    if exact is not None:
        turn = 2.0 * np.pi
        onset = exact.wobbling_onset if exact.wobbling_onset > ROUNDING * exact.step_out else 0.0
        said.append(
            f"axisymmetric robot next to it ({percent(exact.asymmetry)} off), closed forms: "
            f"wobbling from {f(onset / turn)}, step-out {f(exact.step_out / turn)}"
        )
    return "; ".join(said)


def _write(
    out: Path, found: list[Regimes], report: dict[str, Any], name: str, values: list[Any]
) -> None:
    import csv
    import json

    import numpy as np

    from microswim.gait.units import unit
    from microswim.numerics.plain import plain
    from microswim.output.plots import regimes as plots
    from microswim.spec.describe import unit_of

    table, text, picture = (out / file for file in FILES)
    units = found[0].units
    head = [
        *([f"{name} ({unit_of(name, units) or '1'})"] if name else []),
        f"frequency ({unit(units, 'frequency')})",
        "regime",
        "precession_angle (rad)",
        f"velocity ({unit(units, 'speed')})",
        f"velocity_error ({unit(units, 'speed')})",
    ]
    with fresh(table) as scratch, scratch.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for value, one in zip(values or [None], found):
            columns = one.frequency, one.regime, one.precession_angle, one.velocity
            for row in zip(*columns, one.velocity_error):
                writer.writerow([*([value] if name else []), *row])
    write(text, json.dumps(plain(report), allow_nan=False, ensure_ascii=False, indent=1) + "\n")
    if name and all(isinstance(v, (int, float)) for v in values) and len(values) > 1:
        figure = plots.regime_map(found, np.array(values), name, unit_of(name, units))
    else:
        figure = plots.regimes(found[0])
    with fresh(picture) as scratch:
        figure.savefig(scratch, format="png", dpi=200)
