"""The tail that an elastic one beats as in space, and its sums over a period."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from microswim.gait.quantities import magnitude
from microswim.models.elastic.rod import integrals
from microswim.models.elastic.space import worked
from microswim.models.elastic.stroke import Stroke
from microswim.numerics.series.fourier import derivative, evaluate, series_of, trimmed
from microswim.swimmer.geometry.tails.custom_tail import CustomTail
from microswim.swimmer.geometry.tails.elastic.elastic_tail import ElasticTail

ALL = (0, 1, 2, 3, 4, 5)


@dataclass(frozen=True, eq=False)
class CentrelineInSpace:
    """Centreline from its root by the Legendre series of its tangent, each a series in the phase.

    Parameters
    ----------
    length
        Of the filament.
    tangent
        Series in the phase of the coefficients of the unit tangent, (1 + 2 H, m, 3).
    root
        Of the place of its root over the length, (1 + 2 H, 3).
    """

    length: float
    tangent: np.ndarray
    root: np.ndarray

    def __call__(self, s: Any, phase: Any) -> np.ndarray:
        """Position at s and phase, broadcast(s, phase) + (3,)."""
        s, phase = np.broadcast_arrays(np.asarray(s, float), np.asarray(phase, float))
        at, i = np.unique(s, return_inverse=True)
        when, j = np.unique(phase, return_inverse=True)
        along = integrals(at / self.length, self.tangent.shape[1])
        P = np.einsum("am,tmk->atk", along, evaluate(self.tangent, when))
        P = self.length * (P + evaluate(self.root, when))
        return P[i.reshape(s.shape), j.reshape(s.shape)]


def stroke_tail(tail: ElasticTail, beat: Stroke) -> CustomTail:
    """Return the tail that beats as an elastic one has settled to."""
    rod, shape = beat.of.rod, series_of(np.real(beat.shape))
    on = rod.weight > 0.0
    s, w = rod.s[on], rod.weight[on]
    count = len(s) - 4  # the last few are rounding
    legendre = np.polynomial.legendre.legvander(2.0 * s - 1.0, count - 1)
    project = (2.0 * np.arange(count) + 1.0)[:, None] * (legendre.T * w)
    often = 4 * len(beat.shape) + 1
    time = sense_of(tail) * 2.0 * np.pi * np.arange(often) / often
    at, _, _, moved = beat.of.seen(time, beat.state(evaluate(shape, time)))
    t = at.directors[:, on, 2]
    tangents, roots = project @ t, at.place[:, -1] + moved.place - w @ t
    series = (trimmed(series_of(x), 1e-12) for x in (tangents, roots))
    return CustomTail(
        shape=CentrelineInSpace(tail.length, *series),
        length=tail.length,
        radius=tail.radius,
        frequency=tail.frequency,
        wavelength=tail.wavelength,
        tolerance=1e-8,
        sections=tail.sections,
        surface_motion=tail.surface_motion,
    )


def sense_of(tail: ElasticTail) -> float:
    """Return whether its phase runs on or back in time, 1 or -1."""
    return float(np.sign(np.real(tail.rate)) or 1.0)


def samples_of(tail: ElasticTail, beat: Stroke) -> Callable[[int], tuple[np.ndarray, ...]]:
    """Return what gives ``B_t``, ``F_p``, G at 2 n phases, of the swimmer's own units."""
    shape = series_of(beat.shape)
    rates, sense, L = derivative(shape), sense_of(tail), tail.length
    size = magnitude(tail.rate) * L**4 / tail.bending
    lengths = np.array([1.0, 1.0, 1.0, L, L, L])

    def at(n: int) -> tuple[np.ndarray, ...]:
        time = sense * np.pi * np.arange(2 * n) / n
        R, F, G = _sums(beat, time, evaluate(shape, time), evaluate(rates, time))
        R = R * np.outer(lengths, lengths) * L / size
        return R, sense * F * lengths * L**2 / size, G * L**3 / size

    return at


def _sums(
    beat: Stroke, time: np.ndarray, q: np.ndarray, rate: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """``B_t``, ``F_p``, G at times: drag of a held body and its tail, in a stream if there is one,
    and what the tail works against it.
    """
    drag = replace(beat.of.drag, free=ALL)
    now = replace(beat.of, drag=drag).moment(time, beat.state(q))
    v, spin = now.velocity(np.concatenate([np.zeros((len(rate), len(ALL))), rate], axis=-1))
    force, torque = now.drag(v, spin)
    rigid = replace(now, turn=now.turn[..., : len(ALL)], shift=now.shift[..., : len(ALL)])
    R, F = rigid.resistance() - drag.body, worked(rigid.shift, force) + worked(rigid.turn, torque)
    F = F + now.still @ drag.body.T
    own, turning = v - now.stream, spin + now.spin[..., None, :]
    return R, F, (force * own + torque * turning).sum(axis=(-2, -1))
