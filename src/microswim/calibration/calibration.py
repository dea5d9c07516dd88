"""What every calibration returns: the calibrated swimmer, and what is odd about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from microswim import checks
from microswim.gait.portrait import Printed, Rows
from microswim.swimmer.swimmer import Swimmer


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Calibration(Printed):
    """Outcome of a calibration, at one design (`calibrate`) or over many (`calibrate_region`).

    Parameters
    ----------
    swimmer
        The calibrated swimmer.
    warnings
        What is odd about it, in physical words.

    Examples
    --------
    >>> import microswim as ms
    >>> cell = ms.Swimmer.preset("goto/C")
    >>> fit = ms.calibrate(cell, {"swimming_speed": 6.23e-6}, ["translation.s"])
    >>> isinstance(fit, ms.Calibration), fit.swimmer.units
    (True, 'SI')
    """

    swimmer: Swimmer
    warnings: tuple[str, ...] = ()

    def _portrait(self) -> tuple[str, Rows]:
        odd = [("odd", sentence) for sentence in self.warnings]
        return "Calibration", [*self._found(), *odd, ("swimmer", "has it; to_toml() writes it")]

    def _found(self) -> Rows:
        return []

    def as_dict(self) -> dict[str, Any]:
        """Return what there is to print or to store as JSON."""
        made = self.swimmer.calibration
        said = {
            "calibration": made and made.as_tables(),
            "notes": made.lines(self.swimmer) if made else [],
        }
        return {"warnings": list(self.warnings), **said}
