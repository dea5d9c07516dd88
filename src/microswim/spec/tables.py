"""What a spec file may hold: its tables, field by field, with the unit of each quantity.

pydantic reads them; the parts themselves check what makes physical sense.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo

from microswim.spec.units import to_si


def _read_quantity(value: Any, info: ValidationInfo, *, unit: str) -> Any:
    """Convert a quantity and note in the context whether it came with a unit."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError("must be a number, or a quantity in quotes")
    seen = {} if info.context is None else info.context
    if isinstance(value, str):
        number = to_si(value, unit)
        seen.setdefault("units", []).append(info.field_name)
        return number
    if value != 0:
        seen.setdefault("bare", []).append(info.field_name)
    return value


def _read_number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError("must be a bare number")
    return value


def _quantity(unit: str) -> Any:
    return Annotated[
        float,
        BeforeValidator(partial(_read_quantity, unit=unit)),
        Field(json_schema_extra={"unit": unit}),
    ]


Number = Annotated[float, BeforeValidator(_read_number)]
Length = _quantity("m")


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class FluidTable(_Table):
    """[fluid]"""

    viscosity: _quantity("Pa s")  # type: ignore[valid-type]
    density: _quantity("kg/m^3") = 0.0  # type: ignore[valid-type]


class SphereTable(_Table):
    """[body] of shape "sphere"."""

    shape: Literal["sphere"]
    radius: Length  # type: ignore[valid-type]


class SpheroidTable(_Table):
    """[body] of shape "spheroid"."""

    shape: Literal["spheroid"]
    semi_axes: list[Length]  # type: ignore[valid-type]
    drag: str = "exact"


class EllipsoidTable(_Table):
    """[body] of shape "ellipsoid"."""

    shape: Literal["ellipsoid"]
    semi_axes: list[Length]  # type: ignore[valid-type]


class NoBodyTable(_Table):
    """[body] of shape "none"."""

    shape: Literal["none"]


class _TailTable(_Table):
    length: Length  # type: ignore[valid-type]
    radius: Length  # type: ignore[valid-type]
    frequency: _quantity("Hz") = 1.0  # type: ignore[valid-type]
    sections: str | None = None
    surface_motion: str | None = None
    wavelength: Length | None = None  # type: ignore[valid-type]


class _WaveTable(_TailTable):
    amplitude: Length  # type: ignore[valid-type]
    waves: Number | None = None
    ramp: Number = 0.1
    length_measure: str = "apparent"


class HelixTable(_WaveTable):
    """[tail] of kind "helix"."""

    kind: Literal["helix"]
    handedness: str = "left"


class PlaneWaveTable(_WaveTable):
    """[tail] of kind "plane_wave"."""

    kind: Literal["plane_wave"]


class CustomTable(_TailTable):
    """[tail] kind = "custom": `shape` names an importable function, ``"my_module:my_function"``."""

    kind: Literal["custom"]
    shape: str
    breaks: list[Number] = []
    sign: Number = 1.0


class CoefficientsTable(_Table):
    """[coefficients]"""

    law: Literal["lighthill", "gray_hancock", "cox", "constant"] = "lighthill"
    spin: bool = True
    tip: bool = False
    normal: _quantity("Pa s") | None = None  # type: ignore[valid-type]
    tangential: _quantity("Pa s") | None = None  # type: ignore[valid-type]


class InteractionTable(_Table):
    """[interaction]"""

    translation: list[Number] = [1.0, 1.0, 1.0]
    rotation: list[Number] = [1.0, 1.0, 1.0]
    coupling: list[list[Number]] = [[0.0] * 3] * 3
    tail: list[Number] = [1.0, 1.0, 1.0]


class MotionTable(_Table):
    """[motion]"""

    free: str | list[str] = "all"
    frequency_frame: str = "body"
    line_element: str = "arc"


def _read_angle(value: Any) -> Any:
    """A bare number in rad or an angle with its unit; neither decides the units of the file."""
    return to_si(value, "rad") if isinstance(value, str) else _read_number(value)


Angle = Annotated[float, BeforeValidator(_read_angle), Field(json_schema_extra={"unit": "rad"})]


class WallTable(_Table):
    """[wall]: a plane wall beside the swimmer (boundary elements)."""

    distance: Length  # type: ignore[valid-type]
    tilt: Angle = 0.0
    azimuth: Angle = 0.0


class ChannelTable(_Table):
    """[channel]: the vessel around the swimmer (finite elements)."""

    diameter: Length  # type: ignore[valid-type]
    length: Length  # type: ignore[valid-type]
    shape: str = "cylinder"
    position: list[Length] = [0.0, 0.0, 0.0]  # type: ignore[valid-type]
    tilt: Angle = 0.0
    ends: str = "closed"


class RegionTable(_Table):
    """[region]: what ``microswim calibrate --region`` found, as text."""

    data: str


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
