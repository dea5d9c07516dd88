"""Every number of a gait, once: its name, its dimension, one line, and how it is computed.

``run``, `observed`, `calibrate`, `design`, `sweep`, studio, reports and files read `QUANTITIES`.
Angular rates are in radians per time; what is in revolutions says so in its name. All are analytic
in the numbers of the swimmer, so the complex step differentiates them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import renamed
from microswim.gait.basis import Rounded
from microswim.gait.gait import Gait
from microswim.numerics.plain import plain


@dataclass(frozen=True)
class Quantity:
    """A number of a gait, or one for each degree of freedom.

    Parameters
    ----------
    name
        What it is called everywhere.
    dimension
        Key of `microswim.gait.units.UNITS`.
    meaning
        One line.
    of
        Value from a `Basis` of one gait, or of many designs (arrays in place of numbers).
    of_many
        Whether the batched kernel knows what it needs.
    called
        What people read where it is not the name itself.
    """

    name: str
    dimension: str
    meaning: str
    of: Callable[[Any], Any]
    of_many: bool = True
    called: str = ""

    @property
    def label(self) -> str:
        """Its name for people, in small letters."""
        return self.called or self.name.replace("_", " ")


def magnitude(x: Any) -> Any:
    """Return the absolute value, analytic off zero."""
    return np.where(np.real(x) < 0, -x, x)[()]


def ratio(a: Any, b: Any) -> Any:
    """Return a over b, NaN or infinite where b is zero."""
    with np.errstate(all="ignore"):
        return np.divide(a, b)


def _turns(b: Any) -> Any:
    moving = np.real(b.rate) != 0
    return np.where(moving, ratio(b.mean_velocity[..., 3], magnitude(b.rate)), 0.0)[()]


_LIST = (
    Quantity(
        "mean_velocity",
        "twist",
        "twist averaged over the period, body frame, about the body's centre",
        lambda b: b.mean_velocity,
    ),
    Quantity(
        "velocity_amplitude",
        "twist",
        "half of peak to peak of each component of the twist over the period",
        lambda b: b.velocity_amplitude,
    ),
    Quantity(
        "swimming_speed",
        "speed",
        "net displacement along the screw axis per time",
        lambda b: b.swimming_speed,
    ),
    Quantity(
        "forward_velocity",
        "speed",
        "mean velocity towards the body's end, -u_s; negative backwards",
        lambda b: -b.mean_velocity[..., 0],
    ),
    Quantity(
        "lateral_amplitude",
        "speed",
        "half of peak to peak of the velocity along q",
        lambda b: b.velocity_amplitude[..., 1],
    ),
    Quantity(
        "body_rate",
        "rate",
        "mean rate of rotation of the body about s, without sign",
        lambda b: magnitude(b.mean_velocity[..., 3]),
    ),
    Quantity(
        "body_rate_hz",
        "frequency",
        "mean revolutions of the body about s per time, without sign",
        lambda b: magnitude(b.mean_velocity[..., 3]) / (2.0 * np.pi),
        called="body rate",
    ),
    Quantity(
        "body_turns_per_period",
        "number",
        "revolutions of the body about s in a period of the motor, signed",
        _turns,
    ),
    Quantity(
        "yaw_amplitude",
        "rate",
        "half of peak to peak of the body's rate of rotation across s, the larger of q and r",
        lambda b: np.maximum(b.velocity_amplitude[..., 4], b.velocity_amplitude[..., 5]),
    ),
    Quantity(
        "path_speed",
        "speed",
        "along the helix or circle of the period's screw; the swimming speed on a straight path",
        lambda b: b.path_speed,
        of_many=False,
        called="speed along the path",
    ),
    Quantity(
        "path_radius",
        "length",
        "distance of the body's centre from the screw axis at phase 0",
        lambda b: b.path_radius,
        of_many=False,
    ),
    Quantity(
        "path_pitch",
        "length",
        "advance per full turn of the screw motion of a period",
        lambda b: b.path_pitch,
        of_many=False,
    ),
    Quantity(
        "path_curvature",
        "curvature",
        "of the circle or helix that the path runs, its wobble averaged out; zero if straight",
        lambda b: b.path_curvature,
        of_many=False,
    ),
    Quantity(
        "path_torsion",
        "curvature",
        "of the same helix, positive if it is right-handed; zero on a circle",
        lambda b: b.path_torsion,
        of_many=False,
    ),
    Quantity(
        "rotation_per_period",
        "angle",
        "rotation of the screw motion of a period, 0 to 2 pi",
        lambda b: b.rotation_per_period,
        of_many=False,
    ),
    Quantity(
        "frequency",
        "frequency",
        "cycles of the motor per time, negative when reversed",
        lambda b: b.rate / (2.0 * np.pi),
        called="motor frequency",
    ),
    Quantity(
        "mean_power",
        "power",
        "power of the motor, mean over the period",
        lambda b: b.mean_power,
        called="motor power",
    ),
    Quantity(
        "mean_torque",
        "torque",
        "torque of the motor, mean over the period: mean power over the phase rate",
        lambda b: b.mean_torque,
        called="motor torque",
    ),
    Quantity(
        "held_wrench",
        "wrench",
        "mean force and torque by the fluid on the swimmer held still while its tail beats, body "
        "frame, about the body's centre",
        lambda b: -b.rate * b.propulsion_series[0],
        of_many=False,
    ),
    Quantity(
        "efficiency",
        "number",
        "drag power of the body over the power of the motor [Tabak Eq. 24]",
        lambda b: b.efficiency,
    ),
    Quantity(
        "speed_per_torque",
        "speed per torque",
        "swimming speed over the size of the mean torque",
        lambda b: ratio(b.swimming_speed, magnitude(b.mean_torque)),
    ),
    Quantity(
        "speed_per_power",
        "speed per power",
        "swimming speed over mean power",
        lambda b: ratio(b.swimming_speed, b.mean_power),
    ),
    Quantity(
        "distance_per_cycle",
        "length",
        "net displacement along the screw axis in a period",
        lambda b: ratio(2.0 * np.pi * b.swimming_speed, magnitude(b.rate)),
    ),
    Quantity(
        "energy_per_distance",
        "force",
        "mean power over swimming speed",
        lambda b: ratio(b.mean_power, b.swimming_speed),
    ),
    Quantity(
        "body_length",
        "length",
        "length of the body along s (without a body: of the tail)",
        lambda b: b.body_length,
    ),
    Quantity(
        "body_lengths_per_time",
        "frequency",
        "swimming speed over body length",
        lambda b: ratio(b.swimming_speed, b.body_length),
    ),
)
QUANTITIES = {q.name: q for q in _LIST}
OF_SHAPE = ("body_length", "body_lengths_per_time")  #: these need the swimmer's shape too
VECTORS = ("twist", "wrench")  #: dimensions with one number for each degree of freedom
NUMBERS = tuple(q.name for q in _LIST if q.dimension not in VECTORS)
#: Names of earlier versions, with the name of today.
OLD = {
    "speed": "swimming_speed",
    "forward_speed": "forward_velocity",
    "power": "mean_power",
    "torque": "mean_torque",
    "wobble": "lateral_amplitude",
    "yaw": "yaw_amplitude",
}


@checks.given(gait=checks.gait)
def summary(gait: Gait) -> dict[str, Any]:
    """Return every number that a gait alone tells, as plain numbers.

    Returns
    -------
    dict
        Name to number, or to a list with one entry for each degree of freedom us, uq, ur, os, oq,
        or; docs/quantities.md lists them.

    Examples
    --------
    >>> import microswim as ms
    >>> made = ms.summary(ms.Swimmer.preset("tabak/helix").gait())
    >>> round(made["swimming_speed"], 4), len(made["mean_velocity"])
    (0.0672, 6)
    """
    return numbers(gait)


def numbers(gait: Gait, body_length: Any = None, names: Iterable[str] = ()) -> dict[str, Any]:
    """Return every number of a gait, those in body lengths if the body's length is given.

    Or those of the names alone: some, as those of its path, take as long as the gait itself.
    """
    basis, left = Rounded(gait, body_length), OF_SHAPE if body_length is None else ()
    asked = set(names) or {q.name for q in _LIST if q.name not in left}
    return {q.name: plain(np.real(q.of(basis)) + 0.0, nan=True) for q in _LIST if q.name in asked}


def current(name: str) -> str:
    """Return the name of today of a quantity, with a warning if it was renamed."""
    if name in OLD:
        renamed(name, OLD[name])
    return OLD.get(name, name)


class Named(dict):
    """Numbers by name; a name of an earlier version finds the number too, with a warning."""

    def __missing__(self, name: str) -> Any:
        """Look under the name of today."""
        if name not in OLD:
            raise KeyError(name)
        return self[current(name)]
