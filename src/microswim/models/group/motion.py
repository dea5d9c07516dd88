"""How swimmers move once resistance and propulsion are known.

R V + F rate = W  on the free degrees of freedom, V = 0 on the others
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.numerics.array import Array

if TYPE_CHECKING:
    from microswim.swimmer.group import Group


def free_motion(R: Array, load: Array, free: Any) -> Array:
    """Return V (k,) with ``R V = load`` on the free degrees of freedom, zero on the others."""
    f, V = np.flatnonzero(free), np.zeros(len(R))
    if f.size:
        root = np.sqrt(R.diagonal()[f])  # lengths and angles of one size
        part = R[np.ix_(f, f)] / np.outer(root, root)
        V[f] = np.linalg.solve(part, load[f] / root) / root
    return V


class Motion:
    """What follows from a group, its resistance (6n, 6n), propulsion (6n, n) and rates (n,)."""

    if TYPE_CHECKING:
        group: Group

        @property
        def resistance(self) -> Array: ...

        @property
        def propulsion(self) -> Array: ...

        @property
        def rates(self) -> Array: ...

    @property
    def units(self) -> str:
        """``"SI"`` or ``"dimensionless"``."""
        return self.group.units

    @cached_property
    def turn(self) -> Array:
        """Six-vectors (6n, 6n) of the swimmers' axes in the scene's: block diagonal rotations."""
        n = len(self.group.members)
        Q = np.zeros((6 * n, 6 * n))
        for i, member in enumerate(self.group.members):
            for half in (6 * i, 6 * i + 3):
                Q[half : half + 3, half : half + 3] = member.rotation
        return Q

    @cached_property
    def _twist(self) -> Array:
        """Velocities (6n,) of the loaded swimmers at their motors' rates."""
        load = self.group.wrench - self.propulsion @ self.rates
        return free_motion(self.resistance, load, self.group.free)

    @property
    def velocity(self) -> Array:
        """Velocity (n, 6) of each swimmer in its own axes, at the motors' rates under the loads."""
        return self._twist.reshape(-1, 6)

    @property
    def velocity_scene(self) -> Array:
        """Velocity (n, 6) of each swimmer in the scene's axes."""
        return (self.turn @ self._twist).reshape(-1, 6)

    @property
    def wrench(self) -> Array:
        """Force and torque (n, 6) by the fluid on each swimmer, its own axes."""
        return -(self.resistance @ self._twist + self.propulsion @ self.rates).reshape(-1, 6)
