"""What a rotating field does with a robot, as a few lines with units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from microswim.gait.portrait import Printed, Rows
from microswim.gait.readable import quantity, significant
from microswim.gait.units import unit

if TYPE_CHECKING:
    from microswim.path.regimes import Regimes


#: Said of a robot whose moment lies along its long axis.
SPINS = (
    "its moment does not turn it about its own axis, so it goes round with a field that leans, and "
    "spins at a rate of its own; microswim path follows it"
)


class Told(Printed):
    """How regimes are printed."""

    def _portrait(self: Regimes) -> tuple[str, Rows]:  # type: ignore[misc]
        return portrait(self)


def portrait(found: Regimes) -> tuple[str, Rows]:
    """Return title and rows: how often each regime, how fast, where it steps out."""

    def q(value: float, kind: str) -> str:
        return quantity(value, unit(found.units, kind)) if value == value else "-"

    def off(name: str) -> str:
        error = found.expected_error[name]
        return "" if error is None else f" ± {significant(100 * error, 2)} %"

    each = [f"{name} at {found.regime.count(name)}" for name in dict.fromkeys(found.regime)]
    low, high = (q(end(found.velocity), "speed") for end in (np.nanmin, np.nanmax))
    return f"Regimes by {found.model}, {found.units}, {found.frequency.size} frequencies", [
        ("regimes", ", ".join(each)),
        ("velocity", f"{low} to {high} along the field's axis{off('velocity')}"),
        ("step-out", f"{q(found.step_out, 'frequency')}{off('step_out')}"),
        ("wobbling", f"begins at {q(found.wobbling_onset, 'frequency')}"),
        ("more", "plot() draws it, as_dict() has every number"),
    ]
