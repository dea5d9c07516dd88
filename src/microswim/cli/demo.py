"""``microswim demo``: the paper's base case swims."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.cli._options import example, force_option

if TYPE_CHECKING:
    from microswim.gait.gait import Gait
    from microswim.output.report.html import Table

FREE = "us uq ur os"
CASES = (  # label, preset, with interaction coefficients, solver in the data set
    ("RFT constant + gamma", "tabak/helix-constant", True, "rft_constant"),
    ("RFT Lighthill + gamma", "tabak/helix-sbt", True, "rft_sbt"),
    ("RFT constant", "tabak/helix-constant", False, None),
    ("RFT Lighthill", "tabak/helix-sbt", False, None),
)
LEAD = (
    "A sphere pushed by a rotating helix, swimming in a fluid so viscous that inertia plays no "
    "part: the base case of Tabak & Yesilyurt. The picture shows the surrogate with the paper's "
    "constant pair of coefficients and its interaction coefficients."
)
NOTE = (
    "Lengths in body diameters, times in periods of the motor; lateral: half of peak to peak of "
    "u_q; Omega_s in radians. RFT, the surrogate, with the paper's constant pair of local "
    "coefficients or with Lighthill's: alone it swims too fast; gamma, the interaction "
    "coefficients of Table 3, bring it to the paper's CFD. Boundary elements resolve the thick "
    "filament and its spin and swim slower. Check: u_s against independent computations (data set "
    "base-case)."
)


@click.command(epilog=example("microswim demo", "microswim demo --out my-demo --no-bem"))
@click.option(
    "--out",
    metavar="DIR",
    type=click.Path(path_type=Path),
    default=Path("out/demo"),
    show_default=True,
    help="Folder for files and pictures.",
)
@click.option("--bem/--no-bem", default=True, help="Solve with boundary elements too (seconds).")
@force_option
def command(out: Path, bem: bool, force: bool) -> None:
    """Let the paper's base case swim: numbers, pictures, a report."""
    from microswim.cli import _folder, _print
    from microswim.cli._progress import bar

    start = time.perf_counter()
    force = force or out == Path("out/demo")
    _folder.check(out, force)
    from microswim.output.io import run as io
    from microswim.output.report import html as report
    from microswim.spec import presets
    from microswim.swimmer.swimmer import Swimmer

    click.echo("The base case of Tabak & Yesilyurt: a sphere pushed by a rotating helix.\n")
    preset = CASES[0][1]
    swimmer = Swimmer.preset(preset)
    gait = swimmer.gait()
    with bar("demo"):
        table = comparison(bem)
    _print.print_table(table)
    run = io.dataset(swimmer, gait, spec=presets.read(preset))
    tables = [
        table,
        report.numbers_table(io.numbers(swimmer, gait), preset),
        report.spec_table(swimmer),
    ]
    with _folder.filled(out, force) as folder:
        _folder.write(folder, run, swimmer, "The base-case swimmer", tables, LEAD)
    _folder.say_where(out)
    click.echo(f"\nin {time.perf_counter() - start:.0f} s; open {out}/report.html", err=True)


def comparison(bem: bool) -> Table:
    """Return the base case by every method at hand, against the paper and independent numbers."""
    from microswim import data
    from microswim.output.report.html import Table
    from microswim.swimmer.swimmer import Swimmer

    known = data.load("base-case").sel(free=FREE)
    rows = [_row("the paper's CFD", _known(known, "cfd_paper"), None)]
    for label, preset, interaction, solver in CASES:
        swimmer = Swimmer.preset(preset)
        if not interaction:
            ones = (1.0, 1.0, 1.0)
            swimmer = swimmer.with_({"interaction.translation": ones, "interaction.rotation": ones})
        check = None if solver is None else _known(known, solver)
        rows.append(_row(label, _numbers(swimmer.gait()), check))
    if bem:
        gait = Swimmer.preset(CASES[0][1]).gait("bem")
        rows.append(_row("boundary elements", _numbers(gait), _known(known, "bem")))
    header = ("", "u_s", "lateral", "Omega_s", "rev/period", "check")
    return Table("The base case, free: translations and rotation about s", header, rows, NOTE)


def _numbers(gait: Gait) -> tuple[float, float, float]:
    """Mean u_s, lateral amplitude, mean Omega_s."""
    return gait.mean_velocity[0], gait.velocity_amplitude[1], gait.mean_velocity[3]


def _known(known: Any, solver: str) -> tuple[float, float, float]:
    case = known.sel(solver=solver)
    return float(case.u_s), float(case.lateral_amplitude), float(case.Omega_s)


def _row(label: str, values: tuple[float, ...], check: tuple[float, ...] | None) -> tuple[str, ...]:
    u, lateral, turn = values
    agrees = "" if check is None else f"{round(100.0 * (u / check[0] - 1.0), 2) + 0.0:.2f} %"
    numbers = (f"{u:.4f}", f"{lateral:.4f}", f"{turn:.3f}", f"{turn / (2.0 * math.pi):.4f}")
    return (label, *numbers, agrees)
