"""Tracks of many cells from the files of other programs: TrackMate, trackpy, plain tables.

A camera gives pixels and frames. They become lengths and times only by what the file says (a unit
in its header) or the user (`pixel`, `fps`); what neither says is asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError, nearest
from microswim.spec.readers import film, measured
from microswim.spec.readers.measured import Table
from microswim.spec.readers.text import LARGEST_TABLE, read_text
from microswim.studies.identification.films.track import FEWEST, Track, scattered
from microswim.studies.identification.films.track_mdf import table_of_mdf
from microswim.studies.identification.films.track_xml import table_of_xml

#: What a column may be called, in lower case.
KNOWN = {
    "time": film.TIME, "frame": film.FRAMES,
    "x": film.axis("x"), "y": film.axis("y"), "z": film.axis("z"),
    "w": ("w", "qw"), "i": ("i", "qx"), "j": ("j", "qy"), "k": ("k", "qz"),
    "track": film.TRACKS,
}  # fmt: skip
ATTITUDE = ("w", "i", "j", "k")


@dataclass(frozen=True, eq=False)
class Tracks(Mapping[str, Track]):
    r"""The tracks of a file, by the name that each has there.

    Parameters
    ----------
    tracks
        Name to track.
    left_out
        Name of each track that is none, to why.
    ignored
        Columns of the file that were not used.
    remarks
        What was noticed on the way, a sentence each.
    units
        ``"SI"`` or ``"dimensionless"``.

    Examples
    --------
    >>> import tempfile, microswim as ms
    >>> from pathlib import Path
    >>> lines = "frame,x (um),y (um),particle\n" + "".join(
    ...     f"{i},{0.5 * i},0,{p}\n" for i in range(20) for p in (3, 8))
    >>> file = Path(tempfile.mkdtemp()) / "cells.csv"
    >>> _ = file.write_text(lines)
    >>> tracks = ms.read_tracks(file, fps=25)
    >>> list(tracks), round(tracks["8"].speed * 1e6, 3)
    (['3', '8'], 12.5)
    """

    tracks: dict[str, Track]
    left_out: dict[str, str]
    ignored: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    units: str = "SI"

    def __getitem__(self, name: str) -> Track:
        return self.tracks[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.tracks)

    def __len__(self) -> int:
        return len(self.tracks)


def read_tracks(
    path: str | PathLike[str],
    *,
    units: str = "SI",
    pixel: Any = None,
    fps: Any = None,
    track: Any = None,
) -> Tracks:
    r"""Read the tracks of one or many cells from a file of another program.

    Parameters
    ----------
    path
        A table with the columns x, y and, if known, z, of positions; time or frame; the track's
        name if there are several (CSV of TrackMate or trackpy, or any of that kind; comma,
        semicolon, tab or spaces, decimal comma); the XML of TrackMate or Icy, the MDF of MTrackJ.
        Units in the header, ``x (um)``.
    units
        ``"SI"``, or ``"dimensionless"`` for bare numbers in the units of a swimmer without.
    pixel
        Size of a pixel, ``"0.11um"`` or metres, where the file has pixels or names no unit.
    fps
        Frames per second, where the file counts frames; it also overrules times.
    track
        Name or names of the tracks that are wanted; all by default.

    Returns
    -------
    Tracks

    Raises
    ------
    SpecError
        If the file is none, or what it lacks is not given: the sentence asks for it.

    Examples
    --------
    >>> import tempfile, microswim as ms
    >>> from pathlib import Path
    >>> lines = "time (s);x (px);y (px)\n" + "".join(f"{i},0;{i},5;2\n" for i in range(20))
    >>> file = Path(tempfile.mkdtemp()) / "cell.csv"
    >>> _ = file.write_text(lines)
    >>> round(float(ms.read_tracks(file, pixel="0.11um")["0"].position[1, 0]) * 1e6, 3)
    0.165
    """
    checks.place("path", path)
    checks.choice("units", units, ("SI", "dimensionless"))
    pixel_size = film.given("--pixel", pixel, "length", units)
    rate = film.given("--fps", fps, "frequency", units)
    table = _table(path)
    position, remarks = _positions(table, units, pixel_size)
    time, said = film.times(table, units, rate)
    attitude = None
    if all(name in table.numbers for name in ATTITUDE):
        attitude = np.stack([table.numbers[name] for name in ATTITUDE], axis=-1)
    wanted = None if track is None else {str(t) for t in np.atleast_1d(track).tolist()}
    found, left_out, again = _split(table, time, position, attitude, wanted)
    if not found and left_out:
        name, why = next(iter(left_out.items()))
        raise SpecError(f"{table.path}: " + (f"track {name}: {why}" if table.labels else why))
    return Tracks(found, left_out, table.left_out, remarks + said + again, units)


def _table(path: str | PathLike[str]) -> Table:
    for end, reader in ((".xml", table_of_xml), (".mdf", table_of_mdf)):
        if str(path).lower().endswith(end):
            return reader(str(path), read_text(path, LARGEST_TABLE))
    if not Path(path).is_file():
        read_text(path, LARGEST_TABLE)  # says what it is
    table = measured.read(path, KNOWN, ("x", "y"), "track")
    each = table.titles.get("track", "").lower() == "id" and len(set(table.labels)) > 1
    if each and len(set(table.labels)) == len(table.labels):  # names its points, no tracks
        return replace(table, labels=[], left_out=(*table.left_out, table.titles["track"]))
    return table


def _positions(table: Table, units: str, pixel: float | None) -> tuple[np.ndarray, tuple[str, ...]]:
    """Positions in the swimmer's units, and what is said of them."""
    axes = [name for name in ("x", "y", "z") if name in table.numbers]
    columns = [film.lengths(table, name, units, pixel) for name in axes]
    flat = len(axes) == 3 and np.nanstd(columns[2]) == 0
    remarks = ("z is the same everywhere: the tracks are taken as 2-D",) if flat else ()
    return np.stack(columns[: 2 if flat else 3], axis=-1), remarks


