"""Thermal noise in a controller's loop: a random displacement on top of each step.

    z ~ N(0, 2 k_B T M dt),    (x, q) -> (x, q) exp(z)

z: displacement and rotation in the body frame, M the mobility of the whole swimmer at its phase;
exp that of rigid motions, so that turning and moving are coupled as they are in `microswim.path`.
A step followed by such a displacement is exact in the mean and in the covariance to first order in
dt. In free fluid no drift is missing (`microswim.path.brownian`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.control.motion import LOWER
from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.numerics.series.fourier import evaluate
from microswim.path.tumbling import tumbled


def scattered(
    twist: Array, values: Array, energy: float, dt: float, random: np.random.Generator
) -> Array:
    """Return states (n, 8) after the thermal displacements of a time dt.

    Parameters
    ----------
    twist
        Series of the lower triangle of M, and more, as `Response.twist` has it.
    values
        States (n, 8).
    energy
        k_B T.
    dt
        Time.
    random
        Where the random numbers come from.
    """
    rows = np.real(evaluate(twist[:, :21], values[:, 7]))
    M = np.zeros((len(values), 6, 6))
    for m, (i, j) in enumerate(LOWER):
        M[:, i, j] = M[:, j, i] = rows[:, m]
    free = np.flatnonzero(M[0].any(axis=0))
    root = np.linalg.cholesky(M[:, free[:, None], free])
    z = np.zeros((len(values), 6))
    z[:, free] = np.einsum("nij,nj->ni", root, random.standard_normal((len(values), free.size)))
    return moved(values, np.sqrt(2.0 * energy * dt) * z)


def moved(values: Array, z: Array) -> Array:
    """Return states (n, 8) carried on by the exponential of twists z (n, 6), body frame."""
    shift, turn = z[:, :3], z[:, 3:]
    a2 = np.sum(turn**2, axis=1, keepdims=True)
    a = np.sqrt(a2)
    near = a < 1e-4
    safe = np.where(near, 1.0, a)
    first = np.where(near, 0.5 - a2 / 24.0, (1.0 - np.cos(a)) / safe**2)
    second = np.where(near, 1.0 / 6.0 - a2 / 120.0, (safe - np.sin(safe)) / safe**3)
    once = np.cross(turn, shift)
    local = shift + first * once + second * np.cross(turn, once)
    out = np.array(values)
    q = values[:, 3:7]
    out[:, :3] += np.einsum("nij,nj->ni", rotation_matrix(q), local)
    half = np.where(near, 0.5 - a2 / 48.0, np.sin(a / 2.0) / safe)
    out[:, 3:7] = multiply(q, np.concatenate([np.cos(a / 2.0), half * turn], axis=1))
    out[:, 3:7] /= np.linalg.norm(out[:, 3:7], axis=1, keepdims=True)
    return out


def tumble(values: Array, swimmer: Any, dt: float, random: np.random.Generator) -> None:
    """Turn states (n, 8) by the tumbles of a time dt, if the swimmer's noise has any."""
    run_time, angle = tumbles_of(swimmer)
    if run_time > 0.0:
        values[:, 3:7] = tumbled(values[:, 3:7], dt / run_time, angle, random)


def tumbles_of(swimmer: Any) -> tuple[float, float]:
    """Return mean time of a run and angle of a tumble of a swimmer; zeros if it does not tumble."""
    tumbles = None if swimmer is None or swimmer.noise is None else swimmer.noise.tumbles
    return (0.0, 0.0) if tumbles is None else (float(tumbles[0]), float(tumbles[1]))


def energy_of(swimmer: Any) -> float | None:
    """Return k_B T of a swimmer's noise, None if it has none."""
    if swimmer is None or swimmer.noise is None:
        return None
    return float(swimmer.noise.energy(swimmer.units))


def checked(swimmer: Any, dt: Any, random: Any, energy: Any) -> float:
    """Return k_B T, that of the swimmer's noise by default; refuse a time or a source of no sense.

    Raises
    ------
    SpecError
        One sentence.
    """
    checks.positive("dt", dt, "time")
    checks.instance("random", random, "Generator")
    energy = energy_of(swimmer) if energy is None else energy
    if energy is None:
        raise SpecError("energy: missing; give k_B T, or a swimmer with noise")
    checks.positive("energy", energy, "energy")
    return float(energy)
