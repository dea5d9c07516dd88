"""Which poses beside a wall are solved: where the swimmer touches, and a grid over all poses.

The coordinates are those of `microswim.gait.poses.beside_wall`: xi of the gap, sigma of the tilt,
turn of the tail's phase against the wall.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.poses import beside_wall
from microswim.models.swimmer_surface import smooth_centreline
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import settled
from microswim.swimmer.swimmer import Swimmer

#: Points of the centreline per wave, of the body's meridian, phases of the kink. Between two of the
#: meridian a flat side goes from end to end: a cylinder of four radii is off by .005 radii at most.
LINE, MERIDIAN, KINKS = 32, 721, 128


@dataclass(frozen=True, eq=False)
class Shape:
    """What of a swimmer touches a wall.

    Parameters
    ----------
    body, tail
        As `PoseTable` has them.
    numbers
        As `beside_wall.NUMBERS` has them.
    kinks
        Tilt at which body and tail are equally near, for `KINKS` values of psi.
    switch
        As `PoseTable` has it.
    """

    body: Array
    tail: Array
    numbers: Array
    kinks: Array
    switch: Array

    def touch(self, tilt: float, psi: float) -> float:
        """Return the height of the body's centre over the wall at which the swimmer touches it."""
        wall, found = np.zeros(6), np.zeros(14)
        wall[3:] = np.sin(tilt), np.cos(tilt), 0.0
        with settled(False):
            still = np.array([1.0, 0.0, 0.0, 0.0])
            beside_wall.contact(
                wall, self.numbers, self.body, self.tail, np.zeros(3), still, psi, found,
                np.zeros(8),
            )  # fmt: skip
        return -float(min(found[0], found[7]))

    def pose(self, xi: float, sigma: float, turn: float) -> tuple[float, float, float]:
        """Return gap, tilt and psi of coordinates; xi below zero, turn an angle."""
        delta = 2.0 * np.arctan2(np.sin(0.5 * turn), beside_wall.CLOSER * np.cos(0.5 * turn))
        psi = delta
        for _ in range(400):  # a turn's switch goes with the tilt, and that a little with psi
            gap, tilt = self._across(xi, sigma, psi)
            ahead = beside_wall.switched.written(self.switch, min(tilt, self.kink(psi)))
            change = delta + ahead - psi
            psi += 0.5 * change
            if abs(change) < 1e-10:
                break
        return gap, tilt, float(psi % (2.0 * np.pi))

    def kink(self, psi: float) -> float:
        """Return the tilt at which body and tail are equally near."""
        return float(beside_wall.kinked.written(self.kinks, psi))

    def _across(self, xi: float, sigma: float, psi: float) -> tuple[float, float]:
        """Return gap and tilt at a psi."""
        blurred = beside_wall.BLUR if sigma >= 0.0 else beside_wall.TAIL_BLUR
        size, reach, blur = (
            self.numbers[i] for i in (beside_wall.SIZE, beside_wall.REACH, blurred)
        )
        gap = size * np.exp(xi) / (1.0 - np.exp(xi))
        kink = self.kink(psi)
        most = np.log1p(reach * (0.5 * np.pi - np.sign(sigma) * kink) / (gap + blur))
        return gap, kink + np.sign(sigma) * np.expm1(abs(sigma) * most) * (gap + blur) / reach


def has_three(swimmer: Swimmer) -> bool:
    """Return whether a body of revolution has a rigid tail on its axis, or none: three coordinates
    do.
    """
    tail = swimmer.tail
    return (tail.is_rigid or tail.is_absent) and swimmer.body.is_axisymmetric and not tail.is_placed


def shape_of(swimmer: Swimmer, smallest: float) -> Shape:
    """Return what of a swimmer touches a wall.

    Parameters
    ----------
    swimmer
        Body of revolution with a rigid tail; one of both may be absent.
    smallest
        Smallest gap that is solved, in units of the body's smaller half axis.

    Raises
    ------
    SpecError
        If body or tail are of another kind.
    """
    body, tail = swimmer.body, swimmer.tail
    if not has_three(swimmer):
        there, where = ("channel", "in") if swimmer.channel is not None else ("wall", "beside")
        raise SpecError(
            f"{there}: a path {where} it is known for a body of revolution with one helical tail "
            "on its axis; ask at this one pose (microswim run, regimes, with --model bem), or "
            f"leave [{there}] out"
        )
    centre = np.asarray(body.centre, float)
    line = np.zeros((0, 3))
    if not tail.is_absent:
        many = LINE * max(2, int(np.ceil(float(tail.number_of_waves))))
        s = np.linspace(0.0, float(tail.apparent_length), many + 1)
        line = np.ascontiguousarray(smooth_centreline(tail, s, 0.0).P - centre)
    length = body_length(swimmer)
    reach = float(tail.apparent_length - centre[0])
    size = SIZE * length
    lowest = np.log(smallest * length / (smallest * length + size))
    numbers = np.array([tail.sign, tail.radius, size, reach, BLUR * length, lowest, length,
                        swimmer.fluid.viscosity, TAIL_BLUR * length, 0.0,
                        smallest * length], float)  # fmt: skip
    meridian = np.zeros((0, 2)) if body.is_absent else meridian_of(body)
    if not len(line):
        return Shape(meridian, line, numbers, np.zeros(KINKS), np.zeros(0))
    kinks = _kinks(meridian, line, float(tail.radius), tail.sign)
    return Shape(
        meridian, line, numbers, kinks, _switch(line, tail.sign, min(float(kinks.max()), -0.01))
    )