def _split(
    table: Table,
    time: np.ndarray,
    position: np.ndarray,
    attitude: np.ndarray | None,
    wanted: set[str] | None,
) -> tuple[dict[str, Track], dict[str, str], tuple[str, ...]]:
    """One track for each name; what is no track with why; and what is said. Rows with a hole or
    that stand twice are left out.
    """
    whole = np.isfinite(time) & np.isfinite(position).all(axis=1)
    if attitude is not None:
        whole &= np.isfinite(attitude).all(axis=1)
    labels = table.labels or ["0"] * time.size
    names = {label: _name(label) for label in dict.fromkeys(labels)}
    known = {name: code for code, name in enumerate(dict.fromkeys(names.values()))}
    code_of = {label: known[name] for label, name in names.items()}
    codes = np.array([code_of[label] for label in labels], dtype=np.int64)
    known_names = [name for name in known if name]
    missing = sorted((wanted or set()) - set(known_names))
    if missing:
        raise SpecError("--track", missing[0], "a track of the file", nearest(missing[0], known))
    order = np.lexsort((time, codes))
    order = order[whole[order]]
    twice = _twice(codes[order], time[order], position[order])
    order = order[~twice]
    ends = np.searchsorted(codes[order], np.arange(len(known) + 1))
    tracks: dict[str, Track] = {}
    left_out: dict[str, str] = {}
    for name in sorted(known_names, key=_by_number):
        if wanted is not None and name not in wanted:
            continue
        here = order[ends[known[name]] : ends[known[name] + 1]]
        why = _no_track(time[here])
        if why:
            left_out[name] = why
            continue
        q = None if attitude is None else attitude[here]
        tracks[name] = Track(time=time[here], position=position[here], quaternion=q)
    count = np.count_nonzero(twice)
    again = f"{count} {'row stands' if count == 1 else 'rows stand'} twice, each is taken once"
    return tracks, left_out, (again,) if count else ()


def _twice(codes: np.ndarray, time: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Whether a row says the time and place of the one before it, of the same track."""
    same = (np.diff(codes) == 0) & (np.diff(time) == 0) & (np.diff(position, axis=0) == 0).all(1)
    return np.concatenate([[False], same])[: len(codes)]


def _no_track(time: np.ndarray) -> str:
    """Why rows are no track, or nothing."""
    if time.size < FEWEST:
        return f"{time.size} positions; a track has at least {FEWEST}"
    again = np.flatnonzero(np.diff(time) <= 0)
    if again.size:
        return (
            f"two positions at time {time[again[0]]:g}: it splits or merges, or is several tracks "
            "without their names"
        )
    return scattered(time)


def _name(label: str) -> str:
    word = label.strip()
    if word.lower() in ("none", "nan"):
        return ""
    return word[:-2] if word.endswith(".0") else word


def _by_number(name: str) -> tuple[float, str]:
    try:
        return float(name), name
    except ValueError:
        return float("inf"), name
