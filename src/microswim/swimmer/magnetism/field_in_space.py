"""Fields that depend on place: a permanent magnet seen as a dipole, and coils by their calibration.

Field of a dipole p at a distance r, and its gradient ``J_ij = dB_i/dx_j``,

    B = mu_0/(4 pi) (3 r (p . r) / r^5 - p / r^3)
    J = mu_0/(4 pi) 3/r^5 (r p' + p r' + (p . r) (1 - 5 r r'/r^2))

A coil at unit current is a sum of axial multipoles (module `multipole`), B on a grid (`grid`), or
loops of wire (`winding`). A
magnetic moment m feels the force ``J' m`` and the torque ``m x B``.
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
from microswim.swimmer.magnetism.field_in_time import Arm
from microswim.swimmer.magnetism.grid import GridCoil
from microswim.swimmer.magnetism.magnet import MU_0
from microswim.swimmer.magnetism.multipole import Coil
from microswim.swimmer.magnetism.winding import Winding


class FieldInSpace(AppliedField):
    """A field that depends on place: a step takes it with its gradient about a place."""

    is_periodic: ClassVar[bool] = False
    needs_si: ClassVar[bool] = True

    def felt(self, time: float, place: Any = (0.0, 0.0, 0.0)) -> dict[str, np.ndarray]:
        """Return what a stepper takes for a step that begins at a time and a place (..., 3)."""
        here = {"field": self.at(time, place), "field_gradient": self.gradient(time, place)}
        return here | {"field_place": np.asarray(place, float)}


def dipole(moment: np.ndarray, away: np.ndarray) -> np.ndarray:
    """Return B (..., 3) of dipoles (..., 3), so far away from them (..., 3)."""
    p, r = np.broadcast_arrays(moment, away)
    size = np.linalg.norm(r, axis=-1, keepdims=True)
    along = np.sum(p * r, axis=-1, keepdims=True)
    return MU_0 / (4.0 * np.pi) * (3.0 * r * along / size**5 - p / size**3)


def dipole_gradient(moment: np.ndarray, away: np.ndarray) -> np.ndarray:
    """Return ``dB_i/dx_j`` (..., 3, 3) of dipoles (..., 3), so far away from them (..., 3)."""
    p, r = np.broadcast_arrays(moment, away)
    d = np.linalg.norm(r, axis=-1)[..., None, None]
    along, pair = np.sum(p * r, axis=-1)[..., None, None], r[..., :, None] * p[..., None, :]
    own = np.eye(3) - 5.0 * r[..., :, None] * r[..., None, :] / d**2
    return MU_0 / (4.0 * np.pi) * 3.0 / d**5 * (pair + np.swapaxes(pair, -1, -2) + along * own)


#: Share of the strongest gradient per ampere below which one is not asked for.
WEAK = 0.05


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class DipoleField(FieldInSpace):
    """Field of a permanent magnet far enough away to be a dipole; it may turn and move.

    Parameters
    ----------
    moment
        Its magnetic moment (A m^2), lab frame, at time zero.
    position
        Its place (m), lab frame, at time zero.
    axis
        What it turns about, lab frame, any length.
    frequency
        Turns per time (Hz); zero: it does not turn.
    velocity
        With which it moves (m/s), lab frame.
    file
        In place of position and velocity, its way on an arm: a table of t, x, y, z, and mx, my, mz
        in place of the moment, each with its unit in the header; smooth between the rows, and at
        rest before the first and after the last.

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

    moment: tuple[float, float, float] | None = None
    position: tuple[float, float, float] | None = None
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    frequency: float = 0.0
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    file: str | None = None

    def __post_init__(self) -> None:
        turns = self._check_file() if self.file is not None else False
        if not turns:
            if self.moment is None:
                raise SpecError("field.moment: missing; add [x, y, z]")
            object.__setattr__(self, "moment", vector("field.moment", self.moment))
        if self.file is None:
            if self.position is None:
                raise SpecError("field.position: missing; add [x, y, z], or a file of its way")
            checks.numbers("field.position", self.position, 3, "three lengths [x, y, z]")
            object.__setattr__(self, "position", tuple(float(x) for x in self.position))
        checks.numbers("field.velocity", self.velocity, 3, "three velocities [x, y, z]")
        object.__setattr__(self, "velocity", tuple(float(x) for x in self.velocity))
        object.__setattr__(self, "axis", vector("field.axis", self.axis))
        checks.number("field.frequency", self.frequency, "a finite number")

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at times (...) and places (..., 3)."""
        return dipole(*self._seen(times, places))

    def gradient(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return ``dB_i/dx_j`` (..., 3, 3)."""
        return dipole_gradient(*self._seen(times, places))

    def _seen(self, times: Any, places: Any) -> tuple[np.ndarray, np.ndarray]:
        """Moment, and way from the magnet to the places."""
        here, p = self.pose(times)
        return p, np.asarray(places, float) - here

    def pose(self, times: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return place (..., 3) and moment (..., 3) of the magnet at times (...), lab frame."""
        from scipy.spatial.transform import Rotation  # nobody waits for it without such a field

        t = np.asarray(times, float)
        if self._arm is None:
            here = np.array(self.position) + t[..., None] * np.array(self.velocity)
        else:
            here = self._arm.place(self._arm.within(t))
        if self._arm is not None and self._arm.moment is not None:
            return here, self._arm.moment(self._arm.within(t))
        angle = (2.0 * np.pi * self.frequency * t[..., None]) * unit(self.axis)
        turns = Rotation.from_rotvec(angle.reshape(-1, 3))
        return here, turns.apply(np.array(self.moment)).reshape(angle.shape)

    def _check_file(self) -> bool:
        """Refuse what says the way twice; return whether the file tells the moment."""
        if not isinstance(self.file, str) or not self.file:
            raise SpecError("field.file", self.file, "the name of a table")
        told: dict[str, Any] = {"position": self.position is not None}
        told["velocity"] = any(self.velocity)
        turns = self._arm is not None and self._arm.moment is not None
        if turns:
            told |= {"moment": self.moment is not None, "frequency": self.frequency != 0}
        for name, twice in told.items():
            if twice:
                raise SpecError(f"field.{name}: the file tells it; remove one of the two")
        return turns

    @cached_property
    def _arm(self) -> Arm | None:
        return None if self.file is None else Arm(self.file)

    @property
    def rate(self) -> float:
        """How fast it turns, or goes from row to row of its file (rad per time)."""
        turning = abs(2.0 * np.pi * self.frequency)
        if self._arm is None:
            return turning
        return max(turning, float(np.pi / 4.0 / np.diff(self._arm.times).min()))


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class CoilField(FieldInSpace):
    r"""Field of a system of electromagnets by its calibration file, for given currents.

    The current of coil i is ``currents[i] cos(2 pi frequency t + phases[i])``.

    Parameters
    ----------
    file
        Calibration in the layout of multipole sources for each coil (YAML; SI), or a table of B on
        a grid (CSV), x, y, z, Bx, By, Bz with units in the header and a column coil where there
        are several; between its points B is free of sources to rounding, outside it there is none.
        Or the measures of round coils without cores (TOML), tables ``[[coil]]`` of position, axis,
        diameter, turns, length and thickness; needs magpylib.
    currents
        One for each coil of the file (A), in the file's order; of a table times the current at
        which it was measured, 1 by default.
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

    file: str
    currents: tuple[float, ...] | None = None
    frequency: float = 0.0
    phases: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.file, str) or not self.file:
            raise SpecError("field.file", self.file, "the name of a calibration file")
        n = len(self.coils)
        names = ", ".join(coil.name for coil in self.coils)
        allowed = f"{n} numbers, one for each coil ({names})"
        if self.currents is None:
            if not isinstance(self.coils[0], GridCoil):
                raise SpecError(f"field.currents: missing; give {allowed}")
            object.__setattr__(self, "currents", (1.0,) * n)
        checks.numbers("field.currents", self.currents, n, allowed)
        object.__setattr__(self, "currents", tuple(map(float, self.currents)))  # type: ignore[arg-type]
        checks.number("field.frequency", self.frequency, "a finite number")
        if self.phases is not None:
            checks.numbers("field.phases", self.phases, n, allowed)
            object.__setattr__(self, "phases", tuple(float(x) for x in self.phases))

    @cached_property
    def coils(self) -> tuple[Coil | GridCoil | Winding, ...]:
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

    def at_currents(self, currents: Any) -> CoilField:
        """Return the same coils at other currents (n,), steady.

        Raises
        ------
        SpecError
            If there is not one for each coil.
        """
        made: Any = object.__new__(CoilField)
        made.__dict__["coils"] = self.coils  # the file is not read again
        made.__init__(file=self.file, currents=currents)
        return made

    def per_ampere(self, place: Any) -> np.ndarray:
        """Return B, then its gradient row by row, of each coil at one ampere (12, n) at a place."""
        pairs = (coil.both(place) for coil in self.coils)
        return np.array([[*B, *J.ravel()] for B, J in pairs]).T

    def currents_for(self, field: Any, place: Any, gradient: Any = None) -> np.ndarray:
        """Return the smallest currents (n,) with which B at a place is as wanted.

        Parameters
        ----------
        field
            B (3,) wanted, lab frame.
        place
            Where (3,).
        gradient
            ``dB_i/dx_j`` (3, 3) wanted as well: met as nearly as currents that do not change B
            can, those that hardly change the gradient left out.

        Raises
        ------
        SpecError
            If the coils cannot make that field there.
        """
        A, wanted = self.per_ampere(place), np.asarray(field, float)
        found = np.linalg.lstsq(A[:3], wanted, rcond=1e-9)[0]
        if np.linalg.norm(A[:3] @ found - wanted) > 1e-6 * np.linalg.norm(wanted):
            raise SpecError(
                "field", wanted.tolist(), f"one that these {len(found)} coils can make there",
                "three or more coils in different directions make any",
            )  # fmt: skip
        if gradient is None:
            return found
        free = np.linalg.svd(A[:3])[2][3:].T  # currents that make no field here
        left = np.ravel(gradient) - A[3:] @ found
        return found + free @ np.linalg.lstsq(A[3:] @ free, left, rcond=WEAK)[0]

    @property
    def at_rest(self) -> np.ndarray:
        """Currents (n,) at time zero."""
        return self._currents(0.0)

    def _currents(self, times: Any) -> np.ndarray:
        phases = np.array(self.phases if self.phases is not None else [0.0] * len(self.coils))
        angle = 2.0 * np.pi * self.frequency * np.asarray(times, float)[..., None]
        return np.array(self.currents) * np.cos(angle + phases)

    @property
    def rate(self) -> float:
        """How fast the currents change (rad per time)."""
        return abs(2.0 * np.pi * self.frequency)
