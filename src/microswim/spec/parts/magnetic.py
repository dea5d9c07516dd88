"""What a spec file may say of the magnet in the body and of the field around it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import StrictBool

from microswim.spec.fields import About
from microswim.spec.types import (
    Angle,
    Current,
    Frequency,
    Length,
    Moment,
    Number,
    Speed,
    Table,
    Tesla,
    Volume,
)


class MagnetTable(Table):
    """[magnet]: a magnet fixed in the body, permanent or soft."""

    moment: Annotated[
        Moment | list[Moment] | None,
        About("Moment", "magnetic, fixed in the body: [s, q, r], or its size, with a direction",
              entries=("Moment along s", "Moment along q", "Moment along r")),
    ] = None  # fmt: skip
    remanence: Annotated[
        Tesla | None, About("Remanence", "of the magnet, in place of the moment; with its size")
    ] = None
    susceptibility: Annotated[
        list[Number] | list[list[Number]] | None,
        About("Susceptibility", "of a soft magnet as a whole: along s, q, r, or a tensor",
              entries=("Susceptibility along s", "Susceptibility along q",
                       "Susceptibility along r")),
    ] = None  # fmt: skip
    shape: Annotated[
        Literal["block", "cylinder", "sphere"], About("Shape", "block | cylinder | sphere")
    ] = "block"
    size: Annotated[
        list[Length] | None,
        About("Size", "edges of the block; diameter and height; or [diameter] of the sphere"),
    ] = None
    volume: Annotated[Volume | None, About("Volume", "in place of shape and size")] = None
    direction: Annotated[
        Angle | list[Angle] | None,
        About("Direction", "of the moment: [s, q, r], or the angle from s towards q",
              usual=(0.0, 90.0)),
    ] = None  # fmt: skip
    azimuth: Annotated[
        Angle, About("Side, about s", "the moment's, from q towards r", usual=(-180.0, 180.0))
    ] = 0.0


_FIELD = About("Kind", "rotating | uniform | oscillating | sequence | dipole | magnet | coils")
_STRENGTH = About("Strength", "of the field", usual=(0.0, 0.02))
_AXIS = About("Axis", "that the field turns about, lab, [x, y, z]")
_TURNS = About("Frequency", "turns of the field per time")
_LINE = About("Direction", "in the lab, [x, y, z]")


class RotatingFieldTable(Table):
    """[field] of kind "rotating"."""

    kind: Annotated[Literal["rotating"], _FIELD]
    strength: Annotated[Tesla, _STRENGTH]
    frequency: Annotated[Frequency, _TURNS]
    axis: Annotated[list[Number], _AXIS] = [1.0, 0.0, 0.0]
    cone: Annotated[
        Angle, About("Cone", "angle of the field out of its plane, towards the axis",
                     usual=(-80.0, 80.0))
    ] = 0.0  # fmt: skip


class UniformFieldTable(Table):
    """[field] of kind "uniform"."""

    kind: Annotated[Literal["uniform"], _FIELD]
    strength: Annotated[Tesla, _STRENGTH]
    direction: Annotated[list[Number], _LINE] = [1.0, 0.0, 0.0]


class OscillatingFieldTable(Table):
    """[field] of kind "oscillating"."""

    kind: Annotated[Literal["oscillating"], _FIELD]
    strength: Annotated[Tesla, _STRENGTH]
    frequency: Annotated[Frequency, About("Frequency", "cycles of the field per time")]
    direction: Annotated[list[Number], _LINE] = [1.0, 0.0, 0.0]


class DipoleFieldTable(Table):
    """[field] of kind "dipole": a permanent magnet beside the swimmer."""

    kind: Annotated[Literal["dipole"], _FIELD]
    moment: Annotated[
        list[Moment] | None, About("Moment", "of the magnet that makes the field, lab")
    ] = None
    position: Annotated[
        list[Length] | None, About("Place", "of that magnet in the lab, [x, y, z]")
    ] = None
    axis: Annotated[list[Number], _AXIS] = [1.0, 0.0, 0.0]
    frequency: Annotated[Frequency, _TURNS] = 0.0
    velocity: Annotated[
        list[Speed], About("Velocity", "with which that magnet moves, [x, y, z]")
    ] = [0.0, 0.0, 0.0]  # fmt: skip
    file: Annotated[
        str | None, About("File", "in place of position: t, x, y, z of the magnet, mx, my, mz")
    ] = None


class MagnetFieldTable(Table):
    """[field] of kind "magnet": a permanent magnet of finite size beside the swimmer."""

    kind: Annotated[Literal["magnet"], _FIELD]
    remanence: Annotated[Tesla, About("Remanence", "of the magnet that makes the field")]
    shape: Annotated[
        Literal["block", "cylinder", "sphere"], About("Shape", "block | cylinder | sphere")
    ] = "block"
    size: Annotated[
        list[Length],
        About("Size", "edges of the block along x, y, z; diameter and height; or [diameter]"),
    ]
    position: Annotated[list[Length], About("Place", "of its centre in the lab, [x, y, z]")]
    direction: Annotated[
        list[Number], About("Direction", "of its magnetisation, lab, [x, y, z]")
    ] = [0.0, 0.0, 1.0]  # fmt: skip
    axis: Annotated[list[Number], _AXIS] = [1.0, 0.0, 0.0]
    frequency: Annotated[Frequency, _TURNS] = 0.0
    velocity: Annotated[
        list[Speed], About("Velocity", "with which that magnet moves, [x, y, z]")
    ] = [0.0, 0.0, 0.0]  # fmt: skip


class SequenceFieldTable(Table):
    """[field] of kind "sequence": a table of B in time."""

    kind: Annotated[Literal["sequence"], _FIELD]
    file: Annotated[str, About("File", "table of t, Bx, By, Bz with units in the header")]
    repeat: Annotated[StrictBool, About("Repeat", "begin anew after the last row")] = False


class CoilFieldTable(Table):
    """[field] of kind "coils": electromagnets by their calibration."""

    kind: Annotated[Literal["coils"], _FIELD]
    file: Annotated[
        str, About("File", "calibration of the coils, YAML; their measures, TOML; B on a grid, CSV")
    ]
    currents: Annotated[
        list[Current] | None, About("Currents", "one for each coil, in its order")
    ] = None  # fmt: skip
    frequency: Annotated[Frequency, _TURNS] = 0.0
    phases: Annotated[
        list[Angle] | None, About("Phases", "by which each current is ahead, one for each coil")
    ] = None


#: Tables of [field], one of each kind.
APPLIED: tuple[type[Table], ...] = (
    RotatingFieldTable,
    UniformFieldTable,
    OscillatingFieldTable,
    SequenceFieldTable,
    DipoleFieldTable,
    MagnetFieldTable,
    CoilFieldTable,
)
