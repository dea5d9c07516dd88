"""What is observed of a swimmer: numbers of a gait by name, and measurements with uncertainty.

Names of quantities, with the degrees of freedom us, uq, ur, os, oq, or:

===================== ==========================================================================
``mean.us``           velocity averaged over the period
``amplitude.uq``      half of peak to peak of a velocity over the period
``speed``             magnitude of ``mean.us``
``body_rate``         magnitude of ``mean.os`` in revolutions per time
``velocity.us``       velocity at given phases (a time series)
``resistance.us.os``  entry of R averaged over the period; ``tail_resistance``, ``body_resistance``
``propulsion.os``     entry of F_p averaged over the period; ``tail_propulsion``
===================== ==========================================================================

All are analytic in the numbers of the swimmer, so the complex step differentiates them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.swimmer.swimmer import Swimmer

_MATRICES = ("resistance", "tail_resistance", "body_resistance")
_VECTORS = ("mean", "amplitude", "velocity", "propulsion", "tail_propulsion")
_WHOLE = ("speed", "body_rate")
_FORM = "such as mean.us, amplitude.uq, speed, body_rate, velocity.us, resistance.us.os"


def parse(quantity: str) -> tuple[str, tuple[int, ...]]:
    """Kind and indices of a quantity's name.

    Raises
    ------
    SpecError
        If there is no such quantity.
    """
    kind, *names = str(quantity).split(".")
    wanted = 0 if kind in _WHOLE else 2 if kind in _MATRICES else 1 if kind in _VECTORS else -1
    if len(names) != wanted or any(name not in DEGREES_OF_FREEDOM for name in names):
        raise SpecError("quantity", quantity, _FORM)
    return kind, tuple(DEGREES_OF_FREEDOM.index(name) for name in names)


def observed(gait: Gait, quantity: str, phase: Any = None) -> Any:
    """Value of a quantity, from a gait of any model.

    Parameters
    ----------
    gait
        What a model says; may be complex.
    quantity
        Name as in the module's table.
    phase
        Phases of a time series (``velocity.*`` alone).

    Returns
    -------
    number or ndarray
        An array of the phases' shape for a time series.

    Raises
    ------
    SpecError
        If there is no such quantity.

    Examples
    --------
    >>> import microswim as ms
    >>> gait = ms.Swimmer.preset("tabak/helix-constant").gait()
    >>> round(float(ms.observed(gait, "mean.os")), 3)
    -0.39
    """
    kind, index = parse(quantity)
    if kind == "speed":
        return np.sqrt(gait.mean_velocity[0] ** 2)
    if kind == "body_rate":
        return np.sqrt(gait.mean_velocity[3] ** 2) / (2.0 * np.pi)
    if kind == "mean":
        return gait.mean_velocity[index]
    if kind == "amplitude":
        return gait.velocity_amplitude[index]
    if kind == "velocity":
        if phase is None:
            raise SpecError("quantity", quantity, "given with the phases of the samples")
        return gait.velocity(phase)[..., index[0]]
    return _of_part(gait, kind, index)


def _of_part(gait: Gait, kind: str, index: tuple[int, ...]) -> Any:
    """Mean entry of R or F_p, of all, of the body or of the tail (all less the body)."""
    matrix = kind.endswith("resistance")
    whole = gait.resistance_series if matrix else gait.propulsion_series
    body = gait.body_resistance_series if matrix else gait.body_propulsion_series
    own = 0.0 * whole[0] if body is None else body[0]
    part = own if kind.startswith("body") else whole[0] - (own if kind.startswith("tail") else 0.0)
    return part[index]


#: Standard uncertainty of what is given without one, of its largest value.
ASSUMED = 0.01


@dataclass(frozen=True, kw_only=True, eq=False)
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
    >>> ms.Observation(swimmer=swimmer, quantity="speed", value=6.23e-6, sigma=1e-7).sigma
    1e-07
    """

    swimmer: Swimmer
    quantity: str
    value: Any
    sigma: Any = None
    phase: Any = None
    assumed: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        parse(self.quantity)
        value = np.asarray(self.value, dtype=float)
        if not np.all(np.isfinite(value)) or value.size == 0:
            raise SpecError(self.quantity, self.value, "finite numbers")
        if value.ndim and np.shape(self.phase) != value.shape:
            raise SpecError(f"{self.quantity}: as many phases as values must be given")
        sigma = self.sigma
        if sigma is None:
            sigma = ASSUMED * np.abs(value).max() or 1.0
            object.__setattr__(self, "assumed", True)
        if not np.all(np.isfinite(sigma)) or np.any(np.asarray(sigma) <= 0):
            raise SpecError(f"uncertainty of {self.quantity}", self.sigma, "positive")
        object.__setattr__(self, "sigma", sigma)

    @property
    def scale(self) -> float:
        """Largest magnitude of the value."""
        return float(np.abs(self.value).max())


def usual_quantities(swimmer: Swimmer) -> tuple[str, ...]:
    """The three velocities that the paper fits: forward, lateral, and of rotation."""
    helix = swimmer.tail.kind == "helix"
    wanted = ("mean.us", "amplitude.uq", "mean.os" if helix else "amplitude.or")
    mask = dict(zip(DEGREES_OF_FREEDOM, swimmer.motion.mask))
    return tuple(q for q in wanted if mask[q.split(".")[1]])


def from_reference(
    swimmer: Swimmer, gait: Gait, quantities: Iterable[str] = ()
) -> list[Observation]:
    """Observations taken from a gait of the reference model, `usual_quantities` by default.

    The uncertainty of each is 1 % of its value, or of its natural scale where it nearly cancels.
    """
    names = tuple(quantities) or usual_quantities(swimmer)
    found = [(name, float(np.real(observed(gait, name)))) for name in names]
    return [Observation(swimmer=swimmer, quantity=name, value=value) for name, value in found]


def from_dict(swimmer: Swimmer, measured: dict[str, Any]) -> list[Observation]:
    """Observations of one swimmer: ``{"speed": 30e-6, "body_rate": (8.9, 0.4)}``, value or pair."""
    out = []
    for name, entry in measured.items():
        value, sigma = entry if np.ndim(entry) == 1 and len(entry) == 2 else (entry, None)
        out.append(Observation(swimmer=swimmer, quantity=name, value=value, sigma=sigma))
    return out


def from_series(
    swimmer: Swimmer, time: Any, velocities: dict[str, Any], sigma: Any = None, phase: float = 0.0
) -> list[Observation]:
    """Observations from a time series of velocities in the body frame.

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
