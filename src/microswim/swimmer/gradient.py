"""Exact derivatives of the numbers of a gait by the complex step, ``Im f(x + ih) / h``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from microswim.gait.observed import output
from microswim.numerics.complex_step import STEP, derivative_from
from microswim.swimmer.fields import lifted
from microswim.swimmer.magnetism.drive import drive_of

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer


def gradient(swimmer: Swimmer, name: str = "mean_velocity", wrt: Any = None) -> dict[str, Any]:
    """Return the exact derivatives by the complex step; see `Swimmer.gradient`."""
    paths = list(swimmer.numbers) if wrt is None else [wrt] if isinstance(wrt, str) else list(wrt)
    out = {}
    for path in paths:
        values = {path: swimmer.numbers.get(path, 0.0) + 1j * STEP}
        one = lifted(swimmer, values)
        value = output(one.gait(), name, drive_of(one))
        out[path] = derivative_from(value)
    return out
