"""Noise together with a field that depends on place or follows a table: step by step.

Along the way that a swimmer is about to go, B and the force ``J' m`` are curves in time. Over a
step h the first is taken as the wave ``B_0 + B_1 cos(a t/h) + B_2 sin(a t/h)`` through its values
at the start, the middle and the end, the second as its mean by Simpson's rule; `brownian` does the
rest. The way there is that of the velocity at the start, so that a step is of order 2 without
noise.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.path import brownian
from microswim.path.velocity import WORK, Loads, velocity
from microswim.swimmer.magnetism.applied_field import AppliedField

TURN = 0.3  #: a, small, and large enough that rounding does not count
SHARES = np.array([0.0, 0.5, 1.0])  #: of a step
_WAVE = np.linalg.inv(np.stack([np.ones(3), np.cos(TURN * SHARES), np.sin(TURN * SHARES)], axis=1))
_SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0


def scatter(
    table: Any, loads: Loads, energy: float, length: float, t: float, h: float, X: Array, Q: Array,
    phase: float, normals: Array, least: Array, field: AppliedField,
) -> None:  # fmt: skip
    """Carry all paths, X (n, 3) and Q (n, 4), on by the steps of `normals` (steps, n, 12).

    As `brownian.scatter`, in a field of its own.
    """
    one = brownian.scatter.over(1)
    for k, kicks in enumerate(normals):
        at = phase + loads.rate * k * h
        B, pull = _felt(table, loads, field, t + k * h, h, X, Q, at)
        for i in range(len(X)):
            own = slice(i, i + 1)
            here = loads._replace(
                force=loads.force + pull[i], field=_WAVE @ B[i], field_rate=TURN / h
            )
            one(table, here, energy, length, 0.0, h, X[own], Q[own], at, kicks[None, own],
                least[own])  # fmt: skip


def _felt(
    table: Any, loads: Loads, field: AppliedField, t: float, h: float, X: Array, Q: Array,
    phase: float,
) -> tuple[Array, Array]:  # fmt: skip
    """Return B (n, 3 times, 3) along the ways ahead, and the mean force (n, 3), lab frame."""
    V = _velocities(table, loads, field, t, X, Q, phase)
    ahead = h * SHARES[:, None]
    places = X[:, None] + ahead * V[:, None, :3]
    half = ahead * V[:, None, 3:] / 2.0
    turns = np.concatenate([np.ones_like(half[..., :1]), half], axis=-1)
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    R = rotation_matrix(multiply(Q[:, None], turns))
    times = np.broadcast_to(t + h * SHARES, places.shape[:-1])
    B = field.at(times, places)
    return B, np.einsum("s,nsi->ni", _SIMPSON, _pull(loads, field.gradient(times, places), B, R))


def _pull(loads: Loads, slope: Array, B: Array, R: Array) -> Array:
    """Return the force ``J' m`` (..., 3), lab frame, on bodies turned by R (..., 3, 3)."""
    C = loads.magnetic[3:].reshape(3, 3)
    moment = loads.magnetic[:3] + np.einsum("ij,...kj,...k->...i", C, np.swapaxes(R, -1, -2), B)
    return np.einsum("...ji,...jk,...k->...i", slope, R, moment)


def _velocities(
    table: Any, loads: Loads, field: AppliedField, t: float, X: Array, Q: Array, phase: float
) -> Array:
    """Velocity (lab) and angular velocity (body) of each swimmer without noise, (n, 6)."""
    V, out, work, kick = np.zeros((len(X), 6)), np.empty(8), np.empty(WORK), np.zeros(6)
    times = np.full(len(X), t)
    B, slope = field.at(times, X), field.gradient(times, X)
    pull = _pull(loads, slope, B, rotation_matrix(Q))
    rows = np.zeros((3, 3))
    for i in range(len(X)):
        rows[0] = B[i]
        here = loads._replace(force=loads.force + pull[i], field=rows)
        if velocity.dispatcher(table, here, t, X[i], Q[i], phase, kick, out, work) > 0.0:
            V[i] = out[:6]
    return V
