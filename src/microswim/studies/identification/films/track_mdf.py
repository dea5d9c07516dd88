"""MTrackJ's own file: clusters of tracks, a point a line, in pixels and frames."""

from __future__ import annotations

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers.measured import Table


def table_of_mdf(path: str, text: str) -> Table:
    """Return the positions of an MTrackJ data file as a table.

    Parameters
    ----------
    path
        Of the file, for errors.
    text
        What it holds: ``Track 1`` and then its points, ``Point 1 x y z t channel``.

    Raises
    ------
    SpecError
        If it is none, or a point lacks its numbers.
    """
    rows: list[tuple[float, ...]] = []
    labels: list[str] = []
    cluster = track = ""
    if not text.lstrip().startswith("MTrackJ"):
        raise SpecError(f"{path}: no data file of MTrackJ; its first line says MTrackJ")
    for line in text.splitlines():
        word, *rest = line.split() or [""]
        if word == "Cluster":
            cluster = rest[0] if rest else ""
        elif word == "Track":
            track = rest[0] if rest else ""
        elif word == "Point":
            rows.append(_point(path, line, rest))
            labels.append(f"{cluster}.{track}")
    if not rows:
        raise SpecError(f"{path}: holds no tracks")
    if len({label.partition(".")[0] for label in labels}) == 1:
        labels = [label.partition(".")[2] for label in labels]
    names = ("x", "y", "z", "frame")
    units = dict.fromkeys("xyz", "px") | {"frame": None}
    numbers: dict[str, np.ndarray] = dict(zip(names, np.array(rows).T))
    return Table(path, {name: name for name in names}, units, numbers, labels, ())


def _point(path: str, line: str, rest: list[str]) -> tuple[float, ...]:
    """Numbers x, y, z and t of a point."""
    try:
        x, y, z, t = (float(cell) for cell in rest[1:5])
    except ValueError:
        raise SpecError(f"{path}: a number is missing in the row {line.strip()[:60]}") from None
    return x, y, z, t
