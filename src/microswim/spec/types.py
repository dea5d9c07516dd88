"""Types of the fields of a spec: quantities of each dimension, bare numbers, and their table."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict

from microswim.spec.fields import Measures
from microswim.spec.units import DIMENSIONS, to_si


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
Time = Annotated[float, _reads("time"), Measures("time")]
Frequency = Annotated[float, _reads("frequency"), Measures("frequency")]
Viscosity = Annotated[float, _reads("viscosity"), Measures("viscosity")]
Kinematic = Annotated[float, _reads("kinematic viscosity"), Measures("kinematic viscosity")]
Density = Annotated[float, _reads("density"), Measures("density")]
Angle = Annotated[float, _reads("angle"), Measures("angle")]
Bending = Annotated[float, _reads("bending stiffness"), Measures("bending stiffness")]
Curvature = Annotated[float, _reads("curvature"), Measures("curvature")]
Volume = Annotated[float, _reads("volume"), Measures("volume")]
Tesla = Annotated[float, _reads("field"), Measures("field")]
Current = Annotated[float, _reads("current"), Measures("current")]
Speed = Annotated[float, _reads("speed"), Measures("speed")]
ShearRate = Annotated[float, _reads("shear rate"), Measures("shear rate")]
Acceleration = Annotated[float, _reads("acceleration"), Measures("acceleration")]
Temperature = Annotated[float, _reads("temperature"), Measures("temperature")]
Moment = Annotated[float, _reads("moment"), Measures("moment")]
Force = Annotated[float, _reads("force"), Measures("force")]
Torque = Annotated[float, _reads("torque"), Measures("torque")]


class Table(BaseModel):
    """A table of a spec file: no fields but its own, and finite numbers."""

    # What checks a table is built when a file holds one: building all takes longer than a gait.
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, defer_build=True)
