"""Elastic swimmers marched in time by implicit steps of varying order and length (SciPy's BDF).

The state may be handed on and gone on with; where the filament bends more sharply than its strains
resolve, a piece of time is marched again with more of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from microswim.errors import MicroswimError
from microswim.models.elastic.rod import integrals
from microswim.models.elastic.unsteady.numbers import Units, in_time, units_of
from microswim.models.elastic.unsteady.swimmer_in_time import POSE, InTime, derivative, rates
from microswim.models.elastic.whirl import elastic_tail
from microswim.swimmer.swimmer import Swimmer

FIRST, BENT, MOST = 8, 12, 40  #: polynomials a strain; of a tail bent at rest, or from within
SHARP = 3e-4  #: largest share that the last two of them may have in the tail's place
LOOSEST = 3e-5  #: tolerance; with a looser one the steps of BDF fail more often than they save
POINTS = 33  #: of the filament, in what is handed on


@dataclass(frozen=True, eq=False)
class Shape:
    """Pose and shape of an elastic swimmer at one time, in its own units.

    Parameters
    ----------
    position, quaternion, phase
        Of the body's centre, lab; ``wxyz``, body to lab; of the drive.
    strains
        Legendre coefficients of two curvatures and the twist, times L, (3, n).
    hook
        Turn of the hook, (3,); zero without one.
    work
        Of the drive since the start, and what was dissipated, (2,).
    """

    position: np.ndarray
    quaternion: np.ndarray
    phase: float
    strains: np.ndarray
    hook: np.ndarray
    work: np.ndarray


def at_rest(swimmer: Swimmer, position: Any, quaternion: Any, phase: float) -> Shape:
    """Return the swimmer at a pose with its filament as it is where nothing pulls."""
    tail = elastic_tail(swimmer)
    rest, modes = tail.rest_shape, BENT if tail.is_bent or tail.drive == "moment" else FIRST
    modes = modes if rest is None else max(modes, rest.modes() + 2)
    rod = in_time(swimmer, modes).rod
    pose = np.array(position, float), np.array(quaternion, float), float(phase)
    return Shape(*pose, np.array(rod.rest[:, rod.hooks :], float), np.zeros(3), np.zeros(2))


@dataclass(frozen=True, eq=False)
class March:
    """States at some times: each a `Shape`, and the places of the filament, (n, points, 3), lab."""

    shapes: list[Shape]
    places: np.ndarray


@threadpool_limits.wrap(limits=1)  # small matrices
def marched(
    swimmer: Swimmer, start: Shape, times: np.ndarray, tolerance: float, begun: float = 0.0,
    **more: Any,
) -> March:  # fmt: skip
    """Return the states at the times, the first of which is that of the start.

    Parameters
    ----------
    swimmer
        With an `ElasticTail`.
    start
        State at the first time.
    times
        Increasing, in the swimmer's units.
    tolerance
        Of a step, relative; at most `LOOSEST`.
    begun
        Time of the field at the first time.
    more
        As `in_time`.

    Raises
    ------
    SpecError
        As `in_time`.
    MicroswimError
        If a step cannot be made small enough, or the filament bends too sharply.
    """
    units, n = units_of(swimmer), start.strains.shape[1]
    tolerance = min(tolerance, LOOSEST)
    while True:
        of = in_time(swimmer, n, start.phase, **more)
        found, sharp = _integrated(
            of, units, _packed(of, units, start), times - times[0], begun, tolerance
        )
        if sharp <= SHARP:
            break
        n += max(4, n // 3)
        if n > MOST:
            raise MicroswimError(
                "the elastic tail bends too sharply to be followed: stiffen it, or drive it less"
            )
    when = times - times[0]
    shapes = [_unpacked(of, units, start.phase, y, t) for y, t in zip(found, when)]
    return March(shapes, np.array([places(of, units, y, t) for y, t in zip(found, when)]))


def drawn(swimmer: Swimmer, shape: Shape) -> np.ndarray:
    """Return evenly spaced points along the filament of a state, (points, 3), lab frame."""
    units = units_of(swimmer)
    of = in_time(swimmer, shape.strains.shape[1], shape.phase)
    return places(of, units, _packed(of, units, shape), 0.0)


def _packed(of: InTime, units: Units, start: Shape) -> np.ndarray:
    q, first = np.zeros((3, of.rod.count)), of.rod.hooks
    q[:, :first] = start.hook[:, None]
    q[:, first : first + start.strains.shape[1]] = start.strains
    return np.concatenate(
        [start.position / units.length, start.quaternion, q.ravel(), start.work / units.torque]
    )


def _unpacked(of: InTime, units: Units, phase: float, y: np.ndarray, time: float) -> Shape:
    q = y[POSE:-2].reshape(3, -1)
    first = of.rod.hooks
    turn = y[3:POSE] / np.linalg.norm(y[3:POSE])
    spent = y[-2:] * units.torque
    angle = phase + of.rate * time / units.time
    hook = q[:, 0] if first else np.zeros(3)
    return Shape(y[:3] * units.length, turn, angle, q[:, first:], hook, spent)


def places(of: InTime, units: Units, y: np.ndarray, time: float) -> np.ndarray:
    """Return evenly spaced points along the filament, (points, 3), lab frame."""
    at, X, Q, _ = of.seen(time / units.time, y)
    on = of.rod.weight > 0.0
    s, w = of.rod.s[on], of.rod.weight[on]
    values = np.polynomial.legendre.legvander(2.0 * s - 1.0, len(s) - 1)
    series = (2.0 * np.arange(len(s)) + 1.0)[:, None] * (values.T * w) @ at.directors[on, 2]
    along = integrals(np.linspace(0.0, 1.0, POINTS), len(s)) @ series
    root = X[-1] - along[-1]
    return (y[:3] + (root + along) @ Q.T) * units.length


def _integrated(
    of: InTime, units: Units, y0: np.ndarray, times: np.ndarray, begun: float, tolerance: float
) -> tuple[np.ndarray, float]:
    """States at the times, and how sharply the filament was bent on the way."""
    from scipy.integrate import solve_ivp

    shift = begun / units.time
    if shift:
        field = of.loads.field
        later = None if field is None else (lambda t, x: field(t + shift, x))  # type: ignore[misc]
        of = replace(of, loads=replace(of.loads, field=later))
    t = times / units.time
    scale = np.ones(len(y0))
    scale[-2:] = max(1.0, abs(of.drag.normal))
    tolerance = tolerance / 4.0  # so that work and heat agree to it
    found = solve_ivp(
        lambda when, y: rates(of, when, y), (0.0, t[-1]), y0, "BDF", rtol=tolerance,
        atol=tolerance * scale, jac=lambda when, y: derivative(of, when, y), dense_output=True,
    )  # fmt: skip
    if not found.success or not np.isfinite(found.y).all():
        raise MicroswimError("the elastic tail cannot be followed: its loads change too fast")
    return found.sol(t).T, _sharpness(of, found.t, found.y.T)


def _sharpness(of: InTime, t: np.ndarray, y: np.ndarray) -> float:
    """Share of the last two polynomials in the tail's place, of the bends, in the mean of time."""
    bends = y[:, POSE : POSE + of.rod.rest.size].reshape(len(t), 3, -1) - of.rod.rest
    dt, square = np.diff(t)[:, None, None], bends**2
    mean = np.sqrt((dt * (square[1:] + square[:-1]) / 2.0).sum(axis=0) / t[-1])
    return mean[:, -2:].max() / of.rod.count**2 / max(mean.max(), 1e-6)