#: Scale of the gap, and what keeps sigma from shrinking with it, in half axes of the body.
SIZE, BLUR, TAIL_BLUR = 4.0, 0.3, 0.3


def body_length(swimmer: Swimmer) -> float:
    """Return the body's smaller half axis; without a body the tail's widest."""
    widths = [float(a) for a in swimmer.body.semi_axes3 if a > 0]
    if widths:
        return min(widths)
    line = smooth_centreline(
        swimmer.tail, np.linspace(0, float(swimmer.tail.apparent_length), 99)
    ).P
    return float(np.hypot(line[:, 1], line[:, 2]).max() + swimmer.tail.radius)


def meridian_of(body: Any) -> Array:
    """Return points (s, rho) that touch planes, by the angle of s and the direction outwards."""
    angle = np.linspace(0.0, np.pi, MERIDIAN)
    if body.is_ellipsoid:
        a, b = float(body.semi_axes3[0]), float(body.semi_axes3[1])
        support = np.hypot(a * np.cos(angle), b * np.sin(angle))
        return np.stack([a * a * np.cos(angle), b * b * np.sin(angle)], axis=-1) / support[:, None]
    theta = np.linspace(0.0, np.pi, 4001)
    around = np.stack([np.cos(theta), np.sin(theta), 0.0 * theta], axis=-1)
    X = body.surface_point(around) - body.centre
    X = X[:, :2]
    best = np.argmax(np.cos(angle)[:, None] * X[:, 0] + np.sin(angle)[:, None] * X[:, 1], axis=1)
    return np.ascontiguousarray(X[best])


def _kinks(meridian: Array, line: Array, radius: float, sign: float) -> Array:
    """Tilt at which body and tail are equally near to the wall, by bisection, `KINKS` phases."""
    if not len(meridian):
        return np.zeros(KINKS)
    turn = sign * 2.0 * np.pi * np.arange(KINKS)[:, None] / KINKS
    across = line[:, 1] * np.cos(turn) - line[:, 2] * np.sin(turn)  # along n, turned by psi
    low, high = np.full(KINKS, -0.5 * np.pi), np.full(KINKS, 0.5 * np.pi)
    angle = np.linspace(0.0, np.pi, len(meridian))
    for _ in range(50):
        tilt = 0.5 * (low + high)
        c, n = np.sin(tilt), np.cos(tilt)
        tail = (line[:, 0] * c[:, None] + across * n[:, None]).min(axis=1) - radius
        s, rho = (np.interp(0.5 * np.pi + tilt, angle, meridian[:, i]) for i in (0, 1))
        body_lower = s * c - rho * n < tail
        high, low = np.where(body_lower, tilt, high), np.where(body_lower, low, tilt)
    return 0.5 * (low + high)


#: Tilts and phases at which the nearest point of the tail is looked up; share of a wave by which it
#: jumps where another turn takes over; tilt over which the switch comes to rest where none does.
TILTS, PHASES, JUMP, REST = 80, 1440, 0.5, 0.1


def _switch(line: Array, sign: float, last: float) -> Array:
    """Return `PoseTable.switch` from the tail upright up to a tilt.

    Where the tail is so steep that its tip is nearest at all phases, no turn takes over: there the
    phase is soon that of the tip, as it is when it stands upright.
    """
    upright = -0.5 * np.pi
    found: list[float] = []
    tilts = last + (upright - last) * np.arange(4 * TILTS) / (4 * TILTS)
    for tilt in tilts:
        where, jump = _takes_over(line, sign, float(tilt))
        if jump < JUMP * LINE:
            break
        found.append(where)
    if len(found) < 2:
        return np.zeros(0)
    psi, before = np.unwrap(found), max(len(found) - 9, 0)
    steep = tilts[len(found) - 1]
    slope = (psi[-1] - psi[before]) / (steep - tilts[before])
    even = np.linspace(upright, last, 2 * TILTS)
    psi = np.interp(even, tilts[: len(found)][::-1], psi[::-1])
    psi += slope * REST * np.expm1(np.minimum(even - steep, 0.0) / REST)
    return np.concatenate([[upright, last], psi])


def _takes_over(line: Array, sign: float, tilt: float) -> tuple[float, int]:
    """Return the phase at which the nearest point of the tail jumps furthest, and how far."""
    turn = sign * 2.0 * np.pi * np.arange(PHASES) / PHASES
    c, s = np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn)
    nearest = np.argmin(
        np.sin(tilt) * line[:, 0] + c[:, None] * line[:, 1] - s[:, None] * line[:, 2], axis=1
    )
    jumps = np.abs(np.diff(nearest, append=nearest[:1]))
    i = int(np.argmax(jumps))
    return 2.0 * np.pi * (i + 0.5) / PHASES, int(jumps[i])
