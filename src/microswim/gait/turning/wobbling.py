"""Closed forms for an axisymmetric robot in a field that turns in a plane.

With the moment m at an angle Phi to the long axis and the resistances to rotation kappa_par about
it and kappa_perp across it, the robot tumbles, its long axis in the plane of the field, up to

    w_t  = m B cos(Phi) / kappa_perp

wobbles, the axis on a cone about the field's, up to step-out,

    sin(theta) = w_t / w
    w_so = m B sqrt(cos(Phi)^2 / kappa_perp^2 + sin(Phi)^2 / kappa_par^2)

[Morozov & Leshansky 2014].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.numerics.array import Array

ROUND = 0.2  #: largest departure from axial symmetry for which the closed forms are shown


@dataclass(frozen=True)
class Axisymmetric:
    """The robot that is closest to a given one and axisymmetric.

    Parameters
    ----------
    wobbling_onset, step_out
        w_t and w_so (rad per time).
    asymmetry
        How far the given robot is from it: of its rotational mobility, relative to that across.
    """

    wobbling_onset: float
    step_out: float
    asymmetry: float

    @property
    def holds(self) -> bool:
        """Whether the closed forms say something of the given robot."""
        return self.asymmetry <= ROUND

    def precession_angle(self, rates: Any) -> Array:
        """Return theta (rad) at rates of the field; NaN beyond step-out."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self.wobbling_onset / np.asarray(rates, float)
        angle = np.arcsin(np.minimum(ratio, 1.0))
        return np.where(np.asarray(rates) <= self.step_out, angle, np.nan)


def closest(mobility: Array, moment: Array, strength: float) -> Axisymmetric:
    """Return the closed forms of the axisymmetric robot closest to a mobility (6, 3)."""
    W = mobility[3:]
    along, across = W[0, 0], (W[1, 1] + W[2, 2]) / 2.0
    off = float(np.abs(W - np.diag([along, across, across])).max() / across)
    a, b = strength * abs(moment[0]) * across, strength * np.hypot(moment[1], moment[2]) * along
    return Axisymmetric(float(a), float(np.hypot(a, b)), off)
