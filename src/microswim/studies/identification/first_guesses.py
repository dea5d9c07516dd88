"""First guesses of a fit: designs from a grid, then phase and pose in closed form.

A track shows three things without any fit: the frequency of its wobble, the size of the wobble
and the speed along the smoothed path. A grid of designs is compared with those.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.models.rft.batch import evaluate
from microswim.studies.identification.problem import FREQUENCY, PathProblem

AMPLITUDE, WAVES = "tail.amplitude", "tail.waves"
PHASES = 16


def first_guesses(problem: PathProblem, count: int) -> list[dict[str, float]]:
    """Return designs whose speed, wobble and frequency are those of the track, the best first.

    They are local minima of the misfit over a grid of amplitudes (0.3 to 3 times the swimmer's own)
    and numbers of waves (0.75 to 5.5); what is not unknown keeps its value.
    """
    frequency, wobble, _ = problem.track.wobble()
    own = problem.swimmer.numbers
    names = set(problem.names)
    b = own.get(AMPLITUDE, 0.0) * (np.geomspace(0.3, 3.0, 41) if AMPLITUDE in names else np.ones(1))
    free_waves = WAVES in names
    n = np.linspace(0.75, 5.5, 96) if free_waves else np.ones(1)
    B, N = np.meshgrid(b, n, indexing="ij")
    grid = {AMPLITUDE: B.ravel()} if AMPLITUDE in own else {}
    grid |= {WAVES: N.ravel()} if free_waves else {}
    if not grid:
        return [{FREQUENCY: frequency}]
    result = evaluate(problem.swimmer, grid, tolerance=1e-3)
    misfit = _misfit(problem, result, frequency, wobble).reshape(B.shape)
    out = []
    for i, j in _minima(misfit)[:count]:
        guess = {AMPLITUDE: float(B[i, j])} | ({WAVES: float(N[i, j])} if free_waves else {})
        out.append(guess | {FREQUENCY: frequency})
    return out


def _misfit(
    problem: PathProblem, result: dict[str, Any], frequency: float, wobble: float
) -> np.ndarray:
    """Squared logarithms of speed and wobble over the track's; NaN becomes infinite.

    A circle of radius r shows ``sqrt(2) r`` in `Track.wobble`, seen from the side or in a plane r.
    """
    own = problem.swimmer.tail.frequency
    rate = frequency if FREQUENCY in problem.names else own
    share = rate / own
    if problem.swimmer.tail.is_rigid and problem.swimmer.motion.frequency_frame == "body":
        spin = problem.swimmer.tail.sign * result["mean_velocity"][:, 3] / (2.0 * np.pi * own)
        share = share / (1.0 + spin) if FREQUENCY in problem.names else share
    whole = problem.swimmer.tail.is_rigid and problem.track.dimensions == 3
    size = result["velocity_amplitude"][:, 1] * share / (2.0 * np.pi * rate)
    size = size * (np.sqrt(2.0) if whole else 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        speed = np.log(result["swimming_speed"] * share / max(problem.track.speed, 1e-300))
        lateral = np.log(size / max(wobble, 1e-300))
    misfit = speed**2 + lateral**2
    return np.where(np.isfinite(misfit), misfit, np.inf)


def _minima(misfit: np.ndarray) -> list[tuple[int, int]]:
    """Cells of a map that lie below their neighbours, the lowest first."""
    padded = np.pad(misfit, 1, constant_values=np.inf)
    shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    rows, columns = misfit.shape
    around = np.min(
        [padded[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i, j in shifts], axis=0
    )
    cells = np.argwhere((misfit <= around) & np.isfinite(misfit))
    return sorted(((int(i), int(j)) for i, j in cells), key=lambda c: misfit[c])


def initial_poses(problem: PathProblem, values: np.ndarray, count: int = 2) -> list[np.ndarray]:
    """Return parameters with a design's best phases, each with its pose in closed form."""
    found = []
    for phase in 2.0 * np.pi * np.arange(PHASES) / PHASES:
        path, _ = problem.body_path(values, phase)
        z = np.concatenate([values, [phase], pose_of(problem, path)])
        found.append((float(np.sum(problem.residuals(z) ** 2)), z))
    found.sort(key=lambda pair: pair[0])
    return [z for _, z in found[:count]]


def pose_of(problem: PathProblem, path: np.ndarray) -> np.ndarray:
    """Return the rotation and position that lay a path onto the track (Kabsch 1976).

    For a projection of a 3-D path only the heading in the image is chosen, the swimmer lies in it.
    """
    d = problem.track.dimensions
    x, y = path[:, :d], problem.track.position
    U, _, Vt = np.linalg.svd((y - y.mean(axis=0)).T @ (x - x.mean(axis=0)))
    flip = np.ones(d)
    flip[-1] = np.sign(np.linalg.det(U @ Vt))
    Q = U @ (flip[:, None] * Vt)
    shift = y.mean(axis=0) - Q @ x.mean(axis=0)
    if d == 3:
        return np.concatenate([rotation_vector(Q), shift])
    heading = float(np.arctan2(Q[1, 0], Q[0, 0]))
    return np.concatenate([[heading] if problem.planar else [0.0, 0.0, heading], shift])


def rotation_vector(Q: np.ndarray) -> np.ndarray:
    """Return the rotation vector of a rotation matrix."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(Q).as_rotvec()
