"""Numbers that are found by a search or followed in time, with slopes along imaginary parts.

What cannot run in complex numbers is asked at real ones; where the arguments are complex, the
imaginary part of the answer is a central difference along their imaginary parts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.numerics.array import Array

APART = 2e-3  #: relative step of a difference


def with_slopes(function: Callable[[Gait, Any], Array], gait: Gait, drive: Any) -> Any:
    """Return the numbers of a robot and its drive.

    Parameters
    ----------
    function
        Of a gait that stands still at phase 0 and a drive, both real, to numbers.
    gait, drive
        Gait, and `step_out.Drive`, whose numbers may be complex.
    """
    names = [n for n in drive._fields if getattr(drive, n) is not None]
    parts = [gait.resistance(0.0), *(np.asarray(getattr(drive, n)) for n in names)]

    def at(values: list[Any]) -> Array:
        still = Gait(np.array(values[:1]), np.zeros((1, 6)), np.zeros(1), rate=0.0, free=gait.free)
        return function(still, drive._replace(**dict(zip(names, values[1:]))))

    real = [np.real(p) for p in parts]
    if not any(np.iscomplexobj(p) for p in parts):
        return at(real)
    sizes = [np.abs(np.imag(p)).max() / (np.abs(np.real(p)).max() or 1.0) for p in parts]
    step = APART / max(np.nanmax(sizes), 1e-300)
    up, down = (at([np.real(p) + s * step * np.imag(p) for p in parts]) for s in (1, -1))
    return at(real) + 1j * (up - down) / (2.0 * step)
