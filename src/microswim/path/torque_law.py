"""Motors that give a torque: what each gives at its rate, and how fast all turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.errors import MicroswimError
from microswim.numerics.array import Array

#: Trials of which motors turn beyond their knee.
MOST_TRIALS = 50


@dataclass(frozen=True, eq=False)
class TorqueLaw:
    """The torques of n motors, and which motions of their swimmer are free.

    Parameters
    ----------
    free
        Which of the six motions are free, (6,).
    torque
        T of each motor, (n,).
    no_load
        Rate of each motor without load (rad per time), (n,); infinite for a constant torque.
    knee
        Rate up to which the torque does not fall, (n,); not a number where it falls from rest on.
    """

    free: NDArray[np.bool_]
    torque: Array
    no_load: Array
    knee: Array

    def given(self, rate: Array) -> Array:
        """Return the torque of each motor at its rate, (n,)."""
        level, slope = self._line
        line = level - slope * rate
        sign = np.sign(self.torque)
        return np.where(
            np.isnan(self.knee), line, sign * np.minimum(sign * self.torque, sign * line)
        )

    @property
    def _line(self) -> tuple[Array, Array]:
        """Torque at rest and slope of each line that falls to none at W; flat without W."""
        constant = np.isinf(self.no_load)
        low = np.where(np.isnan(self.knee), 0.0, self.knee)
        high = np.where(constant, 1.0, self.no_load)
        slope = np.where(constant, 0.0, self.torque / (high - np.where(constant, 0.0, low)))
        return np.where(constant, self.torque, slope * high), slope

    def turning(self, R: Array, F: Array, G: Array) -> tuple[Array, Array]:
        """Return twist V (6,) and rates (n,) with R (6, 6), F (6, n) and G (n, n).

        Raises
        ------
        MicroswimError
            As `solved`.
        """
        V = np.zeros(6)
        R, F = R[np.ix_(self.free, self.free)], F[self.free]
        V[self.free], rate = self.solved(R, F, G, np.zeros(len(R)))
        return V, rate

    def solved(self, R: Array, F: Array, G: Array, push: Array) -> tuple[Array, Array]:
        """Return what moves (m,) and rates (n,) with R (m, m), F (m, n), G (n, n) and a push (m,).

        Motors beyond their knee are those that turn faster than it: found by trying, since each
        that weakens slows them all, a few times at most.

        Raises
        ------
        MicroswimError
            If that does not end.
        """
        level, slope = self._line
        falls = np.isnan(self.knee)
        for _ in range(MOST_TRIALS):
            both: Any = np.linalg.solve(
                np.block([[R, F], [F.T, G + np.diag(np.where(falls, slope, 0.0))]]),
                np.concatenate([push, np.where(falls, level, self.torque)]),
            )
            rate = both[len(R) :]
            beyond = np.isnan(self.knee) | (np.sign(self.torque) * (rate - self.knee) > 0.0)
            if (beyond == falls).all():
                return both[: len(R)], rate
            falls = beyond
        raise MicroswimError(
            "the rates of the motors were not found at their knees; move the knees"
        )

    def missed(self, guess: tuple[Array, ...], true: tuple[Array, ...]) -> Array:
        """Return by how much R, F and G miss the true ones in V and the rates, (6 + n,).

        Of the speed, of the rate of turning, of each motor's rate.
        """
        (V, w), (known, rate) = self.turning(*guess), self.turning(*true)
        size = np.repeat([np.linalg.norm(known[:3]), np.linalg.norm(known[3:])], 3)
        off = np.abs(np.concatenate([V - known, w - rate]))
        scale = np.concatenate([size, np.abs(rate)])
        return np.divide(off, scale, out=np.zeros_like(off), where=scale > 0.0)
