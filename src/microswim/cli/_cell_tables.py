"""The tables that ``microswim identify`` writes: a line for each cell, and for each lag."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from microswim.cli import _wandering
from microswim.numerics.files import fresh


def flat(rows: list[Any]) -> list[dict[str, Any]]:
    """Return a line of the table for each cell: every number with the ends of its interval."""
    from microswim.studies.identification.without_model import NUMBERS

    lines = []
    for row in rows:
        line = {k: row[k] for k in ("track", "positions", "duration", "frame_rate", "noise")}
        for name in NUMBERS:
            low, high = row["interval_95"][name] or ("", "")
            line |= {name: row[name], f"{name}_low": low, f"{name}_high": high}
        line |= _wandering.columns(row)
        lines.append(line | {"notes": "; ".join(row["notes"])})
    return lines


def values(row: dict[str, Any]) -> dict[str, Any]:
    """Return the line of a cell that was fitted: each value with the ends of its interval."""
    line = {"track": row["track"], "residual": row.get("residual", "")}
    line["designs"] = len(row.get("branches", ())) or ""
    for name, value in row.get("values", {}).items():
        low, high = row["interval_95"][name]
        line |= {name: value, f"{name}_low": low, f"{name}_high": high}
    return line | {"notes": "; ".join(row.get("warnings", ()))}


def lags(rows: list[Any]) -> list[dict[str, Any]]:
    """Return a line for each lag of each cell."""
    lines = []
    for row in rows:
        found = row["mean_squared_displacement"]
        for lag, value, low, high in zip(*(found[k] for k in ("lag", "value", "low", "high"))):
            lines.append({"track": row["track"], "lag": lag, "mean_squared_displacement": value,
                          "low": low, "high": high})  # fmt: skip
    return lines


def write(path: Path, lines: list[dict[str, Any]]) -> None:
    """Write lines as CSV, whole or not at all."""
    header = list(dict.fromkeys(name for line in lines for name in line))
    with fresh(path) as scratch, scratch.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, header, restval="")
        writer.writeheader()
        writer.writerows(lines)
