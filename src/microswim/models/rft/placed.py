"""Tails that stand anywhere, one or several: what each has in its own frame, moved and added.

    B_t = sum_i Ad_i B_i(phase_i) Ad_i',    F_p = sum_i k_i Ad_i F_i(phase_i)
    phase_i = k_i phase + ahead_i,          G = sum_i k_i^2 G_i(phase_i)

with the pace k of each and Ad of `swimmer.geometry.tails.placement`. Resistive force theory is
local: a tail drags and thrusts the same wherever it stands, and tails do not feel one another.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np

from microswim.numerics.series.fourier import add, of_multiple, shifted
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.parts import replaced
from microswim.swimmer.swimmer import Swimmer

Series = tuple[np.ndarray, ...]


def sum_over_tails(swimmer: Swimmer, own: Callable[[Swimmer], Series]) -> Series:
    """Return series of ``B_t``, ``F_p``, G of all tails about the body's centre.

    Parameters
    ----------
    swimmer
        With one or several tails.
    own
        The three of a swimmer whose tail stands at the joint.
    """
    each = [moved(own(replaced(swimmer, "tail", t.own)), swimmer, t) for t in swimmer.tail.each]
    R, F, G = (reduce(add, parts) for parts in zip(*each))
    return R, F, G


def at_own_rates(tail: Tail) -> tuple[Tail, ...]:
    """Return the single tails, the phase of each its own."""
    return tuple(replaced(one, "frequency", one.frequency) for one in tail.each)


def moved(own: Series, swimmer: Swimmer, tail: Tail, ahead: Any = None) -> Series:
    """Return the series of a tail in its own frame, moved to its place and to its own phase.

    `ahead` stands for its own where it is given.
    """
    ahead = tail.ahead if ahead is None else ahead
    R, F, G = (of_multiple(shifted(series, ahead), tail.beats) for series in own)
    centre = swimmer.body.centre
    Ad = tail.placement.adjoint(centre, centre)
    return Ad @ R @ Ad.T, tail.pace * F @ Ad.T, tail.pace**2 * G


def remarks_on(tail: Tail) -> list[str]:
    """Return what is to be said of several tails."""
    if len(tail.each) < 2:
        return []
    return ["the tails' flows do not meet in this model: each drags as if alone; bem knows better"]
