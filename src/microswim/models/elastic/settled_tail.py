"""The tail that an elastic one settles to: a shape given at every phase, like any other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim.models.elastic.beat import Beat, drive
from microswim.models.elastic.rod import integrals
from microswim.numerics.quadrature import gauss
from microswim.numerics.series.fourier import MIRROR_Q, derivative, evaluate, series_of, trimmed
from microswim.swimmer.geometry.tails.custom_tail import CustomTail
from microswim.swimmer.geometry.tails.elastic.elastic_tail import ElasticTail


@dataclass(frozen=True, eq=False)
class Centreline:
    """Centreline ``P(s, phase)`` by the series of its curvature in s and in phase.

    Parameters
    ----------
    length
        Of the filament.
    angles
        Series in the phase of the tangent angle's coordinates: at the joint, then of ``Phi_k``;
        (1 + 2 H, 1 + n).
    place
        Series of the joint's place across s over the length, (1 + 2 H,).
    tilt
        Angle of the root at rest.
    arm
        From the joint to the root at rest, along s and q over the length, (2,).
    """

    length: float
    angles: np.ndarray
    place: np.ndarray
    tilt: float = 0.0
    arm: tuple[float, float] = (0.0, 0.0)

    def __call__(self, s: Any, phase: Any) -> np.ndarray:
        """Position at s and phase, broadcast(s, phase) + (3,)."""
        s, phase = np.broadcast_arrays(np.asarray(s, float), np.asarray(phase, float))
        at, i = np.unique(s, return_inverse=True)
        when, j = np.unique(phase, return_inverse=True)
        i, j = i.reshape(s.shape), j.reshape(s.shape)
        q = evaluate(self.angles, when)
        x, w = gauss(2 * q.shape[1] + 8)
        # P(s) = int_0^s (cos theta, sin theta), by nodes of its own on each [0, s]
        shapes = shapes_at((at[:, None] / self.length * x).ravel(), q.shape[1])
        theta = self.tilt + (shapes @ q.T).reshape(len(at), len(x), len(when))
        along, across = (
            at[:, None] * np.einsum("k,akt->at", w, f(theta)) for f in (np.cos, np.sin)
        )
        c, d, (a, b) = np.cos(q[:, 0]), np.sin(q[:, 0]), self.arm
        along = along + self.length * (c * a - d * b)
        across = across + self.length * (evaluate(self.place, when) + d * a + c * b)
        return np.stack([along[i, j], across[i, j], 0.0 * s], axis=-1)


def shapes_at(s: np.ndarray, count: int) -> np.ndarray:
    """Return ``1, Phi_0, Phi_1, ...`` at any s of [0, 1], (len(s), count)."""
    degree = np.sqrt(2.0 * np.arange(count - 1) + 1.0)
    return _with_one(integrals(s, count - 1) * degree)


@dataclass(frozen=True, kw_only=True)
class SettledTail(CustomTail):
    """A tail with the beat of an elastic one: in the plane s-q, its own image after half a period.

    Parameters are those of `CustomTail`.
    """

    beats_in_plane: ClassVar[bool] = True
    half_period_signs: ClassVar[np.ndarray | None] = MIRROR_Q


@dataclass(frozen=True, kw_only=True)
class LopsidedTail(SettledTail):
    """The same of a beat that is not its own image after half a period.

    Parameters are those of `CustomTail`.
    """

    half_period_signs: ClassVar[np.ndarray | None] = None


def settled_tail(tail: ElasticTail, beat: Beat) -> SettledTail:
    """Return the tail that beats as an elastic one has settled to."""
    angles, place = (trimmed(x, 1e-15) for x in beat_series(tail, beat))
    rest = beat.problem.rest
    tilt, arm = (0.0, (0.0, 0.0)) if rest is None else rest.root_in_plane
    kind = SettledTail if beat.problem.mirrors else LopsidedTail
    return kind(
        shape=Centreline(tail.length, angles, place, tilt, arm),
        length=tail.length,
        radius=tail.radius,
        frequency=tail.frequency,
        wavelength=tail.wavelength,
        sections=tail.sections,
        surface_motion=tail.surface_motion,
    )


def beat_series(tail: ElasticTail, beat: Beat) -> tuple[np.ndarray, np.ndarray]:
    """Return series in the phase of the tangent angle (at the joint, then along) and of the place.

    The angle's are (1 + 2 H, 1 + n), of 1 and of each ``Phi_k``; the place across s is over L.
    """
    base = drive(beat.problem, beat.phases)
    clamped = beat.problem.turning is None
    q = np.pad(beat.shape, ((0, 0), (1, 0))) if clamped else 1.0 * beat.shape
    q[:, 0] += base.angle
    whole, place = beat.over_period(q), beat.over_period(base.place)
    if np.real(tail.rate) < 0.0:  # the same beat, run through backwards by its phase
        whole = np.concatenate([whole[:1], whole[:0:-1]])
    return series_of(whole), series_of(place)


def centreline(
    beat: Beat, tail: ElasticTail, phase: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the position, slope and velocity per unit phase over L at the rod's nodes, each (T,
    m, 3).
    """
    angles, place = beat_series(tail, beat)
    rod = beat.rod
    shapes = rod.shapes if beat.problem.turning is not None else _with_one(rod.shapes)
    theta, turning = (evaluate(x, phase) @ shapes.T for x in (angles, derivative(angles)))
    theta = rod.tilt + theta
    y, y_rate = (evaluate(x, phase)[:, None] for x in (place, derivative(place)))
    c, s, S = np.cos(theta), np.sin(theta), rod.along.T
    X, Y = c @ S, y + s @ S
    U, V = -(s * turning) @ S, y_rate + (c * turning) @ S
    P, P_s, P_phase = (np.stack([a, b, 0.0 * a], axis=-1) for a, b in ((X, Y), (c, s), (U, V)))
    return P, P_s, P_phase


def _with_one(shapes: np.ndarray) -> np.ndarray:
    return np.column_stack([np.ones(len(shapes)), shapes])
