"""Tables of [body], one of each shape."""

from __future__ import annotations

from typing import Annotated, Literal

from microswim.spec.fields import About
from microswim.spec.types import Length, Number, Table

_SHAPE = About(
    "Shape",
    "sphere: radius | spheroid, ellipsoid: semi_axes | capsule, cylinder: length, radius | "
    "box: size | revolution: profile | mesh: file, scale | none",
    words={"none": "None"},
)


_RADIUS = About("Radius", "the body touches the tail's joint with its rear", start=0.5)


class SphereTable(Table):
    """[body] of shape "sphere"."""

    shape: Annotated[Literal["sphere"], _SHAPE]
    radius: Annotated[Length, _RADIUS]


_AXES = About(
    "Semi-axes",
    "half lengths along s, q (and r)",
    entries=("Semi-axis along", "Semi-axis across", "Semi-axis across, r"),
)


class SpheroidTable(Table):
    """[body] of shape "spheroid"."""

    shape: Annotated[Literal["spheroid"], _SHAPE]
    semi_axes: Annotated[list[Length], _AXES]
    drag: Annotated[
        Literal["exact", "slender"], About("Drag", "exact | slender: the paper's Eqs. 18, 19")
    ] = "exact"


class EllipsoidTable(Table):
    """[body] of shape "ellipsoid"."""

    shape: Annotated[Literal["ellipsoid"], _SHAPE]
    semi_axes: Annotated[list[Length], _AXES]


_LONG = About("Body length", "from end to end")
_EDGE = About("Edge", "radius of the rounded edges; a fifth of the half width if not given")


class CapsuleTable(Table):
    """[body] of shape "capsule"."""

    shape: Annotated[Literal["capsule"], _SHAPE]
    length: Annotated[Length, _LONG]
    radius: Annotated[Length, _RADIUS]


class CylinderTable(Table):
    """[body] of shape "cylinder"."""

    shape: Annotated[Literal["cylinder"], _SHAPE]
    length: Annotated[Length, _LONG]
    radius: Annotated[Length, _RADIUS]
    edge: Annotated[Length | None, _EDGE] = None


class BoxTable(Table):
    """[body] of shape "box"."""

    shape: Annotated[Literal["box"], _SHAPE]
    size: Annotated[
        list[Length],
        About("Size", "sides along s, q, r", entries=("Side along", "Side across", "Side, r")),
    ]
    edge: Annotated[Length | None, _EDGE] = None


class RevolutionTable(Table):
    """[body] of shape "revolution"."""

    shape: Annotated[Literal["revolution"], _SHAPE]
    profile: Annotated[
        list[list[Length]],
        About("Profile", "[[s, rho], ...] from the joint to the nose, both ends on the axis"),
    ]


class MeshTable(Table):
    """[body] of shape "mesh"."""

    shape: Annotated[Literal["mesh"], _SHAPE]
    file: Annotated[str, About("Surface file", "STL, PLY or OBJ")]
    scale: Annotated[Length, About("Scale", "length of one unit of the file")]
    position: Annotated[
        list[Length] | None,
        About("Place", "of the file's origin from the joint; else its rear touches the joint",
              entries=("Place along", "Place across", "Place across, r")),
    ] = None  # fmt: skip
    rotation: Annotated[
        list[Number], About("Rotation", "quaternion wxyz, of the file's axes to s, q, r")
    ] = [1.0, 0.0, 0.0, 0.0]


class NoBodyTable(Table):
    """[body] of shape "none"."""

    shape: Annotated[Literal["none"], _SHAPE]


#: Tables of [body], one of each shape.
BODIES: tuple[type[Table], ...] = (
    SphereTable,
    SpheroidTable,
    EllipsoidTable,
    CapsuleTable,
    CylinderTable,
    BoxTable,
    RevolutionTable,
    MeshTable,
    NoBodyTable,
)
