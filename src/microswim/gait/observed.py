"""Numbers of a gait by name: quantities, and entries of its vectors and matrices.

With the degrees of freedom us, uq, ur, os, oq, or:

===================== ==========================================================================
``mean.us``           velocity averaged over the period
``amplitude.uq``      half of peak to peak of a velocity over the period
``velocity.us``       velocity at given phases (a time series)
``resistance.us.os``  entry of R averaged over the period; ``tail_resistance``, ``body_resistance``
``propulsion.os``     entry of F_p averaged over the period; ``tail_propulsion``
``mobility.uq.uq``    velocity per load, averaged over the period, where ``free`` (the rest held)
===================== ==========================================================================
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait.basis import Basis
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.gait.quantities import QUANTITIES, current
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.units import unit

ALL = QUANTITIES | DRIVEN
ENTRIES = {  #: kinds of entries, with how many degrees of freedom each names
    **dict.fromkeys(("mean", "amplitude", "velocity", "propulsion", "tail_propulsion"), 1),
    **dict.fromkeys(("resistance", "tail_resistance", "body_resistance", "mobility"), 2),
}


PHASES = 32  #: at which a mobility is averaged: R of a beat has six harmonics


def parse(quantity: str) -> tuple[str, tuple[int, ...]]:
    """Return kind and indices of a quantity's name.

    Raises
    ------
    SpecError
        If there is no such quantity.
    """
    kind, *names = current(str(quantity)).split(".")
    wanted = 0 if kind in ALL else ENTRIES.get(kind, -1)
    if len(names) != wanted or any(name not in DEGREES_OF_FREEDOM for name in names):
        allowed = "such as mean.us, amplitude.uq, swimming_speed, body_rate, resistance.us.os"
        raise SpecError("quantity", quantity, allowed)
    return kind, tuple(DEGREES_OF_FREEDOM.index(name) for name in names)


def unit_of(quantity: str, units: str) -> str:
    """Return the unit of a quantity by name; of a dimensionless entry of R or F_p an empty text.

    Examples
    --------
    >>> unit_of("mean.os", "SI"), unit_of("swimming_speed", "SI"), unit_of("mobility.us.us", "SI")
    ('rad/s', 'm/s', 'm/s/N')
    """
    kind, index = parse(quantity)
    if kind in ALL:
        return unit(units, ALL[kind].dimension)
    if kind in ("mean", "amplitude", "velocity"):
        return unit(units, "speed" if index[0] < 3 else "rate")
    return _unit_of_entry(kind, sum(i > 2 for i in index)) if units == "SI" else ""


def _unit_of_entry(kind: str, angular: int) -> str:
    """Return the unit of an entry with so many angular indices; force and torque have no rad."""
    if kind == "mobility":
        return ("m/s/N", "1/s/N", "1/s/(N m)")[angular]
    if kind.endswith("propulsion"):
        return ("N s", "N m s")[angular]
    return ("N s/m", "N s", "N m s")[angular]


@checks.given(
    gait=checks.gait,
    quantity=checks.text,
    phase=checks.series,
    body_length=checks.numeric,
    drive=partial(checks.instance, kind="Drive"),
)
def observed(
    gait: Gait, quantity: str, phase: Any = None, *, body_length: Any = None, drive: Any = None
) -> Any:
    """Return the value of a quantity, from a gait of any model.

    Parameters
    ----------
    gait
        What a model says; may be complex.
    quantity
        A name of the list (docs/quantities.md) such as ``"swimming_speed"``, or an entry such as
        ``"mean.us"``.
    phase
        Phases of a time series (``velocity.*`` alone).
    body_length
        Length of the body along s, for what is counted in body lengths.
    drive
        Magnet and rotating field, ``(moment, strength, cone)``, for ``"step_out"`` and the like.

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
    >>> [round(float(ms.observed(gait, name)), 3) for name in ("mean.os", "body_rate")]
    [-0.39, 0.39]
    """
    kind, index = parse(quantity)
    if kind in ALL:
        return ALL[kind].of(Basis(gait, body_length, drive))
    if kind == "mean":
        return gait.mean_velocity[index]
    if kind == "amplitude":
        return gait.velocity_amplitude[index]
    if kind == "velocity":
        if phase is None:
            raise SpecError("quantity", quantity, "given with the phases of the samples")
        return gait.velocity(phase)[..., index[0]]
    if kind == "mobility":
        return _mobility(gait)[index]
    return _of_part(gait, kind, index)


def _mobility(gait: Gait) -> Any:
    """Return the inverse of R in the free directions (6, 6), averaged over the period."""
    free = np.flatnonzero(gait.free)
    phases = 2.0 * np.pi * np.arange(PHASES) / PHASES
    R = gait.resistance(phases)
    M = np.zeros((6, 6), dtype=R.dtype)
    M[np.ix_(free, free)] = np.linalg.inv(R[:, free[:, None], free]).mean(axis=0)
    return M


def _of_part(gait: Gait, kind: str, index: tuple[int, ...]) -> Any:
    """Return a mean entry of R or F_p, of all, of the body or of the tail (all less the body)."""
    matrix = kind.endswith("resistance")
    whole = gait.resistance_series if matrix else gait.propulsion_series
    body = gait.body_resistance_series if matrix else gait.body_propulsion_series
    own = 0.0 * whole[0] if body is None else body[0]
    part = own if kind.startswith("body") else whole[0] - (own if kind.startswith("tail") else 0.0)
    return part[index]


def output(gait: Gait, name: str, drive: Any = None) -> Any:
    """Return a number or array of a gait by name: a quantity, or what the gait itself holds.

    Raises
    ------
    SpecError
        If there is none of that name.
    """
    if name not in QUANTITIES and not name.startswith("_") and hasattr(gait, name):
        value = getattr(gait, name)
        if not callable(value) and not isinstance(value, (str, dict)):
            return value
    try:
        return observed(gait, name, drive=drive)
    except SpecError:
        allowed = "a number of a gait, such as mean_velocity or efficiency"
        raise SpecError("output", name, allowed) from None
