"""Paths of helices and plane waves in closed form, for fits that need thousands of them.

A rigid helix on a body of revolution has a constant twist in the frame T of its tail, so that

    T(t) = Q(phase_0) exp([w] t),  w = W_0 + sign rate e_s,   x' = T U_0

with ``U_0, W_0`` its velocities at phase 0 and Q the rotation by sign phase about s. A plane wave
moves in its plane: heading ``h = int W_r dt``, position ``int R(h) U dt``, both by Fourier series.
Everything else is left to `trajectory`. What does not depend on rate and phase is worked out once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.polynomial.polynomial import polyval

from microswim.gait.gait import Gait
from microswim.numerics.rigid_motion import multiply
from microswim.numerics.series.fourier import evaluate, series_of, trimmed
from microswim.path.trajectory import trajectory
from microswim.swimmer.swimmer import Swimmer

SAMPLES = 64
FLOOR = 1e-12  #: of the largest term, below which harmonics are left out
#: Positions (n, 3) and attitudes (n, 4) from rate, times since the first, and the phase there.
Path = Callable[[float, np.ndarray, float], tuple[np.ndarray, np.ndarray]]


def path_of(
    swimmer: Swimmer, gait: Gait, times: np.ndarray, phase: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (n, 3) and attitudes ``wxyz`` (n, 4) from the origin, axes parallel to the
    lab's.

    Parameters
    ----------
    swimmer
        Whose gait it is.
    gait
        Driven at its own rate, without loads.
    times
        The pose at the first is the origin.
    phase
        Phase at the first time (rad).
    """
    return paths_of(swimmer, gait)(float(gait.rate), times - times[0], phase)


def paths_of(swimmer: Swimmer, gait: Gait) -> Path:
    """Return a function that gives the path of a gait at any rate, from any phase."""
    tail, free = swimmer.tail, gait.free
    if tail.is_planar and swimmer.interaction.coupling == ((0.0,) * 3,) * 3:
        return _plane_wave(gait)
    turning = tail.is_rigid and swimmer.body.is_axisymmetric
    even = free[1] == free[2] and free[4] == free[5] and _alike(swimmer)
    if turning and even:
        return _helix(gait, tail.sign)

    def solved(rate: float, t: np.ndarray, phase: float) -> tuple[np.ndarray, np.ndarray]:
        path = trajectory(gait.at_rate(rate), t, phase=phase)
        return path.position.values, path.quaternion.values

    return solved


def _alike(swimmer: Swimmer) -> bool:
    x = swimmer.interaction
    return x.translation[1] == x.translation[2] and x.rotation[1] == x.rotation[2]


def _helix(gait: Gait, sign: float) -> Path:
    V = gait.velocity(0.0, 1.0)
    w = V[3:] + sign * np.array([1.0, 0.0, 0.0])
    size = np.linalg.norm(w)
    axis = w / size
    along = axis * (axis @ V[:3])
    across = V[:3] - along
    aside = np.cross(axis, across)

    def moved(rate: float, t: np.ndarray, phase: float) -> tuple[np.ndarray, np.ndarray]:
        turned = rate * t[:, None]
        a = size * turned
        way = along * turned + (across * np.sin(a) + aside * (1 - np.cos(a))) / size
        start = _about_s(sign * np.array([phase]))
        turn = np.concatenate([np.cos(a / 2), np.sin(a / 2) * axis], axis=1)
        back = _about_s(-sign * (phase + rate * t))
        c, s = np.cos(sign * phase), np.sin(sign * phase)
        Q = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
        return way @ Q.T, multiply(multiply(start, turn), back)

    return moved


def _about_s(angle: np.ndarray) -> np.ndarray:
    zero = np.zeros_like(angle)
    return np.stack([np.cos(angle / 2), np.sin(angle / 2), zero, zero], axis=-1)


def _integrated(series: np.ndarray) -> np.ndarray:
    """Series of the integral over the phase of a series' periodic part."""
    out = np.zeros_like(series)
    h = np.arange(1, len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    out[1::2], out[2::2] = -series[2::2] / h, series[1::2] / h
    return out


def _plane_wave(gait: Gait) -> Path:
    grid = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    V = gait.velocity(grid, 1.0)
    speed = series_of(V[:, 5])
    turn = _integrated(speed)
    heading = evaluate(turn, grid)
    c, s = np.cos(heading), np.sin(heading)
    step = series_of(np.stack([c * V[:, 0] - s * V[:, 1], s * V[:, 0] + c * V[:, 1]], axis=-1))
    series = trimmed(np.concatenate([turn[:, None], _integrated(step)], axis=1), FLOOR)
    powers = np.concatenate([series[:1], series[1::2] - 1j * series[2::2]])
    return partial(_along, step[0], powers)


def _along(
    mean: np.ndarray, powers: np.ndarray, rate: float, t: np.ndarray, phase: float
) -> tuple[np.ndarray, np.ndarray]:
    """Path whose heading and swing, x and y, are ``Re sum powers exp(i h phase)``."""
    there = rate * t
    angle, *swing = polyval(np.exp(1j * (phase + there)), powers).real
    x, y = (m * there + w - w[0] for m, w in zip(mean, swing))
    c, s = np.cos(angle[0]), np.sin(angle[0])
    half = (angle - angle[0]) / 2.0
    zero = np.zeros_like(half)
    moved = np.stack([x * c + y * s, y * c - x * s, zero], axis=-1)
    return moved, np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)


def quaternion_of(turn: np.ndarray) -> np.ndarray:
    """Return the unit quaternion of a rotation vector."""
    angle = float(np.linalg.norm(turn))
    return np.concatenate([[np.cos(angle / 2)], 0.5 * np.sinc(angle / (2 * np.pi)) * turn])
