"""Closed forms for an axisymmetric robot in a field that turns in a plane.

With the moment m at an angle Phi to the long axis and the resistances to rotation kappa_par about
it and kappa_perp across it, the robot tumbles, its long axis in the plane of the field, up to

    w_t  = m B cos(Phi) / kappa_perp

wobbles, the axis on a cone about the field's, up to step-out,

    sin(theta) = w_t / w
    w_so = m B sqrt(cos(Phi)^2 / kappa_perp^2 + sin(Phi)^2 / kappa_par^2)

[Morozov & Leshansky 2014]. A soft magnet of one axis, its moment ``d (e . b) B e`` along e, does
the same with a moment that depends on the state. With ``D = d B^2``, ``p = (sin(Phi)/kappa_par)^2``
and ``r = (cos(Phi)/kappa_perp)^2`` it wobbles, b at an angle whose cosine is c from q,

    w = D sin(Phi) c sqrt(p (1 - c^2) + r)      sin(theta) = sqrt(r / (p (1 - c^2) + r))

from c = 1, ``w_t = D sin(Phi) cos(Phi) / kappa_perp``, to ``c^2 = (p + r)/(2 p)``, its step-out; in
the plane of the field it follows to ``D / (2 kappa_perp)`` where Phi is below 45 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.gait.turning.soft_turning import SoftTurning
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


@dataclass(frozen=True)
class SoftAxisymmetric(Axisymmetric):
    """The same with a soft magnet of one axis.

    Parameters
    ----------
    pull, p, r
        ``D sin(Phi)``, p and r of the module.
    """

    pull: float
    p: float
    r: float

    def precession_angle(self, rates: Any) -> Array:
        """Return theta (rad) at rates of the field; NaN where it does not wobble."""
        rates = np.asarray(rates, float)
        size = rates / self.pull
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt((self.p + self.r) ** 2 - 4.0 * self.p * size**2)
            c = np.sqrt((self.p + self.r + root) / (2.0 * self.p))
            angle = np.arcsin(np.minimum(np.minimum(c, 1.0) * np.sqrt(self.r) / size, 1.0))
        flat = np.where(rates <= self.wobbling_onset, np.pi / 2.0, angle)
        return flat if self.p > self.r else np.where(rates <= self.step_out, np.pi / 2.0, np.nan)


def closest(mobility: Array, moment: Array, strength: float) -> Axisymmetric:
    """Return the closed forms of the axisymmetric robot closest to a mobility (6, 3)."""
    along, across, off = _round(mobility)
    a, b = strength * abs(moment[0]) * across, strength * np.hypot(moment[1], moment[2]) * along
    return Axisymmetric(float(a), float(np.hypot(a, b)), off)


def closest_soft(mobility: Array, softness: Array, strength: float) -> SoftAxisymmetric | None:
    """Return the same with a soft magnet (3, 3).

    None if that has no axis of its own, or the state of the largest rate is not held: it then
    loses step earlier, in a growing oscillation.
    """
    along, across, off = _round(mobility)
    values, vectors = np.linalg.eigh(softness)
    odd = 2 if values[2] - values[1] >= values[1] - values[0] else 0
    gap, other = values[odd] - values[1], values[1] - values[2 - odd]
    if not abs(other) < 1e-6 * abs(gap):
        return None
    cosine, sine = abs(float(vectors[0, odd])), float(np.hypot(*vectors[1:, odd]))
    size, p, r = strength**2 * abs(gap), (sine * along) ** 2, (cosine * across) ** 2
    onset = size * sine * cosine * across
    if p > r and not _held(along, across, gap, np.array([cosine, sine, 0.0]), (p + r) / (2.0 * p)):
        return None
    wobbling = size * sine * (p + r) / (2.0 * np.sqrt(p)) if p > r else 0.0
    tumbling = size * across / 2.0 if cosine > sine else onset
    return SoftAxisymmetric(onset, max(wobbling, tumbling), off, size * sine, p, r)


def _held(along: float, across: float, gap: float, e: Array, square: float) -> bool:
    """Return whether a soft robot of revolution is held just before c^2 is `square`."""
    M, c = np.zeros((6, 3)), np.sqrt(1e-4 + (1.0 - 1e-4) * square)
    M[3:] = np.diag([along, across, across])
    state = SoftTurning(M, e, 1.0, 0.0, gap * np.outer(e, e))
    return bool(state.at(np.array([0.0, c, np.sqrt(1.0 - c * c)])).held)


def _round(mobility: Array) -> tuple[float, float, float]:
    """Rotational mobility along and across, and how far the robot is from one of revolution."""
    W = mobility[3:]
    along, across = float(W[0, 0]), float(W[1, 1] + W[2, 2]) / 2.0
    return along, across, float(np.abs(W - np.diag([along, across, across])).max() / across)
