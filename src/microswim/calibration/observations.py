"""Measurements of a swimmer, with their uncertainty: quantities of its gait, by name."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import RenamedWarning, SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.gait.observed import observed, parse
from microswim.gait.quantities import NUMBERS, OLD
from microswim.gait.turning.driven import DRIVEN
from microswim.numerics.array import read_only
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.swimmer import Swimmer

_ENTRY = {"mean_velocity": "such as mean.us", "velocity_amplitude": "such as amplitude.uq"}


#: Standard uncertainty of what is given without one, of its largest value.
ASSUMED = 0.01


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False)
@read_only
class Observation:
    """A measured quantity of one swimmer.

    Parameters
    ----------
    swimmer
        Which swimmer; the calibration replaces its unknown numbers.
    quantity
        Name as in `observed`.
    value
        Measured value, an array for a time series.
    sigma
        Standard uncertainty; 1 % of the largest value if left out, which `assumed` then says.
    phase
        Phases of a time series (rad).

    Raises
    ------
    SpecError
        If the quantity does not exist, a number is not finite or sigma is not positive.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("goto/C")
    >>> ms.Observation(swimmer=swimmer, quantity="swimming_speed", value=6.23e-6, sigma=1e-7).sigma
    1e-07
    """

    swimmer: Swimmer
    quantity: str
    value: Any
    sigma: Any = None
    phase: Any = None
    assumed: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        checks.instance("swimmer", self.swimmer, "Swimmer")
        self._check_name()
        checks.series(f"value of {self.quantity}", self.value, "finite numbers")
        value = np.asarray(self.value, dtype=float)
        if value.size == 0:
            raise SpecError(f"value of {self.quantity}", self.value, "finite numbers")
        if value.ndim:
            object.__setattr__(self, "value", value)
        if value.ndim and np.shape(self.phase) != value.shape:
            raise SpecError(f"{self.quantity}: as many phases as values must be given")
        sigma = self.sigma
        if sigma is None:
            sigma = ASSUMED * np.abs(value).max() or 1.0
            object.__setattr__(self, "assumed", True)
        checks.series(f"sigma, uncertainty of {self.quantity}", sigma, "positive")
        if np.any(np.asarray(sigma) <= 0):
            raise SpecError(f"sigma, uncertainty of {self.quantity}", self.sigma, "positive")
        object.__setattr__(self, "sigma", sigma)

    def _check_name(self) -> None:
        """Keep the name of today; say what changed its meaning, refuse what is no number."""
        kind, index = parse(self.quantity)
        if not index and kind not in (*NUMBERS, *DRIVEN):
            raise SpecError("quantity", kind, "one number", f"name an entry, {_ENTRY[kind]}")
        if kind == "body_rate":
            warnings.warn(
                "body_rate is in radians per time; what is in revolutions is body_rate_hz (it was "
                "called body_rate until this release)",
                RenamedWarning,
                stacklevel=4,
            )
        object.__setattr__(self, "quantity", OLD.get(self.quantity, self.quantity))

    @property
    def scale(self) -> float:
        """Largest magnitude of the value."""
        return float(np.abs(self.value).max())


def usual_quantities(swimmer: Swimmer) -> tuple[str, ...]:
    """Return the three velocities that the paper fits: forward, lateral, and of rotation."""
    wanted = ("mean.us", "amplitude.uq", "mean.os" if swimmer.tail.is_rigid else "amplitude.or")
    mask: dict[str, bool] = dict(zip(DEGREES_OF_FREEDOM, swimmer.motion.mask))
    return tuple(q for q in wanted if mask[q.split(".")[1]])


def with_loads(swimmer: Swimmer) -> tuple[str, ...]:
    """Return those, and velocity per force along and across; of a spinning helix also the power."""
    free: dict[str, bool] = dict(zip(DEGREES_OF_FREEDOM, swimmer.motion.mask))
    if not (free["us"] and free["uq"]):
        return usual_quantities(swimmer)
    spins = swimmer.tail.is_rigid and swimmer.coefficients.spin
    loads = "mobility.us.us", "mobility.uq.uq"
    return (*usual_quantities(swimmer), *loads, *(("mean_power",) if spins else ()))


def from_reference(
    swimmer: Swimmer, gait: Gait, quantities: Iterable[str] = ()
) -> list[Observation]:
    """Return observations taken from a gait of the reference model, `usual_quantities` by default.

    The uncertainty of each is 1 % of its value, or of its natural scale where it nearly cancels.
    """
    names = tuple(quantities) or usual_quantities(swimmer)
    drive = drive_of(swimmer)
    found = [(name, float(np.real(observed(gait, name, drive=drive)))) for name in names]
    return [Observation(swimmer=swimmer, quantity=name, value=value) for name, value in found]


def from_dict(swimmer: Swimmer, measured: dict[str, Any]) -> list[Observation]:
    """Return observations of one swimmer: ``{"swimming_speed": 30e-6, "body_rate_hz": (8.9,
    0.4)}``.
    """
    out = []
    for name, entry in measured.items():
        value, sigma = entry if np.ndim(entry) == 1 and len(entry) == 2 else (entry, None)
        out.append(Observation(swimmer=swimmer, quantity=name, value=value, sigma=sigma))
    return out


def from_series(
    swimmer: Swimmer, time: Any, velocities: dict[str, Any], sigma: Any = None, phase: float = 0.0
) -> list[Observation]:
    """Return observations from a time series of velocities in the body frame.

    Parameters
    ----------
    swimmer
        The swimmer, its tail turning at its own rate.
    time
        Times of the samples.
    velocities
        Degree of freedom (``"us"``, ...) to samples.
    sigma
        Uncertainty of a sample, one for all or one per degree of freedom.
    phase
        Phase of the tail at time zero (rad).
    """
    phases = np.asarray(time, dtype=float) * swimmer.gait().rate + phase
    each = sigma if isinstance(sigma, dict) else dict.fromkeys(velocities, sigma)
    return [
        Observation(
            swimmer=swimmer, quantity=f"velocity.{name}", value=v, sigma=each[name], phase=phases
        )
        for name, v in velocities.items()
    ]
