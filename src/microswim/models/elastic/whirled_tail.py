"""The tail that an elastic one whirls as: a shape that turns as a whole about s."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim.models.elastic.filament import Filament
from microswim.models.elastic.rod import integrals
from microswim.models.elastic.space import AXIS, Pose
from microswim.models.elastic.whirl import Whirl
from microswim.swimmer.geometry.tails.custom_tail import CustomTail
from microswim.swimmer.geometry.tails.elastic.elastic_tail import ElasticTail


@dataclass(frozen=True, eq=False)
class TurningCentreline:
    """Centreline ``Q(phase) P(s)``, P from its root by the Legendre series of its tangent.

    Parameters
    ----------
    length
        Of the filament.
    tangent
        Coefficients of the unit tangent at phase 0, of Legendre polynomials on [0, 1], (m, 3).
    root
        Place of its root at phase 0, over the length, (3,).
    """

    length: float
    tangent: np.ndarray
    root: np.ndarray

    def __call__(self, s: Any, phase: Any) -> np.ndarray:
        """Position at s and phase, broadcast(s, phase) + (3,)."""
        s, phase = np.broadcast_arrays(np.asarray(s, float), np.asarray(phase, float))
        at, i = np.unique(s, return_inverse=True)
        P = integrals(at / self.length, len(self.tangent)) @ self.tangent
        P = self.length * (self.root + P)
        x, y, z = P[i.reshape(s.shape)].transpose(-1, *range(s.ndim))
        c, d = np.cos(phase), np.sin(phase)
        return np.stack([x, c * y - d * z, d * y + c * z], axis=-1)


@dataclass(frozen=True, kw_only=True)
class WhirledTail(CustomTail):
    """A tail with the shape of an elastic one whose base turns about s; it turns as a whole.

    Parameters are those of `CustomTail`.
    """

    turns_whole: ClassVar[bool] = True


def whirled_tail(tail: ElasticTail, found: Whirl) -> WhirledTail:
    """Return the tail that turns as an elastic one has settled to."""
    return turning_tail(tail, found.rod, found.pose, tail.frequency)


def turning_tail(tail: ElasticTail, rod: Filament, at: Pose, frequency: float) -> WhirledTail:
    """Return a tail with the shape of a pose, which turns about s at a frequency."""
    on = rod.weight > 0.0
    s, w = rod.s[on], rod.weight[on]
    count = len(s) - 4  # the last few are rounding
    values = np.polynomial.legendre.legvander(2.0 * s - 1.0, count - 1)
    tangents = at.directors[on, 2]
    series = (2.0 * np.arange(count) + 1.0)[:, None] * (values.T @ (w[:, None] * tangents))
    return WhirledTail(
        shape=TurningCentreline(tail.length, series, at.place[-1] - w @ tangents),
        length=tail.length,
        radius=tail.radius,
        frequency=frequency,
        wavelength=tail.wavelength,
        sections=tail.sections,
        surface_motion="rigid",
    )


def whirled_centreline(
    found: Whirl,
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Return the position, slope and velocity per unit phase over L at the nodes, at phase 0, (1,
    m, 3) each, and the weights of the nodes.
    """
    at, on = found.pose, found.rod.on_rod
    P = at.place[None, on]
    return (P, at.directors[None, on, 2], np.cross(AXIS, P)), found.rod.weight[on]
