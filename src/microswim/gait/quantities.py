"""Single numbers of a gait."""

from __future__ import annotations

from typing import Any

from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.screw import screw


def summary(gait: Gait) -> dict[str, Any]:
    """What one usually wants to know about a gait.

    Returns
    -------
    dict
        ``mean_velocity`` (6,), ``velocity_amplitude`` (6,), ``swimming_speed`` (net displacement
        along the screw axis per time), ``path_radius`` (distance of the body's centre from that
        axis at phase 0), ``path_pitch``, ``rotation_per_period`` (rad), ``mean_power`` of the
        motor, ``mean_torque`` (power over rate), ``efficiency`` [Tabak Eq. 24].

    Examples
    --------
    >>> import microswim as ms
    >>> sorted(ms.summary(ms.Swimmer.preset("tabak/helix").gait()))[:2]
    ['efficiency', 'mean_power']
    """
    motion = screw(gait)
    return {
        "mean_velocity": gait.mean_velocity,
        "velocity_amplitude": gait.velocity_amplitude,
        "swimming_speed": motion.speed,
        "path_radius": motion.radius,
        "path_pitch": motion.pitch,
        "rotation_per_period": motion.angle,
        "mean_power": gait.mean_power,
        "mean_torque": gait.mean_torque,
        "efficiency": gait.efficiency,
    }


def output(gait: Gait, name: str) -> Any:
    """A number or array of a gait by name: of the gait itself or of `summary`.

    Raises
    ------
    SpecError
        If there is none of that name.
    """
    if not name.startswith("_") and hasattr(gait, name):
        value = getattr(gait, name)
        if not callable(value) and not isinstance(value, (str, dict)):
            return value
    motion = {"swimming_speed": "speed", "path_radius": "radius"}
    if name in motion:
        return getattr(screw(gait), motion[name])
    raise SpecError("output", name, "a number of a gait, such as mean_velocity or efficiency")
