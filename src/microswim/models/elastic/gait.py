"""Gait of a swimmer with an elastic tail: that of the motion which its tail settles to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from microswim import checks
from microswim.gait.gait import Gait
from microswim.models.elastic import findings
from microswim.models.elastic.beat import Beat, settled
from microswim.models.elastic.problem import elastic_tail, problem
from microswim.models.elastic.settled_tail import centreline, settled_tail
from microswim.models.elastic.stroke import stroke
from microswim.models.elastic.stroke_tail import samples_of, stroke_tail
from microswim.models.elastic.whirl import whirl
from microswim.models.elastic.whirled_tail import whirled_centreline, whirled_tail
from microswim.models.rft.gait import (
    body_resistance,
    centreline_sums,
    series_over_period,
    with_mirror_image,
)
from microswim.numerics.series.fourier import add, rotate
from microswim.swimmer import physical_sense
from microswim.swimmer.geometry.tails.elastic.elastic_tail import SIZE
from microswim.swimmer.swimmer import SURROUNDINGS, Swimmer

#: What is said of how a motion is left; else how often the disturbance turns.
LEFT = {
    "to one side": "",
    "period-doubles": " and changes its side in each: it period-doubles",
}


@threadpool_limits.wrap(limits=1)  # small matrices
def settled_swimmer(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer with the tail that its elastic one settles to.

    Raises
    ------
    SpecError
        If its tail is not elastic, or beyond what is solved here.
    MicroswimError
        If it settles to nothing periodic.
    """
    tail = elastic_tail(swimmer)
    if in_space(swimmer):
        return replace(swimmer, tail=stroke_tail(tail, stroke(swimmer)), hook=None)
    if tail.turns:
        return replace(swimmer, tail=whirled_tail(tail, whirl(swimmer)), hook=None)
    return replace(swimmer, tail=settled_tail(tail, settled(problem(swimmer))), hook=None)


@threadpool_limits.wrap(limits=1)
def gait(swimmer: Swimmer, *, phases: int | None = None) -> Gait:
    """Return the gait of the motion that the elastic tail settles to, by resistive force theory.

    Parameters
    ----------
    swimmer
        A swimmer with an `ElasticTail`; its numbers may be complex (see `swimmer.fields.lifted`).
    phases
        Phases over half a period at which the drag of a beat is summed; enough by default.

    Returns
    -------
    Gait
        With ``model = "elastic"``; its power is what the fluid dissipates, whose mean over a
        period is the drive's. ``info``: ``sperm_number``, ``unknowns``, ``growth`` (of the slowest
        disturbance in a period), ``settles`` (and, if not, ``leaves``: to one side, period-doubles,
        or turns once in so many periods), ``settling_periods`` (to a millionth),
        ``tip_amplitude`` and ``largest_curvature`` (times L).

    Raises
    ------
    SpecError
        If its tail is not elastic, or beyond what is solved here.
    MicroswimError
        If it settles to nothing periodic.
    """
    checks.count("phases", phases)
    physical_sense.require_drag(swimmer)
    series, about = _sums(swimmer)(swimmer, phases)
    body = body_resistance(swimmer)[None]
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


def in_space(swimmer: Swimmer) -> bool:
    """Return whether the tail beats in space: bent out of its plane at rest, or under loads."""
    tail = elastic_tail(swimmer)
    if not (tail.drive in SIZE and tail.rate):
        return False
    rest = None if tail.turns else tail.rest_shape
    return bool(loads_on(swimmer)) or not (rest is None or rest.is_planar)


def loads_on(swimmer: Swimmer) -> list[str]:
    """Return what pulls at the tail of a swimmer that is held in one place."""
    if any(swimmer.motion.mask):
        return []
    return [name for name in ("gravity", "flow", "wall") if getattr(swimmer, name) is not None]


def _sums(swimmer: Swimmer) -> Callable[[Swimmer, int | None], tuple[tuple[np.ndarray, ...], dict]]:
    if in_space(swimmer):
        return _in_space
    return _turning if elastic_tail(swimmer).turns else _beating


def _in_space(swimmer: Swimmer, phases: int | None) -> tuple[tuple[np.ndarray, ...], dict]:
    beat = stroke(swimmer)
    series = series_over_period(samples_of(elastic_tail(swimmer), beat), phases)
    return series, findings.of_stroke(beat)


def _beating(swimmer: Swimmer, phases: int | None) -> tuple[tuple[np.ndarray, ...], dict]:
    beat = settled(problem(swimmer))
    series = series_over_period(lambda n: _samples(swimmer, beat, n), phases)
    return series, findings.of_beat(beat)


def _turning(swimmer: Swimmer, phases: int | None) -> tuple[tuple[np.ndarray, ...], dict]:
    found = whirl(swimmer)
    R, F, G = _summed(swimmer, *whirled_centreline(found))
    series = rotate(R[0], swimmer.tail.sign), rotate(F[0], swimmer.tail.sign), G
    return series, findings.of_whirl(found)


def _samples(swimmer: Swimmer, beat: Beat, n: int) -> tuple[np.ndarray, ...]:
    """Samples of ``B_t``, ``F_p``, G at 2 n phases; half of them may be mirror images."""
    half, mirrors = np.pi * np.arange(2 * n) / n, beat.problem.mirrors
    at = centreline(beat, elastic_tail(swimmer), half[:n] if mirrors else half)
    sums = _summed(swimmer, at, beat.rod.weight)
    return with_mirror_image(*sums) if mirrors else sums


def _summed(
    swimmer: Swimmer, at: tuple[np.ndarray, ...], weight: np.ndarray
) -> tuple[np.ndarray, ...]:
    """``B_t``, ``F_p``, G from places over L at the rod's nodes, the last of which is its tip."""
    L = swimmer.tail.length
    P, slope, U = at
    at = L * P, slope, L * U
    nodes, tip = tuple(x[:, :-1] for x in at), tuple(x[:, -1:] for x in at)
    return centreline_sums(swimmer, nodes, L * weight[:-1], tip)


def _remarks(swimmer: Swimmer, about: dict[str, Any]) -> list[str]:
    around = [name for name in swimmer.parts if name in SURROUNDINGS]
    found = list(swimmer.remarks_on_drag)
    held = loads_on(swimmer) if in_space(swimmer) else []
    found += [
        f"the elastic tail knows no {name}; it settles as in free space"
        for name in around
        if name not in held
    ]
    if held:
        found.append(
            f"the tail settles under its {' and '.join(held)}; the wrench is the drag of the fluid "
            "alone, and the power is the drive's"
        )
    if elastic_tail(swimmer).drive == "none":
        acting = [name for name in ("field", "gravity", "flow") if getattr(swimmer, name)]
        turned = getattr(swimmer.field, "kind", "") == "rotating"
        found.append(
            "nothing drives the base of the tail, which is at rest here"
            + (f"; microswim path follows it under its {' and '.join(acting)}" if acting else "")
            + ("; microswim regimes tells how it turns with it" if turned else "")
        )
    if not about["settles"]:
        found.append(
            "the tail does not settle to this motion: a small disturbance grows "
            f"{about['growth']:.3g} times in a period"
            + LEFT.get(about["leaves"], f" and {about['leaves']}")
        )
    if about["largest_curvature"] * np.real(swimmer.tail.radius / swimmer.tail.length) > 0.5:
        found.append("the filament is bent to a radius below two of its own")
    if any(swimmer.motion.mask):
        found.append('held_wrench is of this beat; motion.free = "none" finds that of a held body')
    return found
