"""What a spec file may hold: its tables, field by field. The one place that says a field.

A field has a type (a quantity of some dimension, a number, a truth, one of some words), a label
and a line of help; `microswim.spec.fields` reads them off for all who ask. pydantic reads files by
these tables; the parts themselves check what makes physical sense.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, StrictBool, create_model

from microswim.spec import fields
from microswim.spec.fields import About
from microswim.spec.parts.body import BODIES
from microswim.spec.parts.elastic import HookTable
from microswim.spec.parts.magnetic import APPLIED, MagnetTable
from microswim.spec.parts.motor import MotorTable
from microswim.spec.parts.outside import FLOWS, GravityTable, NoiseTable
from microswim.spec.parts.tail import TAILS
from microswim.spec.types import (
    Angle,
    Density,
    Kinematic,
    Length,
    Number,
    Viscosity,
)
from microswim.spec.types import Table as _Table
from microswim.swimmer.fields import ALTERNATIVES as OF_A_SWIMMER


class FluidTable(_Table):
    """[fluid]"""

    viscosity: Annotated[Viscosity, About("Viscosity", "dynamic", start=100.0)]
    kinematic_viscosity: Annotated[
        Kinematic | None,
        About("Kinematic viscosity", "in place of viscosity: times the density it is the same"),
    ] = None
    density: Annotated[
        Density,
        About("Density", "for the Reynolds number, and finite elements with inertia", start=1.0),
    ] = 0.0


class CoefficientsTable(_Table):
    """[coefficients]"""

    law: Annotated[
        Literal["lighthill", "gray_hancock", "cox", "constant"],
        About("Law", "or gray_hancock, cox, constant; without a law: model auto corrects",
              start="lighthill", words={"gray_hancock": "Gray–Hancock"}),
    ] = "lighthill"  # fmt: skip
    spin: Annotated[
        StrictBool, About("Filament spin", "the filament resists spinning about itself", start=True)
    ] = True
    tip: Annotated[
        StrictBool,
        About("Tip", "true: the free end has a drag of its own, 3 pi mu r_t", start=False),
    ] = False
    normal: Annotated[Viscosity | None, About("Normal", "c_n of the constant law")] = None
    tangential: Annotated[Viscosity | None, About("Tangential", "c_t of the constant law")] = None


_ONES = [1.0, 1.0, 1.0]


class InteractionTable(_Table):
    """[interaction]"""

    translation: Annotated[
        list[Number],
        About("Drag", "factors on the body's drag along s, q, r", start=_ONES, usual=(0.2, 6.0),
              entries=("γ along s", "γ along q", "γ along r")),
    ] = _ONES  # fmt: skip
    rotation: Annotated[
        list[Number],
        About("Torque", "and about s, q, r; microswim calibrate finds them", start=_ONES,
              usual=(0.2, 6.0), entries=("γ about s", "γ about q", "γ about r")),
    ] = _ONES  # fmt: skip
    coupling: Annotated[
        list[list[Number]], About("Coupling", "force by rotation, 3 x 3", usual=(-1.0, 1.0))
    ] = [[0.0] * 3] * 3
    tail: Annotated[
        list[Number],
        About("Tail", "factors on c_t, c_n, c_r", usual=(0.2, 3.0),
              entries=("Tail, tangential", "Tail, normal", "Tail, spin")),
    ] = _ONES  # fmt: skip


class MotionTable(_Table):
    """[motion]"""

    free: Annotated[
        str | list[str],
        About("Free", 'none: held, or a list such as ["us", "uq", "ur", "os"]', start="all"),
    ] = "all"
    frequency_frame: Annotated[
        Literal["body", "lab"], About("Frequency in", "body: of the motor | lab: of the tail")
    ] = "body"
    line_element: Annotated[
        Literal["arc", "apparent"], About("Line element", "arc | apparent: as Eqs. 5 and 14 may")
    ] = "arc"


_TILT = (-45.0, 45.0)


class WallTable(_Table):
    """[wall]: a plane wall beside the swimmer (boundary elements)."""

    distance: Annotated[Length, About("Distance", "of the body's centre from the wall")]
    tilt: Annotated[Angle, About("Tilt", "nose towards the wall", usual=_TILT)] = 0.0
    azimuth: Annotated[
        Angle, About("Side, about s", "where about s the wall lies", usual=(-180.0, 180.0))
    ] = 0.0


class ChannelTable(_Table):
    """[channel]: the vessel around the swimmer (finite elements)."""

    diameter: Annotated[Length, About("Diameter", "of the cylinder, or sides of the box")]
    length: Annotated[Length, About("Length", "along the axis")]
    shape: Annotated[
        Literal["cylinder", "box"], About("Shape", "cylinder | box", words={"cylinder": "Tube"})
    ] = "cylinder"
    position: Annotated[
        list[Length],
        About("Place", "of the swimmer's middle from the channel's",
              entries=("Place along", "Place across, q", "Place across, r")),
    ] = [0.0, 0.0, 0.0]  # fmt: skip
    tilt: Annotated[Angle, About("Tilt", "of the swimmer about r", usual=_TILT)] = 0.0
    azimuth: Annotated[Angle, About("Tilt about, from r", "about s", usual=(-180.0, 180.0))] = 0.0
    ends: Annotated[Literal["closed", "open"], About("Ends", "closed: walls | open")] = "closed"


class RegionTable(_Table):
    """[region]: what ``microswim calibrate --region`` found, as text."""

    data: Annotated[str, About("Region", "a region calibration, as text")]


class CalibrationTable(_Table):
    """[calibration]: by what, where and when the coefficients or the region were found."""

    reference: Literal["bem", "fem", "rft", "measurements"]
    level: str = ""
    date: str = ""
    version: str = ""
    law: str = ""
    design: dict[str, Number] = {}
    region: dict[str, list[Number]] = {}
    found: dict[str, Number] = {}
    matched: dict[str, Number] = {}
    unmatched: dict[str, Number] = {}


#: The kinds of each table, by its name.
TABLES: dict[str, tuple[type[_Table], ...]] = {
    "fluid": (FluidTable,),
    "body": BODIES,
    "tail": TAILS,
    "coefficients": (CoefficientsTable,),
    "interaction": (InteractionTable,),
    "motion": (MotionTable,),
    "region": (RegionTable,),
    "hook": (HookTable,),
    "motor": (MotorTable,),
    "wall": (WallTable,),
    "channel": (ChannelTable,),
    "magnet": (MagnetTable,),
    "field": APPLIED,
    "gravity": (GravityTable,),
    "flow": FLOWS,
    "noise": (NoiseTable,),
    "calibration": (CalibrationTable,),
}
#: Tables that every spec holds.
REQUIRED = ("fluid", "body", "tail")
#: Every field by its dotted name.
FIELDS = fields.read_off(TABLES)
#: Fields that say the same in two ways: one of the two is given.
ALTERNATIVES = {
    **OF_A_SWIMMER,
    "tail.section": "tail.radius",
    "fluid.viscosity": "fluid.kinematic_viscosity",
    "fluid.kinematic_viscosity": "fluid.viscosity",
}
#: The field that chooses the kind of a table.
TAGS = {"body": "shape", "tail": "kind", "field": "kind", "flow": "kind"}


def of_file(tables: Mapping[str, Any]) -> type[_Table]:
    """Return the table of a whole spec file: the tables that it holds, each of the kind it is."""
    present = [name for name in TABLES if name in tables or name in REQUIRED]
    return _whole(tuple((name, _kind(name, tables.get(name))) for name in present))


def _kind(name: str, given: Any) -> tuple[type[_Table], ...]:
    """Return the kind of a table that is given; all of them where it does not say a known one."""
    kinds = TABLES[name]
    said = given.get(TAGS[name]) if name in TAGS and isinstance(given, dict) else None
    return tuple(k for k in kinds if word(k, name) == said) or kinds


def word(kind: type[_Table], name: str) -> str | None:
    """Return the word that asks for one of the kinds of a table; None where there is one kind."""
    if name not in TAGS:
        return None
    return get_args(kind.model_fields[TAGS[name]].annotation)[0]


@cache
def _whole(present: tuple[tuple[str, tuple[type[_Table], ...]], ...]) -> type[_Table]:
    fields: dict[str, Any] = {}
    for name, kinds in present:
        tag = TAGS[name] if len(kinds) > 1 else None
        fields[name] = (reduce(or_, kinds), Field(discriminator=tag))
    return create_model("SpecTable", __base__=_Table, **fields)
