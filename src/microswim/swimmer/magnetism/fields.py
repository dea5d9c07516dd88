"""Every kind of field by the word of the spec: a new one is a class and a line here."""

from __future__ import annotations

from microswim.swimmer.magnetism.applied_field import (
    AppliedField,
    OscillatingField,
    RotatingField,
    UniformField,
)
from microswim.swimmer.magnetism.field_in_space import CoilField, DipoleField
from microswim.swimmer.magnetism.field_in_time import SequenceField
from microswim.swimmer.magnetism.finite_magnet import MagnetField

KINDS = (
    RotatingField, UniformField, OscillatingField, SequenceField, DipoleField, MagnetField,
    CoilField,
)  # fmt: skip
FIELDS: dict[str, type[AppliedField]] = {f.kind: f for f in KINDS}
