"""What a robot does that the field turns too fast for: it slips, and drifts slower.

No steady state is left, so its path is followed in time and its mean velocity is taken under a
smooth window, whose error falls fast with the number of beats.
"""

from __future__ import annotations

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.stepping import integrate, pack
from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.numerics.array import Array

A_TURN = 64  #: time steps of a turn of the field, at least
FEWEST, MOST = 240, 4000  #: turns of the field that are followed
BEATS = 24  #: slips that are wanted
STEEPEST = 0.1  #: rad that the field could turn the robot by in a step


def drift(gait: Gait, steady: SteadyTurning, rate: float) -> tuple[float, float]:
    """Return the mean velocity along the field's axis at a rate, and how far two halves differ.

    Parameters
    ----------
    gait
        Of the robot; its motor stands still at phase 0.
    steady
        Its steady states; it starts from that of the largest rate.
    rate
        Of the field (rad per time).
    """
    lost = rate**2 - steady.step_out**2
    beats = BEATS * rate / np.sqrt(lost) if lost > 0 else 0.0
    turns = int(np.clip(beats, FEWEST, MOST))
    reach = steady.strength * np.linalg.norm(steady.moment)
    spin = reach * np.linalg.norm(steady.mobility[3:], 2)
    each = int(np.ceil(max(A_TURN, 2.0 * np.pi / rate * spin / STEEPEST)))
    times = np.linspace(0.0, 2.0 * np.pi / rate * turns, turns * each + 1)
    ahead = _path(gait, steady, rate, times)[:: each // 8]
    settled = ahead[len(ahead) // 4 :]
    step = times[-1] / (turns * each) * (each // 8)
    whole = _mean(settled, step)
    half = len(settled) // 2
    spread = abs(_mean(settled[:half], step) - _mean(settled[half:], step))
    return whole, spread


def _path(gait: Gait, steady: SteadyTurning, rate: float, times: Array) -> Array:
    """Return the place along the axis, x, of the body's centre at the times."""
    angle = rate * np.linspace(times[0], times[-1], 2 * times.size - 1)
    lean, flat = np.sin(steady.cone), np.cos(steady.cone)
    loads = np.zeros((angle.size, 5, 3))
    loads[:, 2, 0] = lean
    loads[:, 2, 1], loads[:, 2, 2] = flat * np.cos(angle), flat * np.sin(angle)
    loads[:, 2] *= steady.strength
    loads[:, 4] = steady.moment
    counts = np.ones(times.size, np.int64)
    counts[0] = 0
    X, _, _ = integrate(
        *(pack(gait), np.array(gait.free), np.zeros(3), _start(steady), 0.0),
        *(times, counts, np.zeros(1), loads),
    )
    return X[:, 0]


def _start(steady: SteadyTurning) -> Array:
    """Quaternion (wxyz) of the state of the largest rate, the field's axis along x."""
    state = steady.at_step_out
    if state is None:
        return np.array([1.0, 0.0, 0.0, 0.0])
    n, b = state.axis, state.field
    aside = b - (b @ n) * n
    aside /= np.linalg.norm(aside)
    lab = np.array([n, aside, np.cross(n, aside)])  # rows: x, y, z of the lab, body frame
    from scipy.spatial.transform import Rotation  # a gait need not wait for it

    return Rotation.from_matrix(lab).as_quat(scalar_first=True)


def _mean(x: Array, step: float) -> float:
    """Mean velocity under a Hann window."""
    middle = (np.arange(x.size - 1) + 0.5) / (x.size - 1)
    weight = np.sin(np.pi * middle) ** 2
    return float(np.sum(weight * np.diff(x)) / (weight.sum() * step))
