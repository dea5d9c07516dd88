"""Tables from other programs: the one reader of designs, series, tables, tracks and beats.

Comma, semicolon, tab or spaces between the cells, quoted or not; a decimal point or a decimal
comma; UTF-8 with or without its mark, UTF-16, or the Windows code page 1252. Lines that begin with
``#`` and empty lines are left out.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from os import PathLike
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers.text import LARGEST_TABLE, read_text

BLOCK = 65536  #: rows converted at a time, so that a million of them need not stand as text
SEEN = 16  #: lines that tell what stands between the cells
MISSING = {"", "nan", "na", "n/a", "none", "null", "-"}
_UNSURE = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")  # 1,234: a decimal comma or a thousand


class Rows:
    """The rows of a table as lists of texts, empty ones left out, one after the other.

    Parameters
    ----------
    path
        Of the file, for errors.
    text
        All that it holds.
    mark
        What stands between its cells.
    """

    def __init__(self, path: str | PathLike[str], text: str, mark: str) -> None:
        self.path, self._text, self._mark = path, text, mark
        self._lines = _content(text)
        self._rows = csv.reader(self._lines, delimiter=mark, skipinitialspace=mark != "\t")

    def __iter__(self) -> Iterator[list[str]]:
        return self

    def __next__(self) -> list[str]:
        try:
            for row in self._rows:
                if any(row) and (len(row) > 1 or not row[0].isspace()):
                    return row
        except csv.Error as error:
            raise SpecError(f"{self.path}: not a CSV: {error}") from None
        raise StopIteration

    def all_numbers(
        self, wanted: Sequence[int], labels: int | None
    ) -> tuple[np.ndarray, list[str]] | None:
        """Return what `columns` does of the rows that are left, at once; None where a cell is not
        a bare number, and no row is taken then.

        Parameters
        ----------
        wanted
            Indices of the columns of numbers.
        labels
            Index of the column of words, or None.
        """
        lines = self._lines
        if not isinstance(lines, io.StringIO) or self._mark == " ":
            return None
        at = lines.tell()
        rest = self._text[at:]
        if not rest.strip() or '"' in rest:
            return None
        pointed = self._mark == "," or "." in self._text
        read: dict[str, Any] = {"delimiter": self._mark, "comments": None, "encoding": None}
        try:
            numbers = np.loadtxt(
                io.StringIO(rest if pointed else rest.replace(",", ".")),
                usecols=wanted, ndmin=2, **read,
            )  # fmt: skip
            words: list[str] = []
            if labels is not None:
                words = np.loadtxt(
                    io.StringIO(rest), usecols=labels, dtype=object, ndmin=1, **read
                ).tolist()
        except ValueError:
            return None
        lines.seek(0, io.SEEK_END)
        return numbers, words


def cells(path: str | PathLike[str]) -> Rows:
    """Return the rows of a table as lists of texts, the header first.

    Raises
    ------
    SpecError
        If the file cannot be read or, once its rows are asked for, is no table.
    """
    text = read_text(path, LARGEST_TABLE, windows=True)
    first = _first(text[:BLOCK]) or _first(text)
    said = re.fullmatch(r"sep=(.)\s*", first.strip().strip('"'))  # Excel's own first line
    if said:
        text = text.partition(first)[2]
    return Rows(path, text, said[1] if said else _between(list(islice(_content(text), SEEN))))


def _first(text: str) -> str:
    return next((line for line in io.StringIO(text) if line.strip(" \t\r\n;,")), "")


def _content(text: str) -> Iterator[str]:
    lines = io.StringIO(text, newline="")
    if "#" not in text:
        return lines
    return (line for line in lines if not line.startswith("#"))


def _between(lines: list[str]) -> str:
    """What stands between the cells: as in the first line that has a mark, or spaces where none has
    and the lines below the header are numbers.
    """
    bare = [re.sub(r'"[^"]*"', "", line) for line in lines]
    marks = [next((mark for mark in "\t;," if mark in line), "") for line in bare]
    found = next(filter(None, marks), "")
    if found or len(lines) < 3:
        return found or ","
    header, *below = ([*line.split()] for line in bare[:3])
    even = len(header) > 1 and all(len(row) == len(header) for row in below)
    return " " if even and all(map(is_number, below[1])) else ","


def rows(path: str | PathLike[str]) -> list[dict[str, str]]:
    """Return the rows of a table with a header, as column to text.

    Raises
    ------
    SpecError
        If it cannot be read, has no row, a row that is not full, or a column twice.
    """
    found = cells(path)
    header = [name.strip() for name in next(found, [])]
    table = list(found)
    if not table or any(len(row) != len(header) for row in table):
        raise SpecError(f"{path}: must be a CSV with a header and full rows")
    check_header(path, header)
    return [{name: pointed(cell.strip()) for name, cell in zip(header, row)} for row in table]


def check_header(path: str | PathLike[str], header: Sequence[str], unnamed: bool = False) -> None:
    """Refuse a column without a name (unless `unnamed`) or a name that stands twice.

    Raises
    ------
    SpecError
        One sentence.
    """
    named = [name for name in header if name]
    twice = next((name for name in named if named.count(name) > 1), None)
    if twice:
        raise SpecError(
            f"{path}: must be a CSV whose columns have each their own name; {twice} stands twice"
        )
    if len(named) < len(header) and not unnamed:
        raise SpecError(f"{path}: must be a CSV whose columns have each their own name")


def pointed(cell: str) -> str:
    """Return a number or quantity with a decimal comma as one with a point, other text as it is."""
    comma = re.fullmatch(r"[+-]?\d*,\d+([eE][+-]?\d+)?(\s*[^\W\d][^,]*)?", cell)
    return cell.replace(",", ".", 1) if comma else cell


def is_number(cell: str) -> bool:
    """Return whether a cell holds a number, or nothing where one could be."""
    try:
        float(cell)
    except ValueError:
        return cell.strip().lower() in MISSING or pointed(cell.strip()) != cell.strip()
    return True


def columns(
    first: list[str], table: Rows, wanted: Sequence[int], labels: int | None
) -> tuple[np.ndarray, list[str]]:
    """Return the numbers of some columns, NaN where a cell is empty, and the words of another.

    Parameters
    ----------
    first, table
        Its first row below the header, and the others.
    wanted
        Indices of the columns of numbers.
    labels
        Index of the column of words, or None.

    Returns
    -------
    tuple
        Numbers (rows, columns) and the words, empty without `labels`.

    Raises
    ------
    SpecError
        If a cell holds something else, or commas may be decimal or group thousands.
    """
    blocks, words = [np.empty((0, len(wanted)))], []
    most, alike = max([*wanted, labels or 0]), table.all_numbers(wanted, labels)
    rows = chain([first], table)
    while block := list(islice(rows, BLOCK)):
        block = [row if len(row) > most else row + [""] * (most + 1 - len(row)) for row in block]
        blocks.append(np.stack([_numbers(table.path, block, i) for i in wanted], axis=-1))
        words += [] if labels is None else [row[labels] for row in block]
    if alike is not None:
        blocks.append(alike[0])
        words += alike[1]
    return np.concatenate(blocks), words


def _numbers(path: str | PathLike[str], block: list[list[str]], i: int) -> np.ndarray:
    column = [row[i] for row in block]
    try:
        return np.fromiter(map(float, column), float, len(column))
    except ValueError:
        pass
    commas = [cell.strip() for cell in column if "," in cell]
    if commas and all(map(_UNSURE.fullmatch, commas)) and _has_points(block):
        raise SpecError(
            f"{path}: {commas[0]} may hold a decimal comma or a thousand; write it with a point"
        )
    return np.array([_number(path, row, i) for row in block])


def _has_points(block: list[list[str]]) -> bool:
    """Whether some cells of a table have a decimal point."""
    return any(re.fullmatch(r"[+-]?\d*\.\d+", cell.strip()) for row in block[:64] for cell in row)


def _number(path: str | PathLike[str], row: list[str], i: int) -> float:
    cell = row[i].strip()
    if cell.lower() in MISSING:
        return math.nan
    try:
        return float(pointed(cell))
    except ValueError:
        raise SpecError(f"{path}: a number is missing in the row {', '.join(row)[:60]}") from None
