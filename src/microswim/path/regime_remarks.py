"""What is said beside the regimes of a magnetic robot: inertia, its long axis, no hold."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.poses.one_pose import remark, remark_turned
from microswim.gait.readable import quantity, significant
from microswim.gait.turning.long_axis import AXES, long_axis
from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.gait.turning.step_out import mobility_of
from microswim.gait.units import unit
from microswim.numerics.array import Array
from microswim.path.regime_portrait import SPINS
from microswim.swimmer.physical_sense import INERTIA
from microswim.swimmer.swimmer import Swimmer


def turns(frequency: float, units: str) -> str:
    """Return a frequency of turning in the words of its units.

    Examples
    --------
    >>> turns(1250.0, "SI"), turns(0.5, "dimensionless")
    ('1.250 kHz', '0.5000 turns per time')
    """
    said = quantity(frequency, unit(units, "frequency"))
    return said if units == "SI" else f"{said} turns per time"


def long_axis_of(swimmer: Swimmer, gait: Gait) -> int:
    """Return the axis from which a robot's precession is counted: s, or the long one of a body."""
    return long_axis(mobility_of(gait)) if swimmer.tail.is_absent else 0


def reynolds_of(swimmer: Swimmer, rates: Array, angle: Array, axis: int = 0) -> Array:
    """Return ``rho w a^2 / mu``, a the half length and half width as the robot turns."""
    across, along = inertia_of(swimmer, axis)
    tilt = np.where(np.isnan(angle), np.pi / 2.0, angle)
    return rates * (across + along * np.sin(tilt) ** 2)


def inertia_of(swimmer: Swimmer, axis: int = 0) -> tuple[float, float]:
    """Return ``rho a^2 / mu`` (time) of the half width and of the half length of a robot."""
    rs, *sides = np.roll([float(np.real(x)) for x in swimmer.body.semi_axes3], -axis)
    tail = float(getattr(swimmer.tail, "amplitude", None) or 0.0) + float(swimmer.tail.radius)
    long = rs + float(np.real(swimmer.tail.apparent_length)) / 2.0
    fluid = swimmer.fluid
    slowness = float(np.real(fluid.density)) / float(np.real(fluid.viscosity))
    half_width, half_length = float(max(*sides, tail)), float(long)
    return slowness * half_width**2, slowness * half_length**2


def remarks_of(
    gait: Gait, steady: SteadyTurning, frequencies: Array, reynolds: Array, axis: int
) -> Iterator[str]:
    """Return what goes with the numbers of a rigid robot."""
    held = gait.one_pose
    told = remark(held) if held else None
    for said in gait.info.get("remarks", ()):
        yield remark_turned(held) if said == told else said
    if axis:
        yield f"the body is long along {AXES[axis]}: angles and regimes are those of that axis"
    if not steady.step_out:
        why = SPINS if steady.cone else "its moment does not turn it"
        yield f"the field never holds the robot: {why}"
    yield from of_inertia(frequencies, reynolds, gait.units)


def of_inertia(frequencies: Array, reynolds: Array, units: str) -> Iterator[str]:
    """Return from which frequency on inertia, which is left out, is felt."""
    if reynolds.max() > INERTIA:
        first = frequencies[np.argmax(reynolds > INERTIA)]
        yield (
            f"from {turns(first, units)} on the Reynolds number of the turning is above "
            f"{INERTIA:g} (largest {significant(reynolds.max(), 2)}): inertia, which is left out, "
            "is felt there"
        )
