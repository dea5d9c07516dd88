"""Quantities such as ``"1.37 um"`` into SI numbers: the door where units come in.

pint says what a unit means, with the angle kept as a dimension of its own: a rate of ``1 rad/s`` is
a 2 pi-th of a turn per second, and ``1 Hz`` is a turn per second. Which units may be written is a
list: what counts things, pixels or per cents is no length and no rate. What may be written is
narrower than what pint would evaluate: a number, then units with powers of one digit, so that no
text of a spec file can keep the machine busy (``"9**9**9**9 m"``).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from microswim.gait.units import unit

if TYPE_CHECKING:
    import pint

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?"
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*")
_POWER = r"(?:\*\*|\^)\s*-?\d(?!\s*(?:\*\*|\^|\d|\.))"
_UNIT = re.compile(rf"(?:1\s*(?=/))?(?:[^\W\d]|[° */()·]|{_POWER})*")


@dataclass(frozen=True)
class Dimension:
    """What a field measures.

    Parameters
    ----------
    name
        Key of `microswim.gait.units.UNITS`.
    example
        A quantity that a person would write.
    smallest, largest
        Magnitudes between which a quantity other than zero must lie (SI).
    """

    name: str
    example: str
    smallest: float = 1e-30
    largest: float = 1e30

    @property
    def si(self) -> str:
        """Its unit inside: SI, angles in radians."""
        return unit("SI", self.name)

    def refused(self, value: float) -> str | None:
        """Return the sentence about a number beyond what swims, or None."""
        if value == 0 or self.smallest <= abs(value) <= self.largest:
            return None
        ends = " ".join((f"{self.smallest:g} to {self.largest:g}", self.si)).strip()
        return f"is beyond what is computed here; from {ends} in magnitude"


#: A field's dimension by name. The fields themselves stand in `microswim.spec.tables`.
DIMENSIONS = {
    d.name: d
    for d in (
        Dimension("length", "1 um", 1e-12, 1e4),
        Dimension("frequency", "10 Hz", 1e-9, 1e12),
        Dimension("time", "1 s", 1e-12, 1e9),
        Dimension("viscosity", "1 mPa s", 1e-9, 1e12),
        Dimension("kinematic viscosity", "1 cSt", 1e-12, 1e12),
        Dimension("density", "1000 kg/m^3", 1e-6, 1e6),
        Dimension("bending stiffness", "1e-22 N m^2", 1e-40, 1e12),
        Dimension("angle", "30 deg"),
        Dimension("curvature", "19 rad/mm", 1e-12, 1e12),
        Dimension("speed", "20 um/s"),
        Dimension("rate", "60 rpm"),
        Dimension("force", "1 pN"),
        Dimension("torque", "2 nN m"),
        Dimension("power", "1 fW"),
        Dimension("volume", "0.5 mm^3", 1e-36, 1e12),
        Dimension("field", "5 mT", 1e-12, 1e3),
        Dimension("current", "2 A"),
        Dimension("moment", "2e-5 A m^2"),
        Dimension("shear rate", "10 1/s", 1e-12, 1e12),
        Dimension("acceleration", "9.81 m/s^2", 1e-12, 1e12),
        Dimension("temperature", "298 K", 1e-6, 1e6),
    )
}

#: The units that may be written; whatever else counts or measures something is refused.
_LIST = """
yocto- = 1e-24 = y-
zepto- = 1e-21 = z-
atto- = 1e-18 = a-
femto- = 1e-15 = f-
pico- = 1e-12 = p-
nano- = 1e-9 = n-
micro- = 1e-6 = µ- = μ- = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
deci- = 1e-1 = d-
hecto- = 1e2 = h-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
meter = [length] = m = metre
second = [time] = s = sec
gram = [mass] = g
ampere = [current] = A
kelvin = [temperature] = K
radian = [angle] = rad
micron = 1e-6 * meter
angstrom = 1e-10 * meter = Å
inch = 0.0254 * meter = in
minute = 60 * second = min
hour = 3600 * second = h = hr
hertz = 1 / second = Hz
degree = 0.017453292519943295 * radian = deg = °
arcminute = degree / 60 = arcmin
arcsecond = degree / 3600 = arcsec
turn = 6.283185307179586 * radian = _ = revolution = rev = cycle
revolutions_per_minute = turn / minute = rpm
revolutions_per_second = turn / second = rps
newton = kilogram * meter / second ** 2 = N
dyne = 1e-5 * newton = dyn
pascal = newton / meter ** 2 = Pa
bar = 1e5 * pascal
poise = 0.1 * pascal * second = P
stokes = 1e-4 * meter ** 2 / second = St
joule = newton * meter = J
watt = joule / second = W
liter = 1e-3 * meter ** 3 = L = l = litre
tesla = kilogram / second ** 2 / ampere = T
gauss = 1e-4 * tesla = G
degree_Celsius = kelvin; offset: 273.15 = °C = degC = celsius
"""
#: Sizes in SI of the units that most specs hold, so that they need not wait for pint, and that
#: the studio writes; a test holds them to what pint says.
SIZES = {
    "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9},
    "Hz": {"Hz": 1.0, "kHz": 1e3},
    "Pa s": {"Pa s": 1.0, "mPa s": 1e-3},
    "kg/m^3": {"kg/m^3": 1.0},
    "N m^2": {"N m^2": 1.0},
    "rad": {"rad": 1.0, "deg": math.pi / 180.0, "°": math.pi / 180.0},
    "A": {"A": 1.0, "mA": 1e-3},
    "T": {"T": 1.0, "mT": 1e-3},
    "A m^2": {"A m^2": 1.0},
    "m^3": {"m^3": 1.0, "mm^3": 1e-9},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "um/s": 1e-6},
    "1/s": {"1/s": 1.0},
    "m/s^2": {"m/s^2": 1.0},
    "K": {"K": 1.0},
}


@cache
def _registry() -> Any:
    import pint  # takes a good part of a second

    empty: Any = None  # of pint's own units
    registry = pint.UnitRegistry(empty, autoconvert_to_preferred=False)
    registry.load_definitions(_LIST.strip().splitlines())
    return registry


def parse(text: str) -> pint.Quantity:
    """Return a quantity as pint has it, in units of the list.

    Raises
    ------
    ValueError
        If the text is no number with a unit, or a unit is not one of the list.
    """
    match = _QUANTITY.fullmatch(text)
    if match is None or len(text) > 80 or not _UNIT.fullmatch(match[2]):
        raise ValueError("must be a number with a unit")
    number, unit = match.groups()
    written = f"1{unit}" if unit.startswith("/") else unit.replace("·", "*")
    try:
        return _registry().Quantity(float(number), written)
    except Exception as error:  # pint's parser raises its tokenizer's errors for garbage
        raise ValueError(f'must be a number with a known unit ("{unit}" is none here)') from error


def to_si(value: Any, unit: str) -> float:
    """Return the number in the SI unit of a quantity such as ``"1.37 um"``.

    A frequency may be given as a rate of an angle and the other way round, a turn for a cycle:
    ``"60 rpm"`` is 1 Hz, and ``"1 Hz"`` is 2 pi rad/s.

    Raises
    ------
    ValueError
        If the text is no quantity or its dimension is not that of `unit`.

    Examples
    --------
    >>> from microswim.spec.units import to_si
    >>> to_si("60 rpm", "Hz"), to_si("1 mPa s", "Pa s")
    (1.0, 0.001)
    """
    text = str(value)
    match = _QUANTITY.fullmatch(text)
    if match and match[2] in SIZES.get(unit, ()):
        return _finite(float(match[1]) * SIZES[unit][match[2]])
    if match and not match[2]:
        raise ValueError(f'must have a unit, as in "{match[1]} {unit}"')
    try:
        quantity = parse(text)
    except ValueError as error:
        raise ValueError(f'{error}, as in "1 {unit}"') from None
    angles = _angles(quantity)
    if unit == "Hz" and angles == 1 and "hertz" not in dict(quantity.unit_items()):
        quantity = quantity / _registry().Quantity(1.0, "turn")
    elif unit == "1/m" and angles == 1:  # a curvature, an angle per length
        quantity = quantity / _registry().Quantity(1.0, "radian")
    elif unit == "rad/s" and angles == 0:
        quantity = quantity * _registry().Quantity(1.0, "turn")
    try:
        number = float(quantity.to(unit).magnitude)
    except Exception as error:  # of another dimension, or beyond the range of numbers
        raise ValueError(f"must have the dimension of {unit}") from error
    return _finite(number)


def _finite(number: float) -> float:
    if not math.isfinite(number):
        raise ValueError("must be a finite quantity")
    return number


def _angles(quantity: pint.Quantity) -> float:
    angles: Any = quantity.dimensionality.get("[angle]", 0)
    return float(angles)


def has_unit(value: Any) -> bool:
    """Return whether a value is the text of a number with something behind it, as a quantity is."""
    return bool(unit_written(value))


def unit_written(value: Any) -> str:
    """Return what stands behind the number in the text of a quantity; empty for all else.

    Examples
    --------
    >>> unit_written("1.5e-3 mPa s"), unit_written("1.5"), unit_written(1.5)
    ('mPa s', '', '')
    """
    match = _QUANTITY.fullmatch(value) if isinstance(value, str) else None
    return "" if match is None else match[2]
