"""The flow far from a swimmer: force dipole, rotlet dipole, quadrupole, source dipole.

    8 pi mu u_i = G_ij F_j - D_jk d_k G_ij + 1/2 Q_jkl d_k d_l G_ij - ...
    F = int f dS,  D_jk = int f_j x_k dS,  Q_jkl = int f_j x_k x_l dS       [Kim Karrila 1991]

f is the density of the single layer, x counts from the body's centre. What is the same from all
sides of the axis s, as the mean over the phases of a turning tail is, has four numbers:

    p = D_ss - (D_qq + D_rr)/2            u_r = p/(8 pi mu r^2) (3 cos^2 theta - 1)
    k = int (x x f)_s s dS                two opposite torques along s, a distance apart
    n = Q_sss - B - 2 E                   8 pi mu u = n/2 d_s^2 (G e_s)
    b = B                                 8 pi mu u = b (e_s/r^3 - 3 s r/r^5)
    B = (Q_sqq + Q_srr)/2,  E = (Q_qqs + Q_rrs)/2

A pusher has p > 0: it drives fluid out along its axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.gait.units import unit
from microswim.models.bem.solution import Solution
from microswim.models.group.motion import free_motion
from microswim.numerics.array import Array

#: Share of the tail's own density below which one is rounding: a tail alone only turns back.
ROUNDING = 1e-9
#: What the four numbers, and the force on the axis, are called.
NAMES = ("force", "force_dipole", "rotlet_dipole", "force_quadrupole", "source_dipole")


@dataclass(frozen=True, kw_only=True)
class FarField:
    """The flow far from a swimmer as it swims alone, averaged over its phases.

    Parameters
    ----------
    force
        On the fluid along s: zero for a free swimmer, the Stokeslet of a held one.
    force_dipole
        p (force times length): positive for a pusher, negative for a puller.
    rotlet_dipole
        k (torque times length): body and tail turn against each other.
    force_quadrupole, source_dipole
        n and b (force times length squared), about the body's centre.
    error
        Of these five in that order, the difference from the next coarser level.
    held
        Whether the swimmer is held along s.
    units
        ``"SI"`` or ``"dimensionless"``.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> found = ms.Group((ms.Member(swimmer=helix),)).swim(level="coarse").far_field[0]
    >>> found.kind, bool(found.force_dipole > 10 * found.error[1])
    ('pusher', True)
    """

    force: float
    force_dipole: float
    rotlet_dipole: float
    force_quadrupole: float
    source_dipole: float
    error: tuple[float, ...]
    held: bool
    units: str

    @property
    def kind(self) -> str:
        """``"pusher"``, ``"puller"``, ``"neutral"`` within its error, or ``"held"``."""
        if self.held:
            return "held"
        if abs(self.force_dipole) <= self.error[1]:
            return "neutral"
        return "pusher" if self.force_dipole > 0.0 else "puller"

    def as_dict(self) -> dict[str, Any]:
        """Return the numbers with their errors, units and the kind."""
        units = dict(zip(NAMES, ("force", "torque", *3 * ("bending stiffness",)), strict=True))
        return {
            "kind": self.kind,
            **{name: getattr(self, name) for name in NAMES},
            "error": dict(zip(NAMES, self.error, strict=True)),
            "units": {name: unit(self.units, kind) for name, kind in units.items()},
        }

    @classmethod
    def of(cls, mean: Array, error: Array, *, held: bool, units: str) -> FarField:
        """Return the far field of mean `moments` (5,) and their errors."""
        numbers = dict(zip(NAMES, map(float, mean), strict=True))
        return cls(**numbers, error=tuple(map(float, error)), held=held, units=units)


def moments(alone: Solution) -> Array:
    """Return force along s, p, k, n, b (5,) of a swimmer as it swims alone at its phase."""
    s = alone.surface
    V = free_motion(alone.raw_resistance, -alone.raw_propulsion * alone.rate, alone.free)
    f = alone.combined(V).reshape(s.nodes.shape)  # without any force that is left over
    if np.abs(f).max() <= ROUNDING * np.abs(alone.density[:, 6] * alone.rate).max():
        return np.zeros(5)
    area, moment = s.moments[0], s.moments[1] - s.moments[0][..., None] * alone.centre
    D = np.einsum("epj,epk->jk", f, moment)
    Q = np.einsum("epj,epk,epl->jkl", f, moment, s.nodes - alone.centre)
    B, E = 0.5 * (Q[0, 1, 1] + Q[0, 2, 2]), 0.5 * (Q[1, 1, 0] + Q[2, 2, 0])
    twist = Q[2, 1, 0] - Q[1, 2, 0]  # (x x f)_s s
    p = D[0, 0] - 0.5 * (D[1, 1] + D[2, 2])
    return np.array([np.sum(area * f[..., 0]), p, twist, Q[0, 0, 0] - B - 2.0 * E, B])
