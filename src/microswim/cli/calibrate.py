"""``microswim calibrate``: interaction coefficients, or a region, from a reference or data."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import click

from microswim.cli import _files
from microswim.cli._options import (
    Given,
    change,
    example,
    force_option,
    json_option,
    print_json,
    solver_option,
    swimmer_options,
    workers_option,
)
from microswim.errors import SpecError
from microswim.numerics.files import write
from microswim.spec.readers.delimited import is_number
from microswim.spec.toml import to_toml


@click.command(
    epilog=example(
        "microswim calibrate robot.toml --reference bem -o calibrated.toml",
        'microswim calibrate robot.toml --measured "mean.us=-38 um/s:1 um/s, mean.os=-5 rad/s" '
        "-o calibrated.toml",
        "microswim calibrate robot.toml --reference bem --region tail.amplitude=0.03:0.2,"
        "tail.waves=0.8:4.5 --solves 100 -o calibrated.toml",
        "microswim calibrate cell.toml --table cells.csv --unknown translation.s,rotation.s",
        "microswim calibrate robot.toml --series velocities.csv -o calibrated.toml",
    )
)
@swimmer_options
@click.option("--reference", type=click.Choice(["bem", "fem"]), help="Calibrate on a reference.")
@click.option(
    "--measured",
    multiple=True,
    metavar="NAME=VALUE[:SIGMA]",
    help="Measured quantities with uncertainty, in units where the spec has units, else bare: "
    '"swimming_speed=30 um/s:1 um/s", mean.us=-0.038:0.001, body_rate_hz, ...',
)
@click.option(
    "--table",
    type=click.Path(path_type=Path),
    help="CSV, one swimmer a row: columns of dotted fields, of quantities and of QUANTITY_sigma; "
    'a unit in the cell or in the header, "mean.us (um/s)"; quantities without one are SI.',
)
@click.option(
    "--series",
    type=click.Path(path_type=Path),
    help="CSV with a column time and columns us, uq, ... (and us_sigma, ...), units as there.",
)
@click.option("--unknown", multiple=True, metavar="NAMES", help="translation.s, tail.n, ...")
@click.option("--quantity", multiple=True, metavar="NAMES", help="What to take of the reference.")
@click.option("--bound", multiple=True, metavar="NAME=LOW:HIGH", help="Bounds of an unknown.")
@click.option("--positive", is_flag=True, help="Keep the body's resistance positive definite.")
@click.option(
    "--method",
    type=click.Choice(["least squares", "ratios"]),
    default="least squares",
    show_default=True,
    help="ratios: the paper's direct ratios of the body's force to its velocity.",
)
@click.option("--region", multiple=True, metavar="NAME=LOW:HIGH", help="Calibrate over a region.")
@click.option("--solves", type=click.IntRange(6), default=100, show_default=True)
@workers_option
@solver_option
@click.option(
    "-o",
    "--out",
    "--output",
    "output",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Calibrated spec to write.",
)
@force_option
@json_option
def command(given: Given, output: Path | None, force: bool, as_json: bool, **asked: Any) -> None:
    """Find interaction coefficients, or smooth corrections over a region of designs.

    The calibrated spec serves every command; over a region each answer comes with its expected
    error. A killed region calibration goes on where it was when it is run again.
    """
    begun = time.perf_counter()
    _check(asked)
    if output is not None:
        _files.check_file("--out", output, force)
    options = dict(change(text) for text in asked.pop("options"))
    run = _region if asked["region"] else _coefficients
    report, tables = run(given, output, options, asked)
    report["wall_seconds"] = time.perf_counter() - begun
    if output is not None:
        text = to_toml(tables, f"{given.name}, calibrated")
        with _files.or_else(lambda: click.echo(text)):
            write(output, text)
        report["output"] = str(output)
    if as_json:
        print_json(report)
    else:
        if asked["region"]:
            _print_region(report)
        else:
            _print_coefficients(report, given.swimmer.units)


def _check(asked: dict[str, Any]) -> None:
    """Refuse what one way of calibrating would silently leave out of account."""
    ways = {
        "region": ("measured", "table", "series", "unknown", "quantity", "bound", "positive"),
        "measured": ("options",),
        "table": ("options",),
        "series": ("options",),
    }
    for way, foreign in ways.items():
        for name in foreign:
            if asked[way] and asked[name]:
                option = "option" if name == "options" else name
                raise SpecError(f"--{option} has no meaning with --{way}; leave one of them out")


def _names(texts: tuple[str, ...]) -> list[str]:
    return [name.strip() for text in texts for name in text.split(",") if name.strip()]


def _region(given: Given, output: Path | None, options: dict, asked: dict) -> tuple[dict, dict]:
    from microswim.calibration.region.calibrate import calibrate_region
    from microswim.calibration.region.text import pack
    from microswim.cli._over import bounds
    from microswim.cli._progress import bar

    region = bounds(asked["region"], given.swimmer.units, "--region")
    folder = (output or Path(f"{given.name.replace('/', '-')}.toml")).with_suffix(".solves")
    with bar(f"calibrate {given.name}") as progress:
        fitted = calibrate_region(
            given.swimmer,
            region,
            asked["reference"] or "bem",
            solves=asked["solves"],
            folder=folder,
            workers=asked["workers"],
            progress=progress,
            **options,
        )
    replaced = ("region", "calibration", "coefficients", "interaction")  # a region is all of it
    tables = {k: v for k, v in given.tables.items() if k not in replaced}
    report = fitted.as_dict() | {"solves_kept_in": str(folder)}
    return report, tables | {"region": {"data": pack(fitted.region)}} | _record(fitted)


def _coefficients(given: Given, output: Any, options: dict, asked: dict) -> tuple[dict, dict]:
    from microswim.calibration.calibrate import calibrate
    from microswim.calibration.unknowns import resolve
    from microswim.cli._over import bounds
    from microswim.gait.observed import parse
    from microswim.spec.describe import to_tables

    limits = bounds(asked["bound"], given.swimmer.units, "--bound")
    for name in _names(asked["quantity"]):
        parse(name)
    resolve(given.swimmer, _names(asked["unknown"]))
    data = _data(given, options, asked)  # which may take minutes: names are checked before
    fit = calibrate(
        given.swimmer,
        data,
        _names(asked["unknown"]),
        quantities=_names(asked["quantity"]),
        bounds=limits,
        positive=asked["positive"],
        method=asked["method"],
    )
    x, law = fit.swimmer.interaction, fit.swimmer.coefficients
    own = {n: getattr(x, n) for n in ("translation", "rotation", "coupling", "tail")}
    tables = given.tables | {"interaction": own}
    for name in ("normal", "tangential"):
        if hasattr(law, name):
            tables["coefficients"] = tables.get("coefficients", {}) | {name: getattr(law, name)}
    written = to_tables(fit.swimmer)
    fitted = {name.partition(".")[0] for name in fit.names if name in fit.swimmer.numbers}
    for part in fitted - {"interaction", "coefficients"}:  # a moment, a length: its whole table
        tables[part] = written[part]
    return fit.as_dict(), tables | _record(fit)


def _record(fit: Any) -> dict[str, Any]:
    """Return the table of the spec that says where the numbers come from."""
    return {"calibration": fit.swimmer.calibration.as_tables()}


def _data(given: Given, options: dict, asked: dict) -> Any:
    sources = [n for n in ("reference", "measured", "table", "series") if asked[n]]
    if len(sources) != 1:
        raise SpecError("give one of --reference, --measured, --table and --series")
    if sources == ["reference"]:
        return given.swimmer.gait(asked["reference"], **options)
    if sources == ["measured"]:
        return dict(pair for text in asked["measured"] for pair in _measured(given, text))
    return (_table if sources == ["table"] else _series)(given, asked[sources[0]])


def _measured(given: Given, text: str) -> Any:
    """Names and values, or pairs of value and uncertainty, of ``NAME=VALUE[:SIGMA],...``."""
    from microswim.gait.observed import unit_of
    from microswim.spec.values import in_unit

    example = 'such as "swimming_speed=30 um/s:1 um/s"'
    for piece in text.split(","):
        name, equals, value = (part.strip() for part in piece.partition("="))
        ends = value.split(":")
        if not equals or not 1 <= len(ends) <= 2 or not all(end.strip() for end in ends):
            raise SpecError("--measured", text, "NAME=VALUE or NAME=VALUE:SIGMA", example)
        unit, units = unit_of(name, "SI"), given.swimmer.units
        numbers = [in_unit(f"--measured {name}", end, unit, units) for end in ends]
        yield name, numbers[0] if len(numbers) == 1 else tuple(numbers)


def _table(given: Given, path: Path) -> list[Any]:
    from microswim.calibration.observations import Observation
    from microswim.spec.readers.delimited import rows
    from microswim.spec.values import from_text

    out = []
    for row in map(_with_units, rows(path)):
        numbers, units = given.swimmer.numbers, given.swimmer.units
        fields = {n: from_text(n, v, units, f"{path}: {n}") for n, v in row.items() if n in numbers}
        swimmer = given.swimmer.with_(fields)
        for name in row.keys() - fields.keys() - {"name"}:
            if not name.endswith("_sigma") and row[name]:
                sigma = row.get(f"{name}_sigma", "")
                out.append(
                    Observation(
                        swimmer=swimmer,
                        quantity=name,
                        value=_number(path, name, row[name], units),
                        sigma=_number(path, name, sigma, units) if sigma else None,
                    )
                )
    return out


def _series(given: Given, path: Path) -> list[Any]:
    from microswim.calibration.observations import from_series
    from microswim.spec.readers.delimited import rows

    found, columns = [_with_units(row) for row in rows(path)], {}
    for name in found[0]:
        of = name if name == "time" else f"velocity.{name.removesuffix('_sigma')}"
        columns[name] = [_number(path, of, row[name], given.swimmer.units) for row in found]
    if "time" not in columns:
        raise SpecError(f"{path}: must have a column time")
    time_, sigmas = columns.pop("time"), {n: v for n, v in columns.items() if n.endswith("_sigma")}
    velocities = {n: v for n, v in columns.items() if n not in sigmas}
    sigma = {n: sigmas.get(f"{n}_sigma") for n in velocities}
    return from_series(given.swimmer, time_, velocities, sigma)


def _with_units(row: dict[str, str]) -> dict[str, str]:
    """Return a row of a table with the units of its header, ``mean.us (um/s)``, in its cells."""
    out = {}
    for name, cell in row.items():
        bare, _, unit = name.partition("(")
        whole = cell.strip() and unit and is_number(cell)
        out[bare.strip()] = f"{cell.strip()} {unit.rstrip(' )')}" if whole else cell.strip()
    return out


def _number(path: Path, quantity: str, text: str, units: str) -> float:
    """Return what is measured of a quantity: bare, or with a unit of its own."""
    from microswim.gait.observed import unit_of
    from microswim.spec.values import in_unit

    try:
        return float(text)
    except ValueError:
        unit = "s" if quantity == "time" else unit_of(quantity, "SI")
        return in_unit(f"{path}: {quantity}", text, unit, units)


def _print_coefficients(report: dict[str, Any], units: str) -> None:
    from microswim.gait import observed
    from microswim.gait.readable import quantity, spec_value
    from microswim.spec.describe import unit_of

    for name, value in report["coefficients"].items():
        sigma, unit = report["uncertainty"][name], unit_of(name, units)
        off = "not known" if sigma is None else spec_value(sigma, unit)
        click.echo(f"  {name:20s} {spec_value(value, unit):>14}  +- {off}")
    if report.get("assumed_uncertainty"):
        assumed = report["assumed_uncertainty"]
        share, names = next(iter(assumed.values())), ", ".join(assumed)
        click.echo(
            f"  +- from an assumed {100 * share:g} % of {names}; measurements can say their own "
            "(NAME=VALUE:SIGMA, a column NAME_sigma)"
        )
    click.echo(f"  {report['rank']} of {len(report['coefficients'])} combinations determined")
    for row in report["data"][:12]:
        unit = observed.unit_of(row["quantity"], units)
        numbers = (quantity(row[of], unit or "1") for of in ("measured", "predicted"))
        click.echo("  {:20s} {:>14}  model {}".format(row["quantity"], *numbers))
    for sentence in report["warnings"]:
        click.echo(f"  warning: {sentence}")
    for sentence in report["notes"]:
        click.echo(f"  note: {sentence}")


def _print_region(report: dict[str, Any]) -> None:
    from microswim.gait.readable import percent

    click.echo(f"{report['solves']} solves by {report['reference']}, left-out errors:")
    for name, error in report["left_out_error"].items():
        numbers = ", ".join(f"{k} {percent(error[k])}" for k in ("median", "p90", "worst"))
        click.echo(f"  {name:14s} {numbers}")
    for words, kind in (
        ("set aside, as all others contradict them", "set_aside"),
        ("refused by the reference and replaced", "refused"),
    ):
        if report[kind]:
            reason = report[kind][0].get("reason", "")
            click.echo(f"  {len(report[kind])} designs {words}{': ' if reason else ''}{reason}")
    click.echo(f"solves are kept in {report['solves_kept_in']}, in {report['wall_seconds']:.0f} s")
