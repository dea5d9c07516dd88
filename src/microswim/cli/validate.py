"""``microswim validate``: the surrogate against a reference over a map of designs."""

from __future__ import annotations

import csv
import json
import math
import time
from functools import partial
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
    out_option,
    print_json,
    solver_option,
    swimmer_options,
    workers_option,
)
from microswim.numerics.files import fresh, write
from microswim.swimmer.swimmer import Swimmer

#: Said beside these two rows: a surrogate may swim right and answer a push wrongly.
RESISTANCE = (
    "  resistance: error of the drag in the worst of all motions, as a force, field or flow makes\n"
    "  them; what of it swimming alone feels is velocity_by_resistance"
)
FILES = ("errors.csv", "validation.json", "errors.png")


@click.command(
    epilog=example(
        "microswim validate robot.toml --over tail.amplitude=0.01:0.15:8,tail.waves=1:5:9 --out m",
        "microswim validate calibrated.toml --reference bem --over tail.length=1.2:3:7 --json",
    )
)
@swimmer_options
@click.option(
    "--reference", "--against", type=click.Choice(["bem", "fem"]), default="bem", show_default=True
)
@click.option("--over", multiple=True, required=True, metavar="NAME=A:B:N", help="Axes of the map.")
@click.option("--quantity", multiple=True, metavar="NAMES", help="Velocities to compare.")
@workers_option
@solver_option
@out_option
@force_option
@json_option
def command(given: Given, out: Path | None, force: bool, as_json: bool, **asked: Any) -> None:
    """Errors of speed, lateral amplitude and body rate over a map, stage by stage.

    Writes a table (errors.csv), everything as JSON (validation.json) and contour maps with the 5 %
    and 10 % neighbourhoods (errors.png) into --out; solves are kept there, so a killed run goes on.
    """
    from microswim.calibration.validate import validate
    from microswim.cli._over import axes
    from microswim.cli._progress import bar

    begun = time.perf_counter()
    if out is not None:
        _files.check_files("--out", out, FILES, force)
    with bar(f"validate {given.name}") as progress:
        result = validate(
            given.swimmer,
            axes(asked["over"], given.swimmer.units),
            asked["reference"],
            quantities=[n for text in asked["quantity"] for n in text.split(",")],
            folder=None if out is None else out / "solves",
            workers=asked["workers"],
            progress=progress,
            **dict(change(text) for text in asked["options"]),
        )
    model = "elastic" if given.swimmer.tail.settles else "rft"
    report = {"model": model, **result.as_dict(), "wall_seconds": time.perf_counter() - begun}
    show = partial(print_json, report) if as_json else partial(_print, given.swimmer, report)
    if out is not None:
        with _files.or_else(show):
            _write(out, result, report)
    show()
    if out is not None and not as_json:
        click.echo(f"{out}: errors.csv, validation.json, errors.png")


def heading(swimmer: Swimmer, report: dict[str, Any]) -> str:
    """Return what is judged by what, and whether it is what ``microswim run`` answers with."""
    from microswim.calibration.atlas.choice import not_atlas

    designs = math.prod(len(values) for values in report["over"].values())
    said = f"{report['model']} against {report['against']}, {designs} designs"
    if report["model"] == "elastic" or not_atlas(swimmer):
        return said
    return f"{said}; microswim run takes the atlas here, which is nearer, and prints its error"


def _write(out: Path, result: Any, report: dict[str, Any]) -> None:
    from microswim.numerics.plain import plain
    from microswim.output.plots.validation import error_maps

    rows = result.rows()
    table, text_file, picture = (out / name for name in FILES)
    with (
        fresh(table) as scratch,
        scratch.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    text = json.dumps(plain(report), allow_nan=False, ensure_ascii=False, indent=1)
    write(text_file, text + "\n")
    with fresh(picture) as scratch:
        error_maps(result).savefig(scratch, dpi=200)


def _print(swimmer: Swimmer, report: dict[str, Any]) -> None:
    click.echo(heading(swimmer, report))
    click.echo(f"{'':24s} {'median':>8s} {'90 %':>8s} {'worst':>8s} {'<= 5 %':>8s} {'<= 10 %':>8s}")
    for name, s in report["statistics"].items():
        numbers = (s["median"], s["p90"], s["worst"], s["within_5"], s["within_10"])
        click.echo(f"  {name:22s} " + " ".join(f"{100 * x:6.1f} %" for x in numbers))
    if "resistance" in report["statistics"]:
        click.echo(RESISTANCE)
    if report["failed"]:
        click.echo(f"  {len(report['failed'])} designs failed: {report['failed'][0]['reason']}")
