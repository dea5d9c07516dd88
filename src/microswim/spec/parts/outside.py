"""What a spec file may say of gravity, of the flow around the swimmer and of thermal noise."""

from __future__ import annotations

from typing import Annotated, Literal

from microswim.spec.fields import About
from microswim.spec.types import (
    Acceleration,
    Angle,
    Density,
    Length,
    Number,
    ShearRate,
    Speed,
    Table,
    Temperature,
    Time,
)


class GravityTable(Table):
    """[gravity]"""

    density: Annotated[
        Density | None, About("Density", "of the whole swimmer; or body_density and tail_density")
    ] = None
    body_density: Annotated[Density | None, About("Body's density", "with tail_density")] = None
    tail_density: Annotated[Density | None, About("Tail's density", "with body_density")] = None
    direction: Annotated[
        list[Number], About("Direction", "in which things fall, lab, [x, y, z]")
    ] = [0.0, 0.0, -1.0]  # fmt: skip
    acceleration: Annotated[
        Acceleration | None, About("Acceleration", "of gravity; 9.80665 m/s^2 in SI")
    ] = None
    centre_of_mass: Annotated[
        list[Length],
        About("Centre of mass", "the body's, from the middle of its volume",
              entries=("Mass off along s", "Mass off along q", "Mass off along r")),
    ] = [0.0, 0.0, 0.0]  # fmt: skip


_FLOW = About("Kind", "uniform | shear | strain | rotation | poiseuille")
_SPEED = About("Speed", "of the fluid; on the axis of a tube")
_RATE = About("Rate", "of shear, of stretching, or of turning (rad per time)")
_WAY = About("Direction", "of the flow, lab, [x, y, z]")
_AXIS = About("Axis", "of the turning fluid or of the tube, lab, [x, y, z]")


class UniformFlowTable(Table):
    """[flow] of kind "uniform"."""

    kind: Annotated[Literal["uniform"], _FLOW]
    speed: Annotated[Speed, _SPEED]
    direction: Annotated[list[Number], _WAY] = [1.0, 0.0, 0.0]


class ShearFlowTable(Table):
    """[flow] of kind "shear"."""

    kind: Annotated[Literal["shear"], _FLOW]
    rate: Annotated[ShearRate, _RATE]
    direction: Annotated[list[Number], _WAY] = [1.0, 0.0, 0.0]
    across: Annotated[list[Number], About("Across", "from layer to layer, lab, [x, y, z]")] = [
        0.0, 0.0, 1.0,
    ]  # fmt: skip


class StrainFlowTable(Table):
    """[flow] of kind "strain"."""

    kind: Annotated[Literal["strain"], _FLOW]
    rate: Annotated[ShearRate, _RATE]
    direction: Annotated[list[Number], _WAY] = [1.0, 0.0, 0.0]
    compression: Annotated[
        list[Number] | None, About("Compression", "its direction in planar strain, lab, [x, y, z]")
    ] = None


class RotationFlowTable(Table):
    """[flow] of kind "rotation"."""

    kind: Annotated[Literal["rotation"], _FLOW]
    rate: Annotated[ShearRate, _RATE]
    axis: Annotated[list[Number], _AXIS] = [0.0, 0.0, 1.0]


class PoiseuilleFlowTable(Table):
    """[flow] of kind "poiseuille"."""

    kind: Annotated[Literal["poiseuille"], _FLOW]
    speed: Annotated[Speed, _SPEED]
    diameter: Annotated[
        Length | None, About("Diameter", "of the tube; by default that of the [channel]")
    ] = None
    axis: Annotated[list[Number], _AXIS] = [1.0, 0.0, 0.0]
    centre: Annotated[
        list[Length],
        About("Centre", "a point of the tube's axis, lab",
              entries=("Centre, x", "Centre, y", "Centre, z")),
    ] = [0.0, 0.0, 0.0]  # fmt: skip


#: Tables of [flow], one of each kind.
FLOWS: tuple[type[Table], ...] = (
    UniformFlowTable,
    ShearFlowTable,
    StrainFlowTable,
    RotationFlowTable,
    PoiseuilleFlowTable,
)


class NoiseTable(Table):
    """[noise]"""

    temperature: Annotated[
        Temperature, About("Temperature", "of the fluid; without units the energy k_B T")
    ]
    run_time: Annotated[Time | None, About("Run time", "mean time of a run; a tumble ends it")] = (
        None
    )
    tumble_angle: Annotated[
        Angle | None, About("Tumble angle", "by which a tumble turns the axis")
    ] = None
