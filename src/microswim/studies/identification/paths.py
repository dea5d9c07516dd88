"""Paths of helices and plane waves in closed form, for fits that need thousands of them.

A rigid helix on a body of revolution has a constant twist in the frame T of its tail, so that

    T(t) = Q(phase_0) exp([w] t),  w = W_0 + sign rate e_s,   x' = T U_0

with ``U_0, W_0`` its velocities at phase 0 and Q the rotation by sign phase about s. A plane wave
moves in its plane: heading ``h = int W_r dt``, position ``int R(h) U dt``, both by Fourier series.
Everything else is left to `trajectory`.
"""

from __future__ import annotations

import numpy as np

from microswim.gait.gait import Gait
from microswim.numerics.rigid_motion import multiply
from microswim.numerics.series.fourier import evaluate, series_of
from microswim.path.trajectory import trajectory
from microswim.swimmer.swimmer import Swimmer

SAMPLES = 64


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
    t = times - times[0]
    tail, free = swimmer.tail, gait.free
    if tail.is_planar and swimmer.interaction.coupling == ((0.0,) * 3,) * 3:
        return _plane_wave(gait, t, phase)
    turning = tail.is_rigid and swimmer.body.is_axisymmetric
    even = free[1] == free[2] and free[4] == free[5] and _alike(swimmer)
    if turning and even:
        return _helix(gait, tail.sign, t, phase)
    path = trajectory(gait, times, phase=phase)
    return path.position.values, path.quaternion.values


def _alike(swimmer: Swimmer) -> bool:
    x = swimmer.interaction
    return x.translation[1] == x.translation[2] and x.rotation[1] == x.rotation[2]


def _helix(gait: Gait, sign: float, t: np.ndarray, phase: float) -> tuple[np.ndarray, np.ndarray]:
    V = gait.velocity(0.0)
    w = V[3:] + sign * gait.rate * np.array([1.0, 0.0, 0.0])
    size = np.linalg.norm(w)
    axis = w / size
    along = axis * (axis @ V[:3])
    across = V[:3] - along
    a = size * t[:, None]
    moved = (
        along * t[:, None] + (across * np.sin(a) + np.cross(axis, across) * (1 - np.cos(a))) / size
    )
    start = _about_s(sign * np.array([phase]))
    turned = np.concatenate([np.cos(a / 2), np.sin(a / 2) * axis], axis=1)
    back = _about_s(-sign * (phase + gait.rate * t))
    c, s = np.cos(sign * phase), np.sin(sign * phase)
    Q = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    return moved @ Q.T, multiply(multiply(start, turned), back)


def _about_s(angle: np.ndarray) -> np.ndarray:
    zero = np.zeros_like(angle)
    return np.stack([np.cos(angle / 2), np.sin(angle / 2), zero, zero], axis=-1)


def _integrated(series: np.ndarray) -> np.ndarray:
    """Series of the integral over the phase of a series' periodic part."""
    out = np.zeros_like(series)
    h = np.arange(1, len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    out[1::2], out[2::2] = -series[2::2] / h, series[1::2] / h
    return out


def _plane_wave(gait: Gait, t: np.ndarray, phase: float) -> tuple[np.ndarray, np.ndarray]:
    grid = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    V = gait.velocity(grid) / gait.rate
    turn = _integrated(series_of(V[:, 5]))
    heading = evaluate(turn, grid)
    c, s = np.cos(heading), np.sin(heading)
    step = series_of(np.stack([c * V[:, 0] - s * V[:, 1], s * V[:, 0] + c * V[:, 1]], axis=-1))
    phases = phase + gait.rate * t
    moved = step[0] * (phases - phase)[:, None] + evaluate(_integrated(step), phases)
    moved = moved - moved[0]
    angle = evaluate(turn, phases)
    c, s = np.cos(angle[0]), np.sin(angle[0])
    x, y = moved[:, 0] * c + moved[:, 1] * s, moved[:, 1] * c - moved[:, 0] * s
    half = (angle - angle[0]) / 2.0
    zero = np.zeros_like(half)
    return np.stack([x, y, zero], -1), np.stack([np.cos(half), zero, zero, np.sin(half)], -1)


def quaternion_of(turn: np.ndarray) -> np.ndarray:
    """Return the unit quaternion of a rotation vector."""
    angle = float(np.linalg.norm(turn))
    return np.concatenate([[np.cos(angle / 2)], 0.5 * np.sinc(angle / (2 * np.pi)) * turn])
