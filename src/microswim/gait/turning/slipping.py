"""What a robot does that the field turns too fast for: it slips, and drifts slower.

No steady state is left, so it is followed in time and its mean velocity is taken under a smooth
window, whose error falls fast with the number of beats. With the axis n of the field and its
direction b seen from the body, nothing else of the pose counts:

    n' = -Omega x n      b' = -Omega x b + w n x b      [V; Omega] = B M (m x b)

with ``m = m_0 + B C b``, by a Runge-Kutta method of order 4.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import compiled

A_TURN = 64  #: time steps of a turn of the field, at least
FEWEST, MOST = 240, 4000  #: turns of the field that are followed
BEATS = 24  #: slips that are wanted
STEEPEST = 0.1  #: rad that the field could turn the robot by in a step


def drift(steady: SteadyTurning, rate: float) -> tuple[float, float]:
    """Return the mean velocity along the field's axis at a rate, and how far two halves differ.

    Parameters
    ----------
    steady
        Steady states of the robot; it starts from that of the largest rate.
    rate
        Of the field (rad per time).
    """
    lost = rate**2 - steady.step_out**2
    beats = BEATS * rate / np.sqrt(lost) if lost > 0 else 0.0
    turns = int(np.clip(beats, FEWEST, MOST))
    spin = steady.pull * np.linalg.norm(steady.mobility[3:], 2)
    each = 8 * int(np.ceil(max(A_TURN, 2.0 * np.pi / rate * spin / STEEPEST) / 8))
    step = 2.0 * np.pi / rate / each
    ahead = _path(steady, rate, step, 8 * turns, each // 8)
    settled = ahead[len(ahead) // 4 :]
    whole = _mean(settled, step * (each // 8))
    half = len(settled) // 2
    first, last = (_mean(part, step * (each // 8)) for part in (settled[:half], settled[half:]))
    return whole, abs(first - last)


def _path(steady: SteadyTurning, rate: float, step: float, samples: int, each: int) -> Array:
    """Return the place along the axis of the body's centre, every so many steps."""
    ahead = np.zeros(samples + 1)
    numbers = np.append(steady.magnetic, steady.strength)
    follow(steady.mobility, numbers, float(rate), _start(steady), step, each, ahead)
    return ahead


def _start(steady: SteadyTurning) -> Array:
    """Axis and field seen from the body (6,) in the state of the largest rate."""
    state = steady.at_step_out
    if state is not None:
        return np.concatenate([state.axis, state.field])
    lean, flat = np.sin(steady.cone), np.cos(steady.cone)
    return np.array([1.0, 0.0, 0.0, lean, flat, 0.0])


def _mean(x: Array, step: float) -> float:
    """Mean velocity under a Hann window."""
    middle = (np.arange(x.size - 1) + 0.5) / (x.size - 1)
    weight = np.sin(np.pi * middle) ** 2
    return float(np.sum(weight * np.diff(x)) / (weight.sum() * step))


@compiled()
def change(M: Any, numbers: Any, rate: Any, y: Any, out: Any) -> None:
    """Write n', b' and the velocity along n (7,); numbers: m_0, C row by row, B."""
    B = numbers[12]
    T, b = out[:3], y[3:6]
    m0, m1, m2 = numbers[0], numbers[1], numbers[2]
    for k in range(3):
        m0 += B * numbers[3 + k] * b[k]
        m1 += B * numbers[6 + k] * b[k]
        m2 += B * numbers[9 + k] * b[k]
    t0, t1, t2 = m1 * b[2] - m2 * b[1], m2 * b[0] - m0 * b[2], m0 * b[1] - m1 * b[0]
    along = 0.0
    for i in range(3):
        along += B * y[i] * (M[i, 0] * t0 + M[i, 1] * t1 + M[i, 2] * t2)
        T[i] = B * (M[3 + i, 0] * t0 + M[3 + i, 1] * t1 + M[3 + i, 2] * t2)
    w0, w1, w2 = T[0], T[1], T[2]
    a0, a1, a2 = rate * y[0] - w0, rate * y[1] - w1, rate * y[2] - w2
    out[3], out[4], out[5] = a1 * b[2] - a2 * b[1], a2 * b[0] - a0 * b[2], a0 * b[1] - a1 * b[0]
    out[0], out[1], out[2] = w2 * y[1] - w1 * y[2], w0 * y[2] - w2 * y[0], w1 * y[0] - w0 * y[1]
    out[6] = along


@compiled(always=True)
def follow(M: Any, numbers: Any, rate: Any, start: Any, h: Any, each: int, ahead: Any) -> None:
    """Follow n and b, y (6,), for `each` steps between the entries of `ahead`, the way along n."""
    y, at, k, total = start.copy(), np.empty(6), np.empty(7), np.empty(7)
    for j in range(1, ahead.size):
        ahead[j] = ahead[j - 1]
        for _ in range(each):
            for i in range(6):
                at[i] = y[i]
            for stage in range(4):
                change(M, numbers, rate, at, k)
                weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
                further = h if stage == 2 else h / 2.0
                for i in range(7):
                    total[i] = weight * k[i] + (total[i] if stage else 0.0)
                for i in range(6):
                    at[i] = y[i] + further * k[i]
            for i in range(6):
                y[i] += total[i]
            ahead[j] += total[6]
            for first in (0, 3):
                one = 0.0
                for i in range(3):
                    one += y[first + i] * y[first + i]
                for i in range(3):
                    y[first + i] *= 1.5 - 0.5 * one
