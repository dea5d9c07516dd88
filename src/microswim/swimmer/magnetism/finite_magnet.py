"""Field of a permanent magnet of finite size: a block, a cylinder or a sphere, by magpylib."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from microswim import checks
from microswim.swimmer.magnetism.applied_field import unit, vector
from microswim.swimmer.magnetism.field_in_space import FieldInSpace
from microswim.swimmer.magnetism.magnet import MU_0, SIZES, Magnet
from microswim.swimmer.magnetism.outside import gradient, magpylib


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class MagnetField(FieldInSpace):
    """Field of a permanent magnet of finite size; it may turn and move.

    A block's edges lie along x, y and z of the lab at time zero, a cylinder's axis along z. Needs
    magpylib. B inside the magnet is given too, its gradient is not: a path ends there.

    Parameters
    ----------
    remanence
        Of the material (T), positive.
    shape, size
        ``"block"``, ``"cylinder"`` or ``"sphere"``; its edges, diameter and height, or [diameter]
        (m).
    position
        Its centre (m), lab frame, at time zero.
    direction
        Of its magnetisation, lab frame, at time zero; any length.
    axis
        What it turns about, through its centre, lab frame, any length.
    frequency
        Turns per time (Hz); zero: it does not turn.
    velocity
        With which it moves (m/s), lab frame.

    Raises
    ------
    SpecError
        If a field is out of range.
    MachineError
        If magpylib is not installed.

    Examples
    --------
    >>> import microswim as ms
    >>> cube = ms.MagnetField(remanence=1.3, size=(0.02, 0.02, 0.02), position=(0, 0, -0.05))
    >>> (1e3 * cube.at(0.0)).round(2)  # mT
    array([ 0.  ,  0.  , 13.17])
    """

    kind: ClassVar[str] = "magnet"

    remanence: float
    shape: Literal["block", "cylinder", "sphere"] = "block"
    size: tuple[float, ...]
    position: tuple[float, float, float]
    direction: tuple[float, float, float] = (0.0, 0.0, 1.0)
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    frequency: float = 0.0
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checks.positive("field.remanence", self.remanence)
        checks.choice("field.shape", self.shape, tuple(SIZES))
        n = SIZES[self.shape]
        allowed = {3: "three lengths", 2: "diameter and height", 1: "a list of the diameter"}[n]
        checks.numbers("field.size", self.size, n, allowed, above=0.0)
        checks.numbers("field.position", self.position, 3, "three lengths [x, y, z]")
        checks.numbers("field.velocity", self.velocity, 3, "three velocities [x, y, z]")
        checks.number("field.frequency", self.frequency, "a finite number")
        for name in ("size", "position", "velocity"):
            object.__setattr__(self, name, tuple(float(x) for x in getattr(self, name)))
        for name in ("direction", "axis"):
            object.__setattr__(self, name, vector(f"field.{name}", getattr(self, name)))

    @property
    def moment(self) -> np.ndarray:
        """Magnetic moment (3,) at time zero (A m^2), lab frame."""
        volume = float(Magnet(remanence=1.0, shape=self.shape, size=self.size, direction=0.0).piece)
        return self.remanence * volume / MU_0 * unit(self.direction)

    @cached_property
    def _source(self) -> Any:
        kinds = magpylib().magnet
        J = tuple(map(float, self.remanence * unit(self.direction)))
        match self.size:
            case (diameter,):
                return kinds.Sphere(diameter=diameter, polarization=J)
            case (_, _):
                return kinds.Cylinder(dimension=self.size, polarization=J)
        return kinds.Cuboid(dimension=self.size, polarization=J)

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at times (...) and places (..., 3)."""
        Q, r = self._seen(times, places)
        B = self._source.getB(r.reshape(-1, 3)).reshape(r.shape)
        return np.einsum("...ij,...j->...i", Q, B)

    def gradient(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return ``dB_i/dx_j`` (..., 3, 3); NaN inside the magnet."""
        Q, r = self._seen(times, places)
        flat = r.reshape(-1, 3)
        J = gradient(self._source.getB, flat, self._distance(flat)).reshape(*r.shape, 3)
        return Q @ J @ np.swapaxes(Q, -1, -2)

    def _seen(self, times: Any, places: Any) -> tuple[np.ndarray, np.ndarray]:
        """Rotation of the magnet since time zero (..., 3, 3), and places seen from it (..., 3)."""
        from scipy.spatial.transform import Rotation  # nobody waits for it without such a field

        t = np.asarray(times, float)
        turn = (2.0 * np.pi * self.frequency * t[..., None]) * unit(self.axis)
        Q = Rotation.from_rotvec(turn.reshape(-1, 3)).as_matrix().reshape(*t.shape, 3, 3)
        here = np.array(self.position) + t[..., None] * np.array(self.velocity)
        r = np.einsum("...ji,...j->...i", Q, np.asarray(places, float) - here)
        return np.broadcast_to(Q, (*r.shape[:-1], 3, 3)), r

    def _distance(self, r: np.ndarray) -> np.ndarray:
        """Distance (n,) of places (n, 3) from the surface, negative inside."""
        match self.size:
            case (diameter,):
                return np.linalg.norm(r, axis=-1) - diameter / 2.0
            case (_, _):
                r = np.stack([np.hypot(r[:, 0], r[:, 1]), r[:, 2]], axis=-1)
        beyond = np.abs(r) - np.array(self.size) / 2.0  # of a cylinder: radially, along
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return np.where(outside > 0.0, outside, beyond.max(axis=-1))

    @property
    def rate(self) -> float:
        """How fast it turns (rad per time)."""
        return abs(2.0 * np.pi * self.frequency)
