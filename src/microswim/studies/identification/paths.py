"""Paths of helices and plane waves in closed form, for fits that need thousands of them.

A rigid helix on a body of revolution has a constant twist in the frame T of its tail, so that

    T(t) = Q(phase_0) exp([w] t),  w = W_0 + sign rate e_s,   x' = T U_0

with ``U_0, W_0`` its velocities at phase 0 and Q the rotation by sign phase about s. A plane wave
moves in its plane: heading ``h = int W_r dt``, position ``int R(h) U dt``, both by Fourier series,
and on circles if its mean W_r is not zero.
Everything else is left to `trajectory`. What does not depend on rate and phase is worked out once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.polynomial.polynomial import polyval

from microswim.gait.gait import Gait
from microswim.numerics.rigid_motion import multiply
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


def _plane_wave(gait: Gait) -> Path:
    grid = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    V = gait.velocity(grid, 1.0)
    mean, *turn = np.fft.rfft(V[:, 5]) / SAMPLES
    turn = np.array([0.0, *2.0 * np.array(turn[:-1])]) / (1j * np.maximum(np.arange(len(turn)), 1))
    heading = polyval(np.exp(1j * grid), turn).real
    step = np.fft.fft(np.exp(1j * heading) * (V[:, 0] + 1j * V[:, 1])) / SAMPLES
    return partial(_along, mean.real, _felt(turn), step[0], *_swings(step, mean.real))


def _swings(step: np.ndarray, turn: float) -> tuple[np.ndarray, np.ndarray]:
    """Powers of ``exp(i phase)`` and of its conjugate of ``int exp(i turn phase) step``, the mean
    left out: ``c_h / i(h + turn)``.
    """
    h = np.arange(1, SAMPLES // 2)
    ahead, back = step[h] / (1j * (h + turn)), step[-h] / (1j * (turn - h))
    return _felt(np.array([0.0, *ahead])), _felt(np.array([0.0, *back]))


def _felt(powers: np.ndarray) -> np.ndarray:
    """Powers without the last that are below `FLOOR` of the largest."""
    size = np.abs(powers)
    return powers[: 1 + int(np.flatnonzero(size > FLOOR * size.max()).max(initial=0))]


def _along(
    mean: float, turn: np.ndarray, step: complex, ahead: np.ndarray, back: np.ndarray,
    rate: float, t: np.ndarray, phase: float,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Path of a heading ``mean (phase - phase_0) + Re sum turn exp(i h phase)``, in the complex
    plane: what advances in a period lies on a circle, or on a straight line if the mean is zero.
    """
    there = rate * t
    z = np.exp(1j * (phase + there))
    angle = polyval(z, turn).real
    swing = polyval(z, ahead) + polyval(z.conj(), back)
    whole = np.exp(1j * mean * there)
    chord = there * np.exp(0.5j * mean * there) * np.sinc(mean * there / (2.0 * np.pi))
    moved = np.exp(-1j * angle[0]) * (step * chord + whole * swing - swing[0])
    half = (mean * there + angle - angle[0]) / 2.0
    zero = np.zeros_like(half)
    path = np.stack([moved.real, moved.imag, zero], axis=-1)
    return path, np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)


def quaternion_of(turn: np.ndarray) -> np.ndarray:
    """Return the unit quaternion of a rotation vector."""
    angle = float(np.linalg.norm(turn))
    return np.concatenate([[np.cos(angle / 2)], 0.5 * np.sinc(angle / (2 * np.pi)) * turn])
