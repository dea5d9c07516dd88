"""First guesses of a fit: designs from a grid, then phase and pose in closed form.

A track shows three things without any fit: the frequency of its wobble, the size of the wobble
and the speed along the smoothed path. A grid of designs is compared with those.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, RectBivariateSpline

from microswim.calibration.atlas.choice import not_atlas
from microswim.calibration.atlas.everywhere import everywhere
from microswim.errors import MicroswimError
from microswim.gait.screw import screw
from microswim.models.rft.batch import evaluate
from microswim.numerics.compiling.compiled import settled
from microswim.studies.identification.average_path import average_path
from microswim.studies.identification.fitting.problem import (
    CURVATURE,
    FREQUENCY,
    PathProblem,
    quick_gait,
)
from microswim.studies.identification.spectrum import line
from microswim.swimmer.fields import lifted
from microswim.swimmer.parts import replaced
from microswim.swimmer.swimmer import Swimmer

AMPLITUDE, WAVES = "tail.amplitude", "tail.waves"
PHASES = 16
MOST = 8  #: designs of a line that are followed
COARSER = 4  #: steps of the grid between designs that are solved one by one
MISS = 0.02  #: of the speed, by which a near miss may miss


@dataclass(frozen=True, eq=False)
class Grid:
    """Speed and wobble of a grid of designs, at the spec's own frequency: no track is in it.

    Parameters
    ----------
    amplitude, waves
        The grid: 0.3 to 3 times the swimmer's own, and 0.75 to 5.5; one value if it is known.
    speed, wobble, turn, spin, axial
        Swimming speed, amplitudes of u_q and w_r, and means of w_s and u_s of each, the tail's
        amplitude running slowest.
    swimmer
        Whose designs they are.
    """

    amplitude: np.ndarray
    waves: np.ndarray
    speed: np.ndarray
    wobble: np.ndarray
    turn: np.ndarray
    spin: np.ndarray
    axial: np.ndarray
    swimmer: Swimmer

    @classmethod
    def of(cls, swimmer: Swimmer, names: Iterable[str]) -> Grid | None:
        """Return the grid of the unknowns among amplitude and waves, None if neither is one; of
        a beat with a mean curvature that of none.
        """
        own, names = swimmer.numbers, set(names)
        if CURVATURE in own:
            swimmer = replaced(swimmer, "tail", replaced(swimmer.tail, "mean_curvature", 0.0))
        b, n = np.ones(1), np.ones(1)
        if AMPLITUDE in names:
            b = own[AMPLITUDE] * np.geomspace(0.3, 3.0, 41)
        if WAVES in names:
            n = np.linspace(0.75, 5.5, 96)
        B, N = np.meshgrid(b, n, indexing="ij")
        axes = {k: v.ravel() for k, v in ((AMPLITUDE, B), (WAVES, N)) if k in names}
        if not swimmer.tail.in_batches and set(axes) == {AMPLITUDE, WAVES}:
            return cls(b, n, *_between(swimmer, b, n), swimmer=swimmer)
        return cls(b, n, *shown(swimmer, axes), swimmer=swimmer) if axes else None


def _between(swimmer: Swimmer, b: np.ndarray, n: np.ndarray) -> list[np.ndarray]:
    """Return `shown` of a grid by splines through every fourth design, solved one by one."""
    x, y = np.log(b[::COARSER]), n[np.unique([*range(0, n.size, COARSER - 1), n.size - 1])]
    B, N = np.meshgrid(np.exp(x), y, indexing="ij")
    found = shown(swimmer, {AMPLITUDE: B.ravel(), WAVES: N.ravel()})
    maps = [np.nan_to_num(v.reshape(B.shape)) for v in found]  # what cannot be built swims not
    return [RectBivariateSpline(x, y, v)(np.log(b), n).ravel() for v in maps]


@settled(True)
def _one_by_one(swimmer: Swimmer, axes: dict[str, np.ndarray]) -> tuple[np.ndarray, ...]:
    """`shown` of designs that no loop takes many of, by the gaits that a fit takes."""
    rows = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of laws beyond their range: those guesses lead nowhere
        for values in zip(*axes.values()):
            try:
                made = quick_gait(lifted(swimmer, dict(zip(axes, map(float, values)))))
                swing = made.velocity_amplitude
                mean = made.mean_velocity
                rows.append((screw(made).speed, swing[1], swing[5], mean[3], mean[0]))
            except (MicroswimError, np.linalg.LinAlgError, ValueError):
                rows.append((np.nan,) * 5)
    return tuple(np.array(rows, dtype=float).T)


def shown(swimmer: Swimmer, axes: dict[str, np.ndarray]) -> tuple[np.ndarray, ...]:
    """Return swimming speed, amplitudes of u_q and w_r, and means of w_s and u_s of designs."""
    if not swimmer.tail.in_batches:
        return _one_by_one(swimmer, axes)
    found = np.array(_side_by_side(swimmer, axes))
    by_atlas = None if not_atlas(swimmer) else everywhere(swimmer)
    if by_atlas is not None:
        better = np.array(_side_by_side(by_atlas, axes))
        found = np.where(np.isfinite(better).all(axis=0), better, found)
    return tuple(found)


def _side_by_side(swimmer: Swimmer, axes: dict[str, np.ndarray]) -> tuple[np.ndarray, ...]:
    """`shown` of designs by one batch; NaN where it does not cover them."""
    found = evaluate(swimmer, axes, tolerance=1e-3)
    swing, mean = found["velocity_amplitude"], found["mean_velocity"]
    return found["swimming_speed"], swing[:, 1], swing[:, 5], mean[:, 3], mean[:, 0]


@dataclass(frozen=True, eq=False)
class Designs:
    """The designs of a grid beside a track.

    Parameters
    ----------
    problem
        Whose swimmer it is; what is not unknown keeps its value.
    grid
        Of its unknowns.
    """

    problem: PathProblem
    grid: Grid

    def _seen(self, frequency: float) -> tuple[np.ndarray, np.ndarray]:
        grid = self.grid
        return seen(self.problem, grid.speed, grid.wobble, grid.spin, frequency)

    def design(self, i: int, j: int) -> dict[str, float]:
        """Return the numbers of a cell that are unknown."""
        found = {AMPLITUDE: float(self.grid.amplitude[i]), WAVES: float(self.grid.waves[j])}
        return {k: v for k, v in found.items() if k in self.problem.names}

    def like(self, frequency: float, speed: float, wobble: float, count: int) -> list[Any]:
        """Return designs of a speed and wobble, minima of the misfit over the grid, best first."""
        misfit = _misfit(*self._seen(frequency), speed, wobble)
        cells = minima(misfit.reshape(self.grid.amplitude.size, self.grid.waves.size))
        return [self.design(i, j) | {FREQUENCY: frequency} for i, j in cells[:count]]

    def beside(self, found: dict[str, float]) -> list[Any]:
        """Return designs whose speed and wobble are those of one that fits.

        Along the line of designs that wobble alike the speed swings with the number of waves: each
        crossing of the one wanted, and each near miss, is a design.
        """
        one = {k: np.array([v]) for k, v in found.items() if k in (AMPLITUDE, WAVES)}
        f = found[FREQUENCY]
        speed, wobble, _, spin, _ = shown(self.problem.swimmer, one)
        here = seen(self.problem, speed, wobble, spin, f)
        speed, wobble = float(here[0][0]), float(here[1][0])
        if min(self.grid.amplitude.size, self.grid.waves.size) == 1:
            return self.like(f, speed, wobble, MOST)
        maps = [x.reshape(self.grid.amplitude.size, -1) for x in self._seen(f)]
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = [np.log(x / y) for x, y in zip(maps, (speed, wobble))]
        lines: dict[int, list[tuple[float, float, float]]] = {}
        b = np.log(self.grid.amplitude)
        for j, n in enumerate(self.grid.waves):
            for k, crossing in enumerate(_crossings(b, logs[1][:, j])):
                off = float(np.interp(crossing, b, logs[0][:, j]))
                lines.setdefault(k, []).append((crossing, off, float(n)))
        pairs = [pair for line in lines.values() for pair in _swings(np.array(line))]
        return [{AMPLITUDE: float(np.exp(x)), WAVES: n, FREQUENCY: f} for x, n in pairs]


def _crossings(x: np.ndarray, y: np.ndarray) -> list[float]:
    """Where a line through points crosses zero."""
    i = np.flatnonzero(np.isfinite(y[:-1]) & np.isfinite(y[1:]) & (y[:-1] * y[1:] <= 0.0))
    return [float(x[k] + (x[k + 1] - x[k]) * y[k] / (y[k] - y[k + 1] or 1.0)) for k in i]


def _swings(line: np.ndarray) -> list[tuple[float, float]]:
    """Crossings and near misses of zero of a smooth line: columns log b, speed, waves."""
    line = line[np.isfinite(line[:, 1])]
    if len(line) < 4:
        return []
    fine = np.linspace(line[0, 2], line[-1, 2], 20 * len(line))
    smooth = CubicSpline(line[:, 2], line[:, :2])(fine)
    b, off = smooth.T
    across = list(np.flatnonzero(off[:-1] * off[1:] <= 0.0))
    size = np.abs(off)
    lowest = 1 + np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]))
    near = [i for i in lowest if size[i] < MISS and not any(abs(i - k) < 3 for k in across)]
    return [(float(b[i]), float(fine[i])) for i in sorted(across + near)]


def first_guesses(problem: PathProblem, designs: Designs | None, count: int) -> list[Any]:
    """Return designs whose speed, wobble and frequency are those of the track, the best first."""
    frequency, speed, wobble = seen_in(problem)
    if designs is None:
        return [{FREQUENCY: frequency}]
    return designs.like(frequency, speed, wobble, count)


def seen_in(problem: PathProblem) -> tuple[float, float, float]:
    """Return frequency, speed and wobble of the track; off its average path if it may circle."""
    track = problem.track
    if CURVATURE not in problem.names:
        frequency, wobble, _ = track.wobble()
        return frequency, track.speed, wobble
    seen = line(track.time, track.position)
    if not np.isfinite(seen.frequency):
        frequency, wobble, _ = track.wobble()
        return frequency, track.speed, wobble
    path = average_path(track.time, track.position, 1.0 / seen.frequency)
    inner = (track.time >= path.time[0]) & (track.time <= path.time[-1])
    off = path.seen_from(track.time[inner], track.position[inner], path.heading)
    wobble = float(np.sqrt(max(2.0 * np.mean(np.sum(off**2, axis=1)) - 4.0 * seen.noise**2, 0.0)))
    return seen.frequency, path.speed().value, max(wobble, seen.amplitude)


def curvature_guess(problem: PathProblem, values: np.ndarray) -> float:
    """Return the mean curvature with which a design turns as the track does: for a slight one the
    rate of turning goes with it.
    """
    seen = line(problem.track.time, problem.track.position)
    path = average_path(problem.track.time, problem.track.position, 1.0 / seen.frequency)
    turned = float(path.heading[-1] - path.heading[0]) / float(path.time[-1] - path.time[0])
    i = problem.names.index(CURVATURE)
    slight = np.array(values)
    slight[i] = problem.typical[i]
    return turned / float(problem.gait(slight).mean_velocity[5]) * float(slight[i])


def seen(
    problem: PathProblem, speed: np.ndarray, wobble: np.ndarray, spin: np.ndarray, frequency: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the speed and the size of the wobble of designs that wobble with a frequency.

    A circle of radius r shows ``sqrt(2) r`` in `Track.wobble`, seen from the side or in a plane r.
    """
    own = problem.swimmer.tail.frequency
    rate = frequency if FREQUENCY in problem.names else own
    share = rate / own
    if problem.swimmer.tail.is_rigid and problem.swimmer.motion.frequency_frame == "body":
        turned = problem.swimmer.tail.sign * spin / (2.0 * np.pi * own)
        share = share / (1.0 + turned) if FREQUENCY in problem.names else share
    whole = problem.swimmer.tail.is_rigid and problem.track.dimensions == 3
    size = wobble * share / (2.0 * np.pi * rate)
    return speed * share, size * (np.sqrt(2.0) if whole else 1.0)


def _misfit(speeds: np.ndarray, sizes: np.ndarray, speed: float, wobble: float) -> np.ndarray:
    """Squared logarithms of speed and wobble over those wanted; NaN becomes infinite."""
    with np.errstate(divide="ignore", invalid="ignore"):
        misfit = np.log(speeds / max(speed, 1e-300)) ** 2 + np.log(sizes / max(wobble, 1e-300)) ** 2
    return np.where(np.isfinite(misfit), misfit, np.inf)


def minima(misfit: np.ndarray) -> list[tuple[int, int]]:
    """Return the cells of a map that lie below their neighbours, the lowest first."""
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
