"""What a spec file may hold: its tables, field by field. The one place that says a field.

A field has a type (a quantity of some dimension, a number, a truth, one of some words), a label
and a line of help; `microswim.spec.fields` reads them off for all who ask. pydantic reads files by
these tables; the parts themselves check what makes physical sense.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, StrictBool

from microswim.spec import fields
from microswim.spec.fields import About, Measures
from microswim.spec.units import DIMENSIONS, to_si
from microswim.swimmer.fields import ALTERNATIVES as OF_A_SWIMMER


def _read_quantity(value: Any, *, measures: str) -> Any:
    """Return the number of a quantity, or a bare number as it stands."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError("must be a number, or a quantity in quotes")
    if not isinstance(value, str):
        return value
    dimension = DIMENSIONS[measures]
    number = to_si(value, dimension.si)
    refused = dimension.refused(number)
    if refused:
        raise ValueError(refused)
    return number


def _read_number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError("must be a bare number")
    return value


def _reads(measures: str) -> BeforeValidator:
    return BeforeValidator(partial(_read_quantity, measures=measures))


Number = Annotated[float, BeforeValidator(_read_number)]
Length = Annotated[float, _reads("length"), Measures("length")]
Frequency = Annotated[float, _reads("frequency"), Measures("frequency")]
Viscosity = Annotated[float, _reads("viscosity"), Measures("viscosity")]
Kinematic = Annotated[float, _reads("kinematic viscosity"), Measures("kinematic viscosity")]
Density = Annotated[float, _reads("density"), Measures("density")]
Angle = Annotated[float, _reads("angle"), Measures("angle")]
Volume = Annotated[float, _reads("volume"), Measures("volume")]
Tesla = Annotated[float, _reads("magnetic field"), Measures("magnetic field")]
Moment = Annotated[float, _reads("magnetic moment"), Measures("magnetic moment")]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


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


_SHAPE = About(
    "Shape", "sphere: radius | spheroid, ellipsoid: semi_axes | none", words={"none": "None"}
)


class SphereTable(_Table):
    """[body] of shape "sphere"."""

    shape: Annotated[Literal["sphere"], _SHAPE]
    radius: Annotated[
        Length, About("Radius", "the body touches the tail's joint with its rear", start=0.5)
    ]


_AXES = About(
    "Semi-axes",
    "half lengths along s, q (and r)",
    entries=("Semi-axis along", "Semi-axis across", "Semi-axis across, r"),
)


class SpheroidTable(_Table):
    """[body] of shape "spheroid"."""

    shape: Annotated[Literal["spheroid"], _SHAPE]
    semi_axes: Annotated[list[Length], _AXES]
    drag: Annotated[
        Literal["exact", "slender"], About("Drag", "exact | slender: the paper's Eqs. 18, 19")
    ] = "exact"


class EllipsoidTable(_Table):
    """[body] of shape "ellipsoid"."""

    shape: Annotated[Literal["ellipsoid"], _SHAPE]
    semi_axes: Annotated[list[Length], _AXES]


class NoBodyTable(_Table):
    """[body] of shape "none"."""

    shape: Annotated[Literal["none"], _SHAPE]


_KIND = About("Kind", "helix | plane_wave | custom")
_SECTIONS = Literal["perpendicular", "sheared"]
_SURFACE = Literal["rigid", "translating", "bending"]


class _TailTable(_Table):
    length: Annotated[Length, About("Length", "from the body to the tip", start=2.0)]
    radius: Annotated[Length, About("Filament radius", "of the filament", start=0.05)]
    frequency: Annotated[
        Frequency, About("Frequency", "of the motor: the tail relative to the body", start=1.0)
    ] = 1.0
    sections: Annotated[
        _SECTIONS | None,
        About("Sections", "bem, fem: sheared: circles in s = const planes",
              words={"perpendicular": "Normal"}),
    ] = None  # fmt: skip
    surface_motion: Annotated[
        _SURFACE | None, About("Surface motion", "rigid: turns as a whole | translating | bending")
    ] = None
    wavelength: Annotated[Length | None, About("Wavelength", "along s, or waves")] = None


class _WaveTable(_TailTable):
    amplitude: Annotated[
        Length, About("Amplitude", "of the wave; the radius of a helix", start=0.1)
    ]
    waves: Annotated[
        Number | None,
        About("Waves", "or wavelength, one of the two", start=3, usual=(0.5, 8.0)),
    ] = None
    ramp: Annotated[
        Number,
        About("Ramp", "fraction of the length over which the amplitude grows",
              start=0.1, usual=(0.0, 1.0)),
    ] = 0.1  # fmt: skip
    length_measure: Annotated[
        Literal["apparent", "arc"],
        About("Length is", "apparent: along the axis s | arc: along the filament",
              start="apparent"),
    ] = "apparent"  # fmt: skip


