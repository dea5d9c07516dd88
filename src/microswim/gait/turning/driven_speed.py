"""Velocity of a robot along the axis of its rotating field, at the rate at which that turns.

A robot that follows is in a steady state (module `steady_turning`): b solves

    b . S b = sin(psi) |N b|      B |N b| = w      |b| = 1

by Newton's method, which runs in complex numbers too. One that has stepped out slips; its path is
followed and averaged (module `slipping`), and the derivative of that is a central difference.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.turning.slipping import drift
from microswim.gait.turning.steady_turning import SteadyTurning, cross
from microswim.gait.turning.step_out import Drive, check_free, mobility_of, steady

STEPS = 12
APART = 2e-3  #: relative step of a difference


def driven_velocity(gait: Gait, drive: Drive) -> Any:
    """Return the mean velocity along the field's axis, positive for a right-hand screw.

    Parameters
    ----------
    gait
        Of the robot; its motor stands still at phase 0.
    drive
        Moment, and strength, cone and rate of the field. Where several states are held, the one
        that is reached by raising the rate slowly counts.

    Raises
    ------
    SpecError
        If a rotation is held.
    """
    check_free(gait)
    states = steady(gait, drive).states(float(np.real(drive.rate)))
    if states:
        return _followed(gait, drive, states[0].field)
    return _slipped(gait, drive)


def _followed(gait: Gait, drive: Drive, b: np.ndarray) -> Any:
    M, m = mobility_of(gait), np.asarray(drive.moment)
    N, lean = M[3:] @ cross(m), np.sin(drive.cone)
    size = np.linalg.norm(np.real(N))  # all of size one, or rounding rules the small equations
    N, square = N / size, (drive.rate / (drive.strength * size)) ** 2
    A, S = N.T @ N, (N + N.T) / 2.0
    b = b.astype(np.result_type(N, square, lean, float))
    for _ in range(STEPS):
        size = np.sqrt(b @ A @ b)
        F = np.array([b @ S @ b - lean * size, b @ A @ b - square, b @ b - 1.0])
        J = np.stack([2.0 * S @ b - lean * (A @ b) / size, 2.0 * A @ b, 2.0 * b])
        step = np.linalg.lstsq(J, F, rcond=1e-12)[0]
        b = b - step
        if np.abs(step).max() < 1e-15:
            break
    turn = N @ b
    return drive.strength * (M[:3] @ cross(m) @ b) @ turn / np.sqrt(turn @ turn)


def _slipped(gait: Gait, drive: Drive) -> Any:
    """Return the mean of a path; where numbers are complex, with the slope along their imaginary
    parts.
    """
    R = gait.resistance(0.0)
    parts = [
        R,
        np.asarray(drive.moment),
        *map(np.asarray, (drive.strength, drive.cone, drive.rate)),
    ]
    if not any(np.iscomplexobj(p) for p in parts):
        return _mean(gait, parts)
    sizes = [np.abs(np.imag(p)).max() / (np.abs(np.real(p)).max() or 1.0) for p in parts]
    step = APART / max(max(sizes), 1e-300)
    up, down = (_mean(gait, [np.real(p) + s * step * np.imag(p) for p in parts]) for s in (1, -1))
    return _mean(gait, [np.real(p) for p in parts]) + 1j * (up - down) / (2.0 * step)


def _mean(gait: Gait, parts: list[Any]) -> float:
    R, moment, strength, cone, rate = parts
    still = Gait(np.array([R]), np.zeros((1, 6)), np.zeros(1), rate=0.0, free=gait.free)
    turning = SteadyTurning(mobility_of(still), moment, float(strength), float(cone))
    return drift(turning, float(rate))[0]
