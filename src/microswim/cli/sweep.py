"""``microswim sweep``: grids and lists of designs into a Zarr store, resumable."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path
from typing import Any

import click

from microswim.cli._options import (
    Given,
    auto_option,
    change,
    example,
    json_option,
    level_option,
    leveled,
    print_json,
    swimmer_options,
)
from microswim.errors import MicroswimError, SpecError


@click.command(
    epilog=example(
        "microswim sweep robot.toml --over tail.amplitude=0.1:0.5:9,tail.waves=1:5:9 --out a.zarr",
        "microswim sweep robot.toml --over tail.waves=1:5:20 --model bem --level fine --out b.zarr",
        "microswim sweep robot.toml --designs designs.csv --model bem --out bem.zarr --resume",
        "microswim sweep robot.toml --over ... --model fem --scheduler HOST:8786 --out fem.zarr",
    )
)
@swimmer_options
@click.option(
    "--over",
    multiple=True,
    metavar="NAME=A:B:N",
    help="What varies: NAME=FIRST:LAST:COUNT[:log] or NAME=X,Y,Z; the grid of all combinations.",
)
@click.option(
    "--designs",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="A list of designs instead: CSV, a column for each dotted name.",
)
@auto_option
@level_option
@click.option(
    "--option",
    "options",
    multiple=True,
    metavar="NAME=VALUE",
    help="What else the model takes, as in --option phases=12 (fem).",
)
@click.option(
    "--out",
    required=True,
    metavar="STORE",
    type=click.Path(path_type=Path),
    help="Zarr store to write; xarray.open_zarr reads it at any moment.",
)
@click.option("--resume", is_flag=True, help="Go on with the store if it is there.")
@click.option(
    "--workers",
    type=click.IntRange(0, 1024),
    metavar="N",
    help="Local processes, 0 for none (default: all cores for bem and fem), or cluster jobs.",
)
@click.option("--scheduler", metavar="ADDRESS", help="Solve on the workers of a Dask scheduler.")
@click.option(
    "--cluster",
    type=click.Choice(["slurm"]),
    help="Solve in jobs of a cluster (queue and limits: Dask's jobqueue configuration).",
)
@json_option
def command(given: Given, out: Path, as_json: bool, level: str | None, **asked: Any) -> None:
    """Solve a grid or a list of designs into a Zarr store.

    Results are on disk as they come. Killed at any moment, a sweep loses at most the solves in
    flight, and --resume goes on to the same result. A failed design is a row with its reason.
    """
    from microswim.cli._progress import bar
    from microswim.studies.sweeps.sweep import sweep

    over = _over(asked.pop("over"), asked.pop("designs"), given.swimmer.units)
    options = dict(change(text) for text in asked.pop("options"))
    options |= leveled(asked["model"], level)
    begun = time.perf_counter()
    with bar(f"sweep {given.name}") as progress:
        result = sweep(
            given.swimmer, over, asked.pop("model"), out=out, progress=progress, **asked, **options
        )
    report = _report(result, out, time.perf_counter() - begun)
    if as_json:
        print_json(report)
        _fail_if_all_did(report)
        return
    click.echo(
        f"{report['designs']} designs, {report['failed']} failed, in {report['wall_seconds']:.1f} s"
    )
    for reason, count in report["reasons"].items():
        click.echo(f"  {count} x {reason}")
    click.echo(f'{out}: read it with xarray.open_zarr("{out}")')
    _fail_if_all_did(report)


def _fail_if_all_did(report: dict[str, Any]) -> None:
    """End with status 1 where every design failed, and say why the most of them did.

    Raises
    ------
    MicroswimError
        Then.
    """
    if report["failed"] == report["designs"]:
        raise MicroswimError(f"every design failed: {next(iter(report['reasons']))}")


def _over(over: tuple[str, ...], designs: Path | None, units: str) -> Any:
    if bool(over) == bool(designs):
        raise SpecError("give --over NAME=A:B:N or --designs FILE, one of the two")
    if designs is None:
        from microswim.cli._over import axes

        return axes(over, units)
    from microswim.spec.readers.delimited import rows
    from microswim.spec.values import from_text

    return [
        {name: from_text(name, v, units, f"{designs}, row {i}, {name}") for name, v in row.items()}
        for i, row in enumerate(rows(designs), 1)
    ]


def _report(result: Any, out: Path, seconds: float) -> dict[str, Any]:
    from microswim.studies.sweeps.layout import FAILED

    failed = result["status"].values == FAILED
    reasons = Counter(map(str, result["reason"].values[failed]) if failed.any() else ())
    return {
        "store": str(out),
        "designs": int(result["status"].size),
        "failed": int(failed.sum()),
        "reasons": dict(reasons.most_common(5)),
        "wall_seconds": seconds,
    }
