"""Thermal noise: the energy k_B T that drives Brownian motion."""

from __future__ import annotations

from dataclasses import dataclass

from microswim import checks

BOLTZMANN = 1.380649e-23  #: J/K, exact


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Noise:
    """Thermal noise of the fluid on a swimmer.

    Parameters
    ----------
    temperature
        Of the fluid, K; of a swimmer without units the thermal energy k_B T.

    Raises
    ------
    SpecError
        If the temperature is not positive.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Noise(temperature=298.0).energy("SI") < 5e-21
    True
    """

    temperature: float

    def __post_init__(self) -> None:
        checks.positive("noise.temperature", self.temperature, "temperature")

    def energy(self, units: str) -> float:
        """Return k_B T, in J or in the swimmer's own units."""
        return self.temperature * (BOLTZMANN if units == "SI" else 1.0)
