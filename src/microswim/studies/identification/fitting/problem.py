"""The track of a swimmer as residuals: pose, phase and design against what was seen.

The path depends on the design through the gait alone: ``x(t) = x_0 + R_0 p(t; design, phase_0)``
with the path p of a swimmer that starts at the origin [Tabak Sections 4.1, 5].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from microswim.calibration.calibrate import lift
from microswim.calibration.unknowns import Unknown
from microswim.gait.gait import Gait
from microswim.models.rft.gait import gait as surrogate
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.studies.identification.films.track import Track
from microswim.studies.identification.paths import Path, path_of, paths_of, quaternion_of
from microswim.studies.identification.spectrum import line
from microswim.swimmer.swimmer import Swimmer

FREQUENCY, CURVATURE = "tail.frequency", "tail.mean_curvature"
KEPT = 32  #: shapes whose gaits are kept, while phase and frequency are varied


def quick_gait(swimmer: Swimmer) -> Gait:
    """Return the surrogate's gait, of a beat with as many phases and nodes as a path shows."""
    if swimmer.tail.is_rigid:
        return surrogate(swimmer)
    mirrored = swimmer.tail.half_period_signs is not None
    return surrogate(swimmer, phases=10 if mirrored else 16, nodes=48)


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
        """Size of the noise that the fit starts from: given, or the scatter between frames."""
        if self.sigma is not None:
            return self.sigma
        wobble = float((self.track.position - self.track.smooth).std())
        seen = line(self.track.time, self.track.position).noise if self.weighs else wobble
        return max(seen, 1e-4 * wobble, 1e-300)

    @property
    def weighs(self) -> bool:
        """Whether positions and attitudes are weighed against each other."""
        return self.track.quaternion is not None and not self.planar

    def gait(self, z: np.ndarray) -> Gait:
        """Return the gait of a design whose frequency is that of the wobble, see `wobble_ratio`."""
        made = self._shapes(self._shape(z))[0]
        return made.at_rate(self._rate(z))

    def wobble_ratio(self, values: np.ndarray) -> float:
        """Return frequency of the wobble in the lab over the motor's: ``1 + sign w_s / rate``."""
        return self._shapes(self._shape(values))[1]

    def _rate(self, z: np.ndarray) -> float:
        """Rate of the motor at which the design of the parameters is driven."""
        made, ratio, _ = self._shapes(self._shape(z))
        rate = float(made.rate) / (ratio if self.wobbles else 1.0)
        if not self._scales:
            return rate
        return rate * float(z[self.names.index(FREQUENCY)]) / self.swimmer.tail.frequency

    def _shape(self, z: np.ndarray) -> tuple[float, ...]:
        """Values on which the gait depends but for its rate; the frequency is the spec's own."""
        values = [float(v) for v in z[: len(self.unknowns)]]
        if self._scales:
            values[self.names.index(FREQUENCY)] = self.swimmer.tail.frequency
        return tuple(values)

    @cached_property
    def _scales(self) -> bool:
        """Whether the frequency changes the rate alone: the shape of the tail is given."""
        tail = self.swimmer.tail
        return FREQUENCY in self.names and not tail.settles and tail.frequency != 0

    @cached_property
    def _shapes(self) -> Callable[[tuple[float, ...]], tuple[Gait, float, Path]]:
        """Gait, wobble over the motor's rate, and paths of a shape; the latest are kept."""
        return lru_cache(maxsize=KEPT)(self._of_shape)

    def _of_shape(self, values: tuple[float, ...]) -> tuple[Gait, float, Path]:
        made = self._gait(values)
        ratio = 1.0
        if self.wobbles:
            ratio = float(1.0 + self.swimmer.tail.sign * made.mean_velocity[3] / made.rate)
        return made, ratio, paths_of(self.swimmer, made)

    def _gait(self, values: tuple[float, ...]) -> Gait:
        made = lift(self.swimmer, self.unknowns, values)
        if self.own_model != "rft":
            return made.gait("auto")
        return quick_gait(made)

    @cached_property
    def own_model(self) -> str:
        """The model that the swimmer takes by itself: ``"region"``, ``"atlas"``, ``"rft"``."""
        return "region" if self.swimmer.region is not None else self.swimmer.gait("auto").model

    @cached_property
    def typical(self) -> np.ndarray:
        """Size of each unknown: that of the spec's own value, one where it is zero; a curvature
        bends the tail by a tenth of a radian at least.
        """
        own = self.swimmer.numbers
        slight = 0.1 / float(self.swimmer.tail.arc_length)
        size = [
            max(abs(u.value(own)), slight if u.name == CURVATURE else 0.0) for u in self.unknowns
        ]
        return np.array([s or 1.0 for s in size])

    @cached_property
    def wobbles(self) -> bool:
        """Whether the fit's frequency is that of the wobble in the lab and not the motor's.

        The two differ by the body's counter-rotation. The track shows the former to a fraction of a
        cycle whatever the design, so the fit takes it as its parameter.
        """
        rigid = self.swimmer.tail.is_rigid and self.swimmer.motion.frequency_frame == "body"
        return rigid and FREQUENCY in self.names

    def physical(self, z: np.ndarray) -> np.ndarray:
        """Return values of the unknowns, the motor's frequency among them, from the fit's
        parameters.
        """
        values = np.array(z[: len(self.unknowns)], dtype=float)
        if self.wobbles:
            values[self.names.index(FREQUENCY)] /= self.wobble_ratio(values)
        return values

    def slope(self, z: np.ndarray) -> np.ndarray:
        """Return d parameters / d values, inverse of d physical / d z, by central differences."""
        n = len(self.unknowns)
        columns = []
        for i in range(n):
            h = 1e-6 * max(abs(z[i]), 1e-2 * self.typical[i])
            step = h * np.eye(n)[i]
            columns.append((self.physical(z[:n] + step) - self.physical(z[:n] - step)) / (2.0 * h))
        return np.linalg.inv(np.stack(columns, axis=-1))

    def body_path(self, values: np.ndarray, phase: float) -> tuple[np.ndarray, np.ndarray]:
        """Return path and attitude of the design from the origin, axes parallel to the lab's."""
        path = self._shapes(self._shape(values))[2]
        return path(self._rate(values), self.track.time - self.track.time[0], float(phase))

    def place(self, path: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """Return the path of a swimmer that starts with a pose, in the track's coordinates."""
        d = self.track.dimensions
        if self.planar:
            c, s = np.cos(pose[0]), np.sin(pose[0])
            return path[:, :2] @ np.array([[c, s], [-s, c]]) + pose[1:]
        return (path @ rotation_matrix(quaternion_of(pose[:3])).T)[:, :d] + pose[3:]

    def path(self, z: np.ndarray) -> np.ndarray:
        """Return the positions of a design, phase and pose, in the track's coordinates."""
        n = len(self.unknowns)
        return self.place(self.body_path(z[:n], z[n])[0], z[n + 1 :])

    def pose_size(self) -> int:
        """Return the number of pose parameters: heading or rotation vector, and position."""
        return 3 if self.planar else 3 + self.track.dimensions

    def residuals(self, z: np.ndarray) -> np.ndarray:
        """Return (path - track) / scale, then attitude errors / sigma_attitude."""
        n = len(self.unknowns)
        return self._off(*self.body_path(z[:n], z[n]), z[n + 1 :])

    def residuals_of(self, gait: Gait, z: np.ndarray) -> np.ndarray:
        """Return residuals with another gait in place of the design's."""
        n = len(self.unknowns)
        path = path_of(self.swimmer, gait, self.track.time, float(z[n]))
        return self._off(*path, z[n + 1 :])

    def _off(self, path: np.ndarray, q: np.ndarray, pose: np.ndarray) -> np.ndarray:
        off = (self.place(path, pose) - self.track.position) / self.scale
        if not self.weighs or self.track.quaternion is None:
            return off.ravel()
        whole = multiply(quaternion_of(pose[:3])[None], q)
        back = self.track.quaternion * np.array([1.0, -1.0, -1.0, -1.0])
        error = multiply(back, whole)
        turn = 2.0 * error[:, 1:] * np.sign(error[:, :1])
        return np.concatenate([off.ravel(), turn.ravel() / self.sigma_attitude])

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """Return the central differences; those of the pose need no new path."""
        n = len(self.unknowns)
        here = self.body_path(z[:n], z[n])
        columns = []
        for i in range(len(z)):
            h = 1e-5 * max(abs(z[i]), 1e-2 * self.typical[i]) if i < n else 1e-5
            up, down = z.copy(), z.copy()
            up[i] += h
            down[i] -= h
            if i > n:
                change = self._off(*here, up[n + 1 :]) - self._off(*here, down[n + 1 :])
            else:
                change = self.residuals(up) - self.residuals(down)
            columns.append(change / (2.0 * h))
        return np.stack(columns, axis=-1)
