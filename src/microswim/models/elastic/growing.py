"""A motion at the whole of its drive, by way of smaller ones where it is too far from rest.

Near rest a tail answers in proportion to drive and load: what it would do if it always did is the
first guess, and further ones lie on the line through the last two motions found.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, Self, TypeVar

import numpy as np

STEPS, ROUNDING = 15, 1e-10  #: of Newton's method, at most, and what is left of numbers near one
LITTLE = 1e-3  #: share of drive and loads to which a tail answers in proportion


class Motion(Protocol):
    """What is sought: all its numbers about rest, and the same with so much more."""

    @property
    def motion(self) -> np.ndarray:
        """Its numbers about rest."""
        ...

    def moved(self, dz: np.ndarray, steps: int = 0) -> Self:
        """Return it with another motion, which took so many steps to find."""
        ...


M = TypeVar("M", bound=Motion)


def newton(near: M, correction: Callable[[M], np.ndarray], close: float) -> M | None:
    """Return the motion with no work left over, or None where Newton's method does not get there.

    Parameters
    ----------
    near
        Where it begins.
    correction
        Its step from a motion.
    close
        Share of the motion that the last step may have, whose square is left over.
    """
    last, lags = 2.0 * np.abs(near.motion).max() or np.inf, True
    for step in range(1, STEPS + 1):
        dz = correction(near)
        size, near = np.abs(dz).max(), near.moved(dz, step)
        if size <= close * np.abs(near.motion).max() + ROUNDING:
            if not (lags and np.iscomplexobj(dz)):
                return near
            lags = False  # an imaginary part is a step behind
        elif not size < last:
            return None
        last = size
    return None


def grown(
    at: Callable[[float], M], newton: Callable[[M, bool], M | None],
    first: Callable[[M], np.ndarray] | None, least: float,
) -> tuple[M, float]:  # fmt: skip
    """Return the motion at the largest share of the drive that was reached, and that share.

    Parameters
    ----------
    at
        At rest, with that share of drive and loads.
    newton
        What it finds from a guess, None if nothing; and whether the share is the whole.
    first
        Its first step, of a tail that answers in proportion near rest.
    least
        Share by which the drive grows at least.
    """
    rest, step = at(0.0), 1.0
    known = [(0.0, rest)]
    if first is not None:
        known.append((LITTLE, rest.moved(first(at(LITTLE)))))
    while (done := known[-1][0]) < 1.0 and step >= least:
        share = min(1.0, done + step)
        found = newton(at(share).moved(_on_from(known, share)), share == 1.0)
        if found is None:
            step /= 2.0
        else:
            known = [known[-1], (share, found)]
    return known[-1][1], done


def _on_from(known: list[tuple[float, M]], share: float) -> np.ndarray:
    """The motion at a share, on the line through those known at smaller ones."""
    (low, before), (high, last) = known[0], known[-1]
    ahead = (share - high) / (high - low) if high > low else 0.0
    return last.motion + ahead * (last.motion - before.motion)
