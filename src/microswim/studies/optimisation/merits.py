"""What a designer may ask of a swimmer, by name: from a gait, or of many designs at once.

Magnitudes throughout: a speed, a torque or a rate has no sign here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.screw import screw
from microswim.studies.optimisation.expressions import magnitude
from microswim.swimmer.fields import ALTERNATIVES, both_of_the_wave, in_terms_of
from microswim.swimmer.swimmer import Swimmer

MERITS = {
    "speed": "swimming speed: net displacement along the screw axis per time",
    "forward_speed": "mean velocity along s towards the body's end, negative backwards",
    "efficiency": "hydrodynamic efficiency [Tabak Eq. 24]",
    "power": "mean power of the motor",
    "torque": "mean torque of the motor (power over phase rate)",
    "body_rate": "mean rate of rotation of the body about s (rad per time)",
    "wobble": "amplitude of the lateral velocity of the body's centre",
    "yaw": "amplitude of the body's rate of rotation across s (rad per time)",
    "speed_per_torque": "speed over torque",
    "speed_per_power": "speed over power",
    "distance_per_cycle": "speed over frequency",
    "energy_per_distance": "power over speed",
}
GEOMETRY = {
    "amplitude_wavenumber": "amplitude x wavenumber of the tail",
    "arc_length": "length along the filament",
    "tail_length": "length of the tail along s",
    "length_over_amplitude": "length along the filament over the amplitude",
    "crowding": "radius of the filament over the radius at which the tail touches itself",
    "winding": "least arc length that holds the windings, over the arc length",
    "slenderness": "Lighthill's epsilon = 5.2 r_t alpha / lambda [Tabak Eq. 26]",
}
_OF_SPEED = {
    *("speed", "speed_per_torque", "speed_per_power"),
    *("distance_per_cycle", "energy_per_distance"),
}


def known(swimmer: Swimmer) -> set[str]:
    """Names an expression about this swimmer may use: merits and numbers of the spec."""
    shape = set(GEOMETRY) if hasattr(swimmer.tail, "arc_length") else set()
    both = set(ALTERNATIVES) if shape else set()
    return set(MERITS) | shape | both | set(swimmer.numbers)


def of_gait(swimmer: Swimmer, gait: Gait, names: Any = None) -> dict[str, Any]:
    """Merits of one swimmer with its gait, by any model; complex if the gait is.

    Parameters
    ----------
    swimmer
        The swimmer.
    gait
        Its gait.
    names
        Which are wanted, for speed; all by default.
    """
    wanted = set(MERITS if names is None else names)
    return _derived(
        magnitude(screw(gait).speed) if wanted & _OF_SPEED else None,
        gait.mean_velocity,
        gait.velocity_amplitude if wanted & {"wobble", "yaw"} else None,
        gait.mean_power,
        gait.mean_torque,
        gait.efficiency if "efficiency" in wanted else None,
        swimmer,
    ) | _geometry(swimmer)


def of_many(
    swimmer: Swimmer, numbers: Mapping[str, Any], tolerance: float = 1e-8
) -> dict[str, Any]:
    """Merits of n designs by the batched kernel; NaN where a design makes no sense."""
    from microswim.models.rft.batch import evaluate

    arrays = {name: np.asarray(v, dtype=float) for name, v in numbers.items()}
    r = evaluate(swimmer, arrays, tolerance)
    many = in_terms_of(swimmer, arrays).lifted(arrays)
    basis = ("swimming_speed", "mean_velocity", "velocity_amplitude", "mean_power", "mean_torque")
    with np.errstate(all="ignore"):
        out = _derived(*(r[name] for name in basis), r["efficiency"], many) | _geometry(many)
    n = len(r["mean_power"])
    return {name: np.broadcast_to(value, (n,)) for name, value in out.items()}


def _derived(speed: Any, V: Any, amplitude: Any, power: Any, torque: Any, eta: Any, s: Any) -> dict:
    torque = magnitude(torque)
    out = {
        "forward_speed": -V[..., 0],
        "body_rate": magnitude(V[..., 3]),
        "power": power,
        "torque": torque,
    }
    if eta is not None:
        out["efficiency"] = eta
    if amplitude is not None:
        out["wobble"] = amplitude[..., 1]
        out["yaw"] = amplitude[..., 5 if s.tail.kind == "plane_wave" else 4]
    if speed is not None:
        with np.errstate(all="ignore"):
            out |= {
                "speed": speed,
                "speed_per_torque": speed / torque,
                "speed_per_power": speed / power,
                "distance_per_cycle": speed / magnitude(s.tail.frequency),
                "energy_per_distance": power / speed,
            }
    return out


def _geometry(swimmer: Swimmer) -> dict[str, Any]:
    tail = swimmer.tail
    out = dict(swimmer.numbers)
    if not hasattr(tail, "room"):
        return out
    with np.errstate(all="ignore"):
        return out | {
            "amplitude_wavenumber": tail.amplitude * tail.wavenumber,
            "arc_length": tail.arc_length,
            "tail_length": tail.apparent_length,
            "length_over_amplitude": np.divide(tail.arc_length, tail.amplitude),
            "crowding": tail.radius / tail.room(),
            "winding": tail._wound_length() / tail.length,
            "slenderness": 5.2 * tail.radius * tail.alpha * tail.wavenumber / (2.0 * np.pi),
            **both_of_the_wave(tail),
        }
