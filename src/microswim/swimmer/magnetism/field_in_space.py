"""Fields that depend on place: a permanent magnet seen as a dipole, and coils by their calibration.

Field of a dipole p at a distance r, and its gradient ``J_ij = dB_i/dx_j``,

    B = mu_0/(4 pi) (3 r (p . r) / r^5 - p / r^3)
    J = mu_0/(4 pi) 3/r^5 (r p' + p r' + (p . r) (1 - 5 r r'/r^2))

A coil at unit current is a sum of axial multipoles (module `multipole`). A magnetic moment m feels
the force ``J' m`` and the torque ``m x B``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.swimmer.magnetism.applied_field import AppliedField, unit, vector
from microswim.swimmer.magnetism.magnet import MU_0
from microswim.swimmer.magnetism.multipole import Coil


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class DipoleField(AppliedField):
    """Field of a permanent magnet far enough away to be a dipole; it may turn.

    Parameters
    ----------
    moment
        Its magnetic moment (A m^2), lab frame, at time zero.
    position
        Its place (m), lab frame.
    axis
        What it turns about, lab frame, any length.
    frequency
        Turns per time (Hz); zero: it stands still.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> magnet = ms.DipoleField(moment=(0, 0, 10.0), position=(0, 0, -0.1))
    >>> (1e3 * magnet.at(0.0, (0, 0, 0))).round(6)  # mT
    array([0., 0., 2.])
    """

    kind: ClassVar[str] = "dipole"
    is_periodic: ClassVar[bool] = False
    needs_si: ClassVar[bool] = True

    moment: tuple[float, float, float]
    position: tuple[float, float, float]
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    frequency: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "moment", vector("field.moment", self.moment))
        checks.numbers("field.position", self.position, 3, "three lengths [x, y, z]")
        object.__setattr__(self, "position", tuple(float(x) for x in self.position))
        object.__setattr__(self, "axis", vector("field.axis", self.axis))
        checks.number("field.frequency", self.frequency, "a finite number")

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at times (...) and places (..., 3)."""
        p, r, size = self._seen(times, places)
        along = np.sum(p * r, axis=-1, keepdims=True)
        return MU_0 / (4.0 * np.pi) * (3.0 * r * along / size**5 - p / size**3)

    def gradient(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return ``dB_i/dx_j`` (..., 3, 3)."""
        p, r, size = self._seen(times, places)
        along, d = np.sum(p * r, axis=-1)[..., None, None], size[..., None]
        pair = r[..., :, None] * p[..., None, :]
        own = np.eye(3) - 5.0 * r[..., :, None] * r[..., None, :] / d**2
        both = pair + np.swapaxes(pair, -1, -2) + along * own
        return MU_0 / (4.0 * np.pi) * 3.0 / d**5 * both

    def _seen(self, times: Any, places: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Moment, way from the magnet to the places, and its length."""
        from scipy.spatial.transform import Rotation  # nobody waits for it without such a field

        angle = 2.0 * np.pi * self.frequency * np.asarray(times, float)
        turns = Rotation.from_rotvec(angle[..., None] * unit(self.axis))
        p = turns.apply(np.array(self.moment)) if angle.ndim < 2 else turns.apply(self.moment)
        r = np.asarray(places, float) - np.array(self.position)
        p, r = np.broadcast_arrays(p, r)
        return p, r, np.linalg.norm(r, axis=-1, keepdims=True)

    @property
    def rate(self) -> float:
        """How fast it turns (rad per time)."""
        return abs(2.0 * np.pi * self.frequency)


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class CoilField(AppliedField):
    r"""Field of a system of electromagnets by its calibration file, for given currents.

    The current of coil i is ``currents[i] cos(2 pi frequency t + phases[i])``.

    Parameters
    ----------
    file
        Calibration in the layout of multipole sources for each coil (YAML; SI).
    currents
        One for each coil of the file (A), in the file's order.
    frequency
        Of all currents (Hz); zero: they are steady.
    phases
        Angle (rad) by which each is ahead; zero by default.

    Raises
    ------
    SpecError
        If the file is no calibration, or currents and phases do not fit it.

    Examples
    --------
    >>> import tempfile, pathlib, microswim as ms
    >>> text = "Coil_List: [A]\nA:\n  Source_List: [S]\n  S:\n    B_Coeff: [[1.0e-6]]\n"
    >>> text += "    Source_Position: [[0.1], [0], [0]]\n    Source_Direction: [[-1], [0], [0]]\n"
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "coils.yaml"
    >>> _ = file.write_text(text)
    >>> ms.CoilField(file=str(file), currents=(2.0,)).at(0.0).round(6)
    array([-0.004,  0.   ,  0.   ])
    """

    kind: ClassVar[str] = "coils"
    is_periodic: ClassVar[bool] = False
    needs_si: ClassVar[bool] = True

    file: str
    currents: tuple[float, ...]
    frequency: float = 0.0
    phases: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.file, str) or not self.file:
            raise SpecError("field.file", self.file, "the name of a calibration file")
        n = len(self.coils)
        names = ", ".join(coil.name for coil in self.coils)
        allowed = f"{n} numbers, one for each coil ({names})"
        checks.numbers("field.currents", self.currents, n, allowed)
        object.__setattr__(self, "currents", tuple(float(x) for x in self.currents))
        checks.number("field.frequency", self.frequency, "a finite number")
        if self.phases is not None:
            checks.numbers("field.phases", self.phases, n, allowed)
            object.__setattr__(self, "phases", tuple(float(x) for x in self.phases))

    @cached_property
    def coils(self) -> tuple[Coil, ...]:
        """The coils of the file."""
        return doors.go(doors.READ_COILS, self.file)

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at times (...) and places (..., 3)."""
        now = self._currents(times)
        return sum(now[..., i, None] * coil.field(places) for i, coil in enumerate(self.coils))  # type: ignore[return-value]

    def gradient(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return ``dB_i/dx_j`` (..., 3, 3)."""
        now = self._currents(times)[..., None, None]
        return sum(now[..., i, :, :] * coil.gradient(places) for i, coil in enumerate(self.coils))  # type: ignore[return-value]

    def _currents(self, times: Any) -> np.ndarray:
        phases = np.array(self.phases if self.phases is not None else [0.0] * len(self.currents))
        angle = 2.0 * np.pi * self.frequency * np.asarray(times, float)[..., None]
        return np.array(self.currents) * np.cos(angle + phases)

    @property
    def rate(self) -> float:
        """How fast the currents change (rad per time)."""
        return abs(2.0 * np.pi * self.frequency)
