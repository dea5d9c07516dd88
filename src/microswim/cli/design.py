"""``microswim design``: optimum, trade-off or robust design of a swimmer."""

from __future__ import annotations

from collections.abc import Callable
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
)
from microswim.errors import SpecError
from microswim.numerics.files import fresh, write

Found = tuple[dict[str, Any], Callable[[Path], None]]  #: a report, and what draws it into a folder
FILES = (
    "optimum.toml",
    "sensitivity.png",
    "map.png",
    "map.nc",
    "front.png",
    "front.nc",
    "yield.png",
    "indices.png",
)


@click.command(
    epilog=example(
        "microswim design robot.toml --over tail.amplitude=0.01:0.5,tail.waves=0.5:5 \\",
        '      --maximize swimming_speed --subject-to "mean_torque<=150" --reference bem',
        "microswim design robot.toml --over tail.amplitude=0.01:0.3,tail.kind=helix,plane_wave \\",
        "      --maximize swimming_speed --minimize mean_torque --out front",
        "microswim design robot.toml --over tail.waves=1:4 --maximize swimming_speed \\",
        '      --uncertain tail.amplitude=5% --subject-to "swimming_speed>=0.03" --out robust',
    )
)
@swimmer_options
@click.option(
    "--over",
    multiple=True,
    required=True,
    metavar="NAME=LOW:HIGH",
    help="What may vary: NAME=LOW:HIGH, or choices NAME=X,Y such as tail.handedness=left,right.",
)
@click.option(
    "--maximize", multiple=True, metavar="EXPRESSION", help="Such as swimming_speed/mean_torque."
)
@click.option("--minimize", multiple=True, metavar="EXPRESSION", help="Two wishes: Pareto front.")
@click.option(
    "--subject-to",
    default="",
    metavar="LIST",
    help='"mean_torque<=150, body_rate<=0.5"; with units: "mean_torque<=2 nN m".',
)
@click.option(
    "--model",
    type=click.Choice(["auto", "rft", "atlas"]),
    default="auto",
    show_default=True,
    help="What searches; auto: the atlas where it holds and the spec chooses no law, else rft.",
)
@click.option(
    "--reference", "--verify", type=click.Choice(["bem", "fem"]), help="Judge, calibrate, repeat."
)
@click.option("--tolerance", default=0.05, show_default=True, help="Miss accepted by --reference.")
@solver_option
@click.option(
    "--uncertain",
    multiple=True,
    metavar="NAME=5%|LOW:HIGH",
    help="Spread of made robots and of what is not known; the optimum becomes a robust one.",
)
@click.option("--quantile", default=0.1, show_default=True, help="Of robots that may be worse.")
@click.option("--yield", "least_yield", default=0.95, show_default=True, help="Of good robots.")
@click.option("--seed", default=0, show_default=True, help="Of the random starts.")
@out_option
@force_option
@json_option
def command(given: Given, as_json: bool, out: Path | None, force: bool, **asked: Any) -> None:
    """Find the best design in given ranges.

    Wishes and constraints are arithmetic on swimming_speed, efficiency, mean_power, mean_torque,
    body_rate, lateral_amplitude, yaw_amplitude, speed_per_torque, speed_per_power,
    distance_per_cycle, energy_per_distance, body_lengths_per_time, amplitude_wavenumber,
    arc_length, length_over_amplitude, ... and the numbers of the spec.
    """
    from microswim.cli._over import bounds
    from microswim.cli._progress import bar

    if out is not None:
        _files.check_files("--out", out, FILES, force)
    from microswim.studies.optimisation.limits import in_si

    over = bounds(asked["over"], given.swimmer.units)
    asked["subject_to"] = in_si(asked["subject_to"], given.swimmer, bare=False)
    wishes = (*asked["maximize"], *asked["minimize"])
    if not wishes:
        raise SpecError("give --maximize or --minimize, for example --maximize swimming_speed")
    if len(wishes) > 1 and (asked["reference"] or asked["uncertain"]):
        raise SpecError("--reference and --uncertain go with one wish; give one")
    find = _front if len(wishes) > 1 else _robust if asked["uncertain"] else _optimum
    with bar(f"design {given.name}"):
        report, draw = find(given, over, asked)
        show = partial(_show, report, given.swimmer.units, as_json)
        if out is not None:
            with _files.or_else(show):
                draw(out)
    show()


def _show(report: dict[str, Any], units: str, as_json: bool) -> None:
    from microswim.cli._optimum import show

    if as_json:
        print_json(report)
    else:
        show(report, units)


