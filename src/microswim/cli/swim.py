"""``microswim swim``: swim in time from rest by finite elements, with the fluid's inertia."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Any

import click

from microswim.cli import _files, _kept
from microswim.cli._options import (
    Given,
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

FILES = {
    "swim.nc": "velocities, forces and pose in time, netCDF",
    "swim.csv": "the same as a table",
    "spec.toml": "the spec it came from",
    _kept.CHECKPOINT: "what --resume goes on from",
    "flow.pvd": "the flow in time, for ParaView (files in flow/)",
    "skin.pvd": "the swimmer's surface in time, for ParaView",
    "flow.png": "the last flow as a picture",
    "flow.gif": "all flows as an animation",
}


@click.command(
    epilog=example(
        "microswim swim robot.toml --periods 2 --steps-per-period 40 --out swum",
        "microswim swim robot.toml --periods 2 --steps-per-period 40 --out swum --resume",
        "microswim swim --preset tabak/helix --periods 1 --out film --film",
        "microswim swim robot.toml --hold --periods 1 --json     thrust of a held swimmer",
        "microswim swim --preset tabak/helix --level paper --out paper   310,000 unknowns, 5 GB",
    )
)
@swimmer_options
@click.option(
    "--periods",
    type=click.FloatRange(min=0, min_open=True, max=1e4),
    default=2.0,
    show_default=True,
    help="How long, in periods of the tail.",
)
@click.option(
    "--steps-per-period",
    type=click.IntRange(4, 100_000),
    default=40,
    show_default=True,
    help="Time steps in a period; the error falls with their square.",
)
@level_option
@out_option
@click.option(
    "--checkpoint-every",
    type=click.IntRange(1),
    default=5,
    show_default=True,
    metavar="STEPS",
    help="How often --out keeps the run, and with --flow the flow.",
)
@click.option("--resume", is_flag=True, help="Go on with the run in --out, if there is one.")
@click.option("--flow", is_flag=True, help="Write the flow for ParaView at every checkpoint.")
@click.option("--film", is_flag=True, help="Picture and animation of the flow (extra viz).")
@click.option("--hold", is_flag=True, help="Hold the swimmer: thrust and torque of its tail.")
@force_option
@json_option
def command(
    given: Given, out: Path | None, as_json: bool, resume: bool, force: bool, **asked: Any
) -> None:
    """Swim from rest in time: Navier-Stokes on a moving mesh, the fluid's inertia included.

    The channel is that of the spec, or ten body diameters. With --out the run is kept every few
    steps: killed at any moment, --resume goes on from there to the same numbers. --level is coarse
    by default.
    """
    flow, film = asked.pop("flow"), asked.pop("film")
    options = {"level": asked["level"] or "coarse", "steps_per_period": asked["steps_per_period"]}
    options |= {"checkpoint_every": asked["checkpoint_every"], "periods": asked["periods"]}
    if asked["hold"]:
        options["free"] = (False,) * 6
    _check(given, out, resume, force, flow or film, film)
    if out is not None:
        options["checkpoint"] = _kept.begin(out, given.text)
        options["vtk"] = out / "flow" if flow or film else None
    data = _march(given, out, options)
    report = _report(given, data, options)
    show = partial(print_json if as_json else _print, report)
    if out is not None:
        with _files.or_else(show):
            _write(out, data, given.text, film)
    show()
    if out is not None:
        click.echo(f"written to {out}/", err=True)
        for name, meaning in FILES.items():
            if (out / name).exists():
                click.echo(f"  {name:<14}  {meaning}", err=True)


def _check(given: Given, out: Path | None, resume: bool, force: bool, flow: bool, film: bool):
    """Refuse before any work what cannot end well; with --force, clear the way."""
    if out is None and (resume or flow):
        raise SpecError("--resume, --flow and --film need --out DIR")
    if film:
        from microswim.models.fem import require_viewer

        require_viewer()
    if out is not None and not resume:
        _kept.check(out, "run", FILES, "flow", force)


def _march(given: Given, out: Path | None, options: dict[str, Any]) -> Any:
    from microswim.cli._progress import bar
    from microswim.models import fem

    with _kept.resumable(out), bar(f"swim {given.name}, {options['level']}") as progress:
        return fem.swim(given.swimmer.settled, progress=progress, **options)


def _report(given: Given, data: Any, options: dict[str, Any]) -> dict[str, Any]:
    from microswim.gait.gait import DEGREES_OF_FREEDOM
    from microswim.models.fem import last_period

    return {
        "swimmer": given.name,
        "model": "fem",
        "units": data.attrs["units"],
        "degrees_of_freedom": list(DEGREES_OF_FREEDOM),
        **last_period(data),
        "reynolds": data.attrs["reynolds"] / (2.0 * math.pi),
        "periods": options["periods"],
        "steps_per_period": options["steps_per_period"],
        "position": data.position.values[-1],
        "quaternion": data.quaternion.values[-1],
        "level": options["level"],
        "unknowns": data.attrs["unknowns"],
        "wall_seconds": data.attrs["wall_seconds"],
    }


def _write(out: Path, data: Any, spec: str, film: bool) -> None:
    from microswim import __version__
    from microswim.output.io.run import netcdf

    data.attrs |= {"spec": spec, "microswim_version": __version__}
    write(out / "swim.nc", netcdf(data))
    _write_csv(out / "swim.csv", data)
    if (out / "flow").is_dir():
        from microswim.models.fem.picture import write_collection

        write_collection(out / "flow", float(data.time[0]))
    if film:
        from microswim.models.fem.picture import animate, flow_files, render

        render(flow_files(out / "flow")[-1], out / "flow.png")
        animate(out / "flow", out / "flow.gif")


def _write_csv(path: Path, data: Any) -> None:
    import numpy as np

    parts = [data.time.values[:, None], data.phase.values[:, None], data.velocity.values]
    parts += [data.wrench_body.values, data.wrench_tail.values]
    parts += [data.position.values, data.quaternion.values]
    names = ["time", "phase", *data.component.values.tolist()]
    names += [f"{f}_{part}" for part in ("body", "tail") for f in data.force.values]
    names += ["x", "y", "z", "qw", "qx", "qy", "qz"]
    table = np.column_stack(parts)
    with fresh(path) as part:
        np.savetxt(part, table, fmt="%.12g", delimiter=",", header=",".join(names), comments="")


def _print(report: dict[str, Any]) -> None:
    from microswim.cli import _print
    from microswim.gait.readable import percent, significant
    from microswim.output.report.html import Table

    mean, swing = report["mean_velocity"], report["velocity_amplitude"]
    tail, settling = report["wrench_tail"], report["settling"]
    rows = [
        (name, significant(m), significant(a))
        for name, m, a in zip(report["degrees_of_freedom"], mean, swing)
    ]
    rows += [
        ("force on the tail along s", significant(tail[0]), ""),
        ("torque on the tail about s", significant(tail[3]), ""),
    ]
    settled = "first period" if settling is None else f"changed by {percent(settling)} since"
    note = (
        f"last of {report['periods']:g} periods ({settled}); Reynolds number "
        f"{significant(report['reynolds'], 3)} (frequency x body diameter squared); "
        f"{report['unknowns']:,} unknowns, {report['wall_seconds']:.0f} s"
    )
    title = f"{report['swimmer']}, swimming in time from rest"
    _print.print_table(Table(title, ("", "mean", "half of peak to peak"), rows, note))
