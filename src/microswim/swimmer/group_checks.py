"""What a group of swimmers may be made of, and asked for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.swimmer.in_units import as_units
from microswim.swimmer.magnetism.between import are_magnetic
from microswim.swimmer.magnetism.drive import check_field_units
from microswim.swimmer.member import Member
from microswim.swimmer.swimmer import Swimmer


def blocks(name: str, value: Any) -> None:
    """Refuse what is no `Blocks`."""
    checks.instance(name, value, "Blocks")


def poses(name: str, value: Any) -> None:
    """Refuse what is no list of poses."""
    checks.series(name, value)
    if np.ndim(value) < 2 or not len(value):
        raise SpecError(name, value, "a list of poses, each with a value for every swimmer")


def checked_members(members: Any) -> tuple[Member, ...]:
    """Return the members of a group as a tuple.

    Raises
    ------
    SpecError
        If there is none, or they are of different units or in different fluids.
    """
    if isinstance(members, Member) or not isinstance(members, Iterable):
        raise SpecError("members", members, "a list of Member")
    members = tuple(members)
    if not members:
        raise SpecError("members", "()", "one Member at least")
    for n, member in enumerate(members):
        checks.instance(f"members[{n}]", member, "Member")
    for n, member in enumerate(members[1:], start=1):
        _check_alike(n, member.swimmer, members[0].swimmer)
    heavy = [(n, m.swimmer.gravity) for n, m in enumerate(members) if m.swimmer.gravity is not None]
    for n, gravity in heavy[1:]:
        if not np.allclose(gravity.vector, heavy[0][1].vector, rtol=1e-9, atol=0.0):
            raise SpecError(
                f"swimmer[{n}] gravity: must pull as on swimmer[{heavy[0][0]}], as strongly and "
                "that way; make gravity.direction and gravity.acceleration the same"
            )
    return members


def _check_alike(n: int, other: Swimmer, first: Swimmer) -> None:
    """Refuse a swimmer of other units or in another fluid than the first."""
    if other.units != first.units:
        words = {"SI": "has units", "dimensionless": "has none"}
        raise SpecError(
            f"swimmer[{n}]: its spec {words[other.units]}, that of swimmer[0] "
            f"{words[first.units]}; give units to all swimmers of a group or to none"
        )
    if float(other.fluid.viscosity) != float(first.fluid.viscosity):
        with as_units(first):
            here, there = (measured(s.fluid.viscosity, "viscosity") for s in (first, other))
        raise SpecError(
            f"swimmer[{n}] fluid.viscosity = {there}: must be that of swimmer[0], {here}; a group "
            "swims in one fluid"
        )


def checked_wall(wall: Any) -> tuple:
    """Return point and normal of a wall as tuples of numbers.

    Raises
    ------
    SpecError
        If they are not two threes of numbers, or the normal has no length.
    """
    allowed = "a point of the wall and its normal, ((x, y, z), (x, y, z))"
    if not isinstance(wall, (tuple, list, np.ndarray)) or len(wall) != 2:
        raise SpecError("wall", wall, allowed)
    for name, values in zip(("wall position", "wall normal"), wall, strict=True):
        checks.numbers(name, values, 3, "three finite numbers")
    if not any(wall[1]):
        raise SpecError("wall normal", tuple(wall[1]), "a direction of some length")
    return tuple(tuple(float(x) for x in values) for values in wall)


def checked_field(field: Any, members: tuple[Member, ...]) -> None:
    """Refuse a field that finds no magnet, or that these swimmers' units do not know."""
    checks.instance("field", field, "AppliedField")
    if not are_magnetic(members):
        raise SpecError(
            "field: no swimmer of the group has a magnet; add [magnet] to a spec, or remove it"
        )
    check_field_units(field, members[0].swimmer.units)
