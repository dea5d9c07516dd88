"""What the page knows of a swimmer's magnet and of the field about it."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.gait.gait import Gait
from microswim.path.regime_remarks import inertia_of, long_axis_of
from microswim.studio import maps, nearby_field
from microswim.studio.spec_tables import swimmer_of
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.magnetism.applied_field import RotatingField
from microswim.swimmer.magnetism.magnet import vector_of
from microswim.swimmer.physical_sense import INERTIA
from microswim.swimmer.swimmer import Swimmer


def of(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return the magnet in the body's axes, strength and turns per time of a rotating field.

    ``driven``: readings that a rotating field gives; ``long``: the robot's long axis, 0 of s;
    ``inertia``: times by which the rate of turning gives the Reynolds number, and its bound;
    ``own``: the field about the start, where it is more than one that turns a hard magnet.
    """
    field = swimmer.field if isinstance(swimmer.field, RotatingField) else None
    across, along = inertia_of(swimmer, long_axis_of(swimmer, gait))
    soft = swimmer.magnet is not None and swimmer.magnet.susceptibility is not None
    told: dict[str, Any] = {
        "moment": None if swimmer.magnet is None else list(vector_of(swimmer.magnet)),
        "softness": None,
        "field": None if field is None else float(field.strength),
        "frequency": None if field is None else abs(float(field.frequency)),
        "long": long_axis_of(swimmer, gait),
        "inertia": {"across": across, "along": along, "most": INERTIA},
        "own": None,
        "driven": maps.driven(swimmer),
        "remarks": [],
    }
    if soft:
        told["softness"] = np.real(swimmer.magnet.softness).ravel().tolist()  # type: ignore[union-attr]
    if swimmer.field is None or swimmer.magnet is None or not (field is None or soft):
        return told
    try:
        told["own"] = about(swimmer, 0.0, (0.0, 0.0, 0.0))
    except MicroswimError as error:
        told["remarks"] = [f"the field does not drive it here: {error}"]
    return told


def asked(ask: Any) -> dict[str, Any]:
    """Return the field of ``tables`` about a ``place`` (3,) of the lab from a ``time`` on.

    Raises
    ------
    SpecError
        If there is no field, or time and place are none.
    MicroswimError
        If the field is not known there.
    """
    if not isinstance(ask, dict):
        raise SpecError("the request must be a JSON object")
    time, place = ask.get("time"), ask.get("place")
    checks.number("time", time, "a time", least=0.0)
    checks.numbers("place", place, 3, "three lengths")
    return about(swimmer_of(ask.get("tables")), time, place)


def about(swimmer: Swimmer, time: Any, place: Any) -> dict[str, Any]:
    """Return the field about a place from a time on; see `nearby_field.nearby`."""
    if swimmer.field is None:
        raise SpecError("field: this spec has none")
    length = float(nose_to_tip(swimmer))
    return nearby_field.nearby(swimmer.field, float(time), place, length)
