"""What is measured and in which unit: SI inside, a word for a swimmer without units. The one table.

The quantities of a gait, the fields of a spec, files, tables, pictures and exports read it. Which
units a person may write stands in `microswim.spec.units`.
"""

from __future__ import annotations

from microswim import checks

#: Unit of each dimension, in SI and of a swimmer without units.
UNITS = {
    "number": ("1", "1"),
    "speed": ("m/s", "length/time"),
    "length": ("m", "length"),
    "time": ("s", "time"),
    "angle": ("rad", "rad"),
    "frequency": ("Hz", "1/time"),
    "rate": ("rad/s", "rad/time"),
    "twist": ("m/s, rad/s", "length/time, rad/time"),
    "power": ("W", "power"),
    "torque": ("N m", "torque"),
    "force": ("N", "force"),
    "work": ("J", "work"),
    "wrench": ("N, N m", "force, torque"),
    "bending stiffness": ("N m^2", "force length^2"),
    "speed per torque": ("1/(N s)", "length/(torque time)"),
    "speed per power": ("1/N", "length/(power time)"),
    "viscosity": ("Pa s", "viscosity"),
    "kinematic viscosity": ("m^2/s", "length^2/time"),
    "diffusion": ("m^2/s", "length^2/time"),
    "density": ("kg/m^3", "density"),
    "wavenumber": ("1/m", "1/length"),
    "curvature": ("1/m", "1/length"),
    "drag of a point": ("Pa s m", "viscosity length"),
    "drag of spin": ("Pa s m^2", "viscosity length^2"),
    "volume": ("m^3", "length^3"),
    "current": ("A", "current"),
    "field": ("T", "field"),
    "shear rate": ("1/s", "1/time"),
    "acceleration": ("m/s^2", "length/time^2"),
    "temperature": ("K", "energy"),
    "moment": ("A m^2", "torque/field"),
}
WORDS = {word for si, word in UNITS.values() if word != si} | {"", "1"}


@checks.given(units=checks.text, kind=checks.text)
def unit(units: str, kind: str) -> str:
    """Return unit of a kind of quantity (``"speed"``, ``"length"``, ...) in SI or dimensionless.

    Parameters
    ----------
    units
        ``"SI"`` or ``"dimensionless"``.
    kind
        A key of `UNITS`; what is none is a unit already and comes back.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.io.unit("SI", "speed"), ms.io.unit("dimensionless", "speed")
    ('m/s', 'length/time')
    """
    return UNITS[kind][units != "SI"] if kind in UNITS else kind


def is_dimensionless(unit: str) -> bool:
    """Return whether a unit is one of the words of a dimensionless swimmer, such as
    ``length/time``.
    """
    return unit in WORDS
