"""What a designer may ask of a swimmer, by name: from a gait, or of many designs at once.

The quantities of a gait that the batched kernel knows, and what the shape of the tail says.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.quantities import NUMBERS, OLD, QUANTITIES, Basis
from microswim.swimmer.fields import ALTERNATIVES, both_of_the_wave, in_terms_of, lifted
from microswim.swimmer.geometry.tails import WaveTail
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
    return set(MERITS) | set(OLD) | shape | both | set(swimmer.numbers)


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
    return _values(Basis(gait, swimmer.body_length), names) | _geometry(swimmer)


def of_many(
    swimmer: Swimmer, numbers: Mapping[str, Any], tolerance: float = 1e-8
) -> dict[str, Any]:
    """Return the merits of n designs by the batched kernel; NaN where a design makes no sense."""
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
    n = len(found["mean_power"])
    return {name: np.broadcast_to(value, (n,)) for name, value in out.items()}


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
