"""What a calibration over a region returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from microswim import checks
from microswim.calibration.calibration import Calibration
from microswim.errors import renamed
from microswim.gait.portrait import Rows
from microswim.gait.readable import percent, significant

if TYPE_CHECKING:
    from microswim.calibration.region.correction import Correction


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RegionCalibration(Calibration):
    """Outcome of a calibration over a region of designs.

    Parameters
    ----------
    swimmer
        The same swimmer with a region calibration: its surrogate gaits hold over the region.
    warnings
        What is odd, in physical words.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix")
    >>> region = {"tail.amplitude": (0.08, 0.12)}
    >>> fit = ms.calibrate_region(robot, region, "rft", solves=8, workers=0)
    >>> fit.reference, fit.solves, fit.swimmer.gait().info["outside"]
    ('rft', 8, [])
    """

    def _found(self) -> Rows:
        low, high = self.region.low, self.region.high
        inside = [(n, f"{significant(low[n])} to {significant(high[n])}") for n in low]
        left_out = [
            (n, f"off by {percent(e['median'])} median, {percent(e['worst'])} worst")
            for n, e in self.errors.items()
        ]
        return [("by", f"{self.solves} solves of {self.reference}"), *inside, *left_out]

    @property
    def region(self) -> Correction:
        """What the swimmer carries: smooth corrections with their ranges."""
        return self.swimmer.region  # type: ignore[return-value]

    @property
    def reference(self) -> str:
        """Name of the reference solver."""
        return self.region.about["reference"]

    @property
    def solves(self) -> int:
        """Number of designs that were solved and fitted."""
        return self.region.about["solves"]

    @property
    def errors(self) -> dict[str, dict[str, float]]:
        """Median, 90 % quantile and worst left-out error of each velocity."""
        return self.region.errors

    @property
    def set_aside(self) -> list[dict[str, float]]:
        """Designs that all others contradict."""
        return self.region.about["set_aside"]

    @property
    def refused(self) -> list[dict[str, Any]]:
        """Designs that the reference refused, each with the reason."""
        return self.region.about["refused"]

    def as_dict(self) -> dict[str, Any]:
        """Return what there is to print or to store as JSON."""
        low, high = self.region.low, self.region.high
        return {
            "region": {name: [low[name], high[name]] for name in low},
            "reference": self.reference,
            "solves": self.solves,
            "left_out_error": self.errors,
            "set_aside": self.set_aside,
            "refused": self.refused,
            **super().as_dict(),
        }

    def __getattr__(self, name: str) -> Any:
        """Return what the swimmer has: `calibrate_region` returned it until this release."""
        if name.startswith("__") or name == "swimmer":
            raise AttributeError(name)
        found = getattr(self.swimmer, name)
        renamed(f"calibrate_region(...).{name}", f"calibrate_region(...).swimmer.{name}")
        return found
