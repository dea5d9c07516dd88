"""A robot with a soft magnet in a field that turns in a plane: every way in which it can follow.

Its moment is ``B C b`` with C, its moment per field, so that with mobility M and b seen from the
body

    w n = B^2 M_WT (C b x b)        n . b = 0        velocity along n = B^2 n . M_VT (C b x b)

and a small turn delta out of a state goes as ``delta' = (B^2 M_WT ([C b] - [b] C)[b] - w [n])
delta``. States lie where the cubic ``f = b . M_WT (C b x b)`` is zero, on both sides of the sphere,
since b and -b are one. Of a piece with one axis e of its own, ``C = c + d e e'``, f has the factor
``e . b``; what is left is the cone of a permanent magnet along e (module `steady_turning`). Else
the curves are traced. [Morozov & Leshansky 2014b] treat the piece with one axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from microswim.gait.turning.steady_turning import (
    NEUTRAL,
    Curve,
    SteadyTurning,
    Turned,
    cross,
    principal,
)
from microswim.gait.turning.traced import curves_of
from microswim.numerics.array import Array

ONE_AXIS = 1e-6  #: of the spread of C: two of its eigenvalues are one


@dataclass(frozen=True, eq=False)
class SoftTurning(SteadyTurning):
    """All steady states of a rigid robot with a soft magnet; `moment` is the axis of the piece.

    Parameters
    ----------
    softness
        C (3, 3), moment per field, body frame.
    """

    softness: Array = ()  # type: ignore[assignment]

    @classmethod
    def of(cls, mobility: Array, softness: Array, strength: float) -> SoftTurning:
        """Return the states of a mobility (6, 3), moment per field (3, 3) and strength."""
        values, vectors = np.linalg.eigh(softness)
        odd = 2 if values[2] - values[1] >= values[1] - values[0] else 0
        return cls(mobility, vectors[:, odd], strength, 0.0, softness)

    @property
    def magnetic(self) -> Array:
        """Moment without a field, then moment per field row by row (12,)."""
        return np.concatenate([np.zeros(3), self.softness.ravel()])

    @property
    def pull(self) -> float:
        """Largest torque of the field."""
        return float(self.strength**2 * np.ptp(np.linalg.eigvalsh(self.softness)))

    def at(self, b: Array) -> Turned:
        """Return the states in which the field points along b (..., 3), seen from the body."""
        C, M, square = self.softness, self.mobility, self.strength**2
        moment = b @ C
        twist = square * np.cross(moment, b) @ M.T
        rate = np.linalg.norm(twist[..., 3:], axis=-1)
        n = twist[..., 3:] / np.where(rate > 0, rate, 1.0)[..., None]
        slope = (cross(moment) - cross(b) @ C) @ cross(b)
        J = square * M[3:] @ slope - rate[..., None, None] * cross(n)
        growth = np.linalg.eigvals(J).real.max(axis=-1)
        held = growth < NEUTRAL * self.pull * np.linalg.norm(M[3:], 2)
        return Turned(rate, n, b, np.sum(twist[..., :3] * n, axis=-1), growth, held)

    @cached_property
    def curves(self) -> tuple[Curve, ...]:
        """Closed curves of b over 0 to 2 pi; of two that are each other's negative, one."""
        values = np.linalg.eigvalsh(self.softness)
        spread = values[2] - values[0]
        if not spread > 1e-12 * np.abs(values).max():
            return ()
        if min(np.diff(values)) < ONE_AXIS * spread:
            return (self._planar,)
        return curves_of(self._condition)

    def _condition(self, b: Array) -> tuple[Array, Array]:
        """Return f (...) and its gradient (..., 3) at b (..., 3), both over the size of M C."""
        W, C = self.mobility[3:], self.softness
        size = np.linalg.norm(W) * np.linalg.norm(C)
        moment = b @ C
        torque = np.cross(moment, b)
        N = cross(moment) - cross(b) @ C  # dT = N db
        slope = torque @ W.T + np.einsum("...ji,...j->...i", N, b @ W)
        return np.sum(b * (torque @ W.T), axis=-1) / size, slope / size

    @property
    def wobbling_onset(self) -> float:
        """Rate (rad per time) at which tumbling ends.

        For a robot of revolution the two planes of the cone meet there; else the cone of the axis
        of the piece comes closest to them.
        """
        values, vectors = principal(self.mobility, self.moment)
        return float(self.at(vectors[:, 1]).rate) if values.any() else self.step_out
