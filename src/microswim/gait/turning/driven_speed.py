"""Velocity of a robot along the axis of its rotating field, at the rate at which that turns.

A robot that follows is in a steady state (module `steady_turning`): b solves

    b . S b = sin(psi) |N b|      B |N b| = w      |b| = 1

by Newton's method, which runs in complex numbers too. One that has stepped out slips; its path is
followed and averaged (module `slipping`), and the derivative of that is a central difference; so is
that of a robot with a soft magnet.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.turning.slipping import drift
from microswim.gait.turning.slopes import with_slopes
from microswim.gait.turning.step_out import Drive, check_free, mobility_of, steady
from microswim.numerics.rigid_motion import skew

STEPS = 12


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
    if states and drive.softness is None:
        return _followed(gait, drive, states[0].field)
    return with_slopes(_mean, gait, drive)


def _followed(gait: Gait, drive: Drive, b: np.ndarray) -> Any:
    M, m = mobility_of(gait), np.asarray(drive.moment)
    N, lean = M[3:] @ skew(m), np.sin(drive.cone)
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
    return drive.strength * (M[:3] @ skew(m) @ b) @ turn / np.sqrt(turn @ turn)


def _mean(gait: Gait, drive: Drive) -> np.ndarray:
    """Return the mean velocity of a path, or of the state that is held."""
    turning, rate = steady(gait, drive), float(drive.rate)
    states = turning.states(rate) if drive.softness is not None else []
    return np.array(float(states[0].velocity) if states else drift(turning, rate)[0])
