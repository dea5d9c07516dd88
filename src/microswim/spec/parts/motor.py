"""What a spec file may say of motors that give a torque."""

from __future__ import annotations

from typing import Annotated

from microswim.spec.fields import About
from microswim.spec.types import Frequency, Table, Torque


class MotorTable(Table):
    """[motor]"""

    torque: Annotated[
        Torque | list[Torque], About("Motor torque", "of each tail's motor; a list for several")
    ]
    no_load_frequency: Annotated[
        Frequency | list[Frequency] | None,
        About("Frequency without load", "where the torque has fallen to none; else it is constant"),
    ] = None
    knee_frequency: Annotated[
        Frequency | list[Frequency] | None,
        About("Frequency of the knee", "up to which the torque does not fall; else from rest on"),
    ] = None
