"""Identify a swimmer from its track [Tabak Sections 4.1, 5]: wave shape and rate by least squares.

The path depends on the design through the gait alone: ``x(t) = x_0 + R_0 p(t; design, phase_0)``
with the path p of a swimmer that starts at the origin. The frequency comes from the track's
spectrum, first guesses from a grid of designs, then amplitude, number of waves, frequency (and
what else is asked for) are fitted together with the unknown initial pose and phase.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from microswim.calibration.calibrate import lift
from microswim.calibration.identifiability import determined
from microswim.calibration.unknowns import Unknown, resolve
from microswim.errors import MicroswimError
from microswim.gait.gait import Gait
from microswim.models.rft.gait import gait as surrogate
from microswim.numerics.compiled import settled
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.studies.identification.first_guesses import first_guesses, initial_poses
from microswim.studies.identification.paths import path_of, quaternion_of
from microswim.studies.identification.result import Identification, distinct_from, remarks
from microswim.studies.identification.track import Track
from microswim.swimmer.swimmer import Swimmer

SHAPE = ("tail.amplitude", "tail.waves", "tail.frequency")
FREQUENCY = "tail.frequency"
LOW = {"tail.amplitude": 1e-9, "tail.waves": 0.3}


@settled(True)  # thousands of gaits, one by one
def identify_swimmer(
    swimmer: Swimmer,
    track: Track,
    unknowns: Iterable[str] = SHAPE,
    *,
    sigma: float | None = None,
    sigma_attitude: float | None = None,
    start: dict[str, float] | None = None,
    starts: int = 8,
    progress: Callable[[int, int], None] | None = None,
) -> Identification:
    """Find wave shape and rate of a swimmer from its track.

    Parameters
    ----------
    swimmer
        What is known of it: body, filament, fluid; what is not unknown stays as it is.
    track
        Times and positions of the body's centre, 2-D (projection) or 3-D, noisy.
    unknowns
        Dotted numbers of the spec, or interaction coefficients such as ``"translation.s"``;
        amplitude, number of waves and frequency by default.
    sigma
        Standard deviation of the noise of each coordinate; estimated from the fit by default.
    sigma_attitude
        Of the attitude (rad), if the track has one; 0.02 by default.
    start
        First guess by name; a grid of designs is searched if there is none.
    starts
        Number of first guesses out of the grid that are followed.
    progress
        Called with the number of fits done and in all.

    Returns
    -------
    Identification

    Raises
    ------
    SpecError
        If an unknown does not exist or the track is too short.
    MicroswimError
        If no fit converges.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> t = np.linspace(0, 12, 240)
    >>> track = ms.Track(time=t, position=ms.trajectory(swimmer.gait(), t).position.values)
    >>> guess = {"tail.amplitude": 0.11, "tail.waves": 2.9, "tail.frequency": 1.0}
    >>> found = ms.identify_swimmer(swimmer, track, start=guess)
    >>> [round(float(v), 3) for v in found.values]
    [0.1, 3.0, 1.0]
    """
    chosen = resolve(swimmer, unknowns)
    problem = PathProblem(swimmer, track, chosen, sigma_attitude or 0.02, sigma)
    guesses = [start] if start is not None else first_guesses(problem, starts)
    fits = []
    for i, guess in enumerate(guesses):
        fits += problem.fit(guess, motor=start is not None)
        if progress is not None:
            progress(i + 1, len(guesses))
    if not fits:
        raise MicroswimError("no first guess led to a path like the track; give start values")
    return problem.outcome(sorted(fits, key=lambda fit: fit.cost))


@dataclass(frozen=True)
class PathProblem:
    """Residuals of the track; the last entries of the parameters are phase and pose."""

    swimmer: Swimmer
    track: Track
    unknowns: tuple[Unknown, ...]
    sigma_attitude: float
    sigma: float | None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(u.name for u in self.unknowns)

    @cached_property
    def planar(self) -> bool:
        """Whether the path stays in the image: a plane wave seen in 2-D."""
        return self.swimmer.tail.is_planar and self.track.dimensions == 2

    @cached_property
    def scale(self) -> float:
        """Size of the noise that the fit starts from."""
        if self.sigma is not None:
            return self.sigma
        left = self.track.position - self.track.smooth
        return max(float(left.std()), 1e-12)

    def gait(self, z: np.ndarray) -> Gait:
        """Gait of a design whose frequency is that of the wobble, see `wobble_ratio`."""
        made = self._gait(z)
        return made.at_rate(made.rate / _ratio(made, self.swimmer)) if self.wobbles else made

    def _gait(self, values: np.ndarray) -> Gait:
        options = {} if self.swimmer.tail.is_rigid else {"phases": 10, "nodes": 48}
        return surrogate(lift(self.swimmer, self.unknowns, [float(v) for v in values]), **options)

    @cached_property
    def wobbles(self) -> bool:
        """Whether the fit's frequency is that of the wobble in the lab and not the motor's.

        The two differ by the body's counter-rotation. The track shows the former to a fraction of a
        cycle whatever the design, so the fit takes it as its parameter.
        """
        rigid = self.swimmer.tail.is_rigid and self.swimmer.motion.frequency_frame == "body"
        return rigid and FREQUENCY in self.names

    def physical(self, z: np.ndarray) -> np.ndarray:
        """Values of the unknowns, the motor's frequency among them, from the fit's parameters."""
        values = np.array(z[: len(self.unknowns)], dtype=float)
        if self.wobbles:
            values[self.names.index(FREQUENCY)] /= _ratio(self._gait(values), self.swimmer)
        return values

    def _slope(self, z: np.ndarray) -> np.ndarray:
        """d parameters / d values: the inverse of d physical / d z, by central differences."""
        n = len(self.unknowns)
        columns = []
        for i in range(n):
            h = 1e-6 * max(abs(z[i]), 1e-2)
            step = h * np.eye(n)[i]
            columns.append((self.physical(z[:n] + step) - self.physical(z[:n] - step)) / (2.0 * h))
        return np.linalg.inv(np.stack(columns, axis=-1))

    def body_path(self, values: np.ndarray, phase: float) -> tuple[np.ndarray, np.ndarray]:
        """Path and attitude of the design from the origin, axes parallel to the lab's."""
        return path_of(self.swimmer, self.gait(values), self.track.time, float(phase))

    def place(self, path: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """Path of a swimmer that starts with a pose, in the track's coordinates."""
        d = self.track.dimensions
        if self.planar:
            c, s = np.cos(pose[0]), np.sin(pose[0])
            return path[:, :2] @ np.array([[c, s], [-s, c]]) + pose[1:]
        return (path @ rotation_matrix(quaternion_of(pose[:3])).T)[:, :d] + pose[3:]

    def pose_size(self) -> int:
        """Number of pose parameters: heading or rotation vector, and position."""
        return 3 if self.planar else 3 + self.track.dimensions

    def residuals(self, z: np.ndarray) -> np.ndarray:
        """(path - track) / scale, then attitude errors / sigma_attitude."""
        n = len(self.unknowns)
        return self._off(*self.body_path(z[:n], z[n]), z[n + 1 :])

    def _off(self, path: np.ndarray, q: np.ndarray, pose: np.ndarray) -> np.ndarray:
        off = (self.place(path, pose) - self.track.position) / self.scale
        if self.track.quaternion is None or self.planar:
            return off.ravel()
        whole = multiply(quaternion_of(pose[:3])[None], q)
        back = self.track.quaternion * np.array([1.0, -1.0, -1.0, -1.0])
        error = multiply(back, whole)
        turn = 2.0 * error[:, 1:] * np.sign(error[:, :1])
        return np.concatenate([off.ravel(), turn.ravel() / self.sigma_attitude])

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """Central differences; those of the pose need no new path."""
        n = len(self.unknowns)
        here = self.body_path(z[:n], z[n])
        columns = []
        for i in range(len(z)):
            h = 1e-5 * max(abs(z[i]), 1e-2) if i < n else 1e-5
            up, down = z.copy(), z.copy()
            up[i] += h
            down[i] -= h
            if i > n:
                change = self._off(*here, up[n + 1 :]) - self._off(*here, down[n + 1 :])
            else:
                change = self.residuals(up) - self.residuals(down)
            columns.append(change / (2.0 * h))
        return np.stack(columns, axis=-1)

    def fit(self, guess: dict[str, float], motor: bool = False) -> list[Any]:
        """Least squares from a guess, with a few initial phases; empty if none works.

        `motor`: the guess holds the motor's frequency, not that of the wobble.
        """
        own = self.swimmer.numbers
        first = np.array([guess.get(u.name, u.value(own)) for u in self.unknowns], dtype=float)
        if self.wobbles and motor:
            i = self.names.index(FREQUENCY)
            first[i] *= _ratio(self._gait(first), self.swimmer)
        low = np.array([LOW.get(u.name, -np.inf) for u in self.unknowns])
        bounds = (np.concatenate([low, np.full(1 + self.pose_size(), -np.inf)]), np.inf)
        best = []
        for z in initial_poses(self, np.maximum(first, 1.01 * low), count=1 if motor else 2):
            try:
                slope: dict[str, Any] = {"jac": self.jacobian, "bounds": bounds}
                done = least_squares(
                    self.residuals, z, x_scale=self._sizes(z), max_nfev=40, xtol=1e-9, ftol=1e-9,
                    **slope,
                )  # fmt: skip
            except (MicroswimError, np.linalg.LinAlgError, ValueError):
                continue
            best.append(done)
        return [min(best, key=lambda fit: fit.cost)] if best else []

    def _sizes(self, z: np.ndarray) -> np.ndarray:
        """Typical steps: a tenth of a value; of the frequency a fraction of a cycle."""
        sizes = np.concatenate(
            [0.1 * np.maximum(np.abs(z[: len(self.unknowns)]), 1e-2), np.ones(len(z))]
        )
        sizes = sizes[: len(z)]
        for i, name in enumerate(self.names):
            if name == FREQUENCY:
                sizes[i] = 0.2 / self.track.duration
        d = self.track.dimensions
        sizes[-d:] = np.maximum(np.ptp(self.track.position, axis=0) * 0.1, 1e-9)
        return sizes

    def _misfit(self, cost: float, degrees: int) -> float | None:
        """Chi-squared per degree of freedom, if the noise is known."""
        return None if self.sigma is None else 2.0 * cost / degrees

    def outcome(self, fits: list[Any]) -> Identification:
        """Everything there is to say about the best fit."""
        best = fits[0]
        n, m = len(self.unknowns), best.fun.size
        degrees = m - best.x.size
        spread = np.sqrt(2.0 * best.cost / max(degrees, 1)) if self.sigma is None else 1.0
        J = self.jacobian(best.x) / spread
        nuisance = np.linalg.qr(J[:, n:])[0]
        own = (J[:, :n] - nuisance @ (nuisance.T @ J[:, :n])) @ self._slope(best.x)
        values = self.physical(best.x)
        directions, covariance = determined(own, values, self.names)
        others = [f for f in fits[1:] if 2.0 * (f.cost - best.cost) < 9.0 * spread**2]
        distinct = distinct_from(values, [self.physical(f.x) for f in others], covariance)
        path = self.place(self.body_path(best.x[:n], best.x[n])[0], best.x[n + 1 :])
        found = lift(self.swimmer, self.unknowns, [float(v) for v in values]).with_({})
        residual = float(np.sqrt(np.mean((path - self.track.position) ** 2)))
        return Identification(
            swimmer=found,
            names=self.names,
            values=values,
            covariance=covariance,
            residual=residual,
            degrees=degrees,
            directions=directions,
            warnings=remarks(
                self.names, directions, covariance, distinct, self._misfit(best.cost, degrees)
            ),
            path=path,
            alternatives=distinct,
        )


def _ratio(gait: Gait, swimmer: Swimmer) -> float:
    """Frequency of the wobble in the lab over the motor's: ``1 + sign w_s / rate``."""
    return float(1.0 + swimmer.tail.sign * gait.mean_velocity[3] / gait.rate)
