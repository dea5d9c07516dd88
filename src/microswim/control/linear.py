"""A step linearised for a controller: state space in position, small rotation and phase.

The quaternion has four numbers for three freedoms, so a model with all four is not controllable. A
small rotation theta (rad, body frame) leaves ``q exp(theta/2) = q + G theta``, and ``4 G'`` takes
it back: ``dx = [position (lab), theta (body), phase]`` has seven. In continuous time

    theta' = d omega/d(x, q, phase) dx - omega x theta + d omega/du du
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from microswim.numerics.rigid_motion import skew


class StateSpace(NamedTuple):
    """``x[k+1] = A x[k] + B u[k]``, ``y[k] = C x[k] + D u[k]``, in small differences.

    In continuous time ``x' = A x + B u``.

    Parameters
    ----------
    A, B, C, D
        (7, 7), (7, m), (7, 7) and (7, m): all of the state is an output, at once.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray


def attitude_columns(q: np.ndarray) -> np.ndarray:
    """Return g (4, 3): change of a quaternion ``wxyz`` per small rotation about the body's axes."""
    w, x, y, z = q
    return np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2.0


def error_state(A: np.ndarray, B: np.ndarray, q: np.ndarray, after: np.ndarray) -> StateSpace:
    """Return derivatives (8, 8), (8, m) of a step from attitude q to another as state space."""
    into, back = np.zeros((8, 7)), np.zeros((7, 8))
    into[:3, :3] = back[:3, :3] = np.eye(3)
    into[3:7, 3:6], back[3:6, 3:7] = attitude_columns(q), 4.0 * attitude_columns(after).T
    into[7, 6] = back[6, 7] = 1.0
    B = back @ B
    return StateSpace(back @ A @ into, B, np.eye(7), np.zeros_like(B))


def continuous(slope: np.ndarray, A: np.ndarray, B: np.ndarray, q: np.ndarray) -> StateSpace:
    """Return state space of velocities (7,) and their derivatives (7, 8), (7, m) at attitude q."""
    into = np.zeros((8, 7))
    into[:3, :3], into[3:7, 3:6], into[7, 6] = np.eye(3), attitude_columns(q), 1.0
    A = A @ into
    A[3:6, 3:6] -= skew(slope[3:6])
    return StateSpace(A, B, np.eye(7), np.zeros_like(B))
