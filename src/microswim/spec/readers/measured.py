"""Columns that measure something: names, units in the header, and what a unit makes of numbers.

A unit stands in the title, ``x (um)``, ``x [um]``, ``x_um``, or in a row of its own below it.
Pixels and frames are units of what a camera gives: no length and no time until it is said how large
and how fast they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from os import PathLike

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers.delimited import cells, check_header, columns, is_number
from microswim.spec.units import DIMENSIONS, to_si

PIXEL, FRAME = "px", "frame"
BEFORE = 12  #: rows among which the header is looked for
_PIXELS = {"px", "pixel", "pixels", "pix"}
_FRAMES = {"frame", "frames"}
#: Units as programs of other languages write them out.
WORDS = {
    "s": ("sekunde", "sekunden", "sek", "seconde", "secondes", "segundo", "segundos", "secondo",
          "secondi"),
    "ms": ("millisekunde", "millisekunden", "millisecondes", "milisegundos", "millisecondi"),
    "min": ("minute", "minuten", "minuto", "minutos", "minuti"),
    "um": ("mikrometer", "mikron", "micromètre", "micromètres", "micrómetro", "micrómetros",
           "micrometro", "micrometros", "micrometri"),
    "mm": ("millimètre", "millimètres", "milímetro", "milímetros", "millimetro", "millimetri"),
}  # fmt: skip
_BETWEEN = str.maketrans("", "", " _-")
_UNIT_OF = {word: unit for unit, words in WORDS.items() for word in words}
#: x (um), x [um], x / um, x in um
_TITLE = re.compile(
    r"(?P<name>[^(\[/]*?)\s*(?:\((?P<a>[^)]*)\)|\[(?P<b>[^\]]*)\]|/\s*(?P<c>.+)"
    r"|(?:\bin|\ben|,)\s+(?P<d>\S+))\s*"
)


@dataclass(frozen=True)
class Table:
    """A table with the columns that were known.

    Parameters
    ----------
    path
        Of the file.
    titles
        Title of each known column as it stands in the file.
    units
        Unit of each, None where none is said.
    numbers
        Numbers of each, NaN where a cell is empty.
    labels
        Texts of the column of labels, empty if there is none.
    left_out
        Titles of the columns that were not known.
    """

    path: str
    titles: dict[str, str]
    units: dict[str, str | None]
    numbers: dict[str, np.ndarray]
    labels: list[str]
    left_out: tuple[str, ...]


def read(
    path: str | PathLike[str],
    known: Mapping[str, tuple[str, ...]],
    needed: tuple[str, ...],
    label: str = "",
) -> Table:
    """Return the known columns of a table.

    Parameters
    ----------
    path
        Of the file.
    known
        Name of a column to the titles that it may have, in lower case, without unit.
    needed
        Columns without which it is none.
    label
        Name of the column that holds labels and not numbers.

    Raises
    ------
    SpecError
        One sentence: no table, no such column, a column twice, a cell that is no number.
    """
    table = cells(path)
    titles = _header(path, table, known, needed)
    check_header(path, titles, unnamed=True)
    places, units = _known(path, titles, known)
    missing = [name for name in needed if name not in places]
    if missing:
        there = ", ".join(title for title in titles if title)[:80]
        raise SpecError(f"{path}: no column {missing[0]}; it has {there}")
    first: list[str] = []
    for row in table:
        if all(is_number(cell) for cell in (row[i] for i in _of(places, needed) if i < len(row))):
            first = row
            break
        units |= {n: u for n, u in _row_of_units(path, row, places, needed).items() if u}
    if not first:
        raise SpecError(f"{path}: no rows below its header")
    units = _own_column(titles, first, needed) | {n: u for n, u in units.items() if u}
    wanted = [name for name in places if name != label]
    numbers, labels = columns(first, table, [places[n] for n in wanted], places.get(label))
    return Table(
        path=str(path),
        titles={name: titles[i] for name, i in places.items()},
        units={name: units.get(name) for name in places},
        numbers=dict(zip(wanted, numbers.T)),
        labels=labels,
        left_out=tuple(t for i, t in enumerate(titles) if t and i not in places.values()),
    )


def _header(
    path: str | PathLike[str],
    table: Iterator[list[str]],
    known: Mapping[str, tuple[str, ...]],
    needed: tuple[str, ...],
) -> list[str]:
    """Titles: the first of a few rows that has the columns, some programs say words before; the
    first row where none has them.
    """
    begun: list[list[str]] = []
    for row in islice(table, BEFORE):
        titles = [title.strip().strip("\ufeff") for title in row]
        begun.append(titles)
        if set(needed) <= {name_of(title, known) for title in titles}:
            return titles
    if not begun:
        raise SpecError(f"{path}: no rows; the file is empty")
    return begun[0]


def _own_column(
    titles: list[str], first: list[str], needed: tuple[str, ...]
) -> dict[str, str | None]:
    """Unit of the columns that are needed where a column of its own says it, as Imaris does."""
    places = [i for i, title in enumerate(titles) if title.lower() in ("unit", "units")]
    said = first[places[0]].strip() if len(places) == 1 and places[0] < len(first) else ""
    return dict.fromkeys((*needed, "z"), said) if _is_unit(said) else {}


def _of(places: dict[str, int], names: tuple[str, ...]) -> list[int]:
    return [places[name] for name in names]


def _known(
    path: str | PathLike[str], titles: list[str], known: Mapping[str, tuple[str, ...]]
) -> tuple[dict[str, int], dict[str, str | None]]:
    """Index and unit of each known column; the first title of `known` that is there wins."""
    parts = [_parts(title, known) for title in titles]
    places: dict[str, int] = {}
    for name, words in known.items():
        for word in words:
            here = [i for i, (title, _) in enumerate(parts) if title == bare(word)]
            if len(here) > 1:
                raise SpecError(
                    f"{path}: {titles[here[0]]} and {titles[here[1]]} are one column; remove one"
                )
            if here:
                places[name] = here[0]
                break
    if "time" in known and not {"time", "frame"} & set(places):
        timed = [i for i, (_, unit) in enumerate(parts) if _is_time(unit)]
        if len(timed) == 1:  # whatever it is called
            places["time"] = timed[0]
    return places, {name: parts[i][1] for name, i in places.items()}


def name_of(title: str, known: Mapping[str, tuple[str, ...]]) -> str:
    """Return the name that a title means, empty if it is not known."""
    word = _parts(title.strip().strip("\ufeff"), known)[0]
    return next((name for name, words in known.items() if word in map(bare, words)), "")


def bare(word: str) -> str:
    """Return a title as it is compared: Cell ID, cell_id and cellID are one.

    Examples
    --------
    >>> bare("Cell ID"), bare("pos-X")
    ('cellid', 'posx')
    """
    return word.lower().translate(_BETWEEN)


def _parts(title: str, known: Mapping[str, tuple[str, ...]]) -> tuple[str, str | None]:
    """Bare name and unit of a title."""
    words = {bare(word) for words in known.values() for word in words}
    match = _TITLE.fullmatch(title)
    if match:
        unit = next(match[k] for k in "abcd" if match[k] is not None)
        return bare(match["name"].strip()), unit.strip() or None
    name, _, unit = title.rpartition("_")
    if bare(title) not in words and bare(name) in words:
        return bare(name), None if unit.isdigit() else unit
    return bare(title), None


def _row_of_units(
    path: str | PathLike[str], row: list[str], places: dict[str, int], needed: tuple[str, ...]
) -> dict[str, str | None]:
    """Units that a row below the titles says, empty where it says other words."""
    found = {n: row[i].strip().strip("()[] ") for n, i in places.items() if i < len(row)}
    if any(_is_unit(found.get(name, "")) for name in needed):
        return {n: u or None for n, u in found.items()}
    if sum(c.isalpha() for cell in row for c in cell) == 0 or not _is_titles(found):
        raise SpecError(f"{path}: a number is missing in the row {', '.join(row)[:60]}")
    return {}


def _is_titles(found: dict[str, str]) -> bool:
    """Whether a row says the titles once more, as TrackMate does: X under POSITION_X."""
    return found.get("x", "").lower() in ("x", "x position", "position x")


def _is_time(unit: str | None) -> bool:
    """Whether a unit is one of time."""
    try:
        to_si(f"1 {plain(unit)}", "s")
    except ValueError:
        return False
    return unit is not None


def _is_unit(text: str) -> bool:
    if text.lower() in _PIXELS | _FRAMES:
        return True
    try:
        to_si(f"1 {plain(text)}", "m")
    except ValueError:
        return False
    return bool(text)


def plain(unit: str | None) -> str | None:
    """Return a unit as we write it: one word for pixels, one for frames.

    Examples
    --------
    >>> plain("pixels"), plain("µm"), plain(None)
    ('px', 'µm', None)
    """
    if unit is None:
        return None
    word = unit.strip().replace("\\u00b5", "µ").replace("\\u00B5", "µ")
    if word.lower() in _PIXELS:
        return PIXEL
    return FRAME if word.lower() in _FRAMES else _UNIT_OF.get(word.lower(), word)


def factor(table: Table, name: str, dimension: str, units: str, mend: str) -> float:
    """Return what the numbers of a column are multiplied by, in units of the swimmer.

    Parameters
    ----------
    table
        Where the column stands.
    name
        Of the column.
    dimension
        What it measures: ``"length"``, ``"time"``, ``"angle"``.
    units
        ``"SI"`` or ``"dimensionless"``: whether the numbers of the swimmer have units.
    mend
        What to give where the file does not tell.

    Raises
    ------
    SpecError
        If the unit is missing, is no unit of that dimension, or the swimmer has none.
    """
    unit, title = plain(table.units[name]), table.titles[name]
    if units != "SI" and unit is not None and dimension != "angle":
        raise SpecError(
            f"{table.path}: the column {title} has a unit and the swimmer has none; "
            "give both units or neither"
        )
    if unit is None and dimension != "angle" and units == "SI":
        raise SpecError(f"{table.path}: {title} has no unit; {mend}")
    if unit is None:
        return 1.0
    try:
        return to_si(f"1 {unit}", "s" if dimension == "time" else DIMENSIONS[dimension].si)
    except ValueError as error:
        raise SpecError(f"{table.path}: column {title} {error}") from None
