"""Gait of a swimmer with an elastic tail: that of the beat which its tail settles to."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from microswim import checks
from microswim.gait.gait import Gait
from microswim.models.elastic.beat import Beat, drive, settled
from microswim.models.elastic.growth import NEUTRAL, growth
from microswim.models.elastic.problem import elastic_tail, problem
from microswim.models.elastic.settled_tail import centreline, settled_tail
from microswim.models.rft.gait import (
    body_resistance,
    centreline_sums,
    series_over_period,
    with_mirror_image,
)
from microswim.numerics.fourier import add
from microswim.swimmer import physical_sense
from microswim.swimmer.swimmer import SURROUNDINGS, Swimmer


def settled_swimmer(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer with the tail that its elastic one settles to.

    Raises
    ------
    SpecError
        If its tail is not elastic, or beyond what is solved here.
    MicroswimError
        If no periodic beat is found.
    """
    return _with(swimmer, settled(problem(swimmer)))


def gait(swimmer: Swimmer, *, phases: int | None = None) -> Gait:
    """Gait of the beat that the elastic tail settles to, by resistive force theory.

    Parameters
    ----------
    swimmer
        A swimmer with an `ElasticTail`; its numbers may be complex (`Swimmer.lifted`).
    phases
        Phases over half a period at which drag is summed; enough by default.

    Returns
    -------
    Gait
        With ``model = "elastic"``; its power is what the fluid dissipates, whose mean over a
        period is the drive's. ``info``: ``sperm_number``, ``unknowns``, ``growth`` (of the slowest
        disturbance in a period), ``settles``, ``settling_periods`` (to a millionth),
        ``tip_amplitude`` and ``largest_curvature`` (times L).

    Raises
    ------
    SpecError
        If its tail is not elastic, or beyond what is solved here.
    MicroswimError
        If no periodic beat is found.
    """
    checks.count("phases", phases)
    physical_sense.require_drag(swimmer)
    beat = settled(problem(swimmer))
    about = _about(beat)
    body = body_resistance(swimmer)[None]
    series = series_over_period(lambda n: _samples(swimmer, beat, n), phases)
    made = Gait(
        add(series[0], body),
        *series[1:],
        rate=swimmer.tail.rate,
        free=swimmer.motion.mask,
        body_resistance_series=body,
        model="elastic",
        units=swimmer.units,
        info={"remarks": _remarks(swimmer, about), **about},
    )
    physical_sense.require_dissipation(swimmer, made)
    return made


def _samples(swimmer: Swimmer, beat: Beat, n: int) -> tuple[np.ndarray, ...]:
    """Samples of ``B_t``, ``F_p``, G at 2 n phases; half of them are mirror images."""
    L, rod = swimmer.tail.length, beat.rod
    at = tuple(L * x for x in centreline(beat, elastic_tail(swimmer), np.pi * np.arange(n) / n))
    at = at[0], at[1] / L, at[2]
    tip = tuple(x[:, -1:] for x in at)
    nodes = tuple(x[:, :-1] for x in at)
    return with_mirror_image(*centreline_sums(swimmer, nodes, L * rod.weight[:-1], tip))


def _with(swimmer: Swimmer, beat: Beat) -> Swimmer:
    return replace(swimmer, tail=settled_tail(elastic_tail(swimmer), beat))


def _about(beat: Beat) -> dict[str, Any]:
    factor = growth(beat)
    rod, q = beat.rod, beat.shape
    base = drive(beat.problem, beat.phases)
    tip = base.place + np.sin(base.angle[:, None] + q @ rod.shapes.T) @ rod.along[-1]
    return {
        "sperm_number": beat.problem.sperm_number,
        "unknowns": int(np.size(q) + np.size(beat.velocity)),
        "newton_steps": beat.steps,
        "growth": factor,
        "settles": bool(factor <= 1.0 + NEUTRAL),
        "settling_periods": _periods(factor),
        "tip_amplitude": float(np.abs(np.real(tip)).max()),
        "largest_curvature": float(np.abs(q @ rod.curvatures.T).max()),
    }


def _periods(factor: float) -> float | None:
    """Periods until a disturbance is a millionth of itself; None if it never is."""
    if factor <= 0.0:
        return 0.0
    return math.log(1e-6) / math.log(factor) if factor < 1.0 - NEUTRAL else None


def _remarks(swimmer: Swimmer, about: dict[str, Any]) -> list[str]:
    around = [name for name in swimmer.parts if name in SURROUNDINGS]
    found = physical_sense.remarks_on_drag(swimmer)
    found += [f"the elastic tail knows no {name}; it settles as in free space" for name in around]
    if not about["settles"]:
        found.append(
            "the tail does not settle to this beat: a small disturbance grows "
            f"{about['growth']:.3g} times in a period"
        )
    if about["largest_curvature"] * np.real(swimmer.tail.radius / swimmer.tail.length) > 0.5:
        found.append("the filament is bent to a radius below two of its own")
    if any(swimmer.motion.mask):
        found.append('held_wrench is of this beat; motion.free = "none" finds that of a held body')
    return found
