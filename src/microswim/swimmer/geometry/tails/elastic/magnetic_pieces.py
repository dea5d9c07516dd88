"""The magnetic pieces of a filament: the whole of it, its head, links, or a chain of beads.

A piece of volume ``V = pi r_t^2 l`` has a moment of its own, which turns with it, and one that a
field B makes in it, ``m = (chi_t t t' + chi_n (I - t t')) V B / mu_0``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError

MOST = 500  #: pieces
PAIR = "two fractions of the length, [0, 0.3], or such a pair for each piece"
TRIPLE = "three numbers [s, q, r], or such three for each piece of magnet_span"


@dataclass(frozen=True)
class Piece:
    """A piece of a filament from `first` to `last` of its length, and the moment of it all."""

    first: float
    last: float
    moment: tuple[float, float, float]


def spans(given: Any) -> tuple[Any, ...]:
    """Return the pair that says where a filament is magnetic, or one for each piece.

    Raises
    ------
    SpecError
        If a pair does not rise, or two overlap.
    """
    rows = _rows("tail.magnet_span", given, 2, PAIR)
    flat = np.array(rows).ravel()
    if flat[0] < 0.0 or flat[-1] > 1.0 or (np.diff(flat) < 0.0).any():
        raise SpecError("tail.magnet_span", given, "rising, from 0 to 1")
    if any(first == last for first, last in rows):
        raise SpecError("tail.magnet_span", given, "rising: a piece has a length")
    return rows if np.ndim(given) == 2 else rows[0]


def moments(given: Any, pieces: int) -> tuple[Any, ...]:
    """Return the moment of the filament, or one for each of its pieces.

    Raises
    ------
    SpecError
        If it is none, or there are more or fewer than pieces.
    """
    rows = _rows("tail.magnet", given, 3, TRIPLE)
    if np.ndim(given) == 1:
        return rows[0]
    if len(rows) != pieces:
        raise SpecError("tail.magnet", f"{len(rows)} moments", f"one, or one for each of the "
                        f"{pieces} pieces in tail.magnet_span")  # fmt: skip
    return rows


def pieces(magnet: Any, span: Any) -> list[Piece]:
    """Return the pieces of a filament; a moment of them all is shared by their lengths."""
    each = [span] if np.ndim(span) == 1 else list(span)
    whole = sum(last - first for first, last in each)
    if np.ndim(magnet) == 2:
        return [Piece(a, b, moment) for (a, b), moment in zip(each, magnet)]
    own = np.zeros(3) if magnet is None else np.array(magnet)
    return [Piece(a, b, tuple((own * ((b - a) / whole)).tolist())) for a, b in each]


def _rows(field: str, given: Any, count: int, allowed: str) -> tuple[Any, ...]:
    """Rows of so many finite numbers, of a single one or of several."""
    several = isinstance(given, (list, tuple, np.ndarray)) and len(given) and np.ndim(given[0]) == 1
    rows = list(given) if several else [given]
    if len(rows) > MOST:
        raise SpecError(field, f"{len(rows)} pieces", f"at most {MOST}")
    for i, row in enumerate(rows):
        checks.numbers(f"{field}[{i}]" if several else field, row, count, allowed)
    return tuple(tuple(map(float, row)) for row in rows)
