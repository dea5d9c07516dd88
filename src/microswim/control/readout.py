"""What can be read off the motion, compiled: twist, torque of the motor, derivatives of a step."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.control.motion import (
    FIELD,
    FLOW_BENDS,
    MOTOR,
    STATE,
    WORK,
    advance,
    body_strain,
    compiled,
    graded,
    internal_steps,
    relative_twist,
    row,
    velocity,
)
from microswim.numerics.complex_step import STEP
from microswim.numerics.rigid_motion import to_lab


@compiled
def body_twist(twist: Any, phase: Any, rate: Any, wrench: Any, work: Any, out: Any) -> None:
    """Write ``M W + v rate`` into out (6,): phase and wrench in, twist out, body frame."""
    row(twist, phase, work)
    for i in range(6):
        out[i] = work[21 + i] * rate
    m = 0
    for i in range(6):
        for j in range(i):
            out[i] += work[m] * wrench[j]
            out[j] += work[m] * wrench[i]
            m += 1
        out[i] += work[m] * wrench[i]
        m += 1


@compiled
def outputs(
    twist: Any, strain: Any, magnetic: Any, motor: Any, Y: Any, U: Any, work: Any, out: Any
) -> None:
    """Write twist in the body frame (6) and motor torque (1) of all states into (n, 7)."""
    for i in range(Y.shape[0]):
        u, y = U[i if U.shape[0] > 1 else 0], Y[i]
        q, x, B, bends = (
            (y[3], y[4], y[5], y[6]),
            (y[0], y[1], y[2]),
            (u[FIELD], u[FIELD + 1], u[FIELD + 2]),
            graded(u),
        )
        V = relative_twist(twist, strain, magnetic, q, x, y[7], u, B, bends, work)
        v = velocity(twist, strain, magnetic, q, x, y[7], u, B, bends, work)
        row(motor, y[7], work)
        torque = work[6] * u[MOTOR]
        for k in range(6):
            torque += work[k] * V[k]
        if bends & FLOW_BENDS:
            e = body_strain(q, u)
            for k in range(6):
                torque -= work[7 + k] * e[k]
        a, b, c = to_lab(q, v[0], v[1], v[2], -1.0)
        out[i, 0], out[i, 1], out[i, 2] = a, b, c
        out[i, 3], out[i, 4], out[i, 5], out[i, 6] = v[3], v[4], v[5], torque


@compiled
def derivatives(
    twist: Any, strain: Any, magnetic: Any, limits: Any, y: Any, u: Any, dt: float, steps: int,
    columns: Any,
) -> Any:  # fmt: skip
    """Return ``dy'/dy`` (8, 8) and ``dy'/du`` (8, m) for some inputs, by complex steps."""
    n = steps if steps > 0 else internal_steps(limits, u, dt)
    J = np.empty((STATE, STATE + columns.size))
    work = np.empty(WORK, dtype=np.complex128)
    J[:, :3] = 0.0
    for k in range(3):
        J[k, k] = 1.0
    for k in range(0 if graded(u) else 3, J.shape[1]):  # else the same everywhere
        z, w = y.astype(np.complex128), u.astype(np.complex128)
        if k < STATE:
            z[k] += 1j * STEP
        else:
            w[columns[k - STATE]] += 1j * STEP
        advance(twist, strain, magnetic, limits, z, w, dt, n, work)
        J[:, k] = z.imag / STEP
    return J[:, :STATE], J[:, STATE:]


@compiled
def slopes(twist: Any, strain: Any, magnetic: Any, y: Any, u: Any, columns: Any) -> Any:
    """Return velocity (lab), angular velocity (body) and phase rate (7), and their derivatives
    with respect to the state (7, 8) and to some inputs (7, m), by complex steps.
    """
    found, J = np.empty(7), np.empty((7, STATE + columns.size))
    work, bends = np.empty(WORK, dtype=np.complex128), graded(u)
    for k in range(-1, J.shape[1]):
        z, w = y.astype(np.complex128), u.astype(np.complex128)
        if 0 <= k < STATE:
            z[k] += 1j * STEP
        elif k >= STATE:
            w[columns[k - STATE]] += 1j * STEP
        if k >= STATE:
            bends = graded(w)
        q, x, B = (z[3], z[4], z[5], z[6]), (z[0], z[1], z[2]), (w[7], w[8], w[9])
        V = velocity(twist, strain, magnetic, q, x, z[7], w, B, bends, work)
        for i in range(6):
            if k < 0:
                found[i] = V[i].real
            else:
                J[i, k] = V[i].imag / STEP
        if k < 0:
            found[6] = w[0].real
        else:
            J[6, k] = w[0].imag / STEP
    return found, J[:, :STATE], J[:, STATE:]
