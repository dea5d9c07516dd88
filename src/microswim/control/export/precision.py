"""Double or float: what differs in the C, and C with float in place of double."""

from __future__ import annotations

import re

import numpy as np

from microswim.control.response import scale
from microswim.control.stepper import Stepper
from microswim.errors import SpecError

#: Type and mask of the bits of an infinite number; below which square of an angle series are
#: taken; rounding of a trace; how the phase stays where the precision is good.
PRECISIONS = {
    "double": {
        "bits": "uint64_t",
        "exponent": "0x7ff0000000000000u",
        "small": "1e-6",
        "trace": "1e-9",
        "wrap": "",
        "wrapped": "",
        "shift": "11",
        "steps_of_one": "9007199254740992.0",
    },
    "float": {
        "bits": "uint32_t",
        "exponent": "0x7f800000u",
        "small": "1e-2",
        "trace": "1e-5",
        "wrap": "\n    next.phase -= 6.283185307179586 * floor(next.phase / 6.283185307179586);",
        "wrapped": ", from 0 to 2 pi",
        "shift": "40",
        "steps_of_one": "16777216.0",
    },
}
#: Values of a template that hold numbers of C.
FIGURES = (
    *("limits", "locked", "viscosity_value", "moment_values", "soft_values", "rate_value"),
    *("declared", "actuate", "tables", "small", "trace", "wrap", "energy", "steps_of_one"),
    *("boundary", "start_position", "start_quaternion"),
)
_LITERAL = re.compile(r"(?<![\w.@])(\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+)(?![\w.])")
_FUNCTION = re.compile(r"\b(sqrt|sin|cos|atan2|exp|log|log1p|fabs|fmax|fmin|ceil|floor)\(")


def single(text: str) -> str:
    """Return C with float in place of double: types, functions of libm, numbers."""
    text = re.sub(r"\bdouble\b", "float", text)
    return _LITERAL.sub(r"\1f", _FUNCTION.sub(r"\1f(", text))


def check_range(stepper: Stepper, viscosity: float) -> None:
    """Refuse a model whose numbers a float cannot hold.

    Raises
    ------
    SpecError
        If a force, a torque or a velocity of the model is above 1e37 or below 1e-30.
    """
    sizes = np.concatenate([*(scale(t) for t in stepper.response.tables), [viscosity]])
    if sizes.max() > 1e37 or sizes.min() < 1e-30:
        raise SpecError(
            "precision", "float", '"double"', "the model has numbers beyond those of a float"
        )
