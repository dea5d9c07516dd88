"""Numbers for people: SI values with a prefix, angles in turns."""

from __future__ import annotations

import math
from typing import Any

_PREFIXES = {
    -24: "y", -21: "z", -18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "",
    3: "k", 6: "M", 9: "G",
}  # fmt: skip


def prefixed(largest: float, unit: str) -> tuple[float, str]:
    """Factor and unit in which a quantity of this size reads well.

    Parameters
    ----------
    largest
        Largest magnitude to be shown.
    unit
        Its unit; only SI units that begin with a metre, second, hertz, watt or newton get a
        prefix. Torques far below a newton metre are given per micrometre, as the field does.

    Returns
    -------
    tuple
        ``(factor, unit)``: show ``value * factor`` in that unit.

    Examples
    --------
    >>> from microswim.gait.readable import prefixed
    >>> prefixed(2.3e-5, "m/s")[1]
    'µm/s'
    """
    if unit not in ("m", "m/s", "s", "Hz", "W", "N", "N m") or not 0 < abs(largest) < math.inf:
        return 1.0, unit
    scale = 1.0
    if unit == "N m" and abs(largest) < 1e-9:
        scale, unit = 1e6, "N µm"
    exponent = 3 * math.floor(math.log10(abs(largest) * scale) / 3 + 1e-12)
    highest = 0 if unit.startswith(("m", "s")) else 9
    exponent = min(max(exponent, -24), highest)
    return scale * 10.0**-exponent, _PREFIXES[exponent] + unit


def quantity(value: Any, unit: str, digits: int = 4) -> str:
    """A number with its unit: ``23.53 µm/s``.

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


def significant(value: float, digits: int = 4) -> str:
    """A number to so many significant digits, with a proper exponent when it is extreme."""
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


def is_dimensionless(unit: str) -> bool:
    """Whether a unit is one of the words of a dimensionless swimmer, such as ``length/time``."""
    return unit in ("", "1") or any(w in unit for w in ("length", "time", "power", "torque"))


def label(name: str, unit: str) -> str:
    """Axis label: ``u (µm/s)``; words of dimensionless swimmers are left out."""
    return name if is_dimensionless(unit) else f"{name} ({unit})"
