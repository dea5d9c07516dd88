"""A rigid magnetic robot in a field that turns steadily: every way in which it can follow.

In the frame that turns with the field, at the rate w about the axis n, a robot that follows is at
rest. With n and the field's direction b seen from the body, strength B, moment m, and the mobility
``M = [M_VT; M_WT]`` (6, 3), twist by torque without force,

    w n = B M_WT (m x b)        n . b = sin(psi)        velocity along n = B n . M_VT (m x b)

psi is the angle of the field out of the plane across the axis; zero: it turns in that plane. Then
the condition is a cone in b alone, ``b . S b = 0`` with S the symmetric part of ``M_WT [m]``, a
curve on the sphere that holds all there is: tumbling, wobbling and what lies between. Else n runs
over the circle ``n . M_WT^-1 m = 0``. A small turn delta of the robot out of a state goes as
``delta' = (B M_WT [m][b] - w [n]) delta``; the robot is held where all eigenvalues have negative
real parts. The problem is that of [Morozov et al. 2017], who solve it in Euler angles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import skew

Curve = Callable[[Any], Array]

SAMPLES = 1440  #: of a curve; the ends of what is held are found between them
NEUTRAL = 1e-7  #: growth relative to the fastest that the field can turn the robot: rounding


@dataclass(frozen=True, eq=False)
class Turned:
    """Steady states of a robot in a turning field, one or many.

    Parameters
    ----------
    rate
        Of the field (rad per time).
    axis, field
        Unit vectors in the body frame: what the field turns about, and where it points.
    velocity
        Of the body's centre along the axis.
    growth
        Largest growth rate of a small turn out of the state.
    held
        Whether the robot is held there: no small turn out of it grows.
    """

    rate: Any
    axis: Array
    field: Array
    velocity: Any
    growth: Any
    held: Any

    @property
    def precession_angle(self) -> Any:
        """Angle (rad, 0 to pi/2) between the robot's long axis s, taken as a line, and the axis."""
        across = np.hypot(self.axis[..., 1], self.axis[..., 2])
        return np.arctan2(across, np.abs(self.axis[..., 0]))


