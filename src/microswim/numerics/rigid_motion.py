"""Rigid motion: quaternions, poses and the screw motion of one period.

Quaternions are ``wxyz``, body to lab: ``v_lab = q v_body q*``. Everything stays analytic (no abs,
no conjugates of complex numbers), so that the complex-step derivative runs through it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim import checks
from microswim.numerics.array import kept, read_only
from microswim.numerics.compiling.compiled import compiled


@compiled()
def turn(q: Any, u: Any, out: Any) -> None:
    """Write the quaternion of a body turned further by the rotation vector u (body frame, rad).

    ``out = q exp(u/2)``, with ``exp(u/2) = [cos(|u|/2), sin(|u|/2) u/|u|]``.
    """
    half = np.sqrt((u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) / 4.0 + 1e-40)  # never 0/0
    ratio, w = np.sin(half) / half, np.cos(half)
    x, y, z = ratio * u[0] / 2.0, ratio * u[1] / 2.0, ratio * u[2] / 2.0
    a, b, c, d = q[0], q[1], q[2], q[3]
    out[0] = a * w - b * x - c * y - d * z
    out[1] = a * x + b * w + c * z - d * y
    out[2] = a * y - b * z + c * w + d * x
    out[3] = a * z + b * y - c * x + d * w


@compiled()
def to_lab(q: Any, a: Any, b: Any, c: Any, sense: float) -> Any:
    """Turn a vector from the body into the lab frame, ``R_L v`` [Tabak Eq. 16]; back: sense -1."""
    w, x, y, z = sense * q[0], q[1], q[2], q[3]
    d, e, f = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return a + w * d + y * f - z * e, b + w * e + z * d - x * f, c + w * f + x * e - y * d


def rotation_matrix(q: Any) -> np.ndarray:
    """Return matrix ``R_L`` of quaternions ``wxyz``, shape q.shape[:-1] + (3, 3), body to lab."""
    w, x, y, z = np.moveaxis(np.asarray(q), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def quaternion_of(Q: Any) -> np.ndarray:
    """Return the quaternion ``wxyz`` of a rotation matrix (3, 3), body to lab."""
    from scipy.spatial.transform import Rotation

    return np.roll(Rotation.from_matrix(Q).as_quat(), 1)


def skew(v: Any) -> np.ndarray:
    """Return the matrices (..., 3, 3) of ``v x``, for v (..., 3); transposed, of ``x v``."""
    x, y, z = np.moveaxis(np.asarray(v), -1, 0)
    zero = 0.0 * x
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def along_twist(twist: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement (3,) and quaternion (4,) after unit time of a constant body twist (6,).

    ``x = v + (1 - cos t)/t^2 w x v + (t - sin t)/t^3 w x (w x v)``, t the size of w.
    """
    v, w = twist[:3], twist[3:]
    t2 = np.sum(w * w) + 1e-40  # never 0/0
    t = np.sqrt(t2)
    across = np.cross(w, v)
    x = v + (1.0 - np.cos(t)) / t2 * across + (t - np.sin(t)) / (t * t2) * np.cross(w, across)
    return x, np.concatenate([[np.cos(0.5 * t)], np.sin(0.5 * t) / t * w])