def _one(asked: dict[str, Any]) -> dict[str, Any]:
    names = ("maximize", "minimize")
    return {k: asked[k][0] if asked[k] else None for k in names} | {
        "subject_to": asked["subject_to"],
        "model": asked["model"],
        "seed": asked["seed"],
    }


def _optimum(given: Given, over: Any, asked: dict[str, Any]) -> Found:
    from microswim.studies.optimisation.design import design

    options = dict(change(text) for text in asked["options"])
    best = design(
        given.swimmer,
        over,
        reference=asked["reference"],
        tolerance=asked["tolerance"],
        progress=lambda text: click.echo(text, err=True),
        **_one(asked),
        **options,
    )
    return best.as_dict(), partial(_pictures, given, best, asked["model"])


def _pictures(given: Given, best: Any, model: Any, out: Path) -> None:
    from microswim.output.plots import design as plots_design
    from microswim.spec.describe import to_tables
    from microswim.spec.toml import to_toml
    from microswim.studies.optimisation.limits import for_people
    from microswim.studies.sweeps.sweep import sweep

    value = for_people(best.objective, best.value, given.swimmer.units)
    words = f"{given.name}: {best.objective} {value}, the best in the given ranges"
    write(out / "optimum.toml", to_toml(to_tables(best.swimmer), words))
    _save(plots_design.sensitivity(best), out / "sensitivity.png")
    ranges = [k for k, s in best.sensitivity.items() if s.varied][:2]
    if len(ranges) == 2:
        import numpy as np

        from microswim.output.io.run import netcdf

        axes = {k: np.linspace(best.ranges[k][0], best.ranges[k][1], 41) for k in ranges}
        mapped = ("efficiency", "mean_power", "mean_torque")
        shown = best.objective if best.objective in mapped else "swimming_speed"
        result = sweep(best.swimmer, axes, model)
        write(out / "map.nc", netcdf(result.drop_attrs()))
        _save(plots_design.design_map(result, shown, optimum=best), out / "map.png")


def _save(figure: Any, path: Path) -> None:
    with fresh(path) as scratch:
        figure.savefig(scratch, dpi=200)


def _front(given: Given, over: Any, asked: dict[str, Any]) -> Found:
    from microswim.studies.optimisation.pareto import pareto

    result = pareto(
        given.swimmer,
        over,
        asked["maximize"],
        asked["minimize"],
        subject_to=asked["subject_to"],
        model=asked["model"],
        seed=asked["seed"],
    )
    columns = {str(k): v.values.tolist() for k, v in result.variables.items() if v.ndim}
    found = {"objectives": result.attrs["objectives"], "front": columns}
    return found, partial(_front_files, given, result)


def _front_files(given: Given, result: Any, out: Path) -> None:
    from microswim.output.io.run import netcdf
    from microswim.output.plots.design import front

    write(out / "front.nc", netcdf(result))
    _save(front(result, given.swimmer), out / "front.png")


def _robust(given: Given, over: Any, asked: dict[str, Any]) -> Found:
    from microswim.cli._over import spreads
    from microswim.studies.optimisation.robust_design import robust_design
    from microswim.studies.optimisation.robustness import robustness, sobol_indices

    uncertain = spreads(asked["uncertain"], given.swimmer.units)
    more = {"quantile": asked["quantile"], "least_yield": asked["least_yield"]}
    best = robust_design(given.swimmer, over, uncertain=uncertain, **more, **_one(asked))
    model: Any = best.model if asked["model"] == "auto" else asked["model"]
    made = robustness(best.swimmer, uncertain, subject_to=asked["subject_to"], model=model)
    blame = sobol_indices(best.swimmer, uncertain, best.objective, model=model)
    shares = {
        str(n): {"first": float(a), "total": float(b)}
        for n, a, b in zip(blame.name.values, blame.first.values, blame.total.values)
    }
    found = {
        "yield": made.attrs["yield"],
        "yield_error": made.attrs["yield_error"],
        "sobol_indices": shares,
    }
    return best.as_dict() | found, partial(_robust_files, given, best, made, blame, asked["model"])


def _robust_files(given: Given, best: Any, made: Any, blame: Any, model: Any, out: Path) -> None:
    from microswim.output.plots import design as plots_design

    _pictures(given, best, model, out)
    merit = best.objective if best.objective in made else "swimming_speed"
    picture = plots_design.robustness(made, merit, best.quantities[merit])
    _save(picture, out / "yield.png")
    _save(plots_design.indices(blame), out / "indices.png")
