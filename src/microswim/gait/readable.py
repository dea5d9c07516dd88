"""Numbers for people: SI values with a prefix, angles in turns."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from microswim.gait.units import is_dimensionless

if TYPE_CHECKING:
    from microswim.gait.gait import Gait

#: Where the documentation says how an error is known, as it stands beside errors.
EXPLAINED = "what ± means: docs/errors.md"

#: Units in which people of the field read a quantity, from large to small.
_READ_IN = {
    "m": {"m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "µm/s": 1e-6, "nm/s": 1e-9},
    "s": {"s": 1.0, "ms": 1e-3, "µs": 1e-6},
    "1/m": {"1/µm": 1e6, "1/mm": 1e3, "1/m": 1.0},
    "Hz": {"MHz": 1e6, "kHz": 1e3, "Hz": 1.0, "mHz": 1e-3},
    "W": {"W": 1.0, "mW": 1e-3, "µW": 1e-6, "nW": 1e-9, "pW": 1e-12, "fW": 1e-15},
    "N": {"N": 1.0, "mN": 1e-3, "µN": 1e-6, "nN": 1e-9, "pN": 1e-12, "fN": 1e-15},
    "T": {"T": 1.0, "mT": 1e-3, "µT": 1e-6},
    "A": {"A": 1.0, "mA": 1e-3, "µA": 1e-6},
    "A m^2": {"A m^2": 1.0, "mA m^2": 1e-3, "µA m^2": 1e-6, "nA m^2": 1e-9},
    "N m": {
        "N m": 1.0,
        "mN m": 1e-3,
        "µN m": 1e-6,
        "nN m": 1e-9,
        "nN µm": 1e-15,
        "pN µm": 1e-18,
    },
}

#: Of each SI unit: name, size, and least value that is read in it, from large to small;
#: 0.001 nN m is read rather than a thousand nN µm.
READ_IN = {
    si: [(name, size, 1e-3 * size if name == "nN m" else size) for name, size in units.items()]
    for si, units in _READ_IN.items()
}


def prefixed(largest: float, unit: str) -> tuple[float, str]:
    """Return factor and unit in which a quantity of this size reads well.

    Parameters
    ----------
    largest
        Largest magnitude to be shown.
    unit
        Its SI unit; lengths, speeds, times, rates, powers, forces and torques get a prefix that
        people of the field use: nN m, nN µm, pN µm, fW, never aW or fN µm.

    Returns
    -------
    tuple
        ``(factor, unit)``: show ``value * factor`` in that unit.

    Examples
    --------
    >>> from microswim.gait.readable import prefixed
    >>> prefixed(2.3e-5, "m/s")[1], prefixed(9.4e-10, "N m")[1]
    ('µm/s', 'nN m')
    """
    if unit not in READ_IN or not 0 < abs(largest) < math.inf:
        return 1.0, unit
    fits = (x for x in READ_IN[unit] if abs(largest) >= x[2] * (1.0 - 1e-12))
    name, size, _ = next(fits, READ_IN[unit][-1])
    return (1e18 if size == 1e-18 else 1.0 / size), name


def quantity(value: Any, unit: str, digits: int = 4) -> str:
    """Return a number with its unit: ``23.53 µm/s``.

    Units ``length/time`` and the like of dimensionless swimmers are left out; NaN and infinity
    are said in words.

    Examples
    --------
    >>> from microswim.gait.readable import quantity
    >>> quantity(2.353e-05, "m/s"), quantity(-0.0369872, "length/time")
    ('23.53 µm/s', '-0.03699')
    """
    value = float(value)
    if not math.isfinite(value):
        return significant(value)
    factor, name = prefixed(value, unit)
    text = significant(value * factor, digits)
    return text if is_dimensionless(unit) else f"{text} {name}"


def spec_value(value: Any, unit: str) -> str:
    """Return a number of a spec with its unit, angles in degrees: ``30.00 deg``.

    Examples
    --------
    >>> from microswim.gait.readable import spec_value
    >>> spec_value(0.005, "T"), spec_value(1.5, "rad"), spec_value(2.0, "")
    ('5.000 mT', '85.94 deg', '2.000')
    """
    if unit == "rad":
        return f"{significant(math.degrees(value))} deg"
    return quantity(value, unit or "1")


def with_error(value: Any, error: float | None, unit: str) -> str:
    """Return a number with the error to expect of it: ``-30.7 ± 0.2 µm/s``.

    Parameters
    ----------
    value
        The number.
    error
        Its relative error; None where it is not known: the number stands alone.
    unit
        Its unit.

    Examples
    --------
    >>> from microswim.gait.readable import with_error
    >>> with_error(-3.0712e-05, 0.007, "m/s"), with_error(-0.4157, None, "rad/time")
    ('-30.71 ± 0.21 µm/s', '-0.4157')
    """
    value = float(value)
    if not error or value == 0 or not math.isfinite(value * error):
        return quantity(value, unit)
    factor, name = prefixed(value, unit)
    half = abs(value * error * factor)
    places = 1 - math.floor(math.log10(half) + 1e-12)
    if not -6 < places < 8:
        return f"{quantity(value, unit)} ± {significant(100.0 * error, 2)} %"
    places = max(places - (half >= 10.0 ** (1 - places) * 9.95), 0)
    text = f"{value * factor:.{places}f} ± {half:.{places}f}"
    return text if is_dimensionless(unit) else f"{text} {name}"


def but_rounding(values: Iterable[Any], share: float = 1e-9) -> list[float]:
    """Return numbers of one kind, those that are nothing beside the largest as zero.

    Examples
    --------
    >>> but_rounding([-13.1, 4e-15, 0.5])
    [-13.1, 0.0, 0.5]
    """
    each = [float(x) for x in values]
    largest = max((abs(x) for x in each), default=0.0)
    return [0.0 if abs(x) < share * largest else x for x in each]


def significant(value: float, digits: int = 4) -> str:
    """Return a number to so many significant digits, with a proper exponent when it is extreme."""
    if math.isnan(value):
        return "not defined"
    if math.isinf(value):
        return "infinite"
    if abs(value) < 1e-300:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-12)
    if -5 < exponent < 6:
        return f"{value:.{max(0, digits - 1 - exponent)}f}"
    return f"{value:.{digits - 1}e}"


def percent(share: float | None, signed: bool = False) -> str:
    """Return a share in per cent with two digits, or that it is not known.

    Examples
    --------
    >>> from microswim.gait.readable import percent
    >>> percent(0.0123), percent(1.6), percent(-1.0, signed=True), percent(None)
    ('1.2 %', '160 %', '-100 %', 'not known')
    """
    if share is None:
        return "not known"
    return f"{float(f'{100.0 * share:.2g}'):{'+' if signed else ''}g} %"


def label(name: str, unit: str) -> str:
    """Return Axis label: ``u (µm/s)``; words of dimensionless swimmers are left out."""
    return name if is_dimensionless(unit) else f"{name} ({unit})"


def origin(gait: Gait) -> tuple[str, ...]:
    """Return what a gait says of where it comes from and how far off it is, a sentence each."""
    info = gait.info
    said = [*info.get("calibration", ()), *info.get("remarks", ())]
    error = info.get("expected_error")
    if isinstance(error, dict) and error.get("us") is not None:
        said.append(f"expected error of u_s {percent(error['us'])}: {error['how']}")
    return tuple(said)