def twist_along(x: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the constant body twist (6,) of which displacement (3,) and quaternion (4,) are what
    comes of it after unit time: `along_twist` turned round, by the smaller of both angles.
    """
    q = q if q[0] >= 0.0 else -q
    sine = np.sqrt(np.sum(q[1:] ** 2) + 1e-40)
    w = 2.0 * np.arctan2(sine, q[0]) / sine * q[1:]
    reached = np.stack([along_twist(np.concatenate([e, w]))[0] for e in np.eye(3)], axis=1)
    return np.concatenate([np.linalg.solve(reached, x), w])


def multiply(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the product of arrays of quaternions that broadcast."""
    aw, av = a[..., :1], a[..., 1:]
    bw, bv = b[..., :1], b[..., 1:]
    scalar = aw * bw - np.sum(av * bv, axis=-1, keepdims=True)
    return np.concatenate([scalar, aw * bv + bw * av + np.cross(av, bv)], axis=-1)


@checks.by_name
@dataclass(frozen=True, eq=False)
@read_only
class ScrewMotion:
    """The rigid motion of a swimmer over one period: a turn about an axis and an advance along it.

    Parameters
    ----------
    displacement
        Displacement of the body's centre over the period, frame of the body at its start (3,).
    quaternion
        Rotation over the period, ``wxyz``.
    period
        Time it takes.

    Examples
    --------
    >>> import microswim as ms
    >>> screw = ms.screw(ms.Swimmer.preset("tabak/helix").gait())
    >>> bool(screw.speed > 0.05)
    True
    """

    displacement: np.ndarray
    quaternion: np.ndarray
    period: Any

    @cached_property
    def _sine(self) -> Any:
        return np.sqrt(np.sum(self.quaternion[1:] ** 2))

    @property
    def turns(self) -> bool:
        """Whether the swimmer turns at all over the period (by more than 1e-9 rad)."""
        return not abs(self._sine) <= 5e-10

    @cached_property
    def angle(self) -> Any:
        """Rotation over the period (rad), 0 to 2 pi."""
        sine, cosine = self._sine, self.quaternion[0]
        half = np.arctan2(np.real(sine), np.real(cosine))
        if np.iscomplexobj(self.quaternion):  # d half = c ds - s dc
            half += 1j * (np.real(cosine) * np.imag(sine) - np.real(sine) * np.imag(cosine))
        return 2.0 * half

    @cached_property
    def axis(self) -> np.ndarray:
        """Unit vector of the axis; the direction of the displacement if there is no rotation."""
        if self.turns:
            return kept(self.quaternion[1:] / self._sine)
        length = np.sqrt(np.sum(self.displacement**2))
        return kept(self.displacement / length if length != 0 else [1.0, 0.0, 0.0])

    @cached_property
    def advance(self) -> Any:
        """Displacement along the axis over the period, signed."""
        return np.sum(self.displacement * self.axis)

    @property
    def speed(self) -> Any:
        """Swimming speed: net displacement along the axis per unit time, zero or more."""
        return np.sqrt(self.advance**2) / np.sqrt(self.period**2)

    @property
    def path_speed(self) -> Any:
        """Speed along the helix or circle on which the screw carries the body's centre."""
        round_it = self.angle * self.radius
        return np.sqrt(self.advance**2 + round_it**2) / np.sqrt(self.period**2)

    @property
    def pitch(self) -> Any:
        """Advance per full turn about the axis; infinite without rotation."""
        return 2.0 * np.pi * np.sqrt(self.advance**2) / self.angle if self.turns else np.inf

    def bent(self, radius: Any) -> tuple[Any, Any]:
        """Return curvature and torsion of the helix of a radius about the axis.

        ``r t^2 / (a^2 + r^2 t^2)`` and ``a t / (a^2 + r^2 t^2)`` with advance a and turn t of a
        period, the latter positive of a right-handed helix; zero of a straight path.
        """
        round_it = radius * self.angle
        whole = self.advance**2 + round_it**2
        if not self.turns or whole == 0:
            return 0.0 * self.angle, 0.0 * self.angle
        return self.angle * round_it / whole, self.angle * self.advance / whole

    @cached_property
    def arm(self) -> np.ndarray:
        """Vector from the axis to the body's centre at the start of the period (3,)."""
        if not self.turns:
            return kept(np.zeros(3))
        across = self.displacement - self.advance * self.axis
        cotangent = self.quaternion[0] / self._sine
        return kept(-0.5 * (across + cotangent * np.cross(self.axis, across)))

    @cached_property
    def radius(self) -> Any:
        """Distance of the body's centre from the axis at the start of the period."""
        return np.sqrt(np.sum(self.arm**2))

    def power(self, n: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return the displacement (..., 3) and quaternion (..., 4) after n whole periods (n
        integer, array).

        ``R^n`` turns by n times the angle; the displacements add up as a geometric series,
        ``sum_j R^j d = sin(n x)/sin(x) R^((n-1)/2) d`` across the axis, x half the angle.
        """
        n = np.asarray(n, dtype=float)[..., None]
        along = self.advance * self.axis
        if not self.turns:
            still = np.zeros((*n.shape[:-1], 4))
            still[..., 0] = 1.0
            return n * self.displacement, still
        half = self.angle / 2.0
        across = self.displacement - along
        series = np.sin(n * half) / np.sin(half)
        turn = (n - 1.0) * half
        spun = across * np.cos(turn) + np.cross(self.axis, across) * np.sin(turn)
        q = np.concatenate([np.cos(n * half), np.sin(n * half) * self.axis], axis=-1)
        return n * along + series * spun, q
