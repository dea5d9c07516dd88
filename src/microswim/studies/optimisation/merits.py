"""What a designer may ask of a swimmer, by name: from a gait, or of many designs at once.

The quantities of a gait that the batched kernel knows, and what the shape of the tail says.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from microswim.gait.basis import Basis
from microswim.gait.gait import Gait
from microswim.gait.quantities import NUMBERS, OLD, QUANTITIES
from microswim.gait.turning.driven import DRIVEN
from microswim.swimmer.fields import ALTERNATIVES, both_of_the_wave, in_terms_of, lifted
from microswim.swimmer.geometry.tails.kinds import WaveTail
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.swimmer import Swimmer

MERITS = {name: QUANTITIES[name].meaning for name in NUMBERS if QUANTITIES[name].of_many}
GEOMETRY = {
    "amplitude_wavenumber": "amplitude x wavenumber of the tail",
    "arc_length": "length along the filament",
    "tail_length": "length of the tail along s",
    "length_over_amplitude": "length along the filament over the amplitude",
    "crowding": "radius of the filament over the radius at which the tail touches itself",
    "winding": "least arc length that holds the windings, over the arc length",
    "slenderness": "Lighthill's epsilon = 5.2 r_t alpha / lambda [Tabak Eq. 26]",
}


def known(swimmer: Swimmer) -> set[str]:
    """Return the names an expression about this swimmer may use: merits, numbers of the spec."""
    shape = set(GEOMETRY) if isinstance(swimmer.tail, WaveTail) else set()
    both = set(ALTERNATIVES) if shape else set()
    driven = set(DRIVEN) if drive_of(swimmer) is not None else set()
    return set(MERITS) | driven | set(OLD) | shape | both | set(swimmer.numbers)


def of_gait(swimmer: Swimmer, gait: Gait, names: Any = None) -> dict[str, Any]:
    """Return the merits of one swimmer with its gait, by any model; complex if the gait is.

    Parameters
    ----------
    swimmer
        The swimmer.
    gait
        Its gait.
    names
        Which are wanted, for speed; all by default.
    """
    basis = Basis(gait, swimmer.body_length, drive_of(swimmer))
    turns = drive_of(swimmer) is not None and (names is not None or all(gait.free[3:]))
    driven = [n for n in DRIVEN if names is None or n in names] if turns else []
    found = _values(basis, names) | {name: DRIVEN[name].of(basis) for name in driven}
    return found | _geometry(swimmer)


def of_many(
    swimmer: Swimmer, numbers: Mapping[str, Any], tolerance: float = 1e-8, names: Any = None
) -> dict[str, Any]:
    """Return the merits of n designs by the batched kernel; NaN where a design makes no sense.

    Step-out and the like, one design after the other, if `names` or the swimmer's drive ask.
    """
    from microswim.models.rft.batch import evaluate

    arrays = {name: np.asarray(v, dtype=float) for name, v in numbers.items()}
    found = evaluate(swimmer, arrays, tolerance)
    many = lifted(in_terms_of(swimmer, arrays), arrays)
    rate = many.tail.rate
    if many.motion.frequency_frame == "lab":  # the motor's rate, as `Gait.in_lab_frame` has it
        rate = rate - many.tail.sign * found["mean_velocity"][:, 3]
    basis = SimpleNamespace(**found, rate=rate, body_length=many.body_length)
    with np.errstate(all="ignore"):
        out = _values(basis) | _geometry(many)
    if drive_of(swimmer) is not None and (names is None or set(DRIVEN) & set(names)):
        asked = [n for n in DRIVEN if names is None or n in names]
        out |= _driven(swimmer, arrays, np.isfinite(found["mean_power"]), asked)
    n = len(found["mean_power"])
    return {name: np.broadcast_to(value, (n,)) for name, value in out.items()}


def _driven(
    swimmer: Swimmer, arrays: Mapping[str, Any], good: np.ndarray, names: list[str]
) -> dict[str, Any]:
    """Return what is asked of a rotating field with each design that is one."""
    out = {name: np.full(len(good), np.nan) for name in names}
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for i in np.flatnonzero(good):
            one = lifted(swimmer, {name: float(values[i]) for name, values in arrays.items()})
            basis = Basis(one.gait(), drive=drive_of(one))
            for name in names:
                out[name][i] = DRIVEN[name].of(basis)
    return out


def _values(basis: Any, names: Any = None) -> dict[str, Any]:
    wanted = MERITS if names is None else [name for name in MERITS if name in names]
    return {name: QUANTITIES[name].of(basis) for name in wanted}


def _geometry(swimmer: Swimmer) -> dict[str, Any]:
    tail = swimmer.tail
    out = dict(swimmer.numbers)
    if not isinstance(tail, WaveTail):
        return out
    with np.errstate(all="ignore"):
        return out | {
            "amplitude_wavenumber": tail.amplitude * tail.wavenumber,
            "arc_length": tail.arc_length,
            "tail_length": tail.apparent_length,
            "length_over_amplitude": np.divide(tail.arc_length, tail.amplitude),
            "crowding": tail.radius / tail.room(),
            "winding": tail.wound_length() / tail.length,
            "slenderness": 5.2 * tail.radius * tail.alpha * tail.wavenumber / (2.0 * np.pi),
            **both_of_the_wave(tail),
        }
