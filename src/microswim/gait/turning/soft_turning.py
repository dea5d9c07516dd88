"""A robot with a soft magnet in a field that turns: every way in which it can follow.

Its moment is ``B C b`` with C, its moment per field, so that with mobility M and b seen from the
body

    w n = B^2 M_WT (C b x b)    n . b = sin(psi)    velocity along n = B^2 n . M_VT (C b x b)

and a small turn delta out of a state goes as ``delta' = (B^2 M_WT ([C b] - [b] C)[b] - w [n])
delta``. Turned about, b and -b are one, and the field leans to the side that it should. In a
plane states lie where the cubic ``f = b . W`` is zero, ``W = M_WT (C b x b)``; else where ``f^2 =
sin(psi)^2 W . W`` is. Of a piece with one axis e of its own, ``C = c + d e e'``, W has the factor
``e . b``; what is left are the curves of permanent magnets along e and -e (module
`steady_turning`). Else the curves are traced. [Morozov & Leshansky 2014b] treat the piece with one
axis, in a plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from microswim.errors import SpecError
from microswim.gait.turning.steady_turning import (
    NEUTRAL,
    Curve,
    SteadyTurning,
    Turned,
    principal,
)
from microswim.gait.turning.traced import curves_of
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import skew

ONE_AXIS = 1e-6  #: of the spread of C: two of its eigenvalues are one
LEAST = np.radians(1.0)  #: angle of a cone: curves of smaller ones lie too close to each other


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
    def of(
        cls, mobility: Array, softness: Array, strength: float, cone: float = 0.0
    ) -> SoftTurning:
        """Return the states of a mobility (6, 3), moment per field (3, 3), strength and cone.

        Raises
        ------
        SpecError
            If the field leans out of the plane by less than a degree, or by nearly 90.
        """
        if cone and not LEAST <= abs(cone) <= np.pi / 2.0 - LEAST:
            allowed = "zero, or between 1 and 89 degrees, with a soft magnet"
            raise SpecError("field.cone", cone, allowed)
        values, vectors = np.linalg.eigh(softness)
        odd = 2 if values[2] - values[1] >= values[1] - values[0] else 0
        return cls(mobility, vectors[:, odd], strength, cone, softness)

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
        slope = (skew(moment) - skew(b) @ C) @ skew(b)
        J = square * M[3:] @ slope - rate[..., None, None] * skew(n)
        growth = np.linalg.eigvals(J).real.max(axis=-1)
        if self.cone:
            b = b * np.where(self.cone * np.sum(n * b, axis=-1) < 0.0, -1.0, 1.0)[..., None]
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
            return self._of_one_axis()
        return curves_of(self._leaning if self.cone else self._condition)

    def _of_one_axis(self) -> tuple[Curve, ...]:
        if not self.cone:
            return (self._planar,)
        rest = self.mobility, self.strength, self.cone
        sides = (SteadyTurning(rest[0], e, *rest[1:]) for e in (self.moment, -self.moment))
        return tuple(curve for side in sides for curve in side.curves)

    def _condition(self, b: Array) -> tuple[Array, Array]:
        """Return f (...) and its gradient (..., 3) at b (..., 3), over the size of M C."""
        W, N = self._turn(b)
        return np.sum(b * W, axis=-1), W + np.einsum("...ji,...j->...i", N, b)

    def _turn(self, b: Array) -> tuple[Array, Array]:
        """Return W (..., 3) at b and its derivatives (..., 3, 3), over the size of M C."""
        M, moment = self.mobility[3:], b @ self.softness
        M = M / (np.linalg.norm(M) * np.linalg.norm(self.softness))
        return np.cross(moment, b) @ M.T, M @ (skew(moment) - skew(b) @ self.softness)

    def _leaning(self, b: Array) -> tuple[Array, Array]:
        """Return ``f^2 - sin(psi)^2 W . W`` and its gradient, both over the size squared."""
        (f, slope), (W, N), share = self._condition(b), self._turn(b), np.sin(self.cone) ** 2
        value = f * f - share * np.sum(W**2, axis=-1)
        return value, 2.0 * (f[..., None] * slope - share * np.einsum("...ji,...j->...i", N, W))

    @property
    def wobbling_onset(self) -> float:
        """Rate (rad per time) at which tumbling ends.

        For a robot of revolution the two planes of the cone meet there; else the cone of the axis
        of the piece comes closest to them. NaN for a field out of the plane.
        """
        if self.cone:
            return np.nan
        values, vectors = principal(self.mobility, self.moment)
        return float(self.at(vectors[:, 1]).rate) if values.any() else self.step_out