@dataclass(frozen=True)
class Arc:
    """A run of held states of a curve; the rate rises or falls all along it."""

    curve: Curve
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class SteadyTurning:
    """All steady states of a rigid robot with a moment in a field that turns.

    Parameters
    ----------
    mobility
        M (6, 3): twist by torque about the body's centre, body frame, without force.
    moment
        Magnetic moment m (3,), body frame.
    strength
        Field B, positive.
    cone
        psi (rad), angle of the field out of the plane across the axis.
    """

    mobility: Array
    moment: Array
    strength: float
    cone: float = 0.0

    def at(self, b: Array) -> Turned:
        """Return the states in which the field points along b (..., 3), seen from the body."""
        m, B, M = self.moment, self.strength, self.mobility
        twist = B * np.cross(m, b) @ M.T
        rate = np.linalg.norm(twist[..., 3:], axis=-1)
        n = twist[..., 3:] / np.where(rate > 0, rate, 1.0)[..., None]
        J = B * M[3:] @ skew(m) @ skew(b) - rate[..., None, None] * skew(n)
        growth = np.linalg.eigvals(J).real.max(axis=-1)
        if self.cone:  # the mirror image of a state belongs to a field that leans the other way
            growth = np.where(self.cone * np.sum(n * b, axis=-1) > 0, growth, np.inf)
        held = growth < NEUTRAL * B * np.linalg.norm(m) * np.linalg.norm(M[3:], 2)
        return Turned(rate, n, b, np.sum(twist[..., :3] * n, axis=-1), growth, held)

    @property
    def magnetic(self) -> Array:
        """Moment without a field, then moment per field row by row (12,)."""
        return np.concatenate([self.moment, np.zeros(9)])

    @property
    def pull(self) -> float:
        """Largest torque of the field."""
        return float(self.strength * np.linalg.norm(self.moment))

    @cached_property
    def curves(self) -> tuple[Curve, ...]:
        """Closed curves of b over 0 to 2 pi; the robot is held at -b where it is not at b."""
        return self._conical() if self.cone else (self._planar, lambda u: -self._planar(u))

    @cached_property
    def _principal(self) -> tuple[Array, Array]:
        return principal(self.mobility, self.moment)

    def _planar(self, u: Any) -> Array:
        """Return b on the cone ``b . S b = 0``."""
        (p, q, r), vectors = self._principal
        c, s = np.cos(u), np.sin(u)
        z = np.sqrt(np.maximum(-(p * c * c + q * s * s) / r, 0.0)) if r else 0.0 * c
        b = np.stack([c, s, z], axis=-1) @ vectors.T
        return b / np.linalg.norm(b, axis=-1, keepdims=True)

    def _conical(self) -> tuple[Curve, ...]:
        """Return the curves over n: b in the plane across ``t = M_WT^-1 n``, with n . b given."""
        R = np.linalg.inv(self.mobility[3:])
        circle = np.linalg.svd((R @ self.moment)[None])[2][1:]
        lean = np.sin(self.cone)

        def part(angle: Any) -> tuple[Array, Array, Array]:
            n = np.cos(angle)[..., None] * circle[0] + np.sin(angle)[..., None] * circle[1]
            t = n @ R / np.linalg.norm(n @ R, axis=-1, keepdims=True)
            c = n - np.sum(n * t, axis=-1, keepdims=True) * t
            return t, c, np.linalg.norm(c, axis=-1, keepdims=True)

        def b(angle: Any, side: Any) -> Array:
            t, c, k = part(np.asarray(angle))
            x = lean / k
            y = np.sqrt(np.maximum(1.0 - x * x, 0.0))
            return (x * c + np.asarray(side)[..., None] * y * np.cross(t, c)) / k

        def room(angle: float) -> float:
            return float(part(np.asarray(angle))[2][0]) - abs(lean)

        ends = _zeros(room)
        if not ends:
            return tuple(lambda u, s=s: b(u, s + 0.0 * u) for s in (1.0, -1.0) if room(0.0) > 0)
        made = []
        for first, last in zip(ends, [*ends[1:], ends[0] + 2.0 * np.pi]):
            middle, half = (first + last) / 2.0, (last - first) / 2.0
            if room(middle) > 0:
                made.append(lambda u, m=middle, h=half: b(m - h * np.cos(u), np.sign(np.sin(u))))
        return tuple(made)

    @cached_property
    def arcs(self) -> tuple[Arc, ...]:
        """Every run of held states, the one that begins at the lowest rate first."""
        found: list[Arc] = []
        for curve in self.curves:
            step = 2.0 * np.pi / SAMPLES
            u = step * np.arange(SAMPLES) + 1e-3
            held = self.at(curve(u)).held
            for i in np.flatnonzero(held & ~np.roll(held, 1)):
                length = int(np.argmin(np.roll(held, -i)))
                start = self._edge(curve, u[i], u[i] - step)
                last = u[i] + (length - 1) * step
                end = self._edge(curve, last, last + step)
                found += self._monotonic(curve, start, end)
        return tuple(sorted(found, key=lambda arc: min(self.rates(arc))))

    def _monotonic(self, curve: Curve, start: float, end: float) -> list[Arc]:
        """Return the arcs of a run of held states, cut where the rate turns back.

        It does at rate zero, the moment along the field, for a robot that spins freely about it;
        that may lie next to an end, where points are close.
        """
        from scipy.optimize import minimize_scalar  # nobody waits for it without a field

        u = np.linspace(start, end, max(3, int((end - start) / (2.0 * np.pi) * SAMPLES)))
        near = (u[1] - u[0]) * 0.5 ** np.arange(1, 16)
        u = np.unique(np.concatenate([u, start + near, end - near]))
        slope = np.diff(self.at(curve(u)).rate)
        ends = [start]
        for i in np.flatnonzero(slope[:-1] * slope[1:] < 0) + 1:
            sense = np.sign(slope[i])
            at: Any = minimize_scalar(
                lambda x, s=sense: s * float(self.at(curve(x)).rate),
                bounds=(u[i - 1], u[i + 1]), method="bounded", options={"xatol": 1e-12},
            )  # fmt: skip
            ends.append(float(at.x))
        arcs = [Arc(curve, a, b) for a, b in pairwise([*ends, end])]
        longest = max(arc.end - arc.start for arc in arcs)
        least = min(np.pi / SAMPLES, longest)  # a shorter one is held by the tolerance alone
        return [arc for arc in arcs if arc.end - arc.start >= least]

    def _edge(self, curve: Curve, held: float, lost: float) -> float:
        """Return where the held states of a curve end, by halving five times at once."""
        for _ in range(8):
            u = np.linspace(held, lost, 33)
            first = int(np.argmin(np.append(self.at(curve(u[1:-1])).held, False)))
            held, lost = float(u[first]), float(u[first + 1])
        return held

    def rates(self, arc: Arc) -> tuple[float, float]:
        """Return the rates at the ends of an arc."""
        first, last = self.at(arc.curve(np.array([arc.start, arc.end]))).rate
        return float(first), float(last)

    @cached_property
    def step_out(self) -> float:
        """Largest rate of the field that the robot follows (rad per time), or zero."""
        return max((max(self.rates(arc)) for arc in self.arcs), default=0.0)

    @cached_property
    def at_step_out(self) -> Turned | None:
        """The state of the largest rate."""
        if not self.arcs:
            return None
        ends = (arc.curve(end) for arc in self.arcs for end in (arc.start, arc.end))
        return max((self.at(b) for b in ends), key=lambda state: float(state.rate))

    @property
    def wobbling_onset(self) -> float:
        """Rate (rad per time) at which tumbling ends; NaN for a field out of the plane.

        For an axisymmetric robot the two planes of the cone meet there,
        ``m B cos(Phi) / kappa_perp``; else the cone comes closest to them.
        """
        if self.cone:
            return np.nan
        values, vectors = self._principal
        return float(self.at(vectors[:, 1]).rate) if values.any() else self.step_out

    def states(self, rate: float) -> list[Turned]:
        """Return the held states at a rate of the field.

        The first is that which a robot is in when the field was turned ever faster up to here.
        """
        found = []
        for arc in self.arcs:
            low, high = sorted(self.rates(arc))
            if low <= rate <= high:
                found.append(self._state(arc, rate))
        return found

    def _state(self, arc: Arc, rate: float) -> Turned:
        def beyond(u: float) -> float:
            return float(self.at(arc.curve(u)).rate) - rate

        ends = beyond(arc.start), beyond(arc.end)
        if ends[0] * ends[1] >= 0.0:
            return self.at(arc.curve(arc.start if abs(ends[0]) < abs(ends[1]) else arc.end))
        return self.at(arc.curve(_zero(beyond, arc.start, arc.end)))


def principal(mobility: Array, moment: Array) -> tuple[Array, Array]:
    """Return eigenvalues of S and vectors as columns; the last has a sign of its own."""
    N = mobility[3:] @ skew(moment)
    values, vectors = np.linalg.eigh((N + N.T) / 2.0)
    if np.abs(values).max() < 1e-12 * np.linalg.norm(N):
        # the moment is an axis of symmetry: every plane through it is as good
        return np.zeros(3), np.linalg.svd(moment[None])[2].T
    if values[1] < 0.0:  # S is free of trace
        return values, vectors
    return -values[::-1], vectors[:, ::-1]


def _zeros(of: Callable[[float], float]) -> list[float]:
    """Return where a function of an angle changes sign."""
    u = np.linspace(0.0, 2.0 * np.pi, SAMPLES // 2 + 1)
    values = np.array([of(x) for x in u])
    change = np.flatnonzero(values[:-1] * values[1:] < 0)
    return [_zero(of, u[i], u[i + 1]) for i in change]


def _zero(of: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq  # nobody waits for it without a field

    found: Any = brentq(of, low, high, xtol=1e-13)
    return float(found)
