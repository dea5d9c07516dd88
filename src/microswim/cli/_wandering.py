"""``microswim identify --noise``: how the cells of a film wander, each and all together."""

from __future__ import annotations

from typing import Any

import click

from microswim.gait.units import unit

SHOWN = {
    "persistence_time": "persistence", "effective_diffusion": "effective diffusion",
    "rotational_diffusion": "rotational", "speed_in_space": "speed in space",
    "inclination": "inclination", "diffusion": "diffusion",
}  # fmt: skip
PLANE = (
    "Two coordinates are taken for the projection of cells that head everywhere in space: there "
    "persistence and diffusion are those of space, the speed is sqrt(3/2) times the one seen. Of "
    "cells that stay in the image (at a wall, in a film) rotational diffusion is twice as large "
    "and the speed is the one seen."
)


def found(read: Any, rows: list[Any], what: str) -> dict[str, Any]:
    """Add to each row how its cell wanders; return it for all cells together."""
    from microswim.cli._progress import bar
    from microswim.studies.identification.wandering import wandering

    with bar(f"wandering in {what}") as progress:
        for i, (row, track) in enumerate(zip(rows, read.values())):
            row["wandering"] = _plain(wandering([track]))
            progress(i + 1, len(rows))
    flat = {track.dimensions for track in read.values()}
    alike = [track for track in read.values() if track.dimensions == min(flat)]
    return _plain(wandering(alike)) | {"cells": len(alike), "dimensions": min(flat)}


def _plain(numbers: dict[str, Any]) -> dict[str, Any]:
    """Values, and their intervals beside them."""
    ends = {name: e and [e.low, e.high] for name, e in numbers.items()}
    return {name: e and e.value for name, e in numbers.items()} | {"interval_95": ends}


def columns(row: dict[str, Any]) -> dict[str, Any]:
    """Return what the table of cells holds of it; persistence by headings is there already."""
    some: Any = row.get("wandering")
    line: dict[str, Any] = {}
    for name in SHOWN if some else ():
        low, high = some["interval_95"][name] or ("", "")
        wide = f"wandering_{name}"
        line |= {wide: some[name], f"{wide}_low": low, f"{wide}_high": high}
    return line


def _read(value: float, of: str) -> str:
    """A number to read; areas in the square of micrometres, as cells are measured."""
    from microswim.gait.readable import quantity

    return f"{1e12 * value:.4g} µm^2/s" if of == "m^2/s" else quantity(value, of)


def show(rows: list[Any], whole: dict[str, Any], units: str) -> None:
    """Print a row for each cell and one for all."""
    from microswim.cli._print import print_table
    from microswim.output.report.html import Table
    from microswim.studies.identification.wandering import WANDERING

    every = [(row["track"], row["wandering"]) for row in rows]
    if len(rows) > 1:
        every.append((f"all {whole['cells']}", whole))
    lines = []
    for track, numbers in every:
        if all(numbers[name] is None for name in SHOWN):
            continue
        line = [track]
        for name in SHOWN:
            if numbers[name] is None:
                line.append("-")
                continue
            low, high = numbers["interval_95"][name]
            value, low, high = (
                _read(x, unit(units, WANDERING[name])) for x in (numbers[name], low, high)
            )
            line.append(f"{value} ({low} to {high})")
        lines.append(tuple(line))
    if not lines:
        return click.echo("no track is long enough to tell how its cell wanders")
    wanted = [0, *(k for k in range(1, len(SHOWN) + 1) if any(line[k] != "-" for line in lines))]
    head = ("track", *SHOWN.values())
    note = "In brackets the 95 % interval. " + (PLANE if whole["dimensions"] == 2 else "")
    return print_table(Table("Wandering", tuple(head[k] for k in wanted),
                      [tuple(line[k] for k in wanted) for line in lines], note))  # fmt: skip