class HelixTable(_WaveTable):
    """[tail] of kind "helix"."""

    kind: Annotated[Literal["helix"], _KIND]
    handedness: Annotated[
        Literal["left", "right"], About("Hand", "right for the mirror image", start="left")
    ] = "left"


class PlaneWaveTable(_WaveTable):
    """[tail] of kind "plane_wave"."""

    kind: Annotated[Literal["plane_wave"], _KIND]


class CustomTable(_TailTable):
    """[tail] of kind "custom": `shape` is ``"module:function"`` of a trusted file."""

    kind: Annotated[Literal["custom"], _KIND]
    shape: Annotated[str, About("Centreline", "module:function of a file given to --trust")]
    breaks: Annotated[list[Number], About("Breaks", "fractions of the length with kinks")] = []
    sign: Annotated[Number, About("Sense", "+1 or -1, of a rigid tail's turning")] = 1.0


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
        str | list[str], About("Free", 'or a list such as ["us", "uq", "ur", "os"]', start="all")
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
    tilt: Annotated[Angle, About("Tilt", "nose away from the wall", usual=_TILT)] = 0.0
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
    ends: Annotated[Literal["closed", "open"], About("Ends", "closed: walls | open")] = "closed"


class MagnetTable(_Table):
    """[magnet]: a permanent magnet, fixed in the body."""

    moment: Annotated[
        Moment | list[Moment] | None,
        About("Moment", "magnetic, fixed in the body: [s, q, r], or its size, with a direction",
              entries=("Moment along s", "Moment along q", "Moment along r")),
    ] = None  # fmt: skip
    remanence: Annotated[
        Tesla | None, About("Remanence", "of the magnet, in place of the moment; with its size")
    ] = None
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


_FIELD = About("Kind", "rotating | uniform | oscillating")
_STRENGTH = About("Strength", "of the field", usual=(0.0, 0.02))
_LINE = About("Direction", "in the lab, [x, y, z]")


class RotatingFieldTable(_Table):
    """[field] of kind "rotating"."""

    kind: Annotated[Literal["rotating"], _FIELD]
    strength: Annotated[Tesla, _STRENGTH]
    frequency: Annotated[Frequency, About("Frequency", "turns of the field per time")]
    axis: Annotated[list[Number], About("Axis", "that the field turns about, lab, [x, y, z]")] = [
        1.0, 0.0, 0.0
    ]  # fmt: skip
    cone: Annotated[
        Angle, About("Cone", "angle of the field out of its plane, towards the axis",
                     usual=(-80.0, 80.0))
    ] = 0.0  # fmt: skip


class UniformFieldTable(_Table):
    """[field] of kind "uniform"."""

    kind: Annotated[Literal["uniform"], _FIELD]
    strength: Annotated[Tesla, _STRENGTH]
    direction: Annotated[list[Number], _LINE] = [1.0, 0.0, 0.0]


class OscillatingFieldTable(_Table):
    """[field] of kind "oscillating"."""

    kind: Annotated[Literal["oscillating"], _FIELD]
    strength: Annotated[Tesla, _STRENGTH]
    frequency: Annotated[Frequency, About("Frequency", "cycles of the field per time")]
    direction: Annotated[list[Number], _LINE] = [1.0, 0.0, 0.0]


class RegionTable(_Table):
    """[region]: what ``microswim calibrate --region`` found, as text."""

    data: Annotated[str, About("Region", "a region calibration, as text")]


class SpecTable(_Table):
    """A whole spec file."""

    fluid: FluidTable
    body: SphereTable | SpheroidTable | EllipsoidTable | NoBodyTable = Field(discriminator="shape")
    tail: HelixTable | PlaneWaveTable | CustomTable = Field(discriminator="kind")
    coefficients: CoefficientsTable = CoefficientsTable()
    interaction: InteractionTable = InteractionTable()
    motion: MotionTable = MotionTable()
    region: RegionTable = None  # type: ignore[assignment]
    wall: WallTable = None  # type: ignore[assignment]
    channel: ChannelTable = None  # type: ignore[assignment]
    magnet: MagnetTable = None  # type: ignore[assignment]
    field: RotatingFieldTable | UniformFieldTable | OscillatingFieldTable = Field(
        default=None, discriminator="kind"
    )  # type: ignore[assignment]


#: The kinds of each table, by its name.
TABLES: dict[str, tuple[type[_Table], ...]] = {
    name: get_args(info.annotation) or (info.annotation,)  # type: ignore[misc]
    for name, info in SpecTable.model_fields.items()
}
#: Every field by its dotted name.
FIELDS = fields.read_off(TABLES)
#: Fields that say the same in two ways: one of the two is given.
ALTERNATIVES = {
    **OF_A_SWIMMER,
    "fluid.viscosity": "fluid.kinematic_viscosity",
    "fluid.kinematic_viscosity": "fluid.viscosity",
}
#: The field that chooses the kind of a table.
TAGS = {"body": "shape", "tail": "kind", "field": "kind"}
